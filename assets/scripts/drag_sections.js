// The set speeds of sections, dragged up and down, and the borders between them, dragged along the track.

import {clipped, held_by, scales} from "./drag.js";

const REACH_PX = 16;
const STEPS_A_KMH = 2; // set speeds are multiples of 0.5 km/h

export const section_grips = ({left, right, limit}, event, scale) => limit.flatMap((value, k) => {
  const grips = [];
  if (event.x >= left[k] && event.x <= right[k]) {
    grips.push({kind: "limit", k, away: Math.abs(event.y - value) * scale.y});
  }
  if (k + 1 < limit.length) {
    const room = REACH_PX / scale.y, [low, high] = [Math.min, Math.max].map((end) => end(value, limit[k + 1]));
    if (event.y > low - room && event.y < high + room) {
      grips.push({kind: "border", k, away: Math.abs(event.x - right[k]) * scale.x});
    }
  }
  return grips;
});

// The sections with the held step moved: all columns of the three sources that draw them.
export const moved_sections = (before, {kind, k}, to, {least, shortest}) => {
  const [left, right, limit] = [[...before.left], [...before.right], [...before.limit]];
  if (kind === "limit") {
    limit[k] = clipped(Math.round(STEPS_A_KMH * to.y) / STEPS_A_KMH, least, before.most[k]);
  } else {
    right[k] = left[k + 1] = clipped(Math.round(to.x), left[k] + shortest, right[k + 1] - shortest);
  }
  const text = limit.map((value) => value.toFixed(1).replace(".0", ""));
  const x = right.slice(0, -1), middle = left.map((place, j) => (place + right[j]) / 2);
  return {
    borders: {x, low: limit.slice(0, -1), high: limit.slice(1)},
    handles: {x, y: x.map((_, j) => (limit[j] + limit[j + 1]) / 2)},
    sections: {left, right, limit, middle, text, most: [...before.most]},
  };
};

export const drag_sections = ({f, sections, borders, handles, least, shortest}, event) => {
  const held = held_by(f, event, () => section_grips(sections.data, event, scales(f)), REACH_PX);
  if (!held || event.event_name === "panend") { return; }
  const moved = moved_sections(sections.data, held, event, {least, shortest});
  borders.data = moved.borders;
  handles.data = moved.handles;
  sections.data = moved.sections;
};
