// A speed over the distance, drawn by hand: each point below the pointer, and those that a quick hand leaves out.

// where the hand was before, on the figure: a callback is compiled again when its arguments change
const BEFORE = Symbol.for("railjoule.before");

export const draw_line = ({f, drawn, dropped, least, most}, event) => {
  const {x, y} = drawn.data, last = x.length - 1;
  const clipped = (value, low, high) => Math.round(Math.min(Math.max(value, low), high));
  const now = {k: clipped(last * event.x / x[last], 0, last), kmh: event.y};
  const before = (event.event_name === "pan" || event.event_name === "panend") && f[BEFORE] || now;
  const steps = Math.max(Math.abs(now.k - before.k), 1);
  for (let step = 0; step <= steps; step++) {
    const share = step / steps, k = Math.round(before.k + share * (now.k - before.k));
    y[k] = clipped(before.kmh + share * (now.kmh - before.kmh), least, most);
  }
  f[BEFORE] = now;
  drawn.change.emit();
  if (event.event_name === "panend" || event.event_name === "tap") { dropped.data = {y: [...y]}; }
};
