// The editor's title, the result, and the way out; it takes the focus in and gives it back.

import {around, filled, focused, life_of, redraw_on, until, within} from "./dom.js";

const OPENED_WITHIN_MS = 5000, SETTLE_MS = 400;
const HTML = `<div><h2 tabindex="-1">Scenario</h2><p class="muted small" role="status"></p>
  <p class="hidden" role="alert"></p></div>
  <button type="button" class="small-button" aria-label="Close the editor" title="Close (Escape)">\u00d7</button>`;
const in_sight = (element) => Boolean(element?.isConnected && element.getClientRects().length);
// by the setter of the element itself: React, which draws some of the fields, notices no other change
const write = (field, text) => {
  Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, "value").set.call(field, text);
  field.dispatchEvent(new Event("input", {bubbles: true, composed: true}));
};

export function render({model, el}) {
  const signal = life_of(model), head = filled("div", "editor-title", HTML), [title] = head.querySelectorAll("h2");
  let opener = null, place = null, field = null, before;
  const holds_focus = () => Boolean(place) && within(focused(), place);
  const leave = () => {
    const menu = [...document.querySelectorAll("header button")].find(in_sight);
    if (in_sight(opener) && opener !== document.body) { opener.focus(); } else { menu?.focus(); }
  };
  // immediately, as the answer of the server hides what has the focus
  const shut = () => { leave(); model.send_msg({what: "close"}); };
  const dress = () => {
    if (place) { return; }
    for (place = el; place && !place.classList?.contains("rj-editor");) { place = around(place); }
    place?.setAttribute("role", "region");
    place?.setAttribute("aria-label", "Scenario editor");
    place?.addEventListener("focusin", (event) => { [field] = event.composedPath(); before = field.value; }, {signal});
    place?.addEventListener("keydown", (event) => {
      if (event.key === "Enter") { before = field?.value; }
      if (event.key !== "Escape") { return; }
      // what was typed and not taken goes first, the editor with the next press
      if (!(field instanceof HTMLInputElement) || field.value === before) { shut(); } else { write(field, before); }
    }, {signal, capture: true});
  };
  const take = () => { if (in_sight(title) && !holds_focus()) { title.focus(); } };
  const turn = async () => {
    if (!model.open) {
      if (focused() === document.body || holds_focus()) { leave(); }
      return;
    }
    opener = focused();
    await until(() => in_sight(title), OPENED_WITHIN_MS);
    dress();
    // a drawer that closes at the same time gives the focus back late, and may want to keep it
    await until(() => { if (model.open) { take(); } return !model.open; }, SETTLE_MS);
  };
  head.querySelector("button").addEventListener("click", shut);
  const tell = () => head.querySelectorAll("p").forEach((line, k) => { line.textContent = k ? model.alert : model.status; });
  model.on("open", turn);
  redraw_on(model, ["status", "alert"], tell);
  tell();
  if (model.open) { turn(); }
  return head;
}
