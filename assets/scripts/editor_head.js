// The editor's title, the result, and the way out; it takes the focus in and gives it back.

import {around, filled, focused, life_of, within} from "./dom.js";

const SETTLE_MS = 400;
const HTML = `<div><h2 tabindex="-1">Scenario</h2><p class="muted small" role="status"></p></div>
  <button type="button" class="small-button" aria-label="Close the editor" title="Close (Escape)">\u00d7</button>`;
const in_sight = (element) => Boolean(element?.isConnected && element.getClientRects().length);

export function render({model, el}) {
  const life = life_of(model), head = filled("div", "editor-title", HTML);
  const title = head.querySelector("h2"), status = head.querySelector("p"), close = head.querySelector("button");
  const region = () => {
    let node = el;
    while (node && !node.classList?.contains("rj-editor")) { node = around(node); }
    return node;
  };
  const holds_focus = () => { const place = region(); return Boolean(place) && within(focused(), place); };
  let opener = null, entering = null, dressed = false;
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
    place.addEventListener("keydown", (event) => { if (event.key === "Escape") { shut(); } }, {signal: life});
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
  const tell = () => { status.textContent = model.status; };
  life.addEventListener("abort", () => { entering?.abort(); sight.disconnect(); });
  model.on("open", turn);
  model.on("status", tell);
  tell();
  if (model.open) { enter(); }
  return head;
}
