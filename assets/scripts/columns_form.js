// What the columns of a recorder's file mean: a row for each, with a question under it where its unit is in doubt.

import {redraw_on, life_of, make} from "./dom.js";

export function render({model}) {
  const life = life_of(model), root = make("div", {class: "column-form"});
  const say = (header, text) => model.send_msg({header, text});
  const select = (name, options, value, act) => {
    const field = make("select", {"aria-label": name, "data-place": name},
      ...options.map(([key, words]) => make("option", {value: key}, words)));
    field.value = value;
    field.addEventListener("change", () => act(field.value));
    return field;
  };
  const row_of = ({header, quantity, unit, samples, doubt}) => {
    const units = model.units[quantity] ?? [];
    const meaning = select(`Meaning of ${header}`, model.quantities, quantity, (chosen) => {
      const first = (model.units[chosen] ?? [])[0];
      say(header, first ? `${chosen} ${first[0]}` : "");
    });
    const unit_field = units.length
      ? select(`Unit of ${header}`, unit ? units : [["", "?"], ...units], unit, (chosen) => say(header, `${quantity} ${chosen}`))
      : "";
    if (doubt && unit_field) { unit_field.classList.add("doubted"); }
    const cells = samples.map((text, index) => make("td", {class: index ? "sample more" : "sample"}, text));
    const kind = quantity ? "" : "unused";
    const rows = [make("tr", {class: kind}, make("th", {scope: "row"}, header), make("td", {}, meaning),
      make("td", {}, unit_field), ...cells)];
    if (doubt) {
      const buttons = doubt.choices.map(([text, words], index) => {
        const button = make("button", {type: "button", class: index ? "answer" : "answer first"}, words);
        button.addEventListener("click", () => say(header, text));
        return button;
      });
      const words = make("span", {}, make("b", {}, `${header}: `), doubt.sentence);
      rows.push(make("tr", {class: "doubt"}, make("td", {colspan: 3 + samples.length},
        make("div", {role: "group", "aria-label": `Question about ${header}`}, words, ...buttons))));
    }
    return rows;
  };
  const show = () => {
    const before = root.getRootNode().activeElement?.dataset?.place;
    const head = (words, name = "") => make("th", {scope: "col", class: name}, words);
    const count = model.columns[0]?.samples.length ?? 0;
    const samples = [...Array(count).keys()].map((k) => head(k ? "" : "First row", k ? "sample more" : "sample"));
    if (count > 1) { samples[1].textContent = "Rows in motion"; samples[1].colSpan = count - 1; samples.length = 2; }
    root.replaceChildren(make("table", {"aria-label": "What the columns mean"},
      make("thead", {}, make("tr", {}, head("Column"), head("Meaning"), head("Unit"), ...samples)),
      make("tbody", {}, ...model.columns.flatMap(row_of))));
    if (before) { [...root.querySelectorAll("[data-place]")].find((one) => one.dataset.place === before)?.focus(); }
  };
  redraw_on(model, ["columns", "version"], show);
  life.addEventListener("abort", () => root.replaceChildren());
  show();
  return root;
}
