// The strategies: which run all numbers speak of, which are drawn, and what each of them needs.

import {filled, make} from "./dom.js";

export function render({model}) {
  const root = make("div", {class: "strategies", role: "group", "aria-label": "Strategies"});
  const head = filled("div", "strategy head",
    '<span class="one">this run</span><span class="draw">draw</span><span></span><span></span><span></span>' +
    '<span class="heads"><span>kWh</span><span class="above"></span></span>');
  head.setAttribute("aria-hidden", "true");
  root.append(make("div", {class: "section"}, "Strategies"), head);
  const rows = new Map();
  // Choices that the server has not confirmed: numbers of the run before may come first, and would undo them.
  const asked = {chosen: null, ticks: new Map()};
  const is_chosen = (name) => name === (asked.chosen ?? model.chosen);
  const is_ticked = (name) => asked.ticks.get(name) ?? model.ticked.includes(name);
  for (const {name, label, swatch, info} of model.strategies) {
    const radio = make("input", {class: "one", type: "radio", name: "this-run", value: name, "aria-label": label});
    const box = make("input", {class: "draw", type: "checkbox", "aria-label": `Draw ${label}`});
    const text = make("label", {class: "name"}, label), result = make("span", {class: "result"});
    text.addEventListener("click", () => radio.click());
    const row = make("div", {class: "strategy"},
      radio, box, filled("span", "swatch", swatch), text, filled("span", "", info), result);
    radio.addEventListener("change", () => {
      asked.chosen = name;
      model.send_msg({kind: "choose", name});
      for (const [other, one] of rows) { mark(one, is_chosen(other), is_ticked(other)); }
    });
    box.addEventListener("change", () => {
      asked.ticks.set(name, box.checked);
      box.dataset.ticked = +box.checked;
      model.send_msg({kind: "draw", name, on: box.checked});
    });
    rows.set(name, {row, radio, box, result});
    root.append(row);
  }
  const refusals = make("div", {class: "refusals", role: "status"});
  refusals.addEventListener("click", (event) => {
    const pressed = event.target.closest("button");
    if (pressed) { model.send_msg({kind: pressed.dataset.kind}); }
  });
  // assets/scripts/browser.js turns to the page
  root.append(refusals, make("button", {type: "button", class: "more", "data-open": "Set speeds"}, "Adjust set speeds"));
  const mark = ({row, radio, box}, chosen, ticked) => {
    row.classList.toggle("chosen", chosen);
    radio.checked = chosen;
    box.dataset.ticked = +ticked;
    // the run that all numbers speak of is always drawn
    box.checked = chosen || ticked;
    box.disabled = chosen;
  };
  const show = () => {
    for (const [name, one] of rows) {
      mark(one, is_chosen(name), is_ticked(name));
      const html = model.results[name] ?? model.unknown;
      if (one.html !== html) { one.html = html; one.result.innerHTML = html; }
      one.row.classList.toggle("refused", html.includes("reason"));
      one.row.hidden = model.hidden.includes(name);
    }
    if (refusals.html !== model.refusals) { refusals.html = model.refusals; refusals.innerHTML = model.refusals; }
    head.querySelector(".above").textContent = model.above;
    root.classList.toggle("undrawn", !model.draws);
  };
  model.on("chosen", () => { asked.chosen = null; });
  model.on("ticked", () => {
    for (const [name, on] of asked.ticks) { if (model.ticked.includes(name) === on) { asked.ticks.delete(name); } }
  });
  for (const name of ["chosen", "ticked", "results", "unknown", "above", "draws", "hidden", "refusals"]) { model.on(name, show); }
  show();
  return root;
}
