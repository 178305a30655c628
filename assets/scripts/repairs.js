// Defects of Bokeh and Panel in the browser, repaired before the page is made. Each repair first checks what it changes; a
// release that is built otherwise stays as it is.
(() => {
  "use strict";
  const repair = (what, work) => {
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

  // While a renderer takes new data, it waits between its glyphs. A painting then changes what is masked, and the visuals
  // of glyphs that still have the data of before are read beyond the end of the new columns. The renderer sets all visuals
  // once more when it has the data. To be filed with bokeh: "`masked.change` calls `set_visuals` during `set_data`."
  repair("visuals", () => {
    const {prototype: renderer} = prototype_of("GlyphRenderer").default_view;
    const {set_visuals} = needed(renderer, "set_visuals");
    renderer.set_visuals = async function (...rest) {
      try { await set_visuals.apply(this, rest); } catch (error) { if (!(error instanceof RangeError)) { throw error; } }
    };
  });

  // Keys do nothing in a figure, whose words stand on its frame: the tab key has no business in it. It is done while the
  // figure is made, as a reader with a fast hand and a slow browser would otherwise land on a place without a name.
  repair("tab stops", () => {
    const {prototype: canvas} = prototype_of("Canvas").default_view;
    const {initialize} = needed(canvas, "initialize");
    canvas.initialize = function (...rest) {
      initialize.apply(this, rest);
      if (this.events_el) { this.events_el.tabIndex = -1; }
    };
  });

  // A press that rests for 0.3 s is taken for a gesture of its own, and all that is dragged after it stays where it is:
  // who thinks before she drags, or has a busy machine, drags nothing. No figure here has anything to do with a press.
  repair("drags", () => {
    const {UIGestures} = Bokeh.require("core/ui_gestures");
    if (typeof UIGestures.press_threshold !== "number") { throw new TypeError("there is no press_threshold"); }
    UIGestures.press_threshold = 2 ** 31 - 1;  // the longest delay of a timer, ms
  });

  // Each stroke of each painting asks the style sheets for thirty variables that no page of railjoule has.
  repair("strokes", () => {
    const {prototype: figure} = prototype_of("Plot").default_view;
    const {initialize} = needed(figure, "initialize");
    figure.initialize = function (...rest) {
      initialize.apply(this, rest);
      const owner = owner_of(this.visuals?.outline_line, "_get_css_value");
      if (owner) { owner._get_css_value = () => ""; }
      figure.initialize = initialize;
    };
  });
})();
