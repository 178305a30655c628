// Saves what is shown: figures as PNG, SVG and CSV, tables as CSV; copies and prints the advice card, sorts tables.
// All of it happens in the browser; nothing is asked of the server.

import {filled, life_of, make, until} from "./dom.js";
import {at_ratio, bokeh_views, drawn_in, first_in, named, own_axis, plotly_of, words_of, x_words} from "./figures.js";
import {copy_text, offer} from "./files.js";
import {deep, listen} from "./page.js";

const SVG = "http://www.w3.org/2000/svg";
const PIXELS = 2; // of the picture for each of the page
const LAID_OUT_WITHIN_MS = 5000, COPIED_FOR_MS = 2000;
const [CAPTION_PX, AXIS_PX, STRIP_PX] = [22, 40, 50];
const DECORATION = new Set(["fill", "ink", "colour", "align", "offset", "base", "middle"]);
const NOT_DATA = new Set(["forbidden", "borders"]); // sources that only help the eye
const STYLE = `
:host { position: relative; }
.rj-save { position: absolute; top: 0; right: 14px; z-index: 4; font: 12px var(--rj-font); }
.rj-save.low { right: auto; left: 14px; }
.rj-save.low [role=menu] { right: auto; left: 0; }
.rj-save > button { width: 24px; height: 24px; padding: 3px; border: 1px solid transparent; border-radius: 6px;
  background: var(--rj-surface); color: var(--rj-ink2); cursor: pointer; opacity: 0; display: block; }
:host(:hover) .rj-save > button, .rj-save > button:focus-visible, .rj-save > button[aria-expanded=true] { opacity: 1; }
@media (hover: none) { .rj-save > button { opacity: 1; } }
.rj-save button:focus-visible { outline: 2px solid var(--rj-accent); outline-offset: 1px; }
.rj-save [role=menu] { position: absolute; right: 0; top: 25px; background: var(--rj-surface); padding: 4px;
  border: 1px solid var(--rj-line2); border-radius: 6px; }
.rj-save [role=menuitem] { display: block; width: 100%; min-width: 64px; min-height: 26px; padding: 2px 10px; border: 0;
  background: none; color: var(--rj-ink); font: inherit; text-align: left; border-radius: 4px; cursor: pointer; }
.rj-save [role=menuitem]:hover { background: var(--rj-tint); }
`;
const ICON = `<svg viewBox="0 0 16 16" width="16" height="16" fill="none" stroke="currentColor" stroke-width="1.5"
  aria-hidden="true"><path d="M8 2v8M4.8 7 8 10.2 11.2 7M2.5 11v2.5h11V11"/></svg>`;

