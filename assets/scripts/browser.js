// What only the browser knows, and what it can do without waiting for the server.

import {act_on} from "./actions.js";
import {filled, life_of, make, until, within} from "./dom.js";
import {chart_of, deep, listen} from "./page.js";

const root = document.documentElement;
const named = (name) => Bokeh.documents[0]?.get_model_by_name(name);
const view_of = (name) => { const model = named(name); return model && Bokeh.index.find_one(model); };
const is_there = (name) => {
  const element = view_of(name)?.el;
  return Boolean(element && element.offsetHeight > 0 && !element.classList.contains("rj-away"));
};
// a page stands on the sheet before its words do
const has_heading = (name) => {
  const holder = view_of(name)?.el;
  return deep("h1").some((heading) => heading.offsetHeight > 0 && within(heading, holder));
};
const SKETCH = `<svg viewBox="0 0 100 100" preserveAspectRatio="none" aria-hidden="true">
  <path d="M0 98 C4 40 8 16 18 16 L78 16 C90 16 96 46 100 98"/><path d="M0 99 H100"/></svg>`;
const ROWS = `<div class="rj-rows">${"<i></i>".repeat(10)}</div>`;
const LATE_MS = 100, SWITCHED_WITHIN_MS = 3800, TURNED_WITHIN_MS = 30000, LOOK_MS = 40;

// --- a thin bar while anything is under way

const working = (() => {
  const reasons = new Set();
  let bar = null;
  return (reason, on) => {
    if (on) { reasons.add(reason); } else { reasons.delete(reason); }
    if (reasons.size && !bar) {
      bar = make("div", {class: "rj-working", "aria-hidden": "true"});
      document.body.append(bar);
    } else if (!reasons.size && bar) { bar.remove(); bar = null; }
  };
})();

// --- turning pages

const turning = (model) => {
  let asked = null, sketch = null, limit = null, shown = "";
  const bare = (name) => root.classList.toggle("rj-bare", model.bare.includes(name));
  const scroller = () => deep(".main-content")[0], scrolled = new Map();
  // each page keeps its place, and a new one begins at its top
  const leave = () => { if (shown) { scrolled.set(shown, scroller()?.scrollTop ?? 0); } };
  const arrive = (name) => {
    if (name === shown) return;
    shown = name;
    const main = scroller();
    if (main) { main.scrollTop = scrolled.get(name) ?? 0; }
  };
  const done = () => { clearTimeout(limit); sketch?.remove(); sketch = null; asked = null; working("page", false); };
  const settle = async () => {
    const asks_other = () => asked !== null && asked !== model.page;
    const is_open = () => is_there(`page ${model.page}`) && has_heading(`page ${model.page}`);
    await until(() => asks_other() || is_open(), TURNED_WITHIN_MS);
    if (!asks_other() && is_open()) { done(); arrive(model.page); }
  };
  // a page that was open before is there at once, and what has changed since comes with the server's answer; unless
  // it is to show something else
  const turn = (name, anew = false) => {
    if (name === model.page && asked === null) return;
    asked = name;
    bare(name);
    leave();
    working("page", true);
    clearTimeout(limit);
    limit = setTimeout(done, TURNED_WITHIN_MS);
    if (named(`page ${name}`) && !anew) {
      for (const page of model.pages) {
        named(`page ${page}`)?.setv({css_classes: page === name ? [] : ["rj-away"]}, {sync: false});
      }
      arrive(name);
      sketch?.remove();
      sketch = null;
      return;
    }
    const place = deep(".main-content")[0]?.getBoundingClientRect();
    if (!place) return;
    sketch ??= document.body.appendChild(make("div", {class: "rj-turning"}));
    sketch.innerHTML = `<h1></h1><p role="status">Opening</p>${ROWS}${SKETCH}${SKETCH.replace("<svg", '<svg class="low"')}`;
    sketch.querySelector("h1").textContent = model.questions[name];
    Object.assign(sketch.style, {
      left: `${place.left}px`, top: `${place.top}px`, width: `${place.width}px`, height: `${place.height}px`,
    });
  };
  model.on("page", () => {
    if (asked === null || asked === model.page) { bare(model.page); }
    requestAnimationFrame(settle);
  });
  bare(model.page);
  return turn;
};

// --- the drawer

const drawing = (model) => {
  let sketch = null;
  const settle = async () => {
    await until(() => !sketch || is_there("editor"), TURNED_WITHIN_MS);
    sketch?.remove();
    sketch = null;
  };
  model.on("drawer", () => { if (model.drawer) { requestAnimationFrame(settle); } });
  // returns whether the press is to go on to the server
  return () => {
    if (sketch) return false;
    if (!model.drawer) {
      const html = `<h2>Scenario editor</h2><div class="rj-list">${"<i></i>".repeat(10)}</div>`;
      sketch = document.body.appendChild(filled("div", "rj-drawer", html));
      sketch.setAttribute("role", "status");
      sketch.setAttribute("aria-label", "The scenario editor is opening");
    }
    return true;
  };
};

// --- colours: page, figures and components change in one picture, whatever time each of them takes

const colours = () => {
  const ink = (element) => getComputedStyle(element).color;
  // components change their colours one after the other: they are done when none has the one that it had
  const wait = () => new Promise((resolve) => {
    const limit = performance.now() + SWITCHED_WITHIN_MS;
    const before = deep(".MuiButtonBase-root, .MuiFormLabel-root, .MuiInputBase-input")
      .map((element) => [element, ink(element)]);
    const look = () => {
      const done = before.every(([element, colour]) => !element.isConnected || ink(element) !== colour);
      if (done || performance.now() > limit) { resolve(); } else { setTimeout(look, LOOK_MS); }
    };
    setTimeout(look, LOOK_MS);
  });
  return (tell) => {
    if (!document.startViewTransition || document.hidden) { tell(); return; }
    const transition = document.startViewTransition(() => { tell(); return wait(); });
    for (const promise of [transition.ready, transition.updateCallbackDone, transition.finished]) {
      promise.catch(() => { /* it was too slow, or another one has begun: the page changes without it */ });
    }
  };
};

