// Fields below each other, with label, help and refusal tied to each for those who listen.

import {redraw_on, make} from "./dom.js";

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
    row.back = make("button", {type: "button", class: "small-button", hidden: true}, "\u21ba");
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
  redraw_on(model, ["fields", "version"], show);
  show();
  return root;
}
