// The fields that a study varies: each between two numbers that are typed, or dragged on one rail.

import {make, redraw_on} from "./dom.js";

const plain = (number) => String(Number(Number(number).toPrecision(10)));
const key_of = (fields) => fields.map((field) => field.path).join(" ");

export function render({model}) {
  const root = make("div", {class: "study-fields"});
  const note = make("span", {}), list = make("div"), adding = make("div", {class: "adding"});
  root.append(make("div", {class: "section"}, "Fields and ranges ", note), list, adding);
  let drawn = "", rows = new Map();

  const row_of = ({path, label}) => {
    const text = (end) => {
      const input = make("input", {type: "text", class: "end", inputmode: "decimal", autocomplete: "off",
        "aria-label": `${label}: ${end}`});
      input.addEventListener("keydown", (event) => { if (event.key === "Enter") { send(); } });
      input.addEventListener("change", () => send());
      return input;
    };
    const rail = (end) => make("input", {type: "range", "aria-label": `${label}: ${end}, slider`});
    const [low, high, start, end] = [text("from"), text("to"), rail("from"), rail("to")];
    const filled = make("i"), refusal = make("p", {class: "error", role: "alert", hidden: true});
    const sorted = () => [Number(start.value), Number(end.value)].sort((lower, upper) => lower - upper);
    const send = () => model.send_msg({what: "range", path, low: low.value, high: high.value});
    const fill = () => {
      const [least, most] = [Number(start.min), Number(start.max)], wide = most - least || 1;
      const [from, to] = sorted();
      filled.style.left = `${100 * (from - least) / wide}%`;
      filled.style.right = `${100 * (most - to) / wide}%`;
    };
    for (const one of [start, end]) {
      one.addEventListener("input", () => {
        const [from, to] = sorted();
        [low.value, high.value] = [plain(from), plain(to)];
        fill();
      });
      one.addEventListener("change", send);
    }
    const remove = make("button", {type: "button", class: "remove", "aria-label": `Leave ${label} as it is`,
      title: "Leave it as it is"}, "\u00d7");
    remove.addEventListener("click", () => model.send_msg({what: "remove", path}));
    const element = make("div", {class: "field", role: "group", "aria-label": label},
      make("span", {class: "name", title: path}, label),
      make("div", {class: "ends"}, low, make("span", {class: "muted"}, "to"), high),
      make("div", {class: "under"}, make("div", {class: "rails"}, filled, start, end), remove), refusal);
    const update = (field) => {
      for (const one of [start, end]) { Object.assign(one, {min: field.least, max: field.most, step: field.step}); }
      // what was refused stays as it was typed
      if (!field.refusal) { [low.value, high.value] = [plain(field.low), plain(field.high)]; }
      [start.value, end.value] = [field.low, field.high];
      refusal.textContent = field.refusal;
      refusal.hidden = !field.refusal;
      for (const one of [low, high]) { one.setAttribute("aria-invalid", field.refusal ? "true" : "false"); }
      fill();
    };
    return {element, update};
  };

  const show_adding = () => {
    const {groups} = model;
    if (!groups.length) { adding.replaceChildren(); return; }
    const menu = make("select", {"aria-label": "Add a field"}, make("option", {value: ""}, "+ field"),
      ...groups.map(([group, fields]) => make("optgroup", {label: group},
        ...fields.map(([path, label]) => make("option", {value: path}, label)))));
    menu.addEventListener("change", () => { if (menu.value) { model.send_msg({what: "add", path: menu.value}); } });
    adding.replaceChildren(menu);
  };
  const show = () => {
    note.textContent = model.note;
    if (key_of(model.fields) !== drawn) {
      drawn = key_of(model.fields);
      rows = new Map(model.fields.map((field) => [field.path, row_of(field)]));
      list.replaceChildren(...[...rows.values()].map((row) => row.element));
      show_adding();
    }
    for (const field of model.fields) { rows.get(field.path).update(field); }
  };
  redraw_on(model, ["fields", "note", "version"], show);
  redraw_on(model, ["groups"], show_adding);
  show();
  show_adding();
  return root;
}
