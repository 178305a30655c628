// The lesson on the supplement: seconds dragged from leg to leg until a second more saves alike everywhere.

import {life_of, make} from "./dom.js";
import {figures_of, listen_to, pressing, verdict_of, with_sign} from "./played.js";

const KEY_STEPS = {ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: 5, PageDown: -5, Home: -1e3, End: 1e3};
const NEXT = {uneven: "even", even: "uneven"};

// The border behind leg k moves by some seconds, as far as both legs beside it keep the least.
export const moved = (seconds, k, by, least) => {
  const most = seconds[k + 1] - least, fewest = least - seconds[k], step = Math.min(Math.max(by, fewest), most);
  return seconds.map((one, i) => (i === k ? one + step : i === k + 1 ? one - step : one));
};
// A table holds a value for each whole second from the least on.
export const price_of = (line, seconds, k) => line.legs[k].price_wh_s[seconds[k] - line.min_s];
export const total_kwh = (line, seconds) =>
  line.legs.reduce((sum, leg, k) => sum + leg.energy_kwh[seconds[k] - line.min_s], line.standing_kwh);
const equal_share = (line) => line.legs.map(() => line.slack_s / line.legs.length);

export function render({model}) {
  const signal = life_of(model), root = make("section", {class: "played share-out", "aria-label": "Distribute the supplement"});
  const button = pressing(signal), told = make("p", {role: "status"}), split = make("div", {class: "split"});
  const legs = make("div", {class: "bars"}), total = make("b"), against = make("small"), steps = make("div", {class: "row"});
  let name = "", line = null, seconds = [], asked = false, parts = null;

  const show = () => {
    // one scale as long as no price passes it, so that a bar's length can be compared with that before
    const widest = Math.max(...line.legs.flatMap((_, k) => [1.5 * price_of(line, equal_share(line), k), price_of(line, seconds, k)]));
    let before = 0;
    seconds.forEach((one, k) => {
      const price = price_of(line, seconds, k), {share, fill, value, own, border} = parts[k];
      share.style.width = `${(100 * one) / line.slack_s}%`;
      share.firstChild.textContent = `${one} s`;
      fill.style.width = `${(100 * price) / widest}%`;
      value.textContent = figures_of(price, price < 100 ? 1 : 0);
      own.textContent = figures_of(line.legs[k].energy_kwh[one - line.min_s], 2);
      before += one;
      if (!border) { return; }
      border.style.left = `${(100 * before) / line.slack_s}%`;
      const words = `${one} s for the leg before it, ${seconds[k + 1]} s for the leg after it`, ends = {
        valuemin: before - one + line.min_s, valuemax: before + seconds[k + 1] - line.min_s, valuenow: before, valuetext: words,
      };
      for (const [end, number] of Object.entries(ends)) { border.setAttribute(`aria-${end}`, String(number)); }
    });
    const kwh = total_kwh(line, seconds);
    total.textContent = `${figures_of(kwh, 3)} kWh`;
    against.textContent = `${with_sign(kwh - total_kwh(line, equal_share(line)), 3)} kWh against an equal supplement`;
  };
  const move = (k, by) => {
    const next = moved(seconds, k, by, line.min_s);
    if (asked || next[k] === seconds[k]) { return; }
    seconds = next;
    clear();
    show();
  };
  const clear = () => {
    result.hide();
    reveal.disabled = false;
    for (const mark of split.querySelectorAll(".best")) { mark.remove(); }
    told.textContent = "";
  };
  const held = (border, k) => {
    border.addEventListener("pointerdown", (event) => {
      border.setPointerCapture(event.pointerId);
      border.focus();
      event.preventDefault();
    }, {signal});
    border.addEventListener("pointermove", (event) => {
      if (!border.hasPointerCapture(event.pointerId)) { return; }
      const box = split.getBoundingClientRect(), before = seconds.slice(0, k + 1).reduce((sum, one) => sum + one, 0);
      move(k, Math.round((line.slack_s * (event.clientX - box.left)) / box.width) - before);
    }, {signal});
    border.addEventListener("keydown", (event) => {
      const by = KEY_STEPS[event.key];
      if (!by || event.ctrlKey || event.metaKey || event.altKey) { return; }
      event.preventDefault();
      move(k, by);
    }, {signal});
  };
  // A line's legs, with a border that is dragged behind each but the last.
  const lay = (which, begins) => {
    name = which;
    line = model.given.lines[which];
    seconds = [...begins];
    const titles = line.legs.map((leg) => `${leg.from} \u2013 ${leg.to}`);
    parts = line.legs.map((leg, k) => ({
      share: make("div", {class: "share", title: titles[k]}, make("b"), make("span", {}, titles[k])),
      fill: make("i", {style: "background: var(--rj-accent)"}), value: make("span"), own: make("span"),
      border: k + 1 < line.legs.length
        ? make("div", {class: "border", role: "slider", tabindex: "0", "aria-label": `Seconds before ${leg.to}`}) : null,
    }));
    parts.forEach(({border}, k) => border && held(border, k));
    split.replaceChildren(...parts.map(({share}) => share), ...parts.flatMap(({border}) => border ?? []));
    legs.replaceChildren(...line.legs.flatMap((leg, k) => [
      make("span", {}, titles[k], make("small", {}, ` ${figures_of(leg.length_m / 1000, 2)} km, `, parts[k].own, " kWh")),
      make("div", {}, parts[k].fill), parts[k].value,
    ]));
    steps.replaceChildren(...line.legs.slice(0, -1).flatMap((leg, k) => [
      make("span", {}, `Arrive at ${leg.to}`), button("1 s earlier", () => move(k, -1)), button("1 s later", () => move(k, 1)),
    ]));
    clear();
    told.textContent = "Drag a border between two legs, or press its arrow keys.";
    show();
  };
  const text = () => `${name}:${seconds.join(",")}`;
  const reveal = button("Show the best distribution", () => {
    asked = true;
    reveal.disabled = true;
    told.textContent = "The best distribution is being computed.";
    model.send_msg({what: "done", text: text()});
  }, "main");
  const change = () => { clear(); parts[0].border.focus(); };
  const other = () => { lay(NEXT[name], equal_share(model.given.lines[NEXT[name]])); parts[0].border.focus(); };
  const result = verdict_of(model, signal, {change, other}, text);
  const judge = () => {
    asked = false;
    told.textContent = "";
    let before = 0;
    for (const one of model.verdict.best_s.slice(0, -1)) {
      before += one;
      split.append(make("i", {class: "best", style: `left: ${(100 * before) / line.slack_s}%`}));
    }
    result.show();
  };

  root.append(make("h2", {}, model.title), make("p", {}, model.text), told, result.head, split, steps,
    make("div", {class: "stage"}, make("div", {}, make("h3", {}, "One more second would save, Wh"), legs),
      make("div", {class: "clocks"}, make("div", {}, "Whole line", total, against))),
    make("div", {class: "row"}, reveal), result.details);
  told.textContent = "Opening";
  reveal.disabled = true;
  const prepare = () => { if (!line && model.given.lines) { lay(model.given.line, model.given.seconds); } };
  listen_to(model, {prepare, judge, refuse: () => { asked = false; clear(); }, asked: () => asked});
  return root;
}
