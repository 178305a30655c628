// Functions of the document that all components need.

// An element with attributes; those that are null or false are left out, one that is true has no value.
export const make = (tag, attributes = {}, ...children) => {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value !== null && value !== false) { element.setAttribute(name, value === true ? "" : value); }
  }
  element.append(...children);
  return element;
};

// An element with HTML that this program has written itself, or escaped.
export const filled = (tag, name, html = "") => {
  const element = make(tag, name ? {class: name} : {});
  element.innerHTML = html;
  return element;
};

// The element around another one, through the borders of shadow roots.
export const around = (element) => element.parentNode ?? element.host ?? null;

export const within = (element, place) => {
  for (let node = element; node; node = around(node)) { if (node === place) { return true; } }
  return false;
};

// The element that has the focus, within whatever shadow roots.
export const focused = () => {
  let found = document.activeElement;
  while (found?.shadowRoot?.activeElement) { found = found.shadowRoot.activeElement; }
  return found;
};

const lives = new WeakMap();
// A signal that removes all listeners of a component: when it is removed, or rendered again, which the library does
// not report.
export const life_of = (model) => {
  lives.get(model)?.abort();
  const life = new AbortController();
  lives.set(model, life);
  model.on("remove", () => life.abort());
  return life.signal;
};

// Draws again when one of these has changed, once for all changes of a message. Not at the first of them: of changes
// that the server holds, a later value takes the place of an earlier one, so that no order among them can be relied on.
export const redraw_on = (model, names, draw) => {
  let due = false;
  const soon = () => {
    if (due) { return; }
    due = true;
    queueMicrotask(() => { due = false; draw(); });
  };
  for (const name of names) { model.on(name, soon); }
};

// Looks at each frame whether something holds, for a while: for states without an observer, such as the library's views.
export const until = (holds, within_ms) => new Promise((resolve) => {
  const end = performance.now() + within_ms;
  const look = () => {
    if (holds() || performance.now() > end) { resolve(); } else { requestAnimationFrame(look); }
  };
  look();
});

// From first.js: all elements on the page that match, those within shadow roots included.
export const {deep} = window.railjoule;

// The name of the chart whose place an element is, as charts.py writes it into a class of the place.
export const chart_of = (element) => [...element.classList].find((name) => name.startsWith("rj-chart-"))?.slice(9);

// Has columns in the source of a figure, by its id, without a word to the server.
export const put = (id, data) =>
  Bokeh.documents.map((one) => one.get_model_by_id(id)).find(Boolean)?.setv({data}, {sync: false});
