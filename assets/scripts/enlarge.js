// A figure that takes the whole screen, and all in it larger by one factor: it is laid out in fewer pixels, and scaled.
// Nothing of it is copied, so that it goes on to show each change; taken back, it is as it was.

import {within} from "./dom.js";
import {at_ratio, bokeh_views, drawn_in, first_in, own_axis} from "./figures.js";

const PLOTLY = "panel.models.plotly.PlotlyPlot";
// a strip would be stretched beyond recognition
const MOST_STRETCHED = 5;
// Bokeh cuts off what is left of a pixel
const ROUNDING = 1e-9;

let enlarged = null;
const factor_of = (element) => enlarged && within(element, enlarged.place) ? enlarged.factor : 1;

// Bokeh measures its elements as they are on the screen, and paints as finely as the window: both are told the factor.
// Where a release of it is built otherwise, figures still fill the screen, with words no larger than on the page.
let is_told = null;
const tell_bokeh = () => {
  const view = Bokeh.require("models/ui/ui_element").UIElementView.prototype;
  const layer = Bokeh.require("core/util/canvas").CanvasLayer.prototype;
  const {_update_bbox: measure} = view, {resize} = layer;
  const {get} = Object.getOwnPropertyDescriptor(layer, "pixel_ratio_changed");
  const buses = [Bokeh.require("core/ui_events").UIEventBus, Bokeh.require("core/ui_gestures").UIGestures]
    .map(({prototype}) => [prototype, prototype._get_sxy]);
  if (![measure, resize, get, ...buses.map(([, place]) => place)].every((one) => typeof one === "function")) {
    throw new TypeError("Bokeh is built otherwise");
  }
  view._update_bbox = function () {
    const factor = factor_of(this.el), before = this._bbox;
    const changed = measure.call(this);
    if (factor === 1 || !this._is_displayed) { return changed; }
    const {left, top, constructor: Box} = this._bbox;
    this._bbox = new Box({
      left: Math.round(left / factor), top: Math.round(top / factor),
      width: this.el.offsetWidth, height: this.el.offsetHeight,
    });
    return !before.equals(this._bbox);
  };
  const finely = (element, work) => {
    const factor = factor_of(element);
    return factor === 1 ? work() : at_ratio(factor * window.devicePixelRatio * (1 + ROUNDING), work);
  };
  layer.resize = function (...size) { return finely(this.el, () => resize.apply(this, size)); };
  Object.defineProperty(layer, "pixel_ratio_changed", {
    get() { return finely(this.el, () => get.call(this)); }, configurable: true,
  });
  for (const [bus, place] of buses) {
    bus._get_sxy = function (event) {
      const {sx, sy} = place.call(this, event), factor = factor_of(this.hit_area);
      return {sx: sx / factor, sy: sy / factor};
    };
  }
};
const can_scale = () => {
  try {
    if (is_told === null) { tell_bokeh(); is_told = true; }
  } catch (error) {
    console.debug("railjoule: figures are not scaled", error);
    is_told = false;
  }
  return is_told;
};

const drawn_by = (place, type) => [...Bokeh.index.query((view) => view.model.type === type && within(view.el, place))];

// Lays a place of a chart over a part of the screen {left, top, width, height}, all in it larger by a factor if possible.
// `fit` does so again where the part or what stands in the place has changed; `back` takes all of it back.
export const enlarge = (place) => {
  const {offsetWidth: own_width, offsetHeight: own_height} = place;
  const styles = new Map(), lent = new Map();
  const dress = (element, style) => {
    const before = styles.get(element) ?? {};
    styles.set(element, before);
    for (const [name, value] of Object.entries(style)) {
      before[name] ??= element.style.getPropertyValue(name);
      if (element.style.getPropertyValue(name) !== value) { element.style.setProperty(name, value, "important"); }
    }
  };
  // What is changed of a model, in the browser alone; what the server changes meanwhile is what it has again afterwards.
  const same = (one, other) => String(one) === String(other);
  const lend = (model, wanted) => {
    const {own, given} = lent.get(model) ?? {own: {}, given: {}};
    lent.set(model, {own, given});
    for (const name of Object.keys(wanted)) {
      if (!(name in own) || !same(model[name], given[name])) { own[name] = model[name]; }
      given[name] = wanted[name];
    }
    if (Object.keys(wanted).some((name) => !same(model[name], wanted[name]))) { model.setv(wanted, {sync: false}); }
  };
  const give_axis = ({model: figure}) => {
    const [axis] = figure.below, own = lent.get(axis)?.own;
    if (!axis || (axis.visible && !own)) { return; }
    // its words as they were: else its unit would stay what it is now
    lend(axis, own_axis({x_range: figure.x_range, below: [own ?? axis]}));
  };
  const fit = (part, wanted) => {
    const whole = drawn_in(place), figures = bokeh_views(place), scenes = drawn_by(place, PLOTLY);
    const all = can_scale() || whole ? wanted : 1;
    // a drawing keeps its shape, and is as large as it can be
    const width = whole ? own_width : Math.floor(part.width / all);
    // whole pixels of the screen in the width, or all that is painted would be a little blurred
    const factor = whole ? Math.min(part.width / own_width, part.height / own_height) : Math.floor(part.width) / width;
    const most = figures.length + scenes.length ? MOST_STRETCHED * own_height : own_height;
    const height = whole ? own_height : Math.min(Math.floor(part.height / factor), Math.max(most, 0));
    enlarged = {place, factor};
    const [left, top] = [["left", width], ["top", height]].map(([side, size]) =>
      Math.round(part[side] + (part[side === "left" ? "width" : "height"] - factor * size) / 2));
    dress(place, {
      position: "fixed", left: `${left}px`, top: `${top}px`, width: `${width}px`, height: `${height}px`, margin: "0px",
      "max-width": "none", "max-height": "none", "z-index": "2301", "touch-action": "none",
      transform: `scale(${factor})`, "transform-origin": "0px 0px",
      // a canvas would be shrunk to its layout first and then scaled; what is drawn in words and lines would be blurred
      "will-change": whole ? "auto" : "transform",
    });
    const tall = height / (figures.length + scenes.length || 1);
    for (const {model} of [...figures, ...scenes]) { lend(model, {height: Math.floor(tall)}); }
    // the caption stands beneath the figure, larger
    for (const beside of [".rj-caption", ".rj-save"].map((name) => first_in(place, name))) {
      if (beside) { dress(beside, {display: "none"}); }
    }
    figures.forEach(give_axis);
  };
  const back = () => {
    enlarged = null;
    for (const [element, before] of styles) {
      for (const [name, value] of Object.entries(before)) { element.style.setProperty(name, value); }
    }
    styles.clear();
    for (const [model, {own, given}] of lent) {
      const back_to = Object.entries(own).filter(([name]) => same(model[name], given[name]));
      model.setv(Object.fromEntries(back_to), {sync: false});
    }
    lent.clear();
  };
  return {fit, back};
};
