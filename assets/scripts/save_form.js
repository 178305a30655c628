// Saves the scenario to the server's folder under a name, and asks before it replaces a file.

import {redraw_on, make} from "./dom.js";

export function render({model}) {
  const name = make("input", {type: "text", id: "save-name", class: "wide", maxlength: "200", spellcheck: "false",
    autocomplete: "off", "aria-describedby": "save-error"});
  const error = make("div", {class: "refusal", role: "alert", id: "save-error", hidden: true});
  const status = make("div", {class: "small muted", role: "status"});
  const button = (text) => make("button", {type: "button", class: "text-button"}, text);
  const save = button("Save"), replace = button("Replace it"), close = button("Close");
  let suggested = "";
  const send = (what) => model.send_msg({what, name: name.value});
  const clear = () => { error.hidden = replace.hidden = true; status.textContent = ""; name.removeAttribute("aria-invalid"); };
  name.addEventListener("input", clear);
  name.addEventListener("keydown", (event) => { if (event.key === "Enter") { send("save"); } });
  save.addEventListener("click", () => send("save"));
  replace.addEventListener("click", () => send("replace"));
  close.addEventListener("click", () => send("close"));
  const show = () => {
    // a typed name stays
    if (name.value === suggested || !name.value) { name.value = model.name_now; }
    suggested = model.name_now;
    error.textContent = model.refusal;
    error.hidden = !model.refusal;
    name.setAttribute("aria-invalid", model.refusal ? "true" : "false");
    replace.hidden = !model.can_replace;
    status.textContent = model.status;
  };
  redraw_on(model, ["refusal", "can_replace", "status", "version"], show);
  show();
  return make("div", {class: "save-form"}, make("label", {for: "save-name"}, "Name"), name, error, status,
    make("div", {class: "buttons"}, save, replace, close));
}