const token = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--rj-${name}`).trim();
const slug = (text) => text.toLowerCase().replace(/[^a-z0-9]+/g, "-").replace(/^-+|-+$/g, "").slice(0, 60);
const file_name = (what, ending) => {
  // the name of the scenario; the heading of a page is its question
  const title = deep(".head .scenario").filter((name) => name.checkVisibility())
    .map((name) => name.textContent.trim()).find(Boolean) ?? "railjoule";
  return `${[slug(title), slug(what)].filter(Boolean).join("-")}.${ending}`;
};

// --- pictures

const next_frame = () => new Promise((resolve) => requestAnimationFrame(resolve));
// charts below each other share one axis on the page; a picture of one of them needs its own for a moment
const with_axis = async (view, draw) => {
  const figure = view.model;
  const axis = figure.below[0];
  if (!axis || axis.visible) return draw();
  const before = {visible: false, axis_label: axis.axis_label, bounds: axis.bounds};
  const [height, tall] = [figure.height, view.bbox.height];
  const grow = async (changes, high) => {
    axis.setv(changes, {sync: false});
    figure.setv({height: high}, {sync: false});
    // the library lays out when it has time, and tells nobody
    await until(() => view.bbox.height !== (high === height ? tall + AXIS_PX : tall), LAID_OUT_WITHIN_MS);
    await next_frame();
  };
  await grow(own_axis(figure), height + AXIS_PX);
  try { return draw(); } finally { await grow(before, height); }
};
const image_from = (address) => new Promise((resolve, reject) => {
  const image = new Image();
  image.onload = () => resolve(image);
  image.onerror = () => reject(new Error("The picture could not be drawn."));
  image.src = address;
});
const parsed = (text) => new DOMParser().parseFromString(text, "image/svg+xml").documentElement;
const address_of = (svg) =>
  "data:image/svg+xml;charset=utf-8," + encodeURIComponent(new XMLSerializer().serializeToString(svg));

// each piece of a figure: its size, and itself as a canvas or an image, and as SVG
const pieces_of = async (place, type) => {
  const drawn = drawn_in(place);
  if (drawn) {
    const {width, height} = drawn.viewBox.baseVal;
    return [{width, height, node: type === "svg" ? drawn.cloneNode(true) : await image_from(address_of(drawn))}];
  }
  const plot = plotly_of(place);
  if (plot) {
    const [width, height] = [plot.clientWidth, plot.clientHeight];
    const address = await window.Plotly.toImage(plot, {format: type, width, height, scale: type === "png" ? PIXELS : 1});
    const text = () => decodeURIComponent(address.slice(address.indexOf(",") + 1));
    return [{width, height, node: type === "svg" ? parsed(text()) : await image_from(address)}];
  }
  return Promise.all(bokeh_views(place).map((view) => with_axis(view, () => {
    const {width, height} = view.bbox;
    const node = type === "svg"
      ? parsed(view.export("svg", false).ctx.get_serialized_svg(true))
      : at_ratio(PIXELS, () => view.export("png", true)).canvas;
    return {width, height, node};
  })));
};
const layout_of = (pieces, words) => {
  const top = words ? CAPTION_PX : 0;
  const width = Math.ceil(Math.max(...pieces.map((piece) => piece.width)));
  const height = Math.ceil(pieces.reduce((sum, piece) => sum + piece.height, top)) + 6;
  let y = top;
  for (const piece of pieces) { piece.y = y; y += piece.height; }
  return {width, height};
};
const png_of = async (place) => {
  const [words, pieces] = [words_of(place), await pieces_of(place, "png")];
  const {width, height} = layout_of(pieces, words);
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [width * PIXELS, height * PIXELS];
  const ctx = canvas.getContext("2d");
  ctx.fillStyle = token("surface");
  ctx.fillRect(0, 0, canvas.width, canvas.height);
  ctx.scale(PIXELS, PIXELS);
  ctx.fillStyle = token("ink2");
  ctx.font = `12px ${token("font")}`;
  ctx.fillText(words, 14, 15);
  for (const {node, y, width: wide, height: tall} of pieces) { ctx.drawImage(node, 0, y, wide, tall); }
  return new Promise((resolve) => canvas.toBlob(resolve, "image/png"));
};
const svg_of = async (place) => {
  const [words, pieces] = [words_of(place), await pieces_of(place, "svg")];
  const {width, height} = layout_of(pieces, words);
  const make_svg = (name, attributes, text = "") => {
    const element = document.createElementNS(SVG, name);
    for (const [key, value] of Object.entries(attributes)) { element.setAttribute(key, value); }
    element.textContent = text;
    return element;
  };
  const svg = make_svg("svg", {width, height, viewBox: `0 0 ${width} ${height}`});
  svg.append(make_svg("title", {}, words), make_svg("rect", {width, height, fill: token("surface")}));
  const style = {"font-family": token("font"), "font-size": 12, fill: token("ink2")};
  svg.append(make_svg("text", {x: 14, y: 15, ...style}, words));
  for (const {node, y, width: wide, height: tall} of pieces) {
    for (const [key, value] of Object.entries({x: 0, y, width: wide, height: tall})) { node.setAttribute(key, value); }
    svg.append(document.importNode(node, true));
  }
  return new XMLSerializer().serializeToString(svg);
};

// --- numbers

// a number as programs read it
export const plain = (text) => text.trim().replaceAll("\u202f", "").replaceAll("\u2212", "-");
// text that a spreadsheet would take for a formula is told to be text; numbers lose the spaces and the long minus
export const cell = (value) => {
  if (value == null || Number.isNaN(value)) return "";
  let text = String(value).trim();
  const number = plain(text);
  if (number !== "" && Number.isFinite(Number(number))) { return number.replace(/^\+/, ""); }
  if (/^'*[=+\-@\t\r]/.test(text)) text = `'${text}`;
  return /[",\n\r]/.test(text) ? `"${text.replace(/"/g, '""')}"` : text;
};
export const csv_from = (rows) => rows.map((row) => row.map(cell).join(",")).join("\r\n") + "\r\n";
const table_rows = (table) =>
  [...table.rows].map((row) => [...row.cells].map((entry) => entry.textContent.replace(/\s+/g, " ").trim()));

const image_rows = (data) => {
  const [rows, columns] = [data.image[0].shape?.[0] ?? data.image[0].length, data.image[0].shape?.[1]];
  const wide = columns ?? data.image[0][0].length;
  const at = (row, column) => columns ? data.image[0][row * wide + column] : data.image[0][row][column];
  const points = [];
  for (let row = 0; row < rows; row++) {
    for (let column = 0; column < wide; column++) {
      points.push({
        x: data.x[0] + (column + 0.5) * data.dw[0] / wide, y: data.y[0] + (row + 0.5) * data.dh[0] / rows,
        value: at(row, column),
      });
    }
  }
  return points;
};
const source_points = (data) => {
  if (data.image?.length) return image_rows(data);
  const names = Object.keys(data).filter((name) => !DECORATION.has(name) && typeof data[name][0] !== "object");
  const count = Math.max(0, ...names.map((name) => data[name].length));
  return Array.from({length: count}, (_, k) => Object.fromEntries(names.map((name) => [name, data[name][k]])));
};
// the shortest number that a column of half the size cannot tell from the one that it holds
export const shortest = (value) => {
  for (const digits of [6, 7, 8]) {
    const number = Number(value.toPrecision(digits));
    if (Math.fround(number) === value) { return number; }
  }
  return value;
};
// the points of a line that draws two columns of all that its run has, as run_lines.py lets it; null for other glyphs
export const line_points = ({data}, {type, x, y}) => {
  if (!["Line", "Step"].includes(type) || y?.field === undefined || y.field === "y") return null;
  const [places, values] = [x, y].map(({field}) => {
    const column = data[field];
    return column instanceof Float32Array ? Array.from(column, shortest) : [...column];
  });
  return places.map((place, k) => ({x: place, y: values[k]}));
};
const bokeh_series = (view, words) => {
  const seen = new Set();
  const series = [];
  for (const renderer of view.model.renderers) {
    const {data_source: source, glyph} = renderer;
    if (!source || NOT_DATA.has(source.name) || !renderer.visible || glyph?.type === "Text" || seen.has(source)) continue;
    const line = line_points(source, glyph);
    if (!line) { seen.add(source); }
    const points = line ?? source_points(Object.fromEntries(Object.entries(source.data)));
    // charts.py calls each line and each source by the key that it has in the chart
    if (points.length) series.push([renderer.name ?? source.name ?? `series ${series.length + 1}`, points]);
  }
  const x = x_words(view.model) || "x";
  const side = view.model.left.find((one) => one.axis_label)?.axis_label;
  return [series, {x, y: side || words || "y"}];
};
const plotly_series = (plot) => plot.data.map((trace, k) => {
  const grid = trace.type === "surface";
  const points = grid
    ? [...trace.z].flatMap((row, i) => [...row].map((z, j) => ({x: trace.x[j], y: trace.y[i], z})))
    : [...trace.x].map((x, i) => ({x, y: trace.y[i], z: trace.z[i]}));
  return [trace.name ?? (grid ? "surface" : `series ${k + 1}`), points];
});
const figure_rows = (place) => {
  if (drawn_in(place)) return table_rows(first_in(place, "table"));
  const plot = plotly_of(place);
  const views = plot ? [] : bokeh_views(place);
  const [series, words] = plot ? [plotly_series(plot), {}] : bokeh_series(views[0], words_of(place));
  const columns = [...new Set(series.flatMap(([, points]) => points.flatMap((point) => Object.keys(point))))];
  const rows = series.flatMap(([name, points]) => points.map((point) => [name, ...columns.map((key) => point[key])]));
  return [["series", ...columns.map((key) => words[key] ?? key)], ...rows];
};

const save = async (place, what, type) => {
  const name = file_name(what, type);
  if (type === "png") { offer(await png_of(place), "image/png", name); }
  else if (type === "svg") { offer(await svg_of(place), "image/svg+xml", name); }
  else { offer(csv_from(figure_rows(place)), "text/csv;charset=utf-8", name); }
};

// --- the menu at each figure

const equip = (place) => {
  const root = place.shadowRoot;
  if (!root || root.querySelector(".rj-save") || !named(place)) return;
  const words = words_of(place);
  const sheet = new CSSStyleSheet();
  sheet.replaceSync(STYLE);
  root.adoptedStyleSheets = [...root.adoptedStyleSheets, sheet];
  // a strip has no caption beside which the button could stand: it takes the room of the axis
  const holder = filled("div", place.clientHeight < STRIP_PX ? "rj-save low" : "rj-save",
    `<button type="button" aria-haspopup="menu" aria-expanded="false">${ICON}</button>`);
  const button = holder.firstChild;
  button.setAttribute("aria-label", `Save ${words}`);
  button.title = "Save this figure";
  let menu = null;
  const close = (again) => {
    // let go of it first: what has the focus leaves it when it is removed
    const closing = menu;
    menu = null;
    if (again) button.focus();
    closing?.remove();
    button.setAttribute("aria-expanded", "false");
  };
  const open = () => {
    menu = make("div", {role: "menu", "aria-label": `Save ${words} as`});
    for (const type of ["png", "svg", "csv"]) {
      const item = make("button", {type: "button", role: "menuitem"}, type.toUpperCase());
      item.addEventListener("click", () => { close(true); save(place, words, type); });
      menu.append(item);
    }
    holder.append(menu);
    button.setAttribute("aria-expanded", "true");
    menu.firstChild.focus();
  };
  button.addEventListener("click", () => menu ? close(true) : open());
  holder.addEventListener("keydown", (event) => {
    const items = [...holder.querySelectorAll("[role=menuitem]")];
    const step = {ArrowDown: 1, ArrowUp: -1}[event.key];
    if (event.key === "Escape" && items.length) { close(true); event.stopPropagation(); }
    if (!step || !items.length) return;
    event.preventDefault();
    items[(items.indexOf(root.activeElement) + step + items.length) % items.length].focus();
  });
  holder.addEventListener("focusout", (event) => { if (menu && !holder.contains(event.relatedTarget)) close(false); });
  root.append(holder);
};

// --- buttons within pieces of HTML

// the lines of the advice with their numbers, and between them from where to where each leg leads
const lines_of = (card) => [...card.querySelectorAll("li:has(> b), .way")].map((item) => {
  const number = item.querySelector("b")?.textContent;
  return number ? `${number}. ${item.textContent.trim().slice(number.length)}` : item.textContent;
});
const card_text = (card) => [card.dataset.title, ...lines_of(card)].join("\n");
// a heading and a table beneath it, as the card has them beside its lines
const sheet_part = ([title, rows]) => [make("h2", {}, title),
  make("table", {}, ...rows.map((cells) => make("tr", {}, ...cells.map((text) => make("td", {}, text)))))];
// with so many lines the sheet is to stay one page: some 900 px are left of A4 beside margins and headings
const sheet_style = (count) => {
  const size = Math.max(8, Math.min(15, Math.floor(900 / (1.45 * count + 6))));
  return ` body { font-size: ${size}px; } h1 { font-size: ${1.5 * size}px; margin: 0; } p { margin: 0; }
    h2 { font-size: ${1.15 * size}px; margin: .8em 0 .2em; } h3 { font-size: ${size}px; margin: .3em 0 0; }
    table { font: inherit; border-spacing: 0; } td { padding: 0 24px 0 0; }`;
};
const print_card = (card) => {
  document.getElementById("rj-print")?.remove();
  const frame = make("iframe", {id: "rj-print", title: "Driver\u2019s advice, to print", "aria-hidden": "true"});
  frame.style.cssText = "position:fixed;width:0;height:0;border:0;visibility:hidden";
  document.body.append(frame);
  const sheet = frame.contentDocument;
  const style = sheet.createElement("style");
  const more = card.dataset.sheet ? JSON.parse(card.dataset.sheet) : null;
  style.textContent = "body { font: 20px/1.5 sans-serif; } h1 { font-size: 24px; } h2 { font-size: 20px; } p { margin: 0 0 6px; }";
  if (more) { style.textContent += sheet_style(lines_of(card).length + more.before[1].length + more.after[1].length); }
  const heading = sheet.createElement("h1");
  heading.textContent = card.dataset.title;
  sheet.title = card.dataset.title;
  sheet.head.append(style);
  sheet.body.append(heading);
  if (more) { sheet.body.append(...sheet_part(more.before), make("h2", {}, "Orders")); }
  for (const line of lines_of(card)) {
    const item = sheet.createElement(/^\d+\. /.test(line) ? "p" : more ? "h3" : "h2");
    item.textContent = line;
    sheet.body.append(item);
  }
  if (more) { sheet.body.append(...sheet_part(more.after)); }
  frame.contentWindow.print();
};
const ACTIONS = {
  csv: (button) => {
    const block = button.closest(".block");
    offer(csv_from(table_rows(block.querySelector("table"))), "text/csv;charset=utf-8",
      file_name(button.dataset.name, "csv"));
  },
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
const press = (event) => {
  const button = event.composedPath()[0].closest?.("button[data-act]");
  if (button) ACTIONS[button.dataset.act]?.(button);
};

export function render({model}) {
  const signal = life_of(model);
  const look = () => {
    for (const place of deep(".rj-chart:not(.rj-undrawn)")) { equip(place); }
  };
  document.addEventListener("click", press, {signal});
  signal.addEventListener("abort", listen(look));
  look();
  return make("span");
}
