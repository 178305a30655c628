// A figure on the full screen has its caption as a title, and the x axis that it shares with other figures on the page.
(() => {
  "use strict";
  // Bokeh itself does not find the element within shadow roots
  const full_element = () => {
    let element = document.fullscreenElement;
    while (element?.shadowRoot?.fullscreenElement) { element = element.shadowRoot.fullscreenElement; }
    return element;
  };
  // the tags of a shared axis are a count, its unit and the end of its ticks, as Axis.settle in chart.py writes them
  const own_axis = ({tags: [, unit, end]}) => ({axis_label: {s: "Time, s", m: "Distance, m"}[unit], bounds: [0, end]});
  const model_of = (element) =>
    element ? [...Bokeh.index.query((view) => view.el === element)].find(({model}) => model.type === "Figure")?.model : null;
  let alone = null, is_lent = false;
  const change = () => {
    const element = full_element();
    if (alone && alone === model_of(element)) { return; }
    if (alone) {
      alone.title.setv({visible: false}, {sync: false});
      if (is_lent) { alone.below[0].setv({visible: false}, {sync: false}); }
    }
    alone = model_of(element);
    if (!alone) { return; }
    const [axis] = alone.below;
    is_lent = !axis.visible && alone.x_range.tags.length === 3;
    alone.title.setv({visible: true}, {sync: false});
    if (is_lent) { axis.setv({visible: true, ...own_axis(alone.x_range)}, {sync: false}); }
  };
  // Bokeh prefers the older call, which has an event of its own
  for (const name of ["fullscreenchange", "webkitfullscreenchange"]) { document.addEventListener(name, change); }
})();
