// What Bokeh and Panel do far too often, or too late, mended before the page is made. Each mend first looks for all that
// it changes; where a release of them is built otherwise it is left out, and the page is slower and nothing else.
(() => {
  "use strict";
  const mend = (what, work) => {
    try { work(); } catch (error) { console.debug(`railjoule: ${what} stays as it is`, error); }
  };
  const needed = (owner, ...names) => {
    for (const name of names) {
      if (typeof owner?.[name] !== "function") { throw new TypeError(`there is no ${name}`); }
    }
    return owner;
  };
  const prototype_of = (name) => Bokeh.Models.get(name).prototype;
  const owner_of = (prototype, name) => {
    let owner = prototype;
    while (owner && !Object.hasOwn(owner, name)) { owner = Object.getPrototypeOf(owner); }
    return owner;
  };

  // Each change of a child, a style or a size lays out the whole page at once, and paints all figures on it anew; so
  // does each figure that finds itself resized by that. Here the place of a chart is laid out by itself, as its size does
  // not depend on what is in it, and what else is changed before the next frame is laid out together.
  mend("layout", () => {
    const {prototype: esm} = prototype_of("panel.models.esm.ReactComponent").default_view;
    const {prototype: column} = prototype_of("panel.models.layout.Column").default_view;
    needed(esm, "invalidate_layout", "compute_layout", "_after_resize");
    needed(column, "invalidate_layout", "compute_layout", "after_layout", "measure_layout", "update_bbox",
      "_compute_layout", "update_layout", "render");
    const page = owner_of(esm, "invalidate_layout"), base = owner_of(column, "invalidate_layout");
    const element = owner_of(esm, "_after_resize");
    const {get} = Object.getOwnPropertyDescriptor(base, "layoutable_views");
    const due = new Map();
    let resizing = false, busy = false, inner = null;
    const lay_out = () => {
      const views = [...due];
      due.clear();
      busy = true;
      try {
        for (const [view, work] of views) { if (!view.is_destroyed) { work.call(view); } }
      } finally { busy = false; }
    };
    const later = (view, work) => {
      if (!due.size) {
        requestAnimationFrame(lay_out);
        // a page in the background has no frames
        if (document.hidden) { setTimeout(lay_out, 50); }
      }
      if (work.thorough || !due.has(view)) { due.set(view, work); }
    };
    const when_possible = (view, work) => {
      // what has never been laid out must be, before it counts as finished; and a figure that paints cannot wait
      const wait = !busy && view._layout_computed && (work.thorough || resizing);
      if (wait) { later(view, work); } else { work.call(view); }
    };

    // the place of a chart
    const is_place = (view) => view.rj_place ??= Boolean(view.model.css_classes?.includes("rj-chart"));
    const own_size = ({model: {visible, height, width, margin, sizing_mode}}) =>
      JSON.stringify([visible, height, width, margin, sizing_mode]);
    const compute_place = function () {
      const before = inner;
      inner = this;
      try {
        this.measure_layout();
        this.update_bbox();
        this._compute_layout();
        this.after_layout();
      } finally { inner = before; }
    };
    const invalidate_place = function () {
      const before = inner;
      inner = this;
      try { this.update_layout(); } finally { inner = before; }
      compute_place.call(this);
    };
    invalidate_place.thorough = true;
    const base_work = {invalidate_layout: base.invalidate_layout, compute_layout: base.compute_layout};
    base.invalidate_layout = function () {
      if (!is_place(this) || !this.rj_laid) { base_work.invalidate_layout.call(this); return; }
      const size = own_size(this);
      if (size !== this.rj_size) { this.rj_size = size; base_work.invalidate_layout.call(this); }
      when_possible(this, invalidate_place);
    };
    base.compute_layout = function () {
      if (is_place(this) && this.rj_laid) { when_possible(this, compute_place); return; }
      base_work.compute_layout.call(this);
    };
    const {render, after_layout} = base;
    base.render = function () {
      // what is rendered anew has lost the styles that gave its figure a size: its next layout goes down to that
      if (is_place(this)) { this.rj_laid = false; }
      render.call(this);
    };
    base.after_layout = function () {
      after_layout.call(this);
      if (is_place(this) && !this.rj_laid) { this.rj_laid = true; this.rj_size = own_size(this); }
    };

    // the page
    const page_work = {invalidate_layout: page.invalidate_layout, compute_layout: page.compute_layout};
    page_work.invalidate_layout.thorough = true;
    for (const [name, work] of Object.entries(page_work)) {
      page[name] = function () { if (this.is_managed) { work.call(this); } else { when_possible(this, work); } };
    }
    const {_after_resize} = element;
    element._after_resize = function (...rest) {
      const before = resizing;
      resizing = true;
      try { return _after_resize.apply(this, rest); } finally { resizing = before; }
    };

    // pages that have been left stay where they are, hidden: they need no layout
    const left = (view) => view.model.css_classes?.includes("rj-away");
    Object.defineProperty(base, "layoutable_views", {
      get() { return left(this) || (is_place(this) && this.rj_laid && this !== inner) ? [] : get.call(this); },
      configurable: true,
    });
  });

  // Keys do nothing in a figure, whose words stand on its frame: the tab key has no business in it. It is done while the
  // figure is made, as a reader with a fast hand and a slow browser would otherwise land on a place without a name.
  mend("tab stops", () => {
    const {prototype: canvas} = prototype_of("Canvas").default_view;
    const {initialize} = needed(canvas, "initialize");
    canvas.initialize = function (...rest) {
      initialize.apply(this, rest);
      if (this.events_el) { this.events_el.tabIndex = -1; }
    };
  });

  // A press that rests for 0.3 s is taken for a gesture of its own, and all that is dragged after it stays where it is:
  // who thinks before she drags, or has a busy machine, drags nothing. No figure here has anything to do with a press.
  mend("drags", () => {
    const {UIGestures} = Bokeh.require("core/ui_gestures");
    if (typeof UIGestures.press_threshold !== "number") { throw new TypeError("there is no press_threshold"); }
    UIGestures.press_threshold = 2 ** 31 - 1;  // the longest delay of a timer, ms
  });

  // Each stroke of each painting asks the style sheets for thirty variables that no page of ours has.
  mend("strokes", () => {
    const {prototype: figure} = prototype_of("Plot").default_view;
    const {initialize} = needed(figure, "initialize");
    figure.initialize = function (...rest) {
      initialize.apply(this, rest);
      const owner = owner_of(this.visuals?.outline_line, "_get_css_value");
      if (owner) { owner._get_css_value = () => ""; }
      figure.initialize = initialize;
    };
  });

  // plotly.js is larger than all the rest; it is loaded when a page first needs it, and draws a scene once, in its
  // size and in our colours, where the library would draw it four times.
  mend("plotly", () => {
    const scene = prototype_of("panel.models.plotly.PlotlyPlot");
    const {prototype: plot} = scene.default_view;
    const {setv} = needed(scene, "setv");
    const {plot: draw, remove, resize_layout, _layout_data} =
      needed(plot, "plot", "remove", "resize_layout", "_layout_data");
    // what the theme of the library would set; the server's changes come with options
    scene.setv = function (changes, options) {
      if (options || !("layout" in changes && "data" in changes)) { setv.call(this, changes, options); }
    };
    let plotly = null;
    const load_plotly = () => plotly ??= new Promise((resolve, reject) => {
      const address = document.getElementById("rj-plotly")?.dataset.address;
      if (window.Plotly || !address) { resolve(); return; }
      const script = document.createElement("script");
      script.src = address;
      script.onload = resolve;
      script.onerror = () => { plotly = null; reject(new Error("plotly.js could not be loaded")); };
      document.head.append(script);
    });
    // resolves when the view has a width, or has gone
    const sized = (view) => view.rj_sized ??= new Promise((resolve) => {
      const go_on = () => { observer.disconnect(); view.rj_sized = null; resolve(); };
      const observer = new ResizeObserver(() => { if (view.el.clientWidth) { go_on(); } });
      view.rj_go_on = go_on;
      observer.observe(view.el);
    });
    plot.plot = async function (...rest) {
      await load_plotly();
      if (!this.is_destroyed && !this.el.clientWidth) { await sized(this); }
      if (this.is_destroyed) { return; }
      // what is taken off the page while it draws has lost what it would draw next
      try { await draw.apply(this, rest); } catch (error) { if (!this.is_destroyed) { throw error; } }
    };
    plot._layout_data = function () {
      const {clientWidth: width, clientHeight: height} = this.el;
      return {..._layout_data.call(this), width, height};
    };
    plot.resize_layout = function () {
      const now = this.container?._fullLayout;
      const {clientWidth, clientHeight} = this.el;
      // what has not been drawn yet, or was taken off the page meanwhile, has no layout: plotly would stumble
      if (!now || this.is_destroyed || !clientWidth) { return; }
      if (now.width !== clientWidth || now.height !== clientHeight) { resize_layout.call(this); }
    };
    plot.remove = function () {
      if (!window.Plotly) { this.container = null; }
      remove.call(this);
      this.rj_go_on?.();
    };
  });

  // The server may not know yet which colours the system asks for: components take those of the page from the first.
  mend("colours", () => {
    const component = prototype_of("panel.models.esm.ReactComponent");
    const {initialize} = needed(component, "initialize");
    component.initialize = function (...rest) {
      const {classList} = document.documentElement;
      if (!classList.contains("rj-started") && this.data?.properties?.dark_theme) {
        this.data.setv({dark_theme: classList.contains("rj-dark")}, {silent: true});
      }
      return initialize.apply(this, rest);
    };
  });
})();
