// The track's speed limits, dragged up and down, and those that are no section's by their ends too.

import {clipped, held_by, scales} from "./drag.js";

const REACH_PX = 16;
const END_FIRST = 0.9; // where a limit is about as near as one of its ends, the end counts

export const limit_grips = ({left, right, limit, movable}, event, scale) => limit.flatMap((value, k) => {
  const away_y = Math.abs(event.y - value) * scale.y;
  const end = (part, x) => ({part, k, away: Math.hypot((event.x - x) * scale.x, away_y)});
  const ends = movable[k] ? [end("left", left[k]), end("right", right[k])] : [];
  const is_beside = event.x >= left[k] && event.x <= right[k];
  return [...ends, ...(is_beside ? [{part: "limit", k, away: away_y / END_FIRST}] : [])];
});

export const drag_limits = ({f, steps, dropped, shortest, least, most, end}, event) => {
  const {left, right, limit, middle, text} = steps.data;
  const held = held_by(f, event, () => limit_grips(steps.data, event, scales(f)), REACH_PX);
  if (!held) { return; }
  if (event.event_name === "panend") {
    dropped.data = {left: [...left], right: [...right], limit: [...limit]};
    return;
  }
  const {part, k} = held;
  if (part === "limit") {
    limit[k] = clipped(Math.round(event.y), least, most);
    text[k] = String(limit[k]);
  } else if (part === "left") {
    left[k] = Math.min(Math.max(Math.round(event.x), 0), right[k] - shortest);
  } else {
    right[k] = Math.max(Math.min(Math.round(event.x), end), left[k] + shortest);
  }
  middle[k] = 0.5 * (left[k] + right[k]);
  steps.change.emit();
};
