// The diagram of the control loop: a block lights up with its charts, and a press scrolls to them.

import {chart_of, deep, filled, life_of} from "./dom.js";

const ABOVE_PX = 24;

export function render({model}) {
  const signal = life_of(model), box = filled("div", "", model.drawing);
  const block_of = (name) => Object.keys(model.charts).find((block) => model.charts[block].includes(name));
  const is_of = (host, block) => model.charts[block].includes(chart_of(host));
  let under = null, lit = null;
  const light = () => {
    const block = under ?? box.querySelector(":focus-visible")?.dataset.block ?? null;
    if (block === lit) { return; }
    lit = block;
    for (const shape of box.querySelectorAll("[data-block]")) {
      shape.classList.toggle("lit", shape.dataset.block === block);
    }
    for (const host of deep(".rj-chart")) { host.classList.toggle("rj-lit", block !== null && is_of(host, block)); }
  };
  const show = (block) => {
    const places = model.charts[block].flatMap((name) => deep(`.rj-chart-${name}`));
    const first = places.find((host) => host.offsetParent);
    if (!first) { return; }
    first.style.scrollMarginTop = `${box.getBoundingClientRect().height + ABOVE_PX}px`;
    const calm = window.matchMedia("(prefers-reduced-motion: reduce)").matches;
    first.scrollIntoView({block: "start", behavior: calm ? "instant" : "smooth"});
  };
  // at the document, before the figures, which keep pointer events to themselves
  const move = (event) => {
    const path = event.composedPath();
    const shape = path.find((element) => element.dataset?.block && box.contains(element));
    const host = path.find((element) => element.classList?.contains("rj-chart"));
    under = shape ? shape.dataset.block : (host && block_of(chart_of(host))) ?? null;
    light();
  };
  document.addEventListener("pointermove", move, {capture: true, signal});
  for (const name of ["focusin", "focusout"]) { box.addEventListener(name, light); }
  const press = (event) => {
    const shape = event.target.closest("[data-block]");
    if (!shape || (event.key && event.key !== "Enter" && event.key !== " ")) { return; }
    event.preventDefault();
    show(shape.dataset.block);
  };
  for (const name of ["click", "keydown"]) { box.addEventListener(name, press); }
  return box;
}
