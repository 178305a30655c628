// The lessons of a report: the components of the page Learn, each with a model that answers from the file's own data.

import {make} from "./dom.js";
import {drawing_verdict, drive_verdict, sharing_verdict} from "./verdicts.js";

const VERDICTS = {
  drive_it: (lesson, {commands}) => drive_verdict(lesson, commands),
  share_out: (lesson, {sharing}) => sharing_verdict(lesson, sharing),
  draw_speed: (lesson, {drawn}) => drawing_verdict(lesson, drawn),
};

// What a component needs in place of its model on the page: values, a way to change them, and who hears its messages.
const model_of = (values, hear) => {
  const watchers = {};
  const model = {
    ...values, alone: true, send_msg: (message) => hear(message), on: (name, act) => { (watchers[name] ??= []).push(act); },
  };
  const change = (changed) => {
    Object.assign(model, changed);
    for (const name of Object.keys(changed)) { (watchers[name] ?? []).forEach((act) => act()); }
  };
  return {model, change};
};

// Components have roots of their own as on the page, and so their names and rules to themselves.
const root_in = (place, sheet) => {
  const root = place.attachShadow({mode: "open"}), inside = make("div");
  root.append(make("style", {}, sheet), inside);
  return inside;
};

const play = (place, name, {played, sheets}, components) => {
  const lesson = played[name];
  const {model, change} = model_of({driven: "", verdict: {}, refusals: 0, ...lesson},
    (message) => change({verdict: VERDICTS[name](lesson, message)}));
  root_in(place, sheets.played).append(components[name]({model}));
};

// The curve of the optimum is in the figure after the guess, and has no points in it before.
const reveal_in_figure = ({source, columns, range, ends}, revealed) => {
  const model = (id) => Bokeh.documents.at(-1).get_model_by_id(id);
  model(source).data = revealed ? columns : Object.fromEntries(Object.keys(columns).map((name) => [name, []]));
  model(range).end = ends[+revealed];
};

const guess = (place, name, {guessed, sheets}, components) => {
  const {title, asked, verdicts, before, after, later} = guessed[name];
  const parts = Object.fromEntries([...place.querySelectorAll("[data-part]")]
    .map((part) => [part.dataset.part, root_in(part, sheets[part.dataset.part])]));
  const bars = model_of(before.bars, () => {});
  const show = (revealed) => {
    const shown = revealed ? after : before;
    // written by this program, which has escaped what it names
    for (const part of ["cells", "told", "text"]) { parts[part].innerHTML = shown[part]; }
    bars.change(shown.bars);
    for (const figure of place.querySelectorAll("[data-after]")) { figure.hidden = !revealed; }
  };
  const {model, change} = model_of({lesson: name, title, asked, verdict: {}, guessed: false, opened: false}, ({what, value}) => {
    const revealed = what === "guess";
    if (later.source) { reveal_in_figure(later, revealed); }
    show(revealed);
    change({verdict: revealed ? verdicts[value] : {}, guessed: revealed});
  });
  parts.guess.append(components.guess({model}));
  parts.bars.append(components.energy_bars({model: bars.model}));
  show(false);
};

export const begin = (components) => {
  const data = JSON.parse(document.getElementById("lessons-data").textContent);
  for (const place of document.querySelectorAll("[data-played]")) { play(place, place.dataset.played, data, components); }
  for (const place of document.querySelectorAll("[data-lesson]")) { guess(place, place.dataset.lesson, data, components); }
};
