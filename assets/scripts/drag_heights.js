// The borders of the track's sections, dragged along it and up and down.

import {clipped, held_by, scales} from "./drag.js";
import {written} from "./numbers.js";

const REACH_PX = 18;
const STILL_PX = 5; // who drags one way does not mean the little that a hand goes the other way

const signed = (value) => (value > 0 ? "+" : "") + written(value, 1);

// Range of border k while it is dragged: between its neighbours, no steeper than allowed, within the figure.
export const moved_border = ({x, y}, k, to, {shortest, steepest_permille, bottom, top}) => {
  const is_last = k === x.length - 1, steep = steepest_permille / 1000;
  const place = is_last || to.x === null ? x[k] : clipped(Math.round(to.x), x[k - 1] + shortest, x[k + 1] - shortest);
  const before = place - x[k - 1], after = is_last ? 0 : x[k + 1] - place;
  let low = Math.max(y[k - 1] - steep * before, bottom), high = Math.min(y[k - 1] + steep * before, top);
  if (!is_last) { low = Math.max(low, y[k + 1] - steep * after); high = Math.min(high, y[k + 1] + steep * after); }
  const height = clipped(to.y, low, high);
  const climbs = [1000 * (height - y[k - 1]) / before, ...(is_last ? [] : [1000 * (y[k + 1] - height) / after])];
  return {x: place, y: height, climbs};
};

export const drag_heights = ({f, nodes, sign, dropped, steepest, shortest}, event) => {
  const {x, y} = nodes.data, scale = scales(f);
  const grips = () => Array.from({length: x.length - 1}, (_, k) => k + 1)
    .map((k) => ({k, from: {x: x[k], y: y[k]}, away: Math.hypot((event.x - x[k]) * scale.x, (event.y - y[k]) * scale.y)}));
  const held = held_by(f, event, grips, REACH_PX);
  if (!held) { return; }
  if (event.event_name === "panend") {
    sign.data = {x: [], y: [], text: []};
    dropped.data = {x: [...x], y: [...y]};
    return;
  }
  const {start: bottom, end: top} = f.y_range;
  const bounds = {shortest, steepest_permille: steepest, bottom, top};
  const {from} = held;
  if (Math.abs(event.x - from.x) * scale.x >= STILL_PX) { from.along = true; }
  if (Math.abs(event.y - from.y) * scale.y >= STILL_PX) { from.upwards = true; }
  const to = {x: from.along ? event.x : null, y: from.upwards ? event.y : from.y};
  const moved = moved_border(nodes.data, held.k, to, bounds);
  x[held.k] = moved.x;
  y[held.k] = moved.y;
  sign.data = {x: [moved.x], y: [moved.y], text: [`${moved.x} m: ${moved.climbs.map(signed).join(", ")} \u2030`]};
  nodes.change.emit();
};
