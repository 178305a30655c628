// The explanations of terms: a press or a resting mouse shows one beside its sign; Escape or a press elsewhere closes it.

import {deep, make, until} from "./dom.js";

const REST_MS = 350, TURN_WITHIN_MS = 10000, SETTLED_MS = 300, MARGIN_PX = 8;

export const explain = (turn, signal) => {
  const terms = JSON.parse(document.getElementById("rj-glossary")?.textContent ?? "{}");
  const tip = make("div", {class: "rj-tip", role: "note"});
  const button_of = (event) => event.composedPath().find((one) => one.dataset?.term);
  let shown = null, over = null, is_hovered = false, resting = 0;
  const hide = () => { clearTimeout(resting); tip.remove(); shown?.setAttribute("aria-expanded", "false"); shown = null; };
  const show_in_help = async (term) => {
    hide();
    turn("Help");
    await until(() => deep(`#term-${term}`)[0]?.offsetHeight, TURN_WITHIN_MS);
    // a page that has just come is scrolled to its beginning
    setTimeout(() => {
      const [entry] = deep(`#term-${term}`);
      entry?.scrollIntoView({block: "center"});
      entry?.focus({preventScroll: true});
    }, SETTLED_MS);
  };
  const show = (button, hovered) => {
    hide();
    const {term} = button.dataset, {name, text} = terms[term];
    const more = make("button", {type: "button"}, "All terms in Help");
    more.addEventListener("click", () => show_in_help(term));
    tip.replaceChildren(make("b", {}, name), `: ${text} `, more);
    document.body.append(tip);
    const {left, top, bottom} = button.getBoundingClientRect(), {offsetWidth, offsetHeight} = tip;
    tip.style.left = `${Math.max(MARGIN_PX, Math.min(left - 12, window.innerWidth - offsetWidth - MARGIN_PX))}px`;
    tip.style.top = `${bottom + offsetHeight + MARGIN_PX > window.innerHeight ? top - offsetHeight - 2 : bottom + 2}px`;
    button.setAttribute("aria-expanded", "true");
    [shown, is_hovered] = [button, hovered];
  };
  window.addEventListener("click", (event) => {
    const button = button_of(event);
    if (button && (button !== shown || is_hovered)) { show(button, false); } else if (!tip.contains(event.target)) { hide(); }
  }, {signal});
  window.addEventListener("keydown", (event) => {
    if (event.key !== "Escape" || !shown) { return; }
    event.stopPropagation();
    const button = shown;
    hide();
    button.focus();
  }, {signal, capture: true});
  // events of coming and going do not leave the shadow root within which one comes and goes
  window.addEventListener("pointermove", (event) => {
    const button = event.pointerType === "mouse" ? button_of(event) ?? null : null;
    if (button === over || tip.contains(event.target)) { return; }
    over = button;
    clearTimeout(resting);
    if (button && !shown) { resting = setTimeout(() => show(button, true), REST_MS); } else if (is_hovered) { hide(); }
  }, {passive: true, signal});
  window.addEventListener("wheel", hide, {passive: true, signal});
  signal.addEventListener("abort", hide);
};
