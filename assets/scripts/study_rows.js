// The runs of a study that are chosen, sorted by their energy; each opens on Drive.

import {make, redraw_on} from "./dom.js";

export function render({model}) {
  const root = make("div", {class: "chosen-runs"});
  const button = (text, name, message) => {
    const made = make("button", {type: "button", class: "text-button", "aria-label": name}, text);
    made.addEventListener("click", () => model.send_msg(message));
    return made;
  };
  const row_of = ({row, number, cells}) => make("tr", {},
    make("td", {}, number), ...cells.map((cell) => make("td", {}, cell)),
    make("td", {}, button("Open", `Open run ${number} on Drive`, {what: "open", row})));
  const show = () => {
    const {title, note, head, rows, more, is_chosen} = model;
    const columns = ["Run", ...head].map((words) => make("th", {scope: "col"}, words));
    const last = make("th", {scope: "col"}, make("span", {class: "hidden"}, "Open on Drive"));
    root.replaceChildren(
      make("div", {class: "titled"}, make("h2", {}, title, " ", make("span", {class: "muted"}, note)),
        ...(is_chosen ? [button("Clear the choice", "Clear the choice", {what: "clear"})] : [])),
      make("div", {class: "wide-table", role: "region", tabindex: "0", "aria-label": title},
        make("table", {}, make("thead", {}, make("tr", {}, ...columns, last)), make("tbody", {}, ...rows.map(row_of)))),
      ...(more ? [make("p", {class: "muted"}, `${rows.length} shown. `, button(more, more, {what: "more"}))] : []));
  };
  redraw_on(model, ["title", "note", "head", "rows", "more", "is_chosen"], show);
  show();
  return root;
}
