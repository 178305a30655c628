// The editor's title, the result, and the way out; it takes the focus in and gives it back.

import {around, filled, focused, life_of, redraw_on, within} from "./dom.js";

const SETTLE_MS = 400;
const HTML = `<div><h2 tabindex="-1">Scenario</h2><p class="muted small" role="status"></p>
  <p class="hidden" role="alert"></p></div>
  <button type="button" class="small-button" aria-label="Close the editor" title="Close (Escape)">\u00d7</button>`;
// by the setter of the element itself: React, which draws some of the fields, hears of no other change
const write = (field, text) => {
  Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, "value").set.call(field, text);
  field.dispatchEvent(new Event("input", {bubbles: true, composed: true}));
};
const in_sight = (element) => Boolean(element?.isConnected && element.getClientRects().length);

export function render({model, el}) {
  const life = life_of(model), head = filled("div", "editor-title", HTML);
  const title = head.querySelector("h2"), close = head.querySelector("button");
  const region = () => {
    let node = el;
    while (node && !node.classList?.contains("rj-editor")) { node = around(node); }
    return node;
  };
  const holds_focus = () => { const place = region(); return Boolean(place) && within(focused(), place); };
  let opener = null, entering = null, dressed = false, field = null, before;
  const leave = () => {
    const menu = [...document.querySelectorAll("header button")].find(in_sight);
    if (in_sight(opener) && opener !== document.body) { opener.focus(); } else { menu?.focus(); }
  };
  // at once: the answer of the server hides what has the focus
  const shut = () => { leave(); model.send_msg({what: "close"}); };
  close.addEventListener("click", shut);
  const dress = () => {
    const place = region();
    if (dressed || !place) { return; }
    dressed = true;
    place.setAttribute("role", "region");
    place.setAttribute("aria-label", "Scenario editor");
    place.addEventListener("focusin", (event) => { [field] = event.composedPath(); before = field.value; }, {signal: life});
    place.addEventListener("keydown", (event) => {
      if (event.key === "Enter") { before = field?.value; }
      if (event.key !== "Escape") { return; }
      // what was typed and not taken goes first, the editor with the next press
      if (field?.value === before) { shut(); } else { write(field, before); }
    }, {signal: life, capture: true});
  };

  const take = () => { if (model.open && in_sight(title) && !holds_focus()) { title.focus(); } };
  const came_in_sight = () => {
    if (!in_sight(title)) { return; }
    sight.disconnect();
    dress();
    take();
    // a drawer that closes at the same time gives the focus back late, and may want to keep it: one try a frame
    const now = entering, {signal} = now;
    const retake = () => { if (!signal.aborted) { take(); } };
    document.addEventListener("focusin", () => requestAnimationFrame(retake), {signal});
    setTimeout(() => { retake(); now.abort(); }, SETTLE_MS);
  };
  const sight = new ResizeObserver(came_in_sight);
  const enter = () => {
    opener = focused();
    entering?.abort();
    entering = new AbortController();
    sight.disconnect();
    sight.observe(title);
  };
  const turn = () => {
    if (model.open) { enter(); return; }
    entering?.abort();
    sight.disconnect();
    if (focused() === document.body || holds_focus()) { leave(); }
  };
  const tell = () => [...head.querySelectorAll("p")].forEach((line, k) => { line.textContent = k ? model.alert : model.status; });
  life.addEventListener("abort", () => { entering?.abort(); sight.disconnect(); });
  model.on("open", turn);
  redraw_on(model, ["status", "alert"], tell);
  tell();
  if (model.open) { enter(); }
  return head;
}
