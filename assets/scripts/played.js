// Parts that the played lessons share: numbers in words, bars of energy, buttons, and the verdict of the server.

import {deep, make, redraw_on, until} from "./dom.js";

const J_PER_KWH = 3.6e6;
export const KMH_PER_MS = 3.6;
// Name, label and colour of the parts of a run's energy.
const PARTS = [
  ["motion", "Kinetic", "accent"], ["height", "Potential", "ink3"], ["resistance", "Resistance", "groundline"],
  ["losses", "Losses", "costbar"], ["returned", "Regenerated", "good"], ["drawn", "Drawn from the supply", "ink"],
];
// A number that is rounded to zero has no sign.
export const figures_of = (value, digits) => value.toFixed(digits).replace(/^-(?=0\.?0*$)/, "").replace("-", "\u2212");
export const kwh_of = (joules) => figures_of(joules / J_PER_KWH, 2);
export const clock_of = (seconds) => {
  const tenths = Math.round(10 * Math.max(seconds, 0)), rest = tenths % 600;
  return `${Math.floor(tenths / 600)}:${String(Math.floor(rest / 10)).padStart(2, "0")}.${rest % 10}`;
};
export const with_sign = (value, digits) => {
  const text = figures_of(value, digits);
  return /^\u2212|^0(\.0*)?$/.test(text) ? text : `+${text}`;
};

// Bars of the energy [J], to be shown again with each change.
export const energy_bars = () => {
  const bars = make("div", {class: "bars"}), fills = {}, values = {};
  for (const [name, label, colour] of PARTS) {
    fills[name] = make("i", {style: `background: var(--rj-${colour})`});
    values[name] = make("span");
    bars.append(make("span", {}, label), make("div", {}, fills[name]), values[name]);
  }
  const show = (sum) => {
    const widest = Math.max(sum.drawn, Math.abs(sum.height), 1);
    for (const [name] of PARTS) {
      fills[name].style.width = `${(100 * Math.abs(sum[name])) / widest}%`;
      fills[name].classList.toggle("less", sum[name] < -1);
      values[name].textContent = kwh_of(sum[name]);
    }
  };
  return {bars, show};
};

// Two large numbers with a note each.
export const dials = (first, second) => {
  const [one, other] = [first, second].map((label) => ({label, value: make("b"), note: make("small")}));
  const element = make("div", {class: "clocks"}, ...[one, other].map(({label, value, note}) => make("div", {}, label, value, note)));
  return {element, one, other};
};

// Calls back with what the server sends: what the lesson begins with, a verdict that was asked for, or a refusal.
export const listen_to = (model, {prepare, judge, refuse, asked}) => {
  redraw_on(model, ["given"], prepare);
  redraw_on(model, ["verdict"], () => { if (model.verdict.head && asked()) { judge(); } });
  redraw_on(model, ["refusals"], () => { if (asked()) { refuse(); } });
  prepare();
};

// Notes on the element how long the last frames took, in the middle [ms].
const MEASURED = 100;
export const frame_meter = (root) => {
  const frames = [];
  return (begun) => {
    frames.push(performance.now() - begun);
    if (frames.length > MEASURED) { frames.shift(); }
    root.dataset.frameMs = String(frames.toSorted((one, other) => one - other)[Math.floor(frames.length / 2)]);
  };
};

export const pressing = (signal) => (label, act, name = "") => {
  const made = make("button", {type: "button", class: name || null}, label);
  made.addEventListener("click", act, {signal});
  return made;
};

// The verdict of the server in two parts: its head, whose buttons act here or are for the server, and the details.
export const verdict_of = (model, signal, acts, text) => {
  const head = make("div", {hidden: true}), details = make("div", {hidden: true}), parts = [head, details];
  head.addEventListener("click", (event) => {
    const what = event.target.closest("[data-what]")?.dataset.what;
    if (what) { (acts[what] ?? (() => model.send_msg({what, text: text()})))(); }
  }, {signal});
  const hide = () => { for (const part of parts) { part.hidden = true; } };
  const show = () => {
    head.innerHTML = model.verdict.head;
    details.innerHTML = model.verdict.details;
    for (const part of parts) { part.hidden = false; }
    head.querySelector("h2").focus({preventScroll: true});
  };
  return {head, details, show, hide};
};

// A link may lead to one of the lessons, once it is laid out.
const LAID_OUT_WITHIN_MS = 10_000;
export const lead_to = async (name) => {
  const place = () => deep(`.rj-lesson-${name}`)[0];
  await until(() => place()?.getBoundingClientRect().height > 0, LAID_OUT_WITHIN_MS);
  requestAnimationFrame(() => place()?.scrollIntoView());
};
