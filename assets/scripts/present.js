// The presentation: one figure of the page in sight on the whole screen, its caption and the page's numbers beneath it.
// The figure is the one of the page and no picture of it: whatever changes shows at once, and no step asks the server.

import {around, filled, focused, life_of, make, within} from "./dom.js";
import {enlarge} from "./enlarge.js";
import {first_in, words_of} from "./figures.js";
import {deep, listen} from "./page.js";

// words are as large as on the page in a window of this size, and grow with it
const PAGE_PX = {width: 760, height: 480}, LARGEST = 6;
const SWIPE_PX = 50, SWIPE_WITHIN_MS = 800, FOLLOW_MS = 200;
const STEPS = {ArrowRight: 1, PageDown: 1, " ": 1, Enter: 1, ArrowLeft: -1, PageUp: -1, Backspace: -1};
const ICONS = {
  start: "M2 3h12v8H2zM8 11v3M5 14h6",
  before: "M10 3 5 8l5 5",
  next: "M6 3l5 5-5 5",
  end: "M4 4l8 8M12 4l-8 8",
};
const icon = (name) => `<svg viewBox="0 0 16 16" fill="none" stroke="currentColor" stroke-width="1.5" aria-hidden="true">
  <path d="${ICONS[name]}"/></svg>`;
const button_with = (name, label) => {
  const button = filled("button", "", icon(name));
  button.type = "button";
  button.setAttribute("aria-label", label);
  button.title = label;
  return button;
};

// --- what there is to be shown

const path_to = (element) => {
  const path = [];
  for (let node = element; node; node = around(node)) { path.unshift(node); }
  return path;
};
// In the order of the page, through the borders of shadow roots.
export const in_order = (elements) => {
  const paths = new Map(elements.map((element) => [element, path_to(element)]));
  return elements.toSorted((one, other) => {
    const [a, b] = [paths.get(one), paths.get(other)];
    const parted = a.findIndex((node, k) => node !== b[k]);
    return a[parted]?.compareDocumentPosition(b[parted] ?? a[parted]) & Node.DOCUMENT_POSITION_FOLLOWING ? -1 : 1;
  });
};
// Of elements, the first of those that share most of what is around them with another one.
export const nearest_to = (element, others) => {
  const path = path_to(element);
  const shared = (other) => path_to(other).findIndex((node, k) => node !== path[k]);
  return in_order(others).reduce((best, other) => best && shared(best) >= shared(other) ? best : other, null);
};
const editor = () => {
  const model = Bokeh.documents[0]?.get_model_by_name("editor");
  return model ? Bokeh.index.find_one(model)?.el : null;
};
const of_page = () => {
  const beside = editor();
  return (place) => place.checkVisibility() && !(beside && within(place, beside));
};
const figures_in_sight = () => in_order(deep(".rj-chart").filter(of_page()).filter((place) => place.offsetHeight));
const caption_of = (place) => {
  // with the values beneath the mouse, which the cursor writes there
  const written = first_in(place, ".rj-caption"), words = written && first_in(written, ".bk-clearfix, div");
  return words?.textContent.trim() || words_of(place);
};

// --- one presentation

