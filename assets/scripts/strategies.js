// The strategies: which run all numbers speak of, which are drawn, and what each of them needs.

import {filled} from "./dom.js";

export function render({model}) {
  const root = filled("div", "strategies", model.html), refusals = root.querySelector(".refusals");
  root.setAttribute("role", "group");
  root.setAttribute("aria-label", "Strategies");
  const rows = [...root.querySelectorAll("[data-name]")];
  // Choices that the server has not confirmed: numbers of the run before may come first, and would undo them.
  const asked = {chosen: null, ticks: new Map()};
  const fill = (element, html) => { if (element.html !== html) { element.html = element.innerHTML = html; } };
  const show = () => {
    for (const row of rows) {
      const {name} = row.dataset, [radio, box] = row.querySelectorAll("input"), html = model.results[name] ?? model.unknown;
      const is_chosen = name === (asked.chosen ?? model.chosen), ticked = asked.ticks.get(name) ?? model.ticked.includes(name);
      row.classList.toggle("chosen", is_chosen);
      row.classList.toggle("refused", html.includes("reason"));
      row.hidden = model.hidden.includes(name);
      radio.checked = is_chosen;
      box.dataset.ticked = +ticked;
      // the run that all numbers speak of is always drawn
      box.checked = is_chosen || ticked;
      box.disabled = is_chosen;
      fill(row.querySelector(".result"), html);
    }
    fill(refusals, model.refusals);
    root.querySelector(".above").textContent = model.above;
    root.classList.toggle("undrawn", !model.draws);
  };
  root.addEventListener("change", ({target: {type, value: name, checked: on}}) => {
    if (type === "radio") { asked.chosen = name; } else { asked.ticks.set(name, on); }
    model.send_msg(type === "radio" ? {kind: "choose", name} : {kind: "draw", name, on});
    show();
  });
  refusals.addEventListener("click", ({target: {dataset: {kind}}}) => { if (kind) { model.send_msg({kind}); } });
  model.on("chosen", () => { asked.chosen = null; });
  model.on("ticked", () => {
    for (const [name, on] of asked.ticks) { if (model.ticked.includes(name) === on) { asked.ticks.delete(name); } }
  });
  for (const name of ["chosen", "ticked", "results", "unknown", "above", "draws", "hidden", "refusals"]) { model.on(name, show); }
  show();
  return root;
}
