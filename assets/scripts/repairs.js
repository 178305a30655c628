// Defects of Bokeh in the browser, repaired before the page is made. A release that is built otherwise stays as it is.
(() => {
  "use strict";
  // puts another method in the place of one, from which it is made
  const repair = (module, kind, name, change) => {
    try {
      const {prototype} = Bokeh.require(module)[kind];
      if (typeof prototype[name] !== "function") { throw new TypeError(`there is no ${name}`); }
      prototype[name] = change(prototype[name]);
    } catch (error) { console.debug(`railjoule: ${kind} stays as it is`, error); }
  };

  // While a renderer takes new data, it waits between its glyphs. A painting then changes what is masked, and the visuals
  // of glyphs that still have the data of before are read beyond the end of the new columns. The renderer sets all visuals
  // once more when it has the data. To be filed with bokeh: "`masked.change` calls `set_visuals` during `set_data`."
  repair("models/renderers/glyph_renderer", "GlyphRendererView", "set_visuals", (set_visuals) => async function (...rest) {
    try { await set_visuals.apply(this, rest); } catch (error) { if (!(error instanceof RangeError)) { throw error; } }
  });

  // Keys do nothing in a figure, whose words stand on its frame: the tab key has no business in it. It is done while the
  // figure is made, as a reader with a fast hand and a slow browser would otherwise land on a place without a name.
  repair("models/canvas/canvas", "CanvasView", "initialize", (initialize) => function (...rest) {
    initialize.apply(this, rest);
    if (this.events_el) { this.events_el.tabIndex = -1; }
  });

  // A press that rests for 0.3 s is taken for a gesture of its own, and all that is dragged after it stays where it is:
  // who thinks before she drags, or has a busy machine, drags nothing. No figure here has anything to do with a press.
  repair("core/ui_gestures", "UIGestures", "_pointer_timeout", () => () => {});

  // Each stroke of each painting asks the style sheets for thirty variables that no page of railjoule has.
  repair("core/visuals/visual", "VisualProperties", "_get_css_value", () => () => "");
})();