// --- what the library leaves without a name or at the wrong place

const mend = () => {
  for (const bar of deep("[role=progressbar]:not([aria-label])")) { bar.setAttribute("aria-label", "Progress"); }
  for (const region of deep(".main-content:not([tabindex])")) {
    region.tabIndex = 0;
    region.setAttribute("role", "region");
    region.setAttribute("aria-label", "Page in sight");
  }
  // a download leaves the link behind that began it, without a name
  for (const link of deep("a[download]:empty")) { link.hidden = true; }
  for (const heading of deep("h5:not([role])")) {
    if (!heading.textContent.trim()) { heading.setAttribute("role", "presentation"); }
  }
};

// A figure out of sight shares its axis, and the columns of its runs, with figures in sight: at each move it would be
// painted with them. It rests after its first painting, and is painted when it comes into sight.
const resting = () => {
  const places = new WeakSet();
  const figures_in = (place) =>
    [...Bokeh.index.query((view) => view.model.type === "Figure" && within(view.el, place))];
  const hold = (figures, on) => { for (const {model} of figures) { model.setv({hold_render: on}, {sync: false}); } };
  return (place, in_sight) => {
    if (in_sight === !places.has(place)) return;
    const figures = figures_in(place);
    if (in_sight) {
      places.delete(place);
      hold(figures, false);
    } else if (figures.length && figures.every((view) => view.has_finished())) {
      places.add(place);
      hold(figures, true);
    }
  };
};

const watch = (model, signal) => {
  const seen = new Map(), rest = resting();
  // what is on another page is not painted anyway, and is there at once when its page returns
  const settle = (place) => { if (seen.get(place) || place.offsetHeight) { rest(place, seen.get(place)); } };
  const observer = new IntersectionObserver((entries) => {
    for (const entry of entries) {
      seen.set(entry.target, entry.isIntersecting);
      settle(entry.target);
    }
    const in_sight = [...seen].filter(([element, visible]) => visible && element.isConnected);
    const names = [...new Set(in_sight.map(([element]) => chart_of(element)))].sort();
    if (JSON.stringify(names) !== JSON.stringify(model.charts_in_sight)) { model.charts_in_sight = names; }
  }, {rootMargin: "300px"});
  const look = () => {
    for (const element of deep(".rj-chart")) {
      if (!seen.has(element)) { seen.set(element, false); observer.observe(element); }
    }
    for (const element of deep(".rj-chart:not(.rj-undrawn)")) { if (seen.has(element)) { settle(element); } }
    for (const element of seen.keys()) {
      if (!element.isConnected) { seen.delete(element); observer.unobserve(element); }
    }
    mend();
  };
  look();
  const stop = listen(look);
  signal.addEventListener("abort", () => { stop(); observer.disconnect(); });
};

export function render({model}) {
  const signal = life_of(model), turn = turning(model), draw = drawing(model), change = colours();
  const system = window.matchMedia("(prefers-color-scheme: dark)");
  const paint = () => root.classList.toggle("rj-dark", model.dark);
  const ask_dark = (tell) => {
    working("colours", true);
    requestAnimationFrame(() => { change(tell); working("colours", false); });
  };
  const follow = () => {
    if (model.follows_system && model.dark !== system.matches) {
      ask_dark(() => { model.wants_dark = system.matches; });
    } else { model.wants_dark = system.matches; }
  };
  let resized = null;
  const measure = () => { model.window_width = window.innerWidth; };
  const resize = () => { clearTimeout(resized); resized = setTimeout(measure, 120); };
  const press = (event) => {
    const path = event.composedPath();
    const button = path.find((element) => element.matches?.("button"));
    if (!button || button.ariaDisabled === "true") return;
    const words = (button.getAttribute("aria-label") ?? button.textContent).trim();
    if (button.dataset.scenario) {
      model.send_msg({kind: "scenario", name: button.dataset.scenario});
      requestAnimationFrame(() => setTimeout(() => turn("Drive", true)));
    } else if (button.dataset.file) {
      model.send_msg({kind: "file", name: button.dataset.file});
    } else if (path.some((element) => element.classList?.contains("rj-edit"))) {
      if (!draw()) { event.stopImmediatePropagation(); event.preventDefault(); }
    } else if (words === "Toggle theme") {
      event.stopImmediatePropagation();
      ask_dark(() => model.send_msg({kind: "dark", dark: !model.dark}));
    }
  };
  model.on("dark", paint);
  model.on("working", () => working("server", model.working));
  model.on("started", () => {
    root.classList.add("rj-started");
    document.getElementById("rj-first")?.remove();
  });
  model.on("msg:custom", (event) => {
    const {kind} = event.data ?? event;
    if (kind === "when_idle") {
      const tell = () => model.send_msg({kind: "idle"});
      if (window.requestIdleCallback) { requestIdleCallback(tell, {timeout: 1000}); } else { setTimeout(tell, LATE_MS); }
    }
  });
  window.addEventListener("resize", resize, {signal});
  document.addEventListener("visibilitychange", () => { model.hidden = document.hidden; }, {signal});
  window.addEventListener("click", press, {capture: true, signal});
  document.addEventListener("click", act_on, {signal});
  window.addEventListener("rj-turn", (event) => turn(event.detail.page), {signal});
  system.addEventListener("change", follow, {signal});
  measure();
  model.wants_dark = system.matches;
  watch(model, signal);
  return make("span");
}
