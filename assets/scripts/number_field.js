// The field of a number: its label, a slider where it has ends, a text field, a mark where it is not the scenario's own,
// and the sentence with the reason why a text was not taken.

import {filled, life_of, make} from "./dom.js";
import {written} from "./numbers.js";

// a page redraws no faster; positions of the slider in between are not sent
const SEND_EVERY_MS = 50;
// steps that an arrow key takes with the shift key held
const LEAP = 10;
// more decimals than these nobody types; by less than the second, as a share, binary numbers miss decimal ones
const MOST_TYPED_DIGITS = 6, ROUNDING = 1e-12;

// A number with `digits` decimals, and with more where somebody has typed them: one that a computation gave has no end
// in sight, and is rounded.
export const shown = (number, digits) => {
  for (let more = digits; more <= MOST_TYPED_DIGITS; more++) {
    const missed = Math.abs(Number(number.toFixed(more)) - number);
    if (missed <= ROUNDING * Math.max(Math.abs(number), 1)) { return written(number, more); }
  }
  return written(number, digits);
};

// How far the rail of a slider goes: where its end is no whole number of steps from its start, to the step beyond it.
export const rail_end = ({start, end, step}) => start + Math.ceil((end - start) / step - 1e-9) * step;

// Gives on the first of some values immediately, and then the last one every so often; `flush` gives on the waiting one.
export const throttled = (give, every_ms) => {
  let waiting = [], timer = null;
  const flush = () => {
    clearTimeout(timer);
    timer = null;
    if (!waiting.length) { return; }
    const [value] = waiting;
    waiting = [];
    timer = setTimeout(flush, every_ms);
    give(value);
  };
  return {put: (value) => { waiting = [value]; if (timer === null) { flush(); } }, flush, waiting: () => waiting[0]};
};

export function render({model}) {
  const signal = life_of(model), has_slider = model.step !== null;
  const range = make("input", {id: "slider", class: "rail", type: "range"});
  const tick = make("span", {class: "tick", title: "planned", hidden: true});
  const text = make("input", {id: "text", class: "text", type: "text", autocomplete: "off", spellcheck: "false",
    "aria-label": `${model.of}${model.label}, as a number`, "aria-describedby": "refusal"});
  const mark = make("span", {class: "dot", role: "img", hidden: true}), hint = make("div", {class: "hint"});
  const note = make("div", {class: "note"}), refusal = make("div", {id: "refusal", class: "refusal", role: "alert"});
  const sender = throttled((number) => { model.value = number; }, SEND_EVERY_MS);
  // a message from the server must not take a step back from who slides
  const now = () => sender.waiting() ?? model.value ?? model.suggested;
  const in_words = (number) => number === null ? "" : shown(number, model.digits);
  const with_unit = (number) => `${in_words(number)} ${model.unit}`.trimEnd();
  const fill = (element, words) => { element.textContent = words; element.hidden = !words; };
  // what the script has written, or sent: where the field holds something else, somebody is typing
  let known = "", is_held = false;
  const write = (number) => { text.value = known = in_words(number); };

  const draw_rail = (number) => {
    const share_of = (one) => Math.min(Math.max((one - model.start) / (range.max - model.start || 1), 0), 1);
    Object.assign(range, {min: model.start, max: Number(rail_end(model).toPrecision(12)), step: model.step});
    tick.hidden = model.tick === null || model.tick < model.start || model.tick > model.end;
    tick.style.setProperty("--share", share_of(model.tick ?? model.start));
    if (!is_held) { range.value = number ?? model.start; }
    range.style.setProperty("--share", share_of(number ?? model.start));
    range.setAttribute("aria-valuetext", with_unit(number));
  };
  const draw = (number) => {
    if (has_slider) { draw_rail(number); }
    const [own] = model.original;
    mark.hidden = own === undefined || number === own || (own === null && model.value === null);
    mark.title = `changed: was ${own === null || own === undefined ? "not set" : with_unit(own)}`;
    mark.setAttribute("aria-label", mark.title);
  };
  const show = () => {
    const number = now();
    fill(refusal, model.refusal && number !== null ? `${model.refusal} Kept: ${with_unit(number)}.` : model.refusal);
    fill(note, model.note);
    fill(hint, model.hint);
    text.setAttribute("aria-invalid", Boolean(model.refusal));
    if (is_held) { return; }
    // a refused text stays in the field
    if (!model.refusal && (text.value === known || !text.matches(":focus"))) { write(number); }
    draw(number);
  };
  const move = () => {
    const number = Math.min(Number(range.value), model.end);
    write(number);
    draw(number);
    sender.put(number);
  };
  const rest = () => { is_held = false; sender.flush(); show(); };

  range.addEventListener("input", move);
  range.addEventListener("blur", rest);
  range.addEventListener("pointerdown", () => {
    is_held = true;
    for (const name of ["pointerup", "pointercancel"]) { window.addEventListener(name, rest, {once: true, capture: true, signal}); }
  });
  range.addEventListener("keydown", (event) => {
    // what else a key does, such as a step back, comes after what the slider was moved to before
    if (event.ctrlKey || event.metaKey) { rest(); return; }
    const up = {ArrowUp: 1, ArrowRight: 1, ArrowDown: -1, ArrowLeft: -1}[event.key];
    if (!up || !event.shiftKey) { return; }
    event.preventDefault();
    range.stepUp(LEAP * up);
    move();
  });
  text.addEventListener("change", () => { known = text.value; model.send_msg({text: text.value}); });
  text.addEventListener("keydown", (event) => {
    if (event.key !== "Escape" || text.value === in_words(now())) { return; }
    // what was typed goes first, what the key closes otherwise with the next press
    event.stopPropagation();
    write(now());
    model.refusal = "";
  });
  signal.addEventListener("abort", sender.flush);
  const followed = ["value", "suggested", "original", "start", "end", "tick", "note", "hint", "refusal", "answers"];
  for (const name of followed) { model.on(name, show); }
  write(now());
  show();
  return make("div", {class: `number${has_slider ? "" : " plain"}${model.narrow ? " narrow" : ""}`},
    make("label", {class: "label", for: has_slider ? "slider" : "text"}, model.label), ...has_slider ? [range, tick] : [],
    text, mark, filled("span", "explained", model.info), note, hint, refusal);
}
