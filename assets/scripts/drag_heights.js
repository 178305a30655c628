// The borders of the track's sections, dragged along it and up and down.

import {clipped, held_by, scales} from "./drag.js";
import {written} from "./numbers.js";

const REACH_PX = 18;

const signed = (value) => (value > 0 ? "+" : "") + written(value, 1);

// Where border k may be dragged to: between its neighbours, no steeper than allowed, within the figure.
export const moved_border = ({x, y}, k, to, {shortest, steepest_permille, bottom, top}) => {
  const is_last = k === x.length - 1, steep = steepest_permille / 1000;
  const place = is_last ? x[k] : clipped(Math.round(to.x), x[k - 1] + shortest, x[k + 1] - shortest);
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
    .map((k) => ({k, away: Math.hypot((event.x - x[k]) * scale.x, (event.y - y[k]) * scale.y)}));
  const held = held_by(f, event, grips, REACH_PX);
  if (!held) { return; }
  if (event.event_name === "panend") {
    sign.data = {x: [], y: [], text: []};
    dropped.data = {x: [...x], y: [...y]};
    return;
  }
  const {start: bottom, end: top} = f.y_range;
  const bounds = {shortest, steepest_permille: steepest, bottom, top};
  const moved = moved_border(nodes.data, held.k, event, bounds);
  x[held.k] = moved.x;
  y[held.k] = moved.y;
  sign.data = {x: [moved.x], y: [moved.y], text: [`${moved.x} m: ${moved.climbs.map(signed).join(", ")} \u2030`]};
  nodes.change.emit();
};
