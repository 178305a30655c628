// The browser's half of the frame: draws the bar, and does all that only the browser can do.

import {act_on} from "./actions.js";
import {chart_of, deep, filled, life_of, make, within} from "./dom.js";
import {explain} from "./terms.js";
import {send_file, tie} from "./ties.js";

const root = document.documentElement;
const RESIZED_MS = 120, LOOK_MS = 150, LATE_MS = 1000, IDLE_MS = 100, AWAY = "rj-away";
const TYPED = "input:not([type=range], [type=checkbox], [type=radio], [type=button]), textarea, select, " +
  "[contenteditable=''], [contenteditable=true], [role=textbox], [role=combobox], [role=listbox], [role=option], " +
  "[role=menuitem], [role=spinbutton]";

// Names for screen readers, for elements that the libraries leave without one.
const name_parts = () => {
  for (const bar of deep("[role=progressbar]:not([aria-label])")) { bar.setAttribute("aria-label", "Progress"); }
  for (const region of deep(".main-content:not([tabindex])")) {
    region.tabIndex = 0;
    region.setAttribute("role", "region");
    region.setAttribute("aria-label", "Page in sight");
  }
  for (const heading of deep("h5:not([role])")) {
    if (!heading.textContent.trim()) { heading.setAttribute("role", "presentation"); }
  }
};

// Reports the charts in sight. One out of sight shares its axis and the columns of its runs with charts in sight: it would
// be painted with them at each move, so its painting waits.
const watch_charts = (model, signal) => {
  const seen = new Map(), held = new WeakSet();
  const rest = (place) => {
    const is_seen = seen.get(place);
    if (is_seen === !held.has(place)) { return; }
    const views = [...Bokeh.index.query(({model: {type}, el}) => type === "Figure" && within(el, place))];
    // before its first painting a figure would stay empty
    if (!is_seen && !(views.length && views.every((view) => view.has_finished()))) { return; }
    held[is_seen ? "delete" : "add"](place);
    for (const view of views) { view.model.setv({hold_render: !is_seen}, {sync: false}); }
  };
  const observer = new IntersectionObserver((entries) => {
    for (const {target, isIntersecting} of entries) {
      seen.set(target, isIntersecting);
      // a page that was left is there immediately when it returns
      if (isIntersecting || target.offsetHeight) { rest(target); }
    }
    const names = [...new Set([...seen].filter(([, is_seen]) => is_seen).map(([place]) => chart_of(place)))].sort();
    if (names.join() !== model.charts_in_sight.join()) { model.charts_in_sight = names; }
  }, {rootMargin: "300px"});
  signal.addEventListener("abort", () => observer.disconnect());
  return () => {
    for (const place of seen.keys()) { if (!place.isConnected) { seen.delete(place); observer.unobserve(place); } }
    for (const place of deep(".rj-chart")) { if (!seen.has(place)) { seen.set(place, false); observer.observe(place); } }
    for (const place of seen.keys()) { if (place.offsetHeight) { rest(place); } }
  };
};

// Shows in the bar which page is in sight, what its buttons do, and whether something is being computed.
const show_in_bar = (nav, model, page, is_turning) => {
  const menu = nav.querySelector(".menu"), bar = nav.querySelector(".bar"), working = nav.querySelector(".working");
  menu.firstChild.textContent = page;
  menu.setAttribute("aria-label", `Pages, ${page}`);
  for (const button of nav.querySelectorAll("[data-page]")) {
    if (button.dataset.page === page) { button.setAttribute("aria-current", "page"); } else { button.removeAttribute("aria-current"); }
  }
  const here = bar.querySelector("li:has([aria-current])");
  if (here && bar.scrollWidth > bar.clientWidth) { bar.scrollLeft = here.offsetLeft - bar.offsetLeft; }
  for (const button of nav.querySelectorAll("[data-ask]")) {
    const {ask} = button.dataset, words = model.labels[ask];
    button.title = words;
    button.setAttribute("aria-label", words);
    button.lastChild.textContent = words;
    button.disabled = model.disabled.includes(ask);
  }
  working.hidden = !is_turning && !model.working && model.progress === null;
  working.style.setProperty("--share", model.progress ?? "");
  working.classList.toggle("known", model.progress !== null);
};

