// Brushing over figures of the same rows: each figure holds one brush at most, and what lies within all stands out.
//
// Where the brushes lie is the first tag of the rows, as JSON: {figure's name: {column: [from, to]}}; a number after it
// makes each release a change. While a brush is drawn, nobody but the browser hears of it.

const HERE = {sync: false};
const START = Symbol.for("railjoule.brush");

// 1 for each of `count` rows that lies within all brushes: from the start, up to but not including the end.
export const held_rows = (data, brushes, count) => {
  const held = new Uint8Array(count).fill(1);
  for (const [column, [low, high]] of Object.values(brushes).flatMap(Object.entries)) {
    const values = data[column];
    for (let k = 0; k < count; k += 1) { if (!(values[k] >= low && values[k] < high)) { held[k] = 0; } }
  }
  return held;
};

// How many of the held values lie in each of equal bins.
export const counted = (values, held, start, width, bins) => {
  const counts = Array.from({length: bins}, () => 0);
  for (let k = 0; k < held.length; k += 1) {
    // what was counted first took the end of the last bin in
    const bin = values[k] === start + bins * width ? bins - 1 : Math.floor((values[k] - start) / width);
    if (held[k] && bin >= 0 && bin < bins) { counts[bin] += 1; }
  }
  return counts;
};

const show_box = ({name, columns: [x, y], box}, brushes) => {
  const brush = brushes[name];
  const [left, right] = brush?.[x] ?? [null, null], [bottom, top] = brush?.[y] ?? [null, null];
  const ends = brush ? {left, right, ...(y ? {bottom, top} : {})} : {};
  box.setv({...ends, visible: Boolean(brush)}, HERE);
};

const show_bars = ({columns: [x], brushed}, data, held) => {
  const {left, right} = brushed.data, bins = left.length;
  const top = counted(data[x], held, left[0], (right[bins - 1] - left[0]) / bins, bins);
  brushed.setv({data: {...brushed.data, top}}, HERE);
};

const show_points = ({columns, brushed}, data, held) => {
  const picked = columns.map((column) => [column, Array.from(data[column]).filter((_, k) => held[k])]);
  brushed.setv({data: Object.fromEntries(picked)}, HERE);
};

const brushes_of = (rows) => JSON.parse(rows.tags[0] ?? "{}");

const show = (rows, parts) => {
  const brushes = brushes_of(rows);
  const held = held_rows(rows.data, brushes, rows.get_length() ?? 0);
  for (const part of parts) {
    show_box(part, brushes);
    (part.columns.length > 1 ? show_points : show_bars)(part, rows.data, held);
  }
};

const ordered = (one, other) => [Math.min(one, other), Math.max(one, other)];

// Called by drags and clicks on a figure, and by a changed tag of the rows.
export const brush = ({rows, parts}, event) => {
  if (!event.event_name) { show(rows, parts); return; }
  const part = parts.find(({figure}) => figure === event.origin);
  if (!part) { return; }
  const {name, columns: [x, y], figure} = part;
  const {[name]: own, ...others} = brushes_of(rows);
  const release = (brushes) => { rows.tags = [JSON.stringify(brushes), Math.abs(rows.tags[1] ?? 0) + 1]; };
  if (event.event_name === "tap") {
    if (own) { release(others); }
    return;
  }
  if (event.event_name === "panstart") { figure[START] = event; }
  const start = figure[START];
  if (!start) { return; }
  const drawn = {[x]: ordered(start.x, event.x), ...(y ? {[y]: ordered(start.y, event.y)} : {})};
  const brushes = {...others, [name]: drawn};
  if (event.event_name === "panend") {
    figure[START] = null;
    release(brushes);
  } else {
    rows.setv({tags: [JSON.stringify(brushes), rows.tags[1] ?? 0]}, HERE);
  }
};
