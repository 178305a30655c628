// A table whose cells are fields: typed into, pasted into, and moved through by key.

import {make, redraw_on} from "./dom.js";

// how far from the row of a button the focus goes
const MOVES = {insert: 1, up: -1, down: 1};

export function render({model}) {
  const body = make("div"), error = make("div", {class: "refusal", role: "alert", hidden: true});
  const root = make("div", {class: "table-editor"}, body, error);
  let wanted = null;
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
    const row = Number(dataset.row);
    wanted = {row: row + (MOVES[dataset.what] ?? 0), column: dataset.what === "insert" ? 0 : Number(dataset.column ?? 0)};
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
    const {rows, refusal, columns} = model.table, is_new = body.html !== model.html;
    const here = wanted ?? (is_new ? place(root.getRootNode().activeElement ?? {}) : null);
    if (is_new) { body.html = body.innerHTML = model.html; }
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
  redraw_on(model, ["table", "html", "version"], show);
  show();
  return root;
}
