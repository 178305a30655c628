// What all figures share in which something is dragged.

// what is held, on the figure: a callback is compiled anew when its arguments change, in the middle of a drag too
const HELD = Symbol.for("railjoule.held");

// Pixels for each unit of both axes.
export const scales = (figure) => ({
  x: figure.inner_width / (figure.x_range.end - figure.x_range.start),
  y: figure.inner_height / (figure.y_range.end - figure.y_range.start),
});

// The nearest of grips [{away}], in pixels, if any is within reach.
export const nearest = (grips, reach) =>
  grips.reduce((best, grip) => grip.away < (best?.away ?? reach) ? grip : best, null);

// What an event drags, or null; a drag begins with the nearest grip.
export const held_by = (figure, event, grips, reach) => {
  if (event.event_name === "panstart") { figure[HELD] = nearest(grips(), reach); }
  const held = figure[HELD] ?? null;
  if (event.event_name === "panend") { figure[HELD] = null; }
  return held;
};

export const clipped = (value, low, high) => Math.min(Math.max(value, low), high);
