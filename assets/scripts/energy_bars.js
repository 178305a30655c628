// Where the energy of runs is at one place of their way: bars of motion, height, resistance, losses and what returned.

import {life_of, make, redraw_on} from "./dom.js";
import {PARTS, figures_of} from "./played.js";

export function render({model}) {
  const signal = life_of(model), root = make("section", {class: "energies", "aria-label": "Where the energy is, kWh"});
  const range = make("input", {type: "range", min: 0, step: 1, "aria-label": "Place, m"}), place = make("b");
  const body = make("tbody"), head = make("tr"), told = make("p", {class: "hidden", role: "status"});
  let cells = [];
  const at = () => Number(range.value);

  // the widest bar of all places, so that bars of different places can be compared
  const widest = () => Math.max(0.01, ...model.runs.flatMap((run) => PARTS.flatMap(([name]) => run[name].map(Math.abs))));
  const follow = (tell) => {
    const k = at(), most = widest(), metres = `${model.places[k] ?? 0} m`;
    place.textContent = metres;
    range.setAttribute("aria-valuetext", metres);
    cells.forEach(([name, fills, values]) => model.runs.forEach((run, r) => {
      const kwh = run[name][k] ?? 0;
      fills[r].style.width = `${(100 * Math.abs(kwh)) / most}%`;
      fills[r].classList.toggle("less", kwh < -0.005);
      values[r].textContent = figures_of(kwh, 2);
    }));
    if (tell) {
      told.textContent = model.runs.map((run) => `At ${metres}, ${run.name}: ` +
        PARTS.map(([name, label]) => `${label.toLowerCase()} ${figures_of(run[name][k] ?? 0, 2)}`).join(", ") + " kWh.").join(" ");
    }
  };
  const build = () => {
    root.hidden = !model.runs.length;
    const last = model.places.length - 1, before = range.dataset.placed ? at() : Math.round(last / 2);
    range.max = String(Math.max(last, 0));
    range.value = String(Math.min(before, Math.max(last, 0)));
    if (last > 0) { range.dataset.placed = "yes"; }
    head.replaceChildren(make("th", {scope: "col"}, "kWh"), make("td"), ...model.runs.map((run) =>
      make("th", {scope: "col"}, make("i", {class: run.kind, "aria-hidden": "true"}), run.name)));
    cells = PARTS.map(([name]) => [name, model.runs.map((run) => make("i", {class: run.kind})), model.runs.map(() => make("td"))]);
    body.replaceChildren(...cells.map(([, fills, values], k) => make("tr", {},
      make("th", {scope: "row"}, PARTS[k][1]), make("td", {class: "bars", "aria-hidden": "true"}, ...fills), ...values)));
    follow(false);
  };
  range.addEventListener("input", () => follow(true), {signal});
  root.append(make("h3", {}, "Where the energy is, up to ", place), range, make("table", {}, make("thead", {}, head), body), told);
  build();
  redraw_on(model, ["runs", "places"], build);
  return root;
}
