// The question of a lesson: a number to guess by a slider or by buttons, then guess and answer side by side.

import {life_of, make, redraw_on} from "./dom.js";
import {copy_text} from "./files.js";
import {come_into_sight, lesson_address, pressing} from "./played.js";

// a class is to guess for itself: the link for it has the case of the lesson, and nobody's guesses and runs
const address_for_class = (lesson) => {
  const address = lesson_address(window.location.href, `learn.${lesson}`);
  return `${address}${/[?#]./.test(address) ? "&" : "?"}learn.lesson=${lesson}`;
};

export function render({model}) {
  const signal = life_of(model), root = make("section", {class: "guess", "aria-label": `Guess: ${model.title}`});
  const ask = make("p", {class: "ask", id: "ask"}), copied = make("span", {role: "status"});
  const outcome = make("div", {class: "outcome", tabindex: "-1", role: "group", "aria-label": "Your guess and the answer"});
  const button = pressing(signal);
  let mine = false;
  const guess = (value) => {
    mine = true;
    waiting.hidden = false;
    model.send_msg({what: "guess", value});
  };
  // with the narrow spaces that the page's other numbers have
  const words = (value) => `${String(value).replace(/(\d)(?=\d{3}$)/, "$1\u202f")} ${model.asked.unit}`;

  const {low, high, step, choices} = model.asked, middle = step * Math.round((low + high) / 2 / step);
  const control = make("div", {class: "control"}), waiting = make("span", {role: "status", hidden: true}, "Computing");
  const range = make("input", {type: "range", min: low, max: high, step, value: middle, "aria-labelledby": "ask"});
  const shown = make("output", {}, words(middle));
  const follow = () => { shown.textContent = words(range.value); range.setAttribute("aria-valuetext", words(range.value)); };
  if (choices.length) {
    control.setAttribute("role", "group");
    control.setAttribute("aria-labelledby", "ask");
    control.append(...choices.map((value) => button(words(value), () => guess(value), "choice")));
  } else {
    follow();
    range.addEventListener("input", follow, {signal});
    range.addEventListener("keydown", (event) => { if (event.key === "Enter") { guess(Number(range.value)); } }, {signal});
    control.append(range, shown, button("This is my guess", () => guess(Number(range.value)), "main"));
  }
  control.append(waiting);

  const again = button("Try again", () => { mine = true; model.send_msg({what: "again"}); });
  const link = button("Copy link for a class", async () => {
    copied.textContent = "";
    const done = await copy_text(address_for_class(model.lesson));
    copied.textContent = done ? "Copied: this case, without guesses." : "The browser does not allow copying here.";
  }, "plain");
  const buttons = make("div", {class: "row"}, again, link, copied);

  const mark = (name, share) => make("i", {class: name, style: `left: ${(100 * share).toFixed(1)}%`});
  const show = () => {
    const {verdict} = model, revealed = "answer" in verdict;
    ask.textContent = model.asked.question;
    control.hidden = revealed;
    again.hidden = outcome.hidden = !revealed;
    if (!revealed) {
      outcome.replaceChildren();
    } else {
      waiting.hidden = true;
      const side = (label, value, name) => make("div", {class: name}, make("small", {}, label), make("b", {}, value));
      outcome.replaceChildren(
        make("div", {class: "sides"}, side("Your guess", verdict.guess, "mine"), side("The answer", verdict.answer, "right")),
        make("div", {class: "scale", "aria-hidden": "true"}, mark("mine", verdict.guess_at), mark("right", verdict.answer_at)),
        make("p", {role: "status"}, verdict.sentence));
    }
    // who has pressed a button that is gone now goes on from there; a link that opens a guess moves nobody
    if (mine && revealed) { outcome.focus({preventScroll: true}); }
    if (mine && !revealed && !model.guessed) { control.querySelector("input, button").focus({preventScroll: true}); }
    if (revealed || !model.guessed) { mine = false; }
  };
  root.append(ask, control, outcome, buttons);
  show();
  redraw_on(model, ["asked", "verdict", "guessed"], show);
  const come = () => { if (model.opened) { come_into_sight(root); } };
  redraw_on(model, ["opened"], come);
  come();
  return root;
}
