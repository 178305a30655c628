// The buttons within pieces of HTML: they copy and print the advice card, and sort tables.

import {make} from "./dom.js";
import {copy_text} from "./files.js";

const COPIED_FOR_MS = 2000;
const PRINTED = "body { font: 20px/1.5 sans-serif; } h1 { font-size: 24px; } h2 { font-size: 20px; } p { margin: 0 0 6px; }";

// a number as programs read it
export const plain = (text) => text.trim().replaceAll("\u202f", "").replaceAll("\u2212", "-");

// the lines of the advice with their numbers, and between them from where to where each leg leads
const lines_of = (card) => [...card.querySelectorAll("li:has(> b), .way")].map((item) => {
  const number = item.querySelector("b")?.textContent;
  return number ? `${number}. ${item.textContent.trim().slice(number.length)}` : item.textContent;
});
const card_text = (card) => [card.dataset.title, ...lines_of(card)].join("\n");
const print_card = (card) => {
  document.getElementById("rj-print")?.remove();
  const frame = make("iframe", {
    id: "rj-print", title: "Driver\u2019s advice, to print", "aria-hidden": "true",
    style: "position:fixed;width:0;height:0;border:0;visibility:hidden",
  });
  document.body.append(frame);
  const {head, body} = frame.contentDocument, {title} = card.dataset;
  head.append(make("title", {}, title), make("style", {}, PRINTED));
  body.append(make("h1", {}, title), ...lines_of(card).map((line) => make(/^\d+\. /.test(line) ? "p" : "h2", {}, line)));
  frame.contentWindow.print();
};
const ACTIONS = {
  copy: async (button) => {
    await copy_text(card_text(button.closest(".card")));
    button.textContent = "Copied";
    setTimeout(() => { button.textContent = "Copy"; }, COPIED_FOR_MS);
  },
  print: (button) => print_card(button.closest(".card")),
  sort: (button) => {
    const heading = button.closest("th");
    const upwards = heading.getAttribute("aria-sort") !== "ascending";
    for (const other of heading.parentNode.cells) { other.removeAttribute("aria-sort"); }
    heading.setAttribute("aria-sort", upwards ? "ascending" : "descending");
    const body = heading.closest("table").tBodies[0];
    const rows = [...body.rows].sort((one, other) => {
      const order = compared(...[one, other].map((row) => row.cells[heading.cellIndex].textContent.trim()));
      return upwards ? order : -order;
    });
    body.append(...rows);
  },
};
// numbers by size, words by the alphabet, what is not known last
export const compared = (one, other) => {
  const [a, b] = [one, other].map((text) => Number(plain(text) || NaN));
  if (Number.isNaN(a) !== Number.isNaN(b)) return Number.isNaN(a) ? 1 : -1;
  return Number.isNaN(a) ? one.localeCompare(other) : a - b;
};
export const act_on = (event) => {
  const button = event.composedPath()[0].closest?.("button[data-act]");
  if (button) ACTIONS[button.dataset.act]?.(button);
};
