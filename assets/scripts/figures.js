// What stands in the place of a chart, and what paints it.

import {within} from "./dom.js";

// The first element beneath a place that matches, within whatever shadow roots.
export const first_in = (place, selector) => {
  for (const root of [place.shadowRoot, place]) {
    if (!root) { continue; }
    const found = root.querySelector(selector);
    if (found) { return found; }
    for (const element of root.querySelectorAll("*")) {
      const inner = element.shadowRoot && first_in(element, selector);
      if (inner) { return inner; }
    }
  }
  return null;
};

// The element that names the figure, and its name.
export const named = (place) => first_in(place, "[data-figure], [role=img][aria-label]");
export const words_of = (place) => {
  const figure = named(place);
  return figure ? figure.dataset.figure ?? figure.getAttribute("aria-label") : "";
};

export const bokeh_views = (place) =>
  [...Bokeh.index.query((view) => view.model.type === "Figure" && within(view.el, place))];
export const plotly_of = (place) => first_in(place, ".js-plotly-plot");
export const drawn_in = (place) => first_in(place, "svg[data-figure]");

// Bokeh paints at the pixel ratio of the window: while this draws, it is another one.
export const at_ratio = (ratio, draw) => {
  const own = Object.getOwnPropertyDescriptor(window, "devicePixelRatio");
  Object.defineProperty(window, "devicePixelRatio", {configurable: true, value: ratio});
  try { return draw(); } finally {
    if (own) { Object.defineProperty(window, "devicePixelRatio", own); } else { delete window.devicePixelRatio; }
  }
};

// The tags of a shared axis are a count, its unit and the end of its ticks, as Axis.settle in charts.py writes them.
export const x_words = (figure) => {
  const [, unit] = figure.x_range.tags ?? [];
  return figure.below.find((one) => one.axis_label)?.axis_label
    || {s: "Time, s", m: "Distance, m"}[unit] || "";
};

// What the x axis becomes of a figure that stands alone: on the page, one axis serves all figures above each other.
export const own_axis = (figure) => {
  const end = figure.x_range.tags?.[2];
  return {visible: true, axis_label: x_words(figure), ...(end ? {bounds: [0, end]} : {})};
};
