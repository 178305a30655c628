// What the lessons share: numbers in words, bars of energy, buttons, and the link to hand out.

import {make, until} from "./dom.js";

const J_PER_KWH = 3.6e6;
export const KMH_PER_MS = 3.6;
// Name, label and colour of what the account of a run consists of.
export const PARTS = [
  ["motion", "Motion", "accent"], ["height", "Height", "ink3"], ["resistance", "Resistance", "groundline"],
  ["losses", "Losses", "costbar"], ["returned", "Returned", "good"], ["drawn", "Drawn from the supply", "ink"],
];
// What is rounded to zero has no sign.
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

// Bars of the account [J], to be shown again with each change.
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

export const pressing = (signal) => (label, act, name = "") => {
  const made = make("button", {type: "button", class: name || null}, label);
  made.addEventListener("click", act, {signal});
  return made;
};

// An address without what lessons keep in it, but for one name: such a link opens at its lesson.
export const lesson_address = (address, key) => {
  const url = new URL(address);
  // a long state stands behind the #
  const long = url.hash.length > 1, before = new URLSearchParams(long ? url.hash.slice(1) : url.search);
  const values = new URLSearchParams([...before].filter(([name]) => !name.startsWith("learn.") || name === key));
  if (long) { url.hash = values; } else { url.search = values; }
  return url.href;
};

// Once it is there: what has just been made is not laid out yet, and the page may still be another one.
const LAID_OUT_WITHIN_MS = 10_000;
export const come_into_sight = async (root) => {
  await until(() => root.isConnected && root.getBoundingClientRect().height > 0, LAID_OUT_WITHIN_MS);
  requestAnimationFrame(() => root.scrollIntoView());
};

export const link_button = (button, label, key) => {
  const copied = make("span", {role: "status"});
  return [button(label, async () => {
    try {
      await navigator.clipboard.writeText(lesson_address(window.location.href, key));
      copied.textContent = "Copied.";
    } catch { copied.textContent = "Copy the address of this page: it holds what you did."; }
  }), copied];
};

// A table with a heading of its own; each row is its cells, the first of them on the left.
export const table_of = (head, rows) => make("table", {},
  ...(head.length ? [make("tr", {}, ...head.map((word) => make("th", {scope: "col"}, word)))] : []),
  ...rows.map(({cells, name = null}) => make("tr", {class: name}, ...cells.map((cell) => make("td", {}, cell)))));
