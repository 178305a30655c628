// Saving to My files: what, and under which name.

import {redraw_on, make} from "./dom.js";

export function render({model}) {
  const kind = make("select", {id: "own-kind"}, ...model.kinds.map(([value, text]) => make("option", {value}, text)));
  const name = make("input", {type: "text", id: "own-name", class: "wide", maxlength: "200", spellcheck: "false",
    autocomplete: "off", "aria-describedby": "own-error"});
  const error = make("div", {class: "refusal", role: "alert", id: "own-error", hidden: true});
  const status = make("div", {class: "small muted", role: "status"});
  const button = (text) => make("button", {type: "button", class: "text-button"}, text);
  const save = button("Save"), replace = button("Replace it"), close = button("Close");
  let suggested = "";
  const send = (what) => model.send_msg({what, kind: kind.value, name: name.value});
  const suggest = (anew) => {
    const now = model.names[kind.value] ?? "";
    // what somebody has typed stays, but not for another kind of file
    if (anew || name.value === suggested || !name.value) { name.value = now; }
    suggested = now;
  };
  const clear = () => { error.hidden = replace.hidden = true; status.textContent = ""; name.removeAttribute("aria-invalid"); };
  kind.addEventListener("change", () => { clear(); suggest(true); });
  name.addEventListener("input", clear);
  name.addEventListener("keydown", (event) => { if (event.key === "Enter") { send("save"); } });
  save.addEventListener("click", () => send("save"));
  replace.addEventListener("click", () => send("replace"));
  close.addEventListener("click", () => send("close"));
  const show = () => {
    suggest(false);
    error.textContent = model.refusal;
    error.hidden = !model.refusal;
    name.setAttribute("aria-invalid", model.refusal ? "true" : "false");
    replace.hidden = !model.can_replace;
    status.textContent = model.told;
  };
  redraw_on(model, ["refusal", "can_replace", "told", "version"], show);
  show();
  return make("div", {class: "save-own"}, make("label", {for: "own-kind"}, "What"), kind,
    make("label", {for: "own-name"}, "Name"), name, error, status, make("div", {class: "buttons"}, save, replace, close));
}
