// The bar of pages: their groups as lists that the browser opens and closes, and the buttons at its right end.

import {filled, make} from "./dom.js";

const EDGE_PX = 8, LIST_PX = 236;
const ICONS = {
  undo: "M8 5 3 10l5 5M3 10h11a5 5 0 0 1 0 10h-3", redo: "m16 5 5 5-5 5m5-5H10a5 5 0 0 0 0 10h3",
  share: "M3 12a3 3 0 1 0 6 0 3 3 0 1 0-6 0M15 5a3 3 0 1 0 6 0 3 3 0 1 0-6 0m0 14a3 3 0 1 0 6 0 3 3 0 1 0-6 0M9 10l6-4m-6 8 6 4",
  pin: "M8 3h8m-6 0v7l-4 4h12l-4-4V3m-2 11v7", report: "M6 3h8l4 4v14H6zm8 0v5h4M9 13h6m-6 4h6",
};
const icon = (kind) =>
  `<svg viewBox="0 0 24 24" width="18" height="18" fill="none" stroke="currentColor" stroke-width="1.8" aria-hidden="true"><path d="${ICONS[kind]}"/></svg>`;

// Returns the bar, and what draws the state of the model.
export const make_bar = (model) => {
  const nav = make("nav", {"aria-label": "Pages"}), bar = make("ul", {class: "bar"}), right = make("ul", {class: "right"});
  const page_button = ({name}, kind = null) => make("button", {type: "button", class: kind, "data-page": name}, name);
  const opener = (label, list, kind = "group") => {
    const button = make("button", {type: "button", class: kind, popovertarget: list.id, "aria-expanded": "false"}, label);
    list.addEventListener("toggle", ({newState}) => button.setAttribute("aria-expanded", String(newState === "open")));
    list.addEventListener("keydown", (event) => {
      if (event.key === "Escape") { list.hidePopover(); button.focus(); }
    });
    list.addEventListener("beforetoggle", () => {
      const {left, bottom} = button.getBoundingClientRect();
      list.style.left = `${Math.max(EDGE_PX, Math.min(left, window.innerWidth - LIST_PX))}px`;
      list.style.top = `${Math.round(bottom)}px`;
    });
    return button;
  };
  const all = make("div", {class: "list all", id: "all-pages", popover: "auto"});
  const brand = filled("button", "brand", model.brand), label = make("span");
  brand.dataset.page = "Start";
  brand.setAttribute("aria-label", "Start");
  const listed = new Set();
  for (const entry of model.entries) {
    const {name, place, group} = entry, members = group ? model.entries.filter((other) => other.group === group) : [entry];
    if (group && listed.has(group)) { continue; }
    listed.add(group);
    if (group) { all.append(make("h2", {}, group)); }
    all.append(...members.map((one) => page_button(one, group ? "within" : null)));
    if (place === "brand") { continue; }
    if (!group) { (place === "right" ? right : bar).append(make("li", {}, page_button(entry))); continue; }
    const list = make("ul", {class: "list", id: `group-${name.replaceAll(" ", "-")}`, popover: "auto"});
    list.append(...members.map((one) => make("li", {}, page_button(one))));
    bar.append(make("li", {}, opener(group, list), list));
  }
  const menu = opener(label, all, "group menu");
  const buttons = Object.keys(model.labels).map((kind) => {
    const button = filled("button", `action ${kind}`, `${icon(kind)}<span class="word"></span>`);
    button.type = "button";
    button.dataset.ask = kind;
    return button;
  });
  const working = make("div", {class: "working", "aria-hidden": "true"});
  nav.append(brand, menu, all, bar, right, make("div", {class: "actions"}, ...buttons), working);

  const show = (page, is_turning) => {
    label.textContent = page;
    menu.setAttribute("aria-label", `Pages, ${page}`);
    for (const button of nav.querySelectorAll("[data-page]")) {
      if (button.dataset.page === page) { button.setAttribute("aria-current", "page"); } else { button.removeAttribute("aria-current"); }
    }
    for (const group of bar.querySelectorAll(".group")) {
      group.classList.toggle("here", Boolean(group.parentElement.querySelector("[aria-current]")));
    }
    const here = bar.querySelector("li > [aria-current], .here");
    if (here && bar.scrollWidth > bar.clientWidth) { bar.scrollLeft = here.offsetLeft - bar.offsetLeft; }
    for (const button of buttons) {
      const {ask} = button.dataset, words = model.labels[ask];
      button.title = words;
      button.setAttribute("aria-label", words);
      button.lastChild.textContent = words;
      button.disabled = model.disabled.includes(ask);
    }
    working.hidden = !is_turning && !model.working && model.progress === null;
    working.style.setProperty("--share", model.progress ?? "");
    working.classList.toggle("known", model.progress !== null);
  };
  return {nav, show};
};
