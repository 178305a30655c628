// The cursor through all charts of an axis: their captions show the values below the mouse.

import {written} from "./numbers.js";

// where the mouse rests, on the range that the charts share: a callback is compiled again when its charts change
const PLACE = Symbol.for("railjoule.place");

// The value of a line at a place, NaN beyond its ends; a stepped line has that of the cell that ends there.
export const value_at = ({x, y}, place, stepped) => {
  if (!x || x.length < 2 || place < x[0] || place > x[x.length - 1]) { return NaN; }
  const high = Math.max(x.findIndex((one) => one >= place), 1), low = high - 1;
  if (stepped || x[high] === x[low]) { return y[high]; }
  return y[low] + (y[high] - y[low]) * (place - x[low]) / (x[high] - x[low]);
};

// The caption of a chart with the values of its lines at a place; small values have one digit more.
export const caption_at = (chart, sources, place) => {
  const values = chart.sources
    .map(([word, id, x, y, unit, digits]) => {
      const {data} = sources[id];
      const value = value_at({x: data[x], y: data[y]}, place, chart.stepped);
      // a line may have a unit and digits of its own
      const shown = digits ?? chart.digits + (Math.abs(value) < chart.small ? 1 : 0);
      return Number.isFinite(value) ? `${word ? `${word} ` : ""}${written(value, shown)} ${unit ?? chart.unit}` : "";
    })
    .filter(Boolean);
  if (!values.length) { return chart.words; }
  const where = chart.place ? `${written(place, chart.place[1])} ${chart.place[0]}: ` : "";
  return `${chart.words}&ensp;&ensp;${where}${values.join("&ensp;&ensp;")}`;
};

// Called by the mouse, and by a tag of the range when the runs below a resting mouse have changed.
// A caption's tag lists the sources and columns it reads: the arguments stay the same when runs come and go.
export const follow = ({captions, sources, range}, event) => {
  if (event.event_name) { range[PLACE] = event.event_name === "mouseleave" ? null : event.x; }
  const place = range[PLACE] ?? null;
  if (place === null && !event.event_name) { return; }
  for (const caption of captions) {
    const [chart] = caption.tags;
    caption.text = place === null ? chart.words : caption_at(chart, sources, place);
  }
};
