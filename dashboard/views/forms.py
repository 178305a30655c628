"""Forms in plain HTML: many fields, or a whole table, in one component each.

A widget of the library for each of a hundred fields would make opening a group slow; here the browser draws them at
once, with label, help and refusal tied to each field for those who listen.
"""

from collections.abc import Callable, Sequence
from typing import Any

import param
from panel.custom import JSComponent

from railjoule.dashboard.look.theme import editor_css

FIELDS_JS = """
const make = (tag, attributes, ...children) => {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value !== null && value !== false) { element.setAttribute(name, value === true ? "" : value); }
  }
  element.append(...children);
  return element;
};

export function render({model}) {
  const root = make("div", {class: "fields"});
  let rows = [], shape = "";
  const send = (row, text) => {
    row.known = null;
    model.send_msg({what: "type", key: row.key, text});
  };
  const build = (field, index) => {
    const id = `field${index}`, described = `${id}-help ${id}-error`;
    const row = {key: field.key, kind: field.kind, known: null};
    if (field.kind === "yes_no") {
      row.input = make("input", {type: "checkbox", id, "aria-describedby": described});
      row.input.addEventListener("change", () => send(row, row.input.checked ? "yes" : "no"));
    } else if (field.kind === "choice") {
      const options = field.choices.map(([value, text]) => make("option", {value}, text));
      row.input = make("select", {id, "aria-describedby": described}, ...options);
      row.input.addEventListener("change", () => send(row, row.input.value));
    } else {
      const wide = ["text", "numbers"].includes(field.kind);
      row.input = make("input", {type: "text", id, "aria-describedby": described, autocomplete: "off",
        spellcheck: "false", class: wide ? "wide" : "", inputmode: wide ? null : "decimal"});
      row.input.addEventListener("change", () => send(row, row.input.value));
      row.input.addEventListener("keydown", (event) => {
        // what was typed and not taken goes first, the editor with the next press
        if (event.key !== "Escape" || row.known === null || row.input.value === row.known) return;
        event.stopPropagation();
        row.input.value = row.known;
      });
    }
    row.dot = make("span", {class: "dot", hidden: true});
    row.was = make("span", {class: "hidden"});
    row.back = make("button", {type: "button", class: "small-button", hidden: true}, "\\u21ba");
    row.back.addEventListener("click", () => {
      row.input.focus();
      row.known = null;
      model.send_msg({what: "back", key: row.key});
    });
    row.error = make("div", {class: "refusal", role: "alert", id: `${id}-error`, hidden: true});
    const label = make("label", {for: id}, field.label, row.dot, row.was);
    const help = make("div", {class: "help", id: `${id}-help`}, field.help);
    const value = make("div", {class: "value"}, row.back, row.input);
    const kind = ["text", "numbers", "choice"].includes(field.kind) ? "field broad" : "field";
    root.append(make("div", {class: kind}, make("div", {class: "words"}, label, help), value, row.error));
    return row;
  };
  const show = () => {
    const fields = model.fields;
    const now = JSON.stringify(fields.map((field) => [field.key, field.kind, field.choices, field.help]));
    if (now !== shape) {
      shape = now;
      root.replaceChildren();
      rows = fields.map(build);
    }
    fields.forEach((field, index) => {
      const row = rows[index];
      if (row.known !== field.text) {
        row.known = field.text;
        if (row.kind === "yes_no") { row.input.checked = field.text === "yes"; } else { row.input.value = field.text; }
      }
      row.input.setAttribute("aria-invalid", field.sentence ? "true" : "false");
      row.dot.hidden = row.back.hidden = !field.changed;
      row.was.textContent = field.changed ? " changed" : "";
      row.back.setAttribute("aria-label", `Reset ${field.label} to ${field.was || "empty"}`);
      row.back.title = `Reset to ${field.was || "empty"}`;
      row.error.textContent = field.sentence;
      row.error.hidden = !field.sentence;
    });
  };
  model.on("version", show);
  show();
  return root;
}
"""
TABLE_JS = """
const LARGEST_FILE = 1e6;
const make = (tag, attributes, ...children) => {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value !== null && value !== false) { element.setAttribute(name, value === true ? "" : value); }
  }
  element.append(...children);
  return element;
};
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
        if (!/[\\t\\n]/.test(text.trim())) return;
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
        act("up", "\\u2191", "Move up row", [Math.max(row - 1, 0), last + 1]),
        act("down", "\\u2193", "Move down row", [row + 1, last + 2]),
        act("remove", "\\u00d7", "Remove row", [row, last + 3]),
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
  model.on("version", show);
  show();
  return root;
}
"""
DISCLOSURE_JS = """
export function render({model}) {
  const heading = document.createElement("h3"), button = document.createElement("button");
  const label = document.createElement("span"), note = document.createElement("span");
  const dot = document.createElement("span"), arrow = document.createElement("span");
  heading.className = "turn";
  button.type = "button";
  arrow.className = "arrow";
  arrow.setAttribute("aria-hidden", "true");
  note.className = "muted note";
  dot.className = "dot";
  button.append(arrow, label, dot, note);
  heading.append(button);
  button.addEventListener("click", () => model.send_msg({what: "turn"}));
  const show = () => {
    label.textContent = model.label;
    note.textContent = model.note;
    dot.hidden = !model.changed;
    arrow.textContent = model.open ? "\\u25be" : "\\u25b8";
    button.setAttribute("aria-expanded", String(model.open));
  };
  for (const name of ["label", "note", "open", "changed"]) { model.on(name, show); }
  show();
  return heading;
}
"""
HEAD_JS = """
const LONGEST_WAIT_MS = 1500, SETTLE_MS = 400;
const deep_active = () => {
  let found = document.activeElement;
  while (found?.shadowRoot?.activeElement) { found = found.shadowRoot.activeElement; }
  return found;
};
const in_sight = (element) => element?.isConnected && element.getClientRects().length > 0;

export function render({model, el}) {
  const head = document.createElement("div");
  head.className = "editor-title";
  head.innerHTML = '<div><h2 tabindex="-1">Scenario</h2><p class="muted small" role="status"></p></div>' +
    '<button type="button" class="small-button" aria-label="Close the editor" title="Close (Escape)">\\u00d7</button>';
  const title = head.querySelector("h2"), status = head.querySelector("p"), close = head.querySelector("button");
  // at once: the answer of the server hides what has the focus
  const shut = () => { leave(); model.send_msg({what: "close"}); };
  close.addEventListener("click", shut);
  const host = () => {
    let node = el;
    while (node && !node.classList?.contains("rj-editor")) { node = node.parentNode ?? node.host; }
    return node;
  };
  const holds = (element) => {
    for (let node = element; node; node = node.parentNode ?? node.host) { if (node === host()) return true; }
    return false;
  };
  let opener = null, dressed = false;
  const dress = () => {
    const region = host();
    if (dressed || !region) return;
    dressed = true;
    region.setAttribute("role", "region");
    region.setAttribute("aria-label", "Scenario editor");
    region.addEventListener("keydown", (event) => { if (event.key === "Escape") shut(); });
  };
  const enter = () => {
    opener = deep_active();
    const begun = performance.now();
    const attempt = () => {
      if (!model.open) return;
      dress();
      if (in_sight(title) && !holds(deep_active())) { title.focus(); }
      // a drawer that closes at the same time gives the focus back late
      if (performance.now() - begun < (in_sight(title) ? SETTLE_MS : LONGEST_WAIT_MS)) { setTimeout(attempt, 50); }
    };
    attempt();
  };
  const leave = () => {
    const menu = [...document.querySelectorAll("header button")].find(in_sight);
    if (in_sight(opener) && opener !== document.body) { opener.focus(); } else { menu?.focus(); }
  };
  const turn = () => {
    if (model.open) { enter(); return; }
    const now = deep_active();
    if (now === document.body || holds(now)) { leave(); }
  };
  const tell = () => { status.textContent = model.status; };
  model.on("open", turn);
  model.on("status", tell);
  tell();
  if (model.open) { enter(); }
  return head;
}
"""


