// Draws each figure when it is scrolled into view, in the colours of the page.

const dark = matchMedia("(prefers-color-scheme: dark)");

function template() {
  const style = getComputedStyle(document.documentElement);
  const color = (name) => style.getPropertyValue(`--${name}`).trim();
  const axis = {
    gridcolor: color("line"),
    linecolor: color("line"),
    zerolinecolor: color("soft"),
    automargin: true,
  };
  return {
    layout: {
      font: { family: "system-ui, sans-serif", size: 13, color: color("ink") },
      title: { font: { size: 14 } },
      paper_bgcolor: "rgba(0, 0, 0, 0)",
      plot_bgcolor: "rgba(0, 0, 0, 0)",
      xaxis: axis,
      yaxis: axis,
      margin: { l: 50, r: 15, t: 30, b: 45 },
      modebar: { bgcolor: "rgba(0, 0, 0, 0)", color: color("soft"), activecolor: color("ink") },
      legend: { bgcolor: "rgba(0, 0, 0, 0)" },
      hoverlabel: {
        bgcolor: color("panel"),
        bordercolor: color("line"),
        font: { color: color("ink") },
      },
    },
  };
}

const config = {
  responsive: true,
  displaylogo: false,
  modeBarButtonsToRemove: ["select2d", "lasso2d"],
  toImageButtonOptions: { format: "svg" },
};

function draw(area) {
  if (area.dataset.drawn) return;
  area.dataset.drawn = "true";
  const figure = JSON.parse(area.parentElement.querySelector("script").textContent);
  Plotly.newPlot(area, figure.data, { ...figure.layout, template: template() }, config);
}

const areas = [...document.querySelectorAll(".plot-area")];
const watch = new IntersectionObserver(
  (entries) => {
    for (const entry of entries) if (entry.isIntersecting) draw(entry.target);
  },
  { rootMargin: "400px" },
);
for (const area of areas) watch.observe(area);

function recolor() {
  for (const area of areas) if (area.dataset.drawn) Plotly.relayout(area, { template: template() });
}
dark.addEventListener("change", recolor);
addEventListener("beforeprint", () => {
  document.documentElement.classList.add("printed");
  areas.forEach(draw);
  recolor();
});
addEventListener("afterprint", () => {
  document.documentElement.classList.remove("printed");
  recolor();
});
