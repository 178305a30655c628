// What a report shall tell: its sections, who has written it, a note.

import {make, redraw_on} from "./dom.js";

export function render({model}) {
  const boxes = model.sections.map(([value]) => make("input", {type: "checkbox", value, checked: true}));
  const ticks = model.sections.map(([, title], k) => make("label", {}, boxes[k], title));
  const author = make("input", {type: "text", class: "wide", id: "report-author", autocomplete: "name"});
  const note = make("textarea", {id: "report-note", rows: "5", "aria-describedby": "report-count"});
  const count = make("div", {class: "help", id: "report-count"});
  const error = make("div", {class: "refusal", role: "alert"});
  const cancel = make("button", {type: "button", class: "plain-button"}, "Cancel");
  const form = make("form", {novalidate: true},
    make("h2", {id: "report-title"}, "Report"),
    make("fieldset", {}, make("legend", {}, "Sections"), make("div", {class: "ticks"}, ...ticks)),
    make("label", {for: "report-author"}, "Author"), author,
    make("label", {for: "report-note"}, "Note"), note, count, error,
    make("div", {class: "buttons"}, cancel,
      make("button", {type: "submit", class: "filled-button", autofocus: true}, "Make the report")));
  const dialog = make("dialog", {class: "report-ask", "aria-labelledby": "report-title"}, form);
  const counted = () => {
    // as Python counts: a character beyond the first 65,536 is one
    const used = [...note.value].length;
    count.textContent = `Plain text; an empty line begins a paragraph. ${used} of ${model.longest_note} characters.`;
    count.classList.toggle("over", used > model.longest_note);
  };
  note.addEventListener("input", counted);
  cancel.addEventListener("click", () => dialog.close());
  // also by the key Escape
  dialog.addEventListener("close", () => { if (model.open) { model.send_msg({what: "close"}); } });
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    const sections = boxes.filter((box) => box.checked).map((box) => box.value);
    model.send_msg({what: "make", sections, author: author.value, note: note.value});
  });
  const show = () => {
    error.textContent = model.refusal;
    error.hidden = !model.refusal;
    if (model.open && !dialog.open && dialog.isConnected) { dialog.showModal(); }
    if (!model.open && dialog.open) { dialog.close(); }
  };
  redraw_on(model, ["open", "refusal"], show);
  counted();
  // what is rendered stands in the document only after that
  requestAnimationFrame(show);
  return dialog;
}
