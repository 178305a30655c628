// Drags in figures: steps by their level and their ends, and points up and down.

import {written} from "./numbers.js";

const GRIP_PX = 16;
const END_FIRST = 0.9; // where a level is about as near as an end, the end counts
// what is held, on the figure: a callback is compiled again when its arguments change, in the middle of a drag too
const HELD = Symbol.for("railjoule.held");

export const clipped = (value, low, high) => Math.min(Math.max(value, low), high);
// Pixels for each unit of both axes.
export const scales = (figure) => ({
  x: figure.inner_width / (figure.x_range.end - figure.x_range.start),
  y: figure.inner_height / (figure.y_range.end - figure.y_range.start),
});
// The grip that an event drags, or null; a drag begins with the nearest of the grips [{away}], in pixels, within reach.
export const held_by = (figure, event, grips, reach = GRIP_PX) => {
  if (event.event_name === "panstart") {
    figure[HELD] = grips().reduce((best, grip) => grip.away < (best?.away ?? reach) ? grip : best, null);
  }
  const held = figure[HELD] ?? null;
  if (event.event_name === "panend") { figure[HELD] = null; }
  return held;
};

// Grips of steps: the level, and ends where they can be moved; one that neighbours share spans both of their levels.
export const step_grips = ({left, right, limit, movable}, {x, y}, scale, shared) => limit.flatMap((level, k) => {
  const [low, high] = [Math.min, Math.max].map((end) => end(level, shared ? limit[k + 1] ?? level : level));
  const off = Math.max(low - y, y - high, 0) * scale.y;
  const ends = movable[k] ? [...(shared ? [] : [["left", left[k]]]), ["right", right[k]]] : [];
  const grips = ends.map(([part, place]) => ({part, k, away: Math.hypot((x - place) * scale.x, off)}));
  const is_beside = x >= left[k] && x <= right[k], away = Math.abs(y - level) * scale.y / END_FIRST;
  return is_beside ? [...grips, {part: "limit", k, away}] : grips;
});
// Move the held part of a step in place: levels in multiples of 1 / per, ends in whole metres.
export const move_step = ({left, right, limit, middle, text}, {part, k}, {x, y}, bounds) => {
  const {least, most, per, shortest, end, shared} = bounds, place = Math.round(x);
  if (part === "limit") { text[k] = String(limit[k] = clipped(Math.round(per * y) / per, least, most)); }
  if (part === "left") { left[k] = clipped(place, 0, right[k] - shortest); }
  if (part === "right") { right[k] = clipped(place, left[k] + shortest, shared ? right[k + 1] - shortest : end); }
  if (part === "right" && shared) { left[k + 1] = right[k]; }
  left.forEach((start, j) => { middle[j] = (start + right[j]) / 2; });
};
// `moved` is sent with each move where the server is to answer, else once the step is let go.
export const drag_steps = ({f, steps, moved, live, ...bounds}, event) => {
  const {left, right, limit} = steps.data, ends = event.event_name === "panend";
  const held = held_by(f, event, () => step_grips(steps.data, event, scales(f), bounds.shared));
  if (!held) { return; }
  if (!ends) { move_step(steps.data, held, event, bounds); steps.change.emit(); }
  if (ends !== live) { moved.data = {left: [...left], right: [...right], limit: [...limit]}; }
};

// The time of point k, in tenths, and its height, when it is dragged to a height; it rests at another one.
export const moved_time = ({rest, time, low, high}, k, height) => {
  const to = Math.round(10 * (time[k] + clipped(height, low[k], high[k]) - rest[k])) / 10;
  return {to, y: rest[k] + to - time[k]};
};
export const drag_points = ({f, points, sign, moved}, event) => {
  const {x, y, name} = points.data, scale = scales(f);
  const away = (k) => Math.hypot((event.x - x[k]) * scale.x, (event.y - y[k]) * scale.y);
  const held = held_by(f, event, () => [...x.keys()].map((k) => ({k, away: away(k)})));
  if (!held) { return; }
  if (event.event_name === "panend") { sign.data = {x: [], y: [], text: []}; return; }
  const {k} = held, {to, y: height} = moved_time(points.data, k, Math.min(event.y, f.y_range.end));
  y[k] = height;
  points.change.emit();
  sign.data = {x: [x[k]], y: [height], text: [`${name[k]}: ${written(to, 1)} s`]};
  if (moved.data.number[0] !== k || moved.data.time[0] !== to) { moved.data = {number: [k], time: [to]}; }
};