class Form(JSComponent):
    """What all forms share: their sheet, no space around them, and who hears the browser.

    Parameters
    ----------
    hear : callable
        Called with each message of the browser.
    """

    def __init__(self, hear: Callable[[dict[str, Any]], None], **params: Any) -> None:
        super().__init__(
            **{"margin": 0, "sizing_mode": "stretch_width", "stylesheets": [editor_css()], **params},
        )
        self._hear = hear

    def _handle_msg(self, data: Any) -> None:
        if isinstance(data, dict):
            self._hear(data)


class FieldsForm(Form):
    """Fields below each other."""

    fields = param.List(default=[], doc="What each field shows.")
    version = param.Integer(default=0, doc="Counts what was sent: the browser redraws at each.")

    _esm = FIELDS_JS

    def show(self, fields: Sequence[dict[str, Any]]) -> None:
        """Show fields; what a browser has typed since is written over."""
        self.param.update(fields=list(fields), version=self.version + 1)


class TableForm(Form):
    """A table whose cells are fields."""

    table = param.Dict(default={}, doc="What it shows.")
    version = param.Integer(default=0, doc="Counts what was sent: the browser redraws at each.")

    _esm = TABLE_JS

    def show(self, table: dict[str, Any]) -> None:
        """Show a table; what a browser has typed since is written over."""
        self.param.update(table=table, version=self.version + 1)


class Disclosure(Form):
    """A heading that opens and closes what stands beneath it."""

    label = param.String(default="", doc="The heading.")
    note = param.String(default="", doc="What is in it, in a few words.")
    open = param.Boolean(default=False, doc="Whether it is open.")
    changed = param.Boolean(default=False, doc="Whether anything in it was changed.")

    _esm = DISCLOSURE_JS

    def __init__(self, turn: Callable[[], None], **params: Any) -> None:
        super().__init__(lambda _: turn(), **params)


class EditorHead(Form):
    """The editor's title, the result, and the way out; it takes the focus in and gives it back."""

    status = param.String(default="", doc="The result.")
    open = param.Boolean(default=False, doc="Whether the editor is in sight.")

    _esm = HEAD_JS
