// Makes tables of the class "data" sortable, and connects them to the filters above them.

const PHONE = "(max-width: 640px)";
const FEW = 2; // metrics that are shown at first on a phone
const ROWS = 50; // a longer table has several pages

/** Show the rows whose data attributes are those of the filters. */
function filter(table, form) {
  const wanted = [...form.elements].filter((select) => select.value);
  table.search
    .fixed("filters", (_text, _cells, index) => {
      const row = table.row(index).node();
      return wanted.every((select) => row.dataset[select.name] === select.value);
    })
    .draw();
}

/** Hide the columns of the class "collapse" in which all rows agree. */
function collapse(table) {
  const rows = table.rows({ search: "applied" }).nodes().toArray();
  // biome-ignore lint/suspicious/useIterableCallbackReturn: this `every` of DataTables visits all columns
  table.columns(".collapse").every(function () {
    const name = this.header().dataset.name;
    this.visible(new Set(rows.map((row) => row.dataset[name])).size > 1, false);
  });
}

/** Set the filters that the address names: index.html#track=unknown&scenario=trap/u@1 */
function readAddress(form) {
  const named = new URLSearchParams(location.hash.slice(1));
  const isNamed = [...form.elements].some((select) => named.has(select.name));
  for (const select of form.elements) {
    const wanted = named.get(select.name) ?? "";
    if (isNamed && [...select.options].some((option) => option.value === wanted))
      select.value = wanted;
  }
}

function writeAddress(form) {
  const chosen = new URLSearchParams(
    [...form.elements].map((select) => [select.name, select.value]),
  );
  history.replaceState(null, "", `#${chosen}`);
}

/** A family and one scenario are alternatives. */
function reset(form, changed) {
  const other = { family: "scenario", scenario: "family" }[changed.name];
  if (other && changed.value && form.elements[other]) form.elements[other].value = "";
}

/** The check boxes that show and hide columns. */
function boxes(id) {
  return [...document.querySelectorAll(`.columns[data-table="${id}"] input`)];
}

function connect(table, id) {
  const form = document.querySelector(`form.filters[data-table="${id}"]`);
  if (form?.elements.length) {
    readAddress(form);
    form.addEventListener("submit", (event) => event.preventDefault());
    form.addEventListener("change", (event) => {
      reset(form, event.target);
      writeAddress(form);
      filter(table, form);
    });
    addEventListener("hashchange", () => {
      readAddress(form);
      filter(table, form);
    });
  }
  for (const box of boxes(id)) {
    box.addEventListener("change", () =>
      table.column(`${box.dataset.column}:name`).visible(box.checked),
    );
  }
}

/** Numbers are not searched, and their type is given: both save seconds in large tables. */
function columnOf(head, hidden) {
  const isNumber = head.classList.contains("number");
  return {
    name: head.dataset.name ?? null,
    visible: !hidden.has(head.dataset.name),
    orderable: !head.classList.contains("no-sort"),
    searchable: !isNumber,
    ...(isNumber && { type: "num" }),
  };
}

async function start() {
  const { default: DataTable } = await import(window.dataTablesModule);
  for (const element of document.querySelectorAll("table.data")) {
    const rows = element.tBodies[0].rows.length;
    const heads = [...element.tHead.rows[0].cells];
    if (matchMedia(PHONE).matches)
      for (const box of boxes(element.id)
        .filter((each) => each.checked)
        .slice(FEW))
        box.checked = false;
    const hidden = new Set(
      boxes(element.id)
        .filter((box) => !box.checked)
        .map((box) => box.dataset.column),
    );
    const table = new DataTable(element, {
      autoWidth: false,
      order: [],
      info: false,
      paging: rows > ROWS,
      pageLength: ROWS,
      columns: heads.map((head) => columnOf(head, hidden)),
      layout: {
        topStart: null,
        topEnd: rows > 8 ? "search" : null,
        bottomStart: null,
        bottomEnd: rows > ROWS ? "paging" : null,
      },
      language: {
        search: "Search",
        zeroRecords: "No row is like that.",
        emptyTable: "The table is empty.",
      },
    });
    connect(table, element.id);
    table.on("draw", () => collapse(table));
    const form = document.querySelector(`form.filters[data-table="${element.id}"]`);
    form ? filter(table, form) : table.draw();
  }
  document.documentElement.dataset.tables = "ready";
}
addEventListener("beforeprint", () => {
  for (const details of document.querySelectorAll("details.notes")) details.open = true;
});
start();
