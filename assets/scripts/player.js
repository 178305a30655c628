// The train on Drive: it runs along the track in the time of reality or faster, and the numbers and the advice follow.

import {value_at} from "./cursor.js";
import {deep, filled, life_of, put, redraw_on} from "./dom.js";
import {written} from "./numbers.js";

// under prefers-reduced-motion the train moves once in so many milliseconds
const CALM_MS = 1000;

// The number of the instruction that holds at a time; each begins at its start.
export const instruction_at = (starts, time) => Math.max(starts.findLastIndex((start) => start <= time + 1e-9), 0);

// The quantity of a run at a time; where the train stands, several nodes have one place.
export const quantity_at = (run, name, time, stepped) =>
  name === "time" ? time : value_at({x: run.time, y: run[name]}, Math.max(time, run.time[0]), stepped);

export function render({model}) {
  const signal = life_of(model), calm = window.matchMedia("(prefers-reduced-motion: reduce)");
  const root = filled("div", "player", model.html), [button, pace, range, readouts] = root.children;
  root.setAttribute("role", "group");
  root.setAttribute("aria-label", "Play the run");
  let time = 0, begun_ms = 0, playing = false, asked = false, lit = null, shown = false;

  const is_there = () => (model.run.time?.length ?? 0) > 1;
  const end = () => model.run.time.at(-1);
  // the columns of the run come when somebody is about to play it
  const want = () => { if (!model.wanted) { model.wanted = true; } };

  const light = (number) => {
    if (lit?.number === number && lit.item?.isConnected) { return; }
    lit?.item?.classList.remove("now");
    lit?.item?.removeAttribute("aria-current");
    const item = deep(".advice li:has(> b)").filter((one) => one.offsetParent)[number] ?? null;
    item?.classList.add("now");
    item?.setAttribute("aria-current", "step");
    // only within its list: the page stays where it is
    const list = item?.closest(".many");
    if (list) { list.scrollTop = item.offsetTop - list.offsetTop; }
    lit = {number, item};
  };
  const show = () => {
    if (!is_there()) { return; }
    shown = true;
    readouts.classList.remove("idle");
    time = Math.min(time, end());
    const {run} = model, at = (name, stepped) => quantity_at(run, name, time, stepped);
    range.max = String(end());
    range.value = String(time);
    for (const value of readouts.querySelectorAll("b")) {
      const {quantity, digits, stepped} = value.dataset;
      value.parentElement.hidden = !run[quantity];
      if (run[quantity]) { value.textContent = written(at(quantity, stepped), Number(digits)); }
    }
    range.setAttribute("aria-valuetext", `${written(time, 1)} s, ${written(at("position"), 0)} m`);
    const x = [model.over_time ? time : at("position")];
    ["speed", "height"].forEach((name, k) => put(model.train[k], {x, y: [at(name)]}));
    light(instruction_at(run.starts, time));
  };
  const stop = () => {
    playing = asked = false;
    button.textContent = "Play";
  };
  const step = (now_ms) => {
    if (!playing) { return; }
    // another page is in sight, or none
    if (signal.aborted || !root.checkVisibility()) { stop(); return; }
    const since_ms = now_ms - begun_ms;
    if (!calm.matches || since_ms >= CALM_MS) {
      time += (since_ms / 1000) * Number(pace.value);
      begun_ms = now_ms;
      show();
    }
    if (time >= end()) { stop(); } else { requestAnimationFrame(step); }
  };
  const start = () => {
    if (time >= end()) { time = 0; }
    playing = true;
    asked = false;
    button.textContent = "Pause";
    begun_ms = performance.now();
    requestAnimationFrame(step);
  };
  button.addEventListener("click", () => {
    want();
    if (playing) { stop(); } else if (is_there()) { start(); } else { asked = true; }
  });
  range.addEventListener("input", () => {
    want();
    time = Number(range.value);
    show();
  });
  root.addEventListener("pointerenter", want);
  root.addEventListener("focusin", want);
  redraw_on(model, ["run", "train", "over_time"], () => {
    if (asked && is_there()) { start(); }
    if (shown || playing) { show(); } else if (is_there()) { range.max = String(end()); }
  });
  return root;
}
