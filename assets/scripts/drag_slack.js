// The stations in a chart of time supplements, dragged up and down: an arrival that is a second later gives the leg
// before the station a second and takes it from the leg after it.

import {clipped, held_by, scales} from "./drag.js";
import {written} from "./numbers.js";

const REACH_PX = 18;
const STEPS_A_S = 10; // arrivals are tenths of a second, as the fields show them

// The arrival at station k, and where its mark lies, when it is dragged to a height; it rests at another one.
export const moved_arrival = ({rest, arrival, low, high}, k, height) => {
  const to = arrival[k] + clipped(height, low[k], high[k]) - rest[k];
  const arrives = Math.round(STEPS_A_S * to) / STEPS_A_S;
  return {arrives, y: rest[k] + arrives - arrival[k]};
};

export const drag_slack = ({f, grips, sign, moved}, event) => {
  const {x, y, name} = grips.data, scale = scales(f);
  const all = () => Array.from({length: x.length}, (_, k) => k)
    .map((k) => ({k, away: Math.hypot((event.x - x[k]) * scale.x, (event.y - y[k]) * scale.y)}));
  const held = held_by(f, event, all, REACH_PX);
  if (!held) { return; }
  const {k} = held;
  if (event.event_name === "panend") {
    sign.data = {x: [], y: [], text: []};
    return;
  }
  const to = moved_arrival(grips.data, k, Math.min(event.y, f.y_range.end));
  y[k] = to.y;
  grips.change.emit();
  sign.data = {x: [x[k]], y: [to.y], text: [`${name[k]}: ${written(to.arrives, 1)} s`]};
  if (moved.data.number[0] !== k || moved.data.arrival[0] !== to.arrives) {
    moved.data = {number: [k], arrival: [to.arrives]};
  }
};
