// The kept studies: each is opened by its name, or deleted.

import {make, redraw_on} from "./dom.js";

export function render({model}) {
  const root = make("div", {class: "study-fields"});
  const button = (text, name, message) => {
    const made = make("button", {type: "button", class: "text-button", "aria-label": name}, text);
    made.addEventListener("click", () => model.send_msg(message));
    return made;
  };
  const row_of = ([name, told, is_shown]) => make("div", {class: "field"},
    is_shown ? make("b", {class: "name"}, name) : button(name, `Open the study ${name}`, {what: "open", name}),
    is_shown ? make("span", {}, told) : button("Delete", `Delete the study ${name}`, {what: "delete", name}));
  const show = () => {
    root.replaceChildren(...(model.rows.length
      ? [make("div", {class: "section"}, "Kept studies"), ...model.rows.map(row_of)] : []));
  };
  redraw_on(model, ["rows"], show);
  show();
  return root;
}
