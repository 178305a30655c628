// The field of a number: its label, a slider where it has ends, a text field, a mark where it is not the scenario's own,
// and the sentence that says why a text was not taken.

import {filled, life_of, make} from "./dom.js";
import {written} from "./numbers.js";

// a page redraws no faster; what the slider passes meanwhile is not sent
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

// Gives on the first of some values at once, and then the last one every so often. `flush` gives on what waits, and
// `waiting` tells it.
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
  const put = (value) => {
    waiting = [value];
    if (timer === null) { flush(); }
  };
  return {put, flush, waiting: () => waiting[0]};
};

// The rail: `move` is told each number that it is moved to, `rest` when it is let go.
const make_slider = (model, signal, {move, rest}) => {
  const range = make("input", {id: "slider", class: "rail", type: "range"});
  const tick = make("span", {class: "tick", title: "planned", hidden: true});
  const slider = {parts: [range, tick], held: false};
  let rail = "";
  const share_of = (number) => Math.min(Math.max((number - model.start) / (range.max - model.start || 1), 0), 1);
  slider.show = (number, text) => {
    const now = [model.start, model.end, model.step, model.tick].join();
    if (now !== rail) {
      rail = now;
      range.min = model.start;
      range.max = Number(rail_end(model).toPrecision(12));
      range.step = model.step;
      tick.hidden = model.tick === null || model.tick < model.start || model.tick > model.end;
      tick.style.setProperty("--share", share_of(model.tick ?? model.start));
    }
    if (!slider.held) { range.value = number; }
    range.style.setProperty("--share", share_of(number));
    range.setAttribute("aria-valuetext", text);
  };
  const moved = () => move(Math.min(Number(range.value), model.end));
  const let_go = () => { slider.held = false; rest(); };
  range.addEventListener("input", moved);
  range.addEventListener("pointerdown", () => {
    slider.held = true;
    for (const name of ["pointerup", "pointercancel"]) {
      window.addEventListener(name, let_go, {once: true, capture: true, signal});
    }
  });
  range.addEventListener("blur", let_go);
  range.addEventListener("keydown", (event) => {
    // what else a key does, such as a step back, comes after what the slider was moved to before
    if (event.ctrlKey || event.metaKey) { rest(); return; }
    const up = {ArrowUp: 1, ArrowRight: 1, ArrowDown: -1, ArrowLeft: -1}[event.key];
    if (!up || !event.shiftKey) { return; }
    event.preventDefault();
    range.stepUp(LEAP * up);
    moved();
  });
  return slider;
};

export function render({model}) {
  const signal = life_of(model), has_slider = model.step !== null;
  const label = make("label", {class: "label", for: has_slider ? "slider" : "text"}, model.label);
  const text = make("input", {id: "text", class: "text", type: "text", autocomplete: "off", spellcheck: "false",
    "aria-label": `${model.of}${model.label}, as a number`, "aria-describedby": "refusal"});
  const mark = make("span", {class: "dot", role: "img", hidden: true});
  const note = make("div", {class: "note", hidden: true});
  const refusal = make("div", {id: "refusal", class: "refusal", role: "alert", hidden: true});
  const sender = throttled((number) => { model.value = number; }, SEND_EVERY_MS);
  // what the server says meanwhile, of the number or of something else, must not take a step back from who slides
  const now = () => sender.waiting() ?? model.value ?? model.suggested;
  const with_unit = (number) => `${shown(number, model.digits)} ${model.unit}`.trimEnd();
  // what the script has written, or sent: where the field holds something else, somebody is typing
  let known = "";
  const write = (number) => { text.value = known = number === null ? "" : shown(number, model.digits); };
  const is_typing = () => text.value !== known && text.matches(":focus");
  const slider = has_slider ? make_slider(model, signal, {
    move: (number) => {
      write(number);
      draw(number);
      sender.put(number);
    },
    rest: () => { sender.flush(); show(); },
  }) : null;

  const draw = (number) => {
    slider?.show(number ?? model.start, number === null ? "" : with_unit(number));
    const [own] = model.original;
    mark.hidden = own === undefined || number === own || (own === null && model.value === null);
    mark.title = `changed: was ${own === null || own === undefined ? "not set" : with_unit(own)}`;
    mark.setAttribute("aria-label", mark.title);
  };
  const show = () => {
    const number = now();
    refusal.textContent = model.refusal && number !== null ? `${model.refusal} Kept: ${with_unit(number)}.` : model.refusal;
    refusal.hidden = !model.refusal;
    text.setAttribute("aria-invalid", Boolean(model.refusal));
    note.textContent = model.note;
    note.hidden = !model.note;
    if (slider?.held) { return; }
    // what was refused stays to be mended
    if (!model.refusal && !is_typing()) { write(number); }
    draw(number);
  };
  text.addEventListener("change", () => {
    known = text.value;
    model.send_msg({text: text.value});
  });
  text.addEventListener("keydown", (event) => {
    const number = now();
    if (event.key !== "Escape" || text.value === (number === null ? "" : shown(number, model.digits))) { return; }
    // what was typed goes first, what the key closes otherwise with the next press
    event.stopPropagation();
    write(number);
    model.refusal = "";
  });
  signal.addEventListener("abort", sender.flush);
  for (const name of ["value", "suggested", "original", "start", "end", "tick", "note", "refusal", "answers"]) {
    model.on(name, show);
  }
  write(now());
  show();
  const explained = filled("span", "explained", model.info);
  const kind = `number${has_slider ? "" : " plain"}${model.narrow ? " narrow" : ""}`;
  return make("div", {class: kind}, label, ...slider?.parts ?? [], text, mark, explained, note, refusal);
}
