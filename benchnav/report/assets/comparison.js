// Shows the comparison of two chosen navigators. `template`, `config` and `areas` are of figures.js.

(() => {
  const read = (id) => JSON.parse(document.getElementById(id).textContent);
  const shared = read("shared");
  const [first, second, track] = ["first", "second", "track"].map((id) =>
    document.getElementById(id),
  );
  const names = shared.navigators.map((navigator) => navigator.name);
  const LONG = 600; // characters: longer notes are folded
  const MIRRORED = { better: "worse", worse: "better", higher: "lower", lower: "higher" };
  const GREY = "#7a8794";
  const ROW = 24,
    FRAME = 110;

  /** Return an element with a text. */
  function element(name, text = "", className = "") {
    const made = document.createElement(name);
    made.textContent = text;
    if (className) made.className = className;
    return made;
  }

  /** Fill a menu with options. */
  function fill(menu, texts) {
    for (const [index, text] of texts.entries()) menu.append(new Option(text, index));
  }

  /** Return the comparisons of two navigators, seen from the first. */
  function comparisons(a, b) {
    const pair = read(a < b ? `pair-${a}-${b}` : `pair-${b}-${a}`);
    const sign = a < b ? 1 : -1;
    const turned = (x) => (x === null ? null : sign * x || 0);
    const rows = pair.rows.map(([metric, place, worlds, difference, low, high, p, verdict]) => {
      const [scenario, track, role, split] = shared.places[place];
      const word = shared.verdicts[verdict];
      return {
        metric: shared.metrics[metric],
        scenario,
        track,
        role,
        split,
        worlds,
        p,
        difference: turned(difference),
        low: turned(sign > 0 ? low : high),
        high: turned(sign > 0 ? high : low),
        verdict: sign > 0 ? word : (MIRRORED[word] ?? word),
      };
    });
    return { ...pair, rows };
  }

  /** Return the text that distinguishes the place of a comparison from the others. */
  function placeOf(row, rows) {
    const several = (key) => new Set(rows.map((each) => each[key])).size > 1;
    const parts = [row.scenario || "all scenarios"];
    if (several("track")) parts.push(row.track);
    if (several("role")) parts.push(`${row.role}s`);
    if (several("split")) parts.push(row.split);
    return parts.join(", ");
  }

  /** Return the decimals that the narrowest interval of some rows of one metric resolves. */
  function placesOf(rows) {
    const halves = rows.map((row) => (row.high - row.low) / 2).filter((half) => half > 0);
    const least = rows[0]?.metric.decimals ?? 0;
    if (!halves.length) return Math.max(2, least);
    const half = Math.min(...halves);
    const power = Math.floor(Math.log10(half));
    return Math.min(Math.max(least, (half / 10 ** power < 3 ? 1 : 0) - power), 9);
  }

  /** Return a number with a sign. */
  function signed(x, places) {
    const text = Math.abs(x).toFixed(places);
    return Number(text) === 0 ? "0" : `${x < 0 ? "−" : "+"}${text}`;
  }

  /** Return "+4.2 s [+2.9, +5.6]". */
  function textOf(row, places) {
    if (!row.worlds || row.difference === null) return "no common value";
    const name = row.metric.unit ? ` ${row.metric.unit}` : "";
    const value = `${signed(row.difference, places)}${name}`;
    if (row.low === null) return value;
    return `${value} [${signed(row.low, places)}, ${signed(row.high, places)}]`;
  }

  /** Whether a comparison shows a difference. */
  const isDecided = (row) => row.verdict in MIRRORED;

  /** Return the style of a mark: that of the better navigator; grey for a tie. */
  function markOf(row, a, b) {
    if (!isDecided(row)) return { color: GREY, symbol: "circle-open" };
    if (!row.metric.better) return { color: GREY, symbol: "circle" };
    return row.verdict === "better" ? a : b;
  }

  const plain = (text) => text.replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/>/g, "&gt;");

  /** Return the figure of one metric. */
  function forest(metric, rows, every, a, b) {
    const shown = rows.filter((row) => row.worlds && row.difference !== null);
    const y = shown.map((row) => plain(placeOf(row, every)));
    const [x, low, high] = ["difference", "low", "high"].map((key) =>
      shown.map((row) => row[key] ?? row.difference),
    );
    const marks = shown.map((row) => markOf(row, a, b));
    const reach = 1.08 * Math.max(...[...x, ...low, ...high].map(Math.abs), 0) || 1;
    const bars = shown.map((row, k) => ({
      type: "scatter",
      mode: "lines",
      x: [low[k], high[k]],
      y: [y[k], y[k]],
      hoverinfo: "skip",
      line: { color: marks[k].color, width: row.scenario ? 2 : 4 },
    }));
    const sides = {
      better: "",
      higher: "← B better · A better →",
      lower: "← A better · B better →",
    };
    const order = [...new Set(y)].reverse();
    const places = placesOf(shown);
    return {
      data: [
        ...bars,
        {
          type: "scatter",
          mode: "markers",
          x,
          y,
          marker: {
            color: marks.map((mark) => mark.color),
            symbol: marks.map((mark) => mark.symbol),
            size: 10,
            line: { width: 1.5, color: marks.map((mark) => mark.color) },
          },
          text: shown.map(
            (row) => `${plain(textOf(row, places))}<br>${row.verdict}, ${row.worlds} worlds`,
          ),
          hovertemplate: "%{y}<br>%{text}<extra></extra>",
        },
      ],
      layout: {
        title: { text: plain(metric.name), x: 0.02, xanchor: "left" },
        showlegend: false,
        height: FRAME + ROW * Math.max(order.length, 2),
        xaxis: {
          range: [-reach, reach],
          zeroline: true,
          title: {
            text: `A − B${metric.unit ? ` [${plain(metric.unit)}]` : ""}<br>${sides[metric.better] ?? ""}`,
            font: { size: 12 },
          },
        },
        yaxis: {
          type: "category",
          categoryorder: "array",
          categoryarray: order,
          range: [-0.6, order.length - 0.4],
          fixedrange: true,
          ticks: "",
        },
        margin: { t: 40, b: 76 },
      },
    };
  }

  /** Return how often each verdict occurs: "better in 3 of 6, tie in 3 of 6". */
  function outcome(rows) {
    const counts = new Map();
    for (const row of rows) counts.set(row.verdict, (counts.get(row.verdict) ?? 0) + 1);
    const ordered = [...counts].sort((one, other) => other[1] - one[1]);
    return ordered.map(([verdict, n]) => `${verdict} in ${n} of ${rows.length}`).join(", ");
  }

  /** Return a word as a shell reads it. */
  const quoted = (word) =>
    /^[\w@%+=:,./-]+$/.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`;

  function drawFigures(rows, a, b) {
    const forests = document.getElementById("forests");
    for (const area of forests.querySelectorAll(".plot-area")) {
      areas.splice(areas.indexOf(area), 1);
      Plotly.purge(area);
    }
    const metrics = shared.metrics.filter((metric) => rows.some((row) => row.metric === metric));
    const figures = metrics.map((metric) =>
      forest(
        metric,
        rows.filter((row) => row.metric === metric),
        rows,
        a,
        b,
      ),
    );
    const frames = metrics.map((metric, k) => frameOf(metric, figures[k], rows, a, b));
    forests.replaceChildren(...frames); // all before one is drawn, as they share the width
    frames.forEach((frame, k) => {
      const area = frame.firstChild;
      areas.push(area);
      Plotly.newPlot(area, figures[k].data, { ...figures[k].layout, template: template() }, config);
    });
  }

  /** Return the element of a figure, not drawn yet. */
  function frameOf(metric, figure, rows, a, b) {
    const area = element("div", "", "plot-area");
    area.dataset.drawn = "true";
    area.setAttribute("role", "img");
    area.setAttribute("aria-label", `${metric.name}: ${a.name} − ${b.name}`);
    area.style.height = `${figure.layout.height}px`;
    const verdicts = outcome(rows.filter((row) => row.metric === metric));
    const frame = element("figure", "", "plot");
    frame.append(
      area,
      element("figcaption", `${metric.title}. Verdict on ${a.name}: ${verdicts}.`),
    );
    return frame;
  }

  function drawTable(rows) {
    const table = document.getElementById("differences");
    const metrics = shared.metrics.filter((metric) => rows.some((row) => row.metric === metric));
    const head = element("tr");
    head.append(element("th", "scenario"), element("th", "worlds", "number"));
    for (const metric of metrics) head.append(element("th", `${metric.name}, A − B`, "number"));
    const every = [...new Set(rows.map((row) => placeOf(row, rows)))];
    const places = metrics.map((metric) => placesOf(rows.filter((row) => row.metric === metric)));
    const body = every.map((place) => {
      const line = element("tr");
      const cells = metrics.map((metric) =>
        rows.find((row) => row.metric === metric && placeOf(row, rows) === place),
      );
      line.append(
        element("td", place),
        element("td", String(cells.find((row) => row)?.worlds ?? ""), "number"),
      );
      for (const [k, row] of cells.entries()) {
        const cell = element(
          "td",
          row ? textOf(row, places[k]) : "",
          row && isDecided(row) ? "number best" : "number",
        );
        if (row?.worlds) cell.append(element("div", row.verdict, "muted"));
        line.append(cell);
      }
      return line;
    });
    const parts = [element("thead"), element("tbody")];
    parts[0].append(head);
    parts[1].append(...body);
    table.replaceChildren(...parts);
  }

  /** Return a list behind a heading that opens it. */
  function folded(list, count) {
    const details = element("details");
    const noun = count === 1 ? "note" : "notes";
    details.append(element("summary", `${count} ${noun} on this comparison`), list);
    return details;
  }

  function show() {
    const [a, b] = [first, second].map((menu) => Number(menu.value));
    const notes = document.getElementById("notes");
    notes.replaceChildren();
    for (const menu of [first, second]) {
      const other = menu === first ? second : first;
      for (const option of menu.options) option.disabled = option.value === other.value;
    }
    const { family, needed, notes: noted, rows } = comparisons(a, b);
    const texts = noted[track.value];
    rows.sort((one, other) => Boolean(one.scenario) - Boolean(other.scenario));
    if (texts.length || !rows.length) {
      const list = element("ul");
      list.append(...texts.map((text) => element("li", text)));
      const box = element("div", rows.length ? "" : "Both never ran in the same world.", "note");
      box.append(texts.join().length > LONG ? folded(list, texts.length) : list);
      notes.append(box);
    }
    const shown = rows.filter((row) => row.track === shared.tracks[track.value]);
    drawFigures(shown, shared.navigators[a], shared.navigators[b]);
    drawTable(shown);
    for (const each of document.querySelectorAll(".family")) each.textContent = family;
    document.getElementById("needed").textContent = needed;
    document.getElementById("too-few").hidden = !shown.some(
      (row) => row.verdict === "too few worlds",
    );
    document.getElementById("command").textContent = [
      "benchnav compare",
      ...[...shared.runs, names[a], names[b]].map(quoted),
    ].join(" ");
    const state = new URLSearchParams({
      a: names[a],
      b: names[b],
      track: shared.tracks[track.value],
    });
    history.replaceState(null, "", `#${state}`);
  }

  /** Choose what the address names; else the first two navigators. */
  function restore() {
    const state = new URLSearchParams(location.hash.slice(1));
    const a = Math.max(names.indexOf(state.get("a")), 0);
    const b = names.indexOf(state.get("b"));
    first.value = a;
    second.value = b >= 0 && b !== a ? b : a === 0 ? 1 : 0;
    track.value = Math.max(shared.tracks.indexOf(state.get("track")), 0);
  }

  fill(first, names);
  fill(second, names);
  fill(track, shared.tracks);
  document.getElementById("track-label").hidden = shared.tracks.length < 2;
  restore();
  for (const menu of [first, second, track]) menu.addEventListener("change", show);
  document.getElementById("swap").addEventListener("click", () => {
    [first.value, second.value] = [second.value, first.value];
    show();
  });
  addEventListener("hashchange", () => {
    restore();
    show();
  });
  addEventListener("DOMContentLoaded", show); // plotly.js and figures.js are loaded by then
})();