export function render({model, view}) {
  const signal = life_of(model), {document: bokeh_document} = view.model, nav = filled("nav", "", model.bar);
  const on = (target, name, listener, options = {}) => target.addEventListener(name, listener, {signal, ...options});
  let asked = null, limit = 0;

  // --- pages: one that was open before is there immediately, and later changes come with the server's answer

  const scroller = () => deep(".main-content")[0], scrolled = new Map();
  const draw = () => {
    const page = asked ?? model.page;
    show_in_bar(nav, model, page, asked !== null);
    root.classList.toggle("rj-bare", model.bare.includes(page));
  };
  const arrive = () => {
    const main = scroller();
    if (main) { main.scrollTop = scrolled.get(asked ?? model.page) ?? 0; }
  };
  const turn = (name) => {
    if (name === (asked ?? model.page)) { return; }
    if (asked === null) { scrolled.set(model.page, scroller()?.scrollTop ?? 0); }
    asked = name;
    const holder = (page) => bokeh_document.get_model_by_name(`page ${page}`);
    for (const page of holder(name) ? model.pages : []) {
      holder(page)?.setv({css_classes: page === name ? [] : [AWAY]}, {sync: false});
    }
    if (holder(name)) { arrive(); }
    clearTimeout(limit);
    limit = setTimeout(() => { asked = null; draw(); }, 30 * LATE_MS);
    draw();
    model.send_msg({kind: "turn", name});
  };
  model.on("page", () => {
    if (asked !== null && asked !== model.page) { return; }
    asked = null;
    clearTimeout(limit);
    draw();
    requestAnimationFrame(arrive);
  });
  for (const name of ["working", "progress", "labels", "disabled"]) { model.on(name, draw); }

  // --- buttons and keys

  const ask_for_file = () => {
    const input = make("input", {type: "file", accept: ".toml,.html,.htm,.csv,.tsv,.txt,.xlsx,.gpx,.nc"});
    on(input, "change", () => { for (const file of input.files) { send_file(model, file); } });
    input.click();
  };
  on(window, "click", (event) => {
    const button = event.composedPath().find((one) => one.dataset && (one.dataset.page || one.dataset.open || one.dataset.ask));
    if (!button || button.disabled) { act_on(event); return; }
    const {page, open, ask, name} = button.dataset;
    button.closest("[popover]")?.hidePopover();
    if (page || open) { turn(page ?? open); } else if (ask === "file") { ask_for_file(); } else { model.send_msg({kind: ask, name: name ?? ""}); }
  });
  on(window, "keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.repeat || event.defaultPrevented) { return; }
    if (event.composedPath().some((element) => element.matches?.(TYPED))) { return; }
    if (event.key === "Escape") { model.send_msg({kind: "escape"}); return; }
    const page = event.key === "?" ? "Help" : model.keyed[Number(event.key) - 1];
    if (page) { turn(page); } else if (event.key.toLowerCase() === "p" && !event.shiftKey) { model.send_msg({kind: "pin"}); }
    else { return; }
    event.preventDefault();
  });

  // within a shadow root the browser does not give the focus back to what has opened a list
  on(nav, "keydown", ({key}) => {
    const list = key === "Escape" && nav.querySelector(":popover-open");
    if (list) { list.hidePopover(); nav.querySelector(`[popovertarget=${list.id}]`).focus(); }
  });

  // --- the window, its colours, and what is in sight

  const system = window.matchMedia("(prefers-color-scheme: dark)");
  const measure = () => { model.window_width = window.innerWidth; };
  const colour = () => { model.wants_dark = system.matches; };
  let resized = 0, due = 0;
  on(window, "resize", () => { clearTimeout(resized); resized = setTimeout(measure, RESIZED_MS); });
  on(document, "visibilitychange", () => { model.hidden = document.hidden; });
  on(system, "change", colour);
  model.on("dark", () => root.classList.toggle("rj-dark", model.dark));
  model.on("started", () => {
    root.classList.add("rj-started");
    document.getElementById("rj-first")?.remove();
  });
  model.on("msg:custom", (event) => {
    const {kind, name} = event.data ?? event;
    if (kind === "focus") { nav.querySelector(`.${name}`)?.focus(); }
    if (kind !== "when_idle") { return; }
    const tell = () => model.send_msg({kind: "idle"});
    if (window.requestIdleCallback) { requestIdleCallback(tell, {timeout: LATE_MS}); } else { setTimeout(tell, IDLE_MS); }
  });
  const watch = watch_charts(model, signal);
  const look = () => { due = 0; watch(); name_parts(); };
  // parts of the page come with changes of the document, and are drawn a little later
  const soon = () => { due ||= setTimeout(look, LOOK_MS); };
  bokeh_document.on_change(soon);
  signal.addEventListener("abort", () => bokeh_document.remove_on_change(soon));
  for (const late_ms of [0, LOOK_MS, LATE_MS, 3 * LATE_MS]) { setTimeout(look, late_ms); }

  nav.setAttribute("aria-label", "Pages");
  tie(model, bokeh_document, signal);
  explain(turn, signal);
  measure();
  colour();
  draw();
  return nav;
}
