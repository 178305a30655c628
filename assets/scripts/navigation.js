// The bar of pages, their groups, and the keys that open pages.

import {filled, life_of, make} from "./dom.js";
import {ask} from "./page.js";

const MARGIN_PX = 8;
const TYPED = "input:not([type=range], [type=checkbox], [type=radio], [type=button]), textarea, select, " +
  "[contenteditable=''], [contenteditable=true], [role=textbox], [role=combobox], [role=listbox], [role=option], " +
  "[role=menuitem], [role=spinbutton]";

export function render({model}) {
  const signal = life_of(model), nav = make("nav", {"aria-label": "Pages"});
  const page_button = (name) => make("button", {type: "button", "data-page": name}, name);
  const entries = model.entries, pages = (group) => entries.filter((entry) => entry.group === group);

  // --- lists that open beneath a button

  let opened = null;
  const close = (refocus = false) => {
    if (!opened) { return; }
    const {button, list} = opened;
    opened = null;
    list.hidden = true;
    button.setAttribute("aria-expanded", "false");
    if (refocus) { button.focus(); }
  };
  const open = (button, list, focus) => {
    close();
    opened = {button, list};
    list.hidden = false;
    button.setAttribute("aria-expanded", "true");
    const place = button.getBoundingClientRect();
    const room = window.innerWidth - list.offsetWidth - MARGIN_PX;
    list.style.left = `${Math.max(MARGIN_PX, Math.min(place.left, room))}px`;
    list.style.top = `${Math.round(place.bottom)}px`;
    if (focus) { (list.querySelector("[aria-current]") ?? list.querySelector("button")).focus(); }
  };
  const opener = (button, list) => {
    button.setAttribute("aria-expanded", "false");
    button.setAttribute("aria-controls", list.id);
    // a press by key comes as a click without a place
    button.addEventListener("click", (event) => {
      if (opened?.button === button) { close(); } else { open(button, list, event.detail === 0); }
    });
    button.addEventListener("keydown", (event) => {
      if (event.key === "ArrowDown") { event.preventDefault(); open(button, list, true); }
    });
    list.addEventListener("keydown", (event) => {
      const step = {ArrowDown: 1, ArrowUp: -1}[event.key];
      if (!step) { return; }
      event.preventDefault();
      const buttons = [...list.querySelectorAll("button")];
      const now = buttons.indexOf(event.composedPath()[0]);
      buttons[(now + step + buttons.length) % buttons.length].focus();
    });
  };

  // --- the bar, and the one menu of narrow screens

  const brand = filled("button", "brand", model.brand);
  brand.type = "button";
  brand.dataset.page = "Start";
  brand.setAttribute("aria-label", "Start");
  const bar = make("ul", {class: "bar"}), right = make("ul", {class: "right"});
  for (const {name, place, group} of entries) {
    if (place === "brand") { continue; }
    if (!group) { (place === "right" ? right : bar).append(make("li", {}, page_button(name))); continue; }
    if (pages(group)[0].name !== name) { continue; }
    const list = make("ul", {class: "list", id: `group-${group.replaceAll(" ", "-")}`, hidden: ""});
    list.append(...pages(group).map((entry) => make("li", {}, page_button(entry.name))));
    const button = make("button", {type: "button", class: "group"}, group);
    opener(button, list);
    bar.append(make("li", {}, button, list));
  }
  const label = make("span", {}), menu = make("button", {type: "button", class: "group menu"}, label);
  const all = make("div", {class: "list all", id: "all-pages", hidden: ""});
  let last = "";
  for (const {name, group} of entries) {
    if (group && group !== last) { all.append(make("h2", {}, group)); }
    const button = page_button(name);
    button.classList.toggle("within", Boolean(group));
    all.append(button);
    last = group;
  }
  opener(menu, all);
  nav.append(brand, menu, all, bar, right);

  const show = (page) => {
    label.textContent = page;
    menu.setAttribute("aria-label", `Pages, ${page}`);
    for (const button of nav.querySelectorAll("[data-page]")) {
      if (button.dataset.page === page) { button.setAttribute("aria-current", "page"); }
      else { button.removeAttribute("aria-current"); }
    }
    for (const group of bar.querySelectorAll(".group")) {
      group.classList.toggle("here", Boolean(group.parentElement.querySelector("[aria-current]")));
    }
    const here = bar.querySelector("li > [aria-current], .here");
    if (here && bar.scrollWidth > bar.clientWidth) { bar.scrollLeft = here.offsetLeft - bar.offsetLeft; }
  };
  const turn = (page) => {
    close();
    show(page);
    model.send_msg({kind: "page", page});
    // the press is seen first
    requestAnimationFrame(() => setTimeout(() => ask("turn", {page})));
  };
  nav.addEventListener("click", (event) => {
    const button = event.composedPath().find((element) => element.dataset?.page);
    if (button) { turn(button.dataset.page); }
  });
  const step_aside = (event) => {
    const step = {ArrowRight: 1, ArrowLeft: -1}[event.key];
    const tops = [...nav.querySelectorAll(".brand, .menu, .bar > li > button, .right > li > button")];
    const seen = tops.filter((button) => button.offsetWidth), now = seen.indexOf(event.composedPath()[0]);
    if (!step || now < 0) { return; }
    event.preventDefault();
    close();
    seen[(now + step + seen.length) % seen.length].focus();
  };
  nav.addEventListener("keydown", (event) => {
    if (event.key === "Escape" && opened) { event.stopPropagation(); close(true); } else { step_aside(event); }
  });
  nav.addEventListener("focusout", (event) => {
    if (opened && event.relatedTarget && !nav.contains(event.relatedTarget)) { close(); }
  });

  // --- keys, while nothing is typed

  const key = (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.repeat || event.defaultPrevented) { return; }
    if (event.composedPath().some((element) => element.matches?.(TYPED))) { return; }
    const page = model.keyed[Number(event.key) - 1];
    if (page) { turn(page); } else if (event.key === "?") { turn("Help"); }
    else if (event.key.toLowerCase() === "p" && !event.shiftKey) { model.send_msg({kind: "pin"}); }
    else { return; }
    event.preventDefault();
  };
  const outside = (event) => { if (opened && !event.composedPath().includes(nav)) { close(); } };
  const away = () => close();
  const listeners = [["keydown", key], ["pointerdown", outside], ["resize", away], ["blur", away]];
  for (const [name, listener] of listeners) { window.addEventListener(name, listener, {signal}); }
  // from elsewhere, such as the explanations
  window.addEventListener("rj-open", (event) => turn(event.detail.page), {signal});
  model.on("page", () => show(model.page));
  show(model.page);
  return nav;
}
