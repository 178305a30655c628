// A heading that opens and closes what stands beneath it.

import {make} from "./dom.js";

export function render({model}) {
  const arrow = make("span", {class: "arrow", "aria-hidden": "true"}), label = make("span");
  const dot = make("span", {class: "dot"}), note = make("span", {class: "muted note"});
  const button = make("button", {type: "button"}, arrow, label, dot, note);
  button.addEventListener("click", () => model.send_msg({what: "turn"}));
  const show = () => {
    label.textContent = model.label;
    note.textContent = model.note;
    dot.hidden = !model.changed;
    arrow.textContent = model.open ? "\u25be" : "\u25b8";
    button.setAttribute("aria-expanded", String(model.open));
  };
  for (const name of ["label", "note", "open", "changed"]) { model.on(name, show); }
  show();
  return make(`h${model.level}`, {class: "turn"}, button);
}
