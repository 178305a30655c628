// A table whose cells are fields: typed into, pasted into, or read from a file.

import {redraw_on, make} from "./dom.js";

const LARGEST_FILE = 1e6;
const button = (text, name, act) => {
  const element = make("button", {type: "button", class: "small-button", "aria-label": name, title: name}, text);
  element.addEventListener("click", act);
  return element;
};

export function render({model}) {
  const root = make("div", {class: "table-editor"});
  let cells = [], shape = "", known = [], wanted = null;
  const send = (message) => { known = []; model.send_msg(message); };
  const focus = (place) => {
    const [row, column] = place, line = cells[Math.min(row, cells.length - 1)];
    const found = line ? line[Math.min(column, line.length - 1)] : root.querySelector(".add");
    found?.focus();
    found?.select?.();
  };
  const error = make("div", {class: "refusal", role: "alert", hidden: true});
  const tell = (sentence) => { error.textContent = sentence; error.hidden = !sentence; };

  const build_cell = (column, row, index) => {
    const name = `${column.label}, row ${row + 1}`;
    const commit = () => send({what: "cell", row, column: index, text: input.value});
    let input;
    if (column.kind === "choice") {
      input = make("select", {"aria-label": name}, ...column.choices.map((value) => make("option", {value}, value)));
    } else {
      const wide = column.kind === "text";
      input = make("input", {type: "text", "aria-label": name, autocomplete: "off", spellcheck: "false",
        class: wide ? "wide" : "", inputmode: wide ? null : "decimal"});
      input.addEventListener("paste", (event) => {
        const text = event.clipboardData.getData("text");
        if (!/[\t\n]/.test(text.trim())) return;
        event.preventDefault();
        wanted = [row, index];
        send({what: "paste", row, column: index, text});
      });
      input.addEventListener("keydown", (event) => {
        const before = known[row]?.[index];
        if (event.key === "Escape" && before !== undefined && input.value !== before) {
          event.stopPropagation();
          input.value = before;
          return;
        }
        const by = {ArrowUp: -1, ArrowDown: 1, Enter: 1}[event.key];
        if (!by || !cells[row + by]) return;
        event.preventDefault();
        focus([row + by, index]);
      });
    }
    input.addEventListener("change", commit);
    return input;
  };
  const build = () => {
    const {columns, rows} = model.table, last = model.table.columns.length;
    const head = columns.map((column) => make("th", {scope: "col", title: column.help}, column.label));
    cells = [];
    const lines = rows.map((_, row) => {
      const inputs = columns.map((column, index) => build_cell(column, row, index));
      const act = (what, text, name, place) => button(text, `${name} ${row + 1}`, () => {
        wanted = place;
        send({what, row});
      });
      const acts = [
        act("insert", "+", "Insert a row below row", [row + 1, 0]),
        act("up", "\u2191", "Move up row", [Math.max(row - 1, 0), last + 1]),
        act("down", "\u2193", "Move down row", [row + 1, last + 2]),
        act("remove", "\u00d7", "Remove row", [row, last + 3]),
      ];
      cells.push([...inputs, ...acts]);
      return make("tr", {}, make("th", {scope: "row"}, String(row + 1)),
        ...inputs.map((input) => make("td", {}, input)), make("td", {class: "acts"}, ...acts));
    });
    const add = make("button", {type: "button", class: "add text-button"}, "Add a row");
    add.addEventListener("click", () => { wanted = [0, 0]; send({what: "insert", row: 0}); });
    const dot = make("span", {class: "dot"});
    const back = make("button", {type: "button", class: "text-button back"}, "Reset");
    back.setAttribute("aria-label", `Reset ${model.table.label}`);
    back.addEventListener("click", () => { wanted = [0, 0]; send({what: "back"}); });
    const title = make("h4", {}, model.table.label, ...(model.table.changed ? [dot] : []));
    root.replaceChildren(make("div", {class: "table-head"}, title, ...(model.table.changed ? [back] : [])));
    if (model.table.help) { root.append(make("p", {class: "help"}, model.table.help)); }
    if (rows.length) {
      const corner = make("th", {scope: "col"}, make("span", {class: "hidden"}, "Row"));
      const end = make("th", {scope: "col"}, make("span", {class: "hidden"}, "Change the rows"));
      const body = make("table", {"aria-label": model.table.label},
        make("thead", {}, make("tr", {}, corner, ...head, end)), make("tbody", {}, ...lines));
      root.append(make("div", {class: "scroll"}, body));
    } else {
      root.append(add);
    }
    if (model.table.more) { root.append(make("p", {class: "help"}, model.table.more)); }
    root.append(error, paster);
  };

  const area = make("textarea", {rows: "3", spellcheck: "false", "aria-label": "Cells of a spreadsheet"});
  const replace = make("button", {type: "button", class: "text-button"}, "Replace all rows");
  replace.addEventListener("click", () => send({what: "paste_all", text: area.value}));
  const file = make("input", {type: "file", accept: ".csv,.tsv,.txt", "aria-label": "CSV file with rows"});
  file.addEventListener("change", async () => {
    const [chosen] = file.files;
    if (!chosen) return;
    if (chosen.size > LARGEST_FILE) { tell("The file is larger than the 1 MB allowed. Nothing is changed."); return; }
    send({what: "paste_all", text: await chosen.text()});
    file.value = "";
  });
  const paster = make("details", {}, make("summary", {}, "Paste a table or open a CSV file"),
    make("p", {class: "help"}, "Tabs, semicolons or commas separate cells; the first row can name the columns. " +
      "You can also paste a block directly into a cell."), area, make("div", {class: "paste-row"}, replace, file));

  const show = () => {
    const {columns, rows, changed, refusal, label, more} = model.table;
    const now = JSON.stringify([columns, rows.length, changed, label, more]);
    const active = root.getRootNode().activeElement;
    let place = null;
    cells.forEach((line, row) => line.forEach((cell, column) => { if (cell === active) place = [row, column]; }));
    if (now !== shape) {
      shape = now;
      known = [];
      build();
      if (wanted ?? place) { focus(wanted ?? place); }
    } else if (wanted) {
      focus(wanted);
    }
    wanted = null;
    known = rows.map((texts, row) => texts.map((text, column) => {
      const wrong = refusal && refusal.row === row && refusal.column === column;
      const shown = wrong ? refusal.text : text, cell = cells[row][column];
      if (known[row]?.[column] !== shown) { cell.value = shown; }
      cell.setAttribute("aria-invalid", wrong ? "true" : "false");
      return shown;
    }));
    tell(refusal ? refusal.sentence : "");
  };
  redraw_on(model, ["table", "version"], show);
  show();
  return root;
}