const present = (model, signal, ended) => {
  const stage = make("div", {class: "stage", role: "img"});
  const caption = make("p", {class: "caption"}), numbers = make("div", {class: "numbers"});
  const count = make("p", {class: "count", role: "status"});
  const [before, next, close] = [button_with("before", "Previous figure"), button_with("next", "Next figure"),
    button_with("end", "End the presentation")];
  const rail = make("input", {type: "range", "aria-label": model.slider}), value = make("span", {"aria-hidden": "true"});
  const slide = make("label", {class: "slide", hidden: true}, make("span", {}, model.slider), rail, value);
  const wall = make("div", {class: "rj-wall", role: "dialog", "aria-modal": "true", "aria-label": "Presentation",
    tabindex: "-1"}, stage, make("div", {class: "foot"}, make("div", {class: "told"}, caption, numbers),
    make("div", {class: "steps"}, slide, before, count, next, close)));
  const focus_before = focused(), scroller = deep(".main-content")[0], scrolled = scroller?.scrollTop ?? 0;
  const life = new AbortController(), listening = {signal: life.signal};
  let places = figures_in_sight(), place = null, shown = null, went_full = false;

  // --- what is shown

  const write = (element, text) => { if (element.textContent !== text) { element.textContent = text; } };
  const factor_now = () => Math.min(LARGEST,
    Math.max(1, Math.min(window.innerWidth / PAGE_PX.width, window.innerHeight / PAGE_PX.height)));
  const fit = () => {
    wall.style.setProperty("--rj-larger", factor_now());
    const {left, top, width, height} = stage.getBoundingClientRect();
    if (!shown || !width || !height) { return; }
    shown.fit({left, top, width, height}, factor_now());
    // where names of lines have room, the server knows
    const figure_px = Math.floor(width / factor_now());
    if (model.figure_px !== figure_px) { model.figure_px = figure_px; }
  };
  const tell = () => {
    const words = caption_of(place);
    write(caption, words);
    stage.setAttribute("aria-label", words);
    // told with the caption to those who listen, but not whenever the cursor writes a value there
    const which = `${places.indexOf(place) + 1} of ${places.length}`;
    if (count.firstChild?.textContent !== which) { count.replaceChildren(which, make("span", {}, `: ${words}`)); }
    const row = nearest_to(place, deep(".figures").filter((one) => one.checkVisibility({visibilityProperty: true})));
    const cells = [...row?.querySelectorAll(".figure") ?? []].map((cell) => make("div", {},
      ...[".label span", ".value", ".detail"].map((part) => cell.querySelector(part)?.cloneNode(true) ?? "")));
    if (cells.map((cell) => cell.innerHTML).join() !== [...numbers.children].map((cell) => cell.innerHTML).join()) {
      numbers.replaceChildren(...cells);
    }
  };
  const show = (wanted) => {
    shown?.back();
    place = wanted;
    shown = enlarge(place);
    tell();
    fit();
  };
  const step = (by) => {
    const to = places.indexOf(place) + by;
    if (places[to]) { show(places[to]); }
  };
  const look = () => {
    const at = places.indexOf(place);
    places = figures_in_sight();
    if (!places.length) { end(); return; }
    // what the page does not show any more makes room for what came after it
    if (!places.includes(place)) { show(places[Math.min(Math.max(at, 0), places.length - 1)]); return; }
    tell();
    fit();
  };

  // --- the slider of the page, where it has one

  const source = () => document.documentElement.classList.contains("rj-bare") ? null
    : deep("input[type=range]").find((one) => one.labels?.[0]?.textContent === model.slider) ?? null;
  const field = source();
  const follow = () => {
    if (!field) { return; }
    Object.assign(rail, {min: field.min, max: field.max, step: field.step, value: field.value});
    write(value, field.getAttribute("aria-valuetext") ?? field.value);
    rail.setAttribute("aria-valuetext", value.textContent);
  };
  slide.hidden = !field;
  follow();
  const following = setInterval(follow, FOLLOW_MS);
  for (const [event, told] of [["input", "input"], ["change", "blur"]]) {
    rail.addEventListener(event, () => {
      field.value = rail.value;
      field.dispatchEvent(new Event(told));
      follow();
    });
  }

  // --- keys, touch and the mouse

  const stops = () => [rail, before, next, close].filter((one) => one.checkVisibility());
  const keep_focus = (event) => {
    event.preventDefault();
    const all = stops(), at = all.indexOf(document.activeElement);
    const to = at < 0 ? (event.shiftKey ? all.length - 1 : 0) : (at + (event.shiftKey ? -1 : 1) + all.length) % all.length;
    all[to].focus();
  };
  const own_key = (event) => {
    const target = document.activeElement;
    if (target === rail) { return !["PageDown", "PageUp", " ", "Enter", "Backspace"].includes(event.key); }
    return target?.localName === "button" && wall.contains(target) && [" ", "Enter"].includes(event.key);
  };
  const press = (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) { return; }
    if (event.key !== "p" && event.key !== "P") { event.stopImmediatePropagation(); }
    if (event.key === "Tab") { keep_focus(event); return; }
    if (event.key === "Escape") { event.preventDefault(); end(); return; }
    if (own_key(event)) { return; }
    if (event.key === "Home" || event.key === "End") { show(event.key === "Home" ? places[0] : places.at(-1)); }
    else if (STEPS[event.key]) { step(STEPS[event.key]); }
    else { return; }
    event.preventDefault();
  };
  let touch = null;
  const on_stage = (event) => !event.composedPath().includes(wall.lastChild);
  const swipe = (event) => {
    if (event.pointerType !== "touch" || !on_stage(event)) { return; }
    // a figure would take it for a zoom
    event.stopImmediatePropagation();
    if (event.type === "pointerdown") { touch = {x: event.clientX, y: event.clientY, at: event.timeStamp}; return; }
    if (event.type === "pointermove" || !touch) { return; }
    const [x, y, took] = [event.clientX - touch.x, event.clientY - touch.y, event.timeStamp - touch.at];
    touch = null;
    if (Math.abs(x) > SWIPE_PX && Math.abs(x) > 2 * Math.abs(y) && took < SWIPE_WITHIN_MS) { step(x < 0 ? 1 : -1); }
  };
  // what the browser would scroll goes on to move after a swipe, and takes the next touch for its end
  const hold_still = (event) => { if (on_stage(event)) { event.preventDefault(); } };
  // a clicker's space goes on, whatever was pressed last by mouse
  const presses = (button, act) => button.addEventListener("click", (event) => {
    act();
    if (event.detail) { wall.focus(); }
  });
  presses(before, () => step(-1));
  presses(next, () => step(1));
  close.addEventListener("click", () => end());

  // --- begin and end

  const end = () => {
    life.abort();
    clearInterval(following);
    stop();
    shown?.back();
    shown = null;
    model.figure_px = 0;
    wall.remove();
    document.documentElement.classList.remove("rj-presents");
    if (went_full && document.fullscreenElement) { document.exitFullscreen().catch(() => { /* it has ended itself */ }); }
    if (scroller) { scroller.scrollTop = scrolled; }
    if (focus_before?.isConnected) { focus_before.focus({preventScroll: true}); }
    ended();
  };
  document.documentElement.classList.add("rj-presents");
  document.body.append(wall);
  document.addEventListener("fullscreenchange", () => {
    if (document.fullscreenElement) { went_full = true; }
    // the browser keeps the key Escape to itself then
    else if (went_full) { end(); }
  }, listening);
  const full = document.documentElement.requestFullscreen?.({navigationUI: "hide"});
  full?.catch(() => { /* it is not allowed here: the window is filled */ });
  for (const name of ["pointerdown", "pointermove", "pointerup", "pointercancel"]) {
    window.addEventListener(name, swipe, {...listening, capture: true});
  }
  window.addEventListener("touchmove", hold_still, {...listening, capture: true, passive: false});
  window.addEventListener("keydown", press, {...listening, capture: true});
  window.addEventListener("focusin", (event) => {
    if (!event.composedPath().includes(wall)) { wall.focus(); }
  }, {...listening, capture: true});
  window.addEventListener("rj-turn", () => end(), listening);
  const observer = new ResizeObserver(fit);
  observer.observe(stage);
  life.signal.addEventListener("abort", () => observer.disconnect());
  const stop = listen(look);
  signal.addEventListener("abort", end, listening);
  show(places.find((one) => one.getBoundingClientRect().bottom > 0) ?? places[0]);
  wall.focus();
  return {end};
};

export function render({model}) {
  const signal = life_of(model), button = button_with("start", "Present the figures (F)");
  let now = null;
  const start = () => {
    if (!now && figures_in_sight().length) { now = present(model, signal, () => { now = null; }); }
  };
  // after each change of the page: nothing is measured, which would lay it out
  const offer_it = () => { if (!now) { button.hidden = !deep(".rj-chart").some(of_page()); } };
  button.addEventListener("click", start);
  window.addEventListener("rj-present", start, {signal});
  model.on("page", () => { now?.end(); offer_it(); });
  const stop = listen(offer_it);
  signal.addEventListener("abort", stop);
  offer_it();
  return button;
}
