// A table whose cells are fields: typed into, pasted into, and moved through by key.

import {make, redraw_on} from "./dom.js";

const ACTS = [
  ["insert", "+", "Insert a row below row", 1],
  ["up", "\u2191", "Move up row", -1],
  ["down", "\u2193", "Move down row", 1],
  ["remove", "\u00d7", "Remove row", 0],
];
const button = (what, row, name, text, kind, more = {}) =>
  make("button", {type: "button", class: kind, "data-what": what, "data-row": row, "aria-label": name, ...more}, text);
const cell = ({kind, choices, label}, row, column) => {
  const named = {"aria-label": `${label}, row ${row + 1}`, "data-row": row, "data-column": column};
  if (kind === "choice") { return make("select", named, ...choices.map((value) => make("option", {value}, value))); }
  const wide = kind === "text", more = {class: wide ? "wide" : "", inputmode: wide ? null : "decimal"};
  return make("input", {...named, ...more, type: "text", autocomplete: "off", spellcheck: "false"});
};
const head = (text, more = {}, ...inner) => make("th", {scope: "col", ...more}, ...inner, text);
const body = ({columns, rows, label}) => make("div", {class: "scroll"}, make("table", {"aria-label": label},
  make("thead", {}, make("tr", {}, head("", {}, make("span", {class: "hidden"}, "Row")),
    ...columns.map((column) => head(column.label, {title: column.help})),
    head("", {}, make("span", {class: "hidden"}, "Change the rows")))),
  make("tbody", {}, ...rows.map((_, row) => make("tr", {}, make("th", {scope: "row"}, String(row + 1)),
    ...columns.map((column, index) => make("td", {}, cell(column, row, index))),
    make("td", {class: "acts"}, ...ACTS.map(([what, sign, name], k) => button(what, row, `${name} ${row + 1}`, sign,
      "small-button", {title: `${name} ${row + 1}`, "data-column": columns.length + k}))))))));

export function render({model}) {
  const root = make("div", {class: "table-editor"});
  const error = make("div", {class: "refusal", role: "alert", hidden: true});
  let shape = "", wanted = null;
  const line = (row) => root.querySelectorAll("tbody tr")[row]?.querySelectorAll("input, select, button");
  const place = ({dataset}) => dataset?.row && {row: Number(dataset.row), column: Number(dataset.column)};
  const focus = ({row, column}) => {
    const last = model.table.rows.length - 1, found = line(Math.min(Math.max(row, 0), last))?.[column] ?? root.querySelector(".add");
    found?.focus();
    found?.select?.();
  };
  root.addEventListener("change", ({target}) => {
    // so that the answer is shown even where it is the text of before
    target.defaultValue = target.value;
    model.send_msg({what: "cell", ...place(target), text: target.value});
  });
  root.addEventListener("paste", (event) => {
    const text = event.clipboardData.getData("text");
    if (!/[\t\n]/.test(text.trim())) { return; }
    event.preventDefault();
    wanted = place(event.target);
    model.send_msg({what: "paste", ...wanted, text});
  });
  root.addEventListener("click", ({target: {dataset}}) => {
    if (!dataset.what) { return; }
    const row = Number(dataset.row), by = ACTS.find(([what]) => what === dataset.what)?.[3] ?? 0;
    wanted = {row: row + by, column: dataset.what === "insert" ? 0 : Number(dataset.column ?? 0)};
    model.send_msg({what: dataset.what, row});
  });
  root.addEventListener("keydown", (event) => {
    const by = event.target.type === "text" && {ArrowUp: -1, ArrowDown: 1, Enter: 1}[event.key];
    const {row, column} = place(event.target) || {};
    if (!by || !line(row + by)) { return; }
    event.preventDefault();
    focus({row: row + by, column});
  });
  const show = () => {
    const {rows, refusal, label, help, changed, more, columns} = model.table;
    const now = JSON.stringify([rows.length, columns, label, changed, more]);
    const here = wanted ?? (now === shape ? null : place(root.getRootNode().activeElement ?? {}));
    if (now !== shape) {
      shape = now;
      const title = make("h4", {}, label, ...(changed ? [make("span", {class: "dot"})] : []));
      const back = changed ? [button("back", 0, `Reset ${label}`, "Reset", "text-button back")] : [];
      const notes = [help, more].filter(Boolean).map((text) => make("p", {class: "help"}, text));
      const add = () => button("insert", 0, `Add a row to ${label}`, "Add a row", "add text-button");
      root.replaceChildren(make("div", {class: "table-head"}, title, ...back), ...notes,
        rows.length ? body(model.table) : add(), error);
    }
    const cells = root.querySelectorAll("input, select");
    rows.flat().forEach((text, k) => {
      const wrong = Boolean(refusal) && refusal.row * columns.length + refusal.column === k && refusal.row >= 0;
      const shown = wrong ? refusal.text : text;
      if (cells[k].defaultValue !== shown) { cells[k].value = cells[k].defaultValue = shown; }
      cells[k].setAttribute("aria-invalid", String(wrong));
    });
    if (here) { focus(here); }
    wanted = null;
    error.textContent = refusal?.sentence ?? "";
    error.hidden = !refusal;
  };
  redraw_on(model, ["table", "version"], show);
  show();
  return root;
}
