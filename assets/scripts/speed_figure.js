// The figure of the lessons that are played: speed over distance on a canvas, drawn again in each frame.

import {KMH_PER_MS, figures_of, with_sign} from "./played.js";

const INKS = ["surface", "ink", "ink2", "ink3", "line", "line2", "ground", "limit", "accent", "brake", "coast", "full_power", "overline", "over"];
// as far as two lines of words reach
const NEAR_LIMIT_MS = 4;
const COMMANDS = ["power", "coast", "brake"], COMMAND_PX = 62;

// Speed over distance with limit and commands, the height of the track, and later the optimum with the difference.
// `again` draws it when its size or its colours have changed.
export const figure_on = (canvas, mesh, signal, again) => {
  const {position, limit, gradient, length} = mesh, end = position.at(-1);
  const heights = [0];
  // per newton of weight: only the shape is drawn
  gradient.forEach((force, i) => heights.push(heights[i] + force * length[i]));
  const [low, high] = [Math.min(...heights), Math.max(...heights)];
  const top = 1.15 * Math.max(...limit);
  let ink = {};
  const recolour = () => {
    const style = getComputedStyle(canvas);
    ink = Object.fromEntries(INKS.map((name) => [name, style.getPropertyValue(`--rj-${name.replace("_", "-")}`).trim()]));
  };
  const LEFT = 34, edges = () => ({right: canvas.clientWidth - 8, bottom: 0.6 * canvas.clientHeight});
  // `at` and `speed` are the place of the mark, as those of a `ghost` are of another
  const draw = ({speeds, commands, at, speed, verdict, ghost = null}) => {
    const ratio = window.devicePixelRatio || 1, wide = canvas.clientWidth, tall = canvas.clientHeight;
    if (!wide) { return; }
    if (canvas.width !== Math.round(wide * ratio)) { canvas.width = Math.round(wide * ratio); }
    if (canvas.height !== Math.round(tall * ratio)) { canvas.height = Math.round(tall * ratio); }
    const pen = canvas.getContext("2d");
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, wide, tall);
    const left = LEFT, {right, bottom} = edges(), strip = bottom + 8, track = bottom + 52, floor = tall - 22;
    const x_of = (place) => left + ((right - left) * place) / end;
    const y_of = (ms) => bottom - ((bottom - 20) * ms) / top;
    const text = (words, x, y, colour, align = "left") => {
      pen.fillStyle = colour;
      pen.textAlign = align;
      pen.fillText(words, x, y);
    };
    const line = (xs, ys, colour, thick) => {
      pen.strokeStyle = colour;
      pen.lineWidth = thick;
      pen.beginPath();
      for (let i = 0; i < ys.length; i++) { pen.lineTo(xs(i), ys[i]); }
      pen.stroke();
    };
    // between a line over the nodes and a level
    const area = (xs, ys, level, colour, alpha = 1) => {
      pen.fillStyle = colour;
      pen.globalAlpha = alpha;
      pen.beginPath();
      pen.moveTo(xs(0), level);
      ys.forEach((y, i) => pen.lineTo(xs(i), y));
      pen.lineTo(xs(ys.length - 1), level);
      pen.fill();
      pen.globalAlpha = 1;
    };
    const dot = (x, y, radius, colour) => {
      pen.fillStyle = colour;
      pen.beginPath();
      pen.arc(x, y, radius, 0, 7);
      pen.fill();
    };
    const node_x = (i) => x_of(position[i]);
    pen.font = "11px Inter, sans-serif";
    text("Speed, km/h", left, 11, ink.ink2);
    for (let kmh = 0; kmh < top * KMH_PER_MS; kmh += 20) {
      const y = y_of(kmh / KMH_PER_MS);
      line((i) => [left, right][i], [y, y], ink.line, 1);
      text(String(kmh), left - 6, y + 4, ink.ink3, "right");
    }
    // what lies above the limit, and its edge
    const edge_x = (i) => node_x((i + 1) >> 1), edge = limit.flatMap((ms) => [y_of(ms), y_of(ms)]);
    area(edge_x, edge, 16, ink.ground, 0.5);
    line(edge_x, edge, ink.limit, 1.2);
    let before = null;
    limit.forEach((ms, i) => {
      if (ms !== before) { text(`limit ${Math.round(ms * KMH_PER_MS)}`, x_of(position[i]) + 4, y_of(ms) - 4, ink.limit); }
      before = ms;
    });
    // commands so far, and what their colours mean
    const fills = [ink.full_power, ink.coast, ink.brake];
    COMMANDS.forEach((word, k) => {
      const x = right - COMMAND_PX * (COMMANDS.length - k);
      pen.fillStyle = fills[k];
      pen.fillRect(x, 3, 10, 10);
      pen.strokeStyle = ink.line2;
      pen.strokeRect(x, 3, 10, 10);
      text(word, x + 15, 11, ink.ink2);
    });
    pen.fillStyle = ink.line;
    pen.fillRect(left, strip + 8, right - left, 2);
    for (let i = 0, from = 0; i < commands.length; i++) {
      // as one, since borders within would be seen
      if (commands[i + 1] === commands[i]) { continue; }
      pen.fillStyle = fills[commands[i]];
      pen.fillRect(x_of(position[from]), strip, x_of(position[i + 1]) - x_of(position[from]) + 0.5, 18);
      from = i + 1;
    }
    // the track, and over it what the run costs beyond the best
    const level = (joule) => floor - ((floor - track - 14) * (joule - low)) / Math.max(high - low, 1);
    area(node_x, heights.map(level), floor, ink.ground);
    if (verdict) {
      const above = verdict.above_kwh, most = Math.max(...above, 0.01), least = Math.min(...above, 0);
      const rise = (kwh) => floor - ((floor - track - 6) * (kwh - least)) / (most - least);
      text("Energy above the best, kWh; grey: track", left, track - 4, ink.ink2);
      area(node_x, above.map(rise), rise(0), ink.over, 0.75);
      line(node_x, above.map(rise), ink.overline, 1.4);
      text(with_sign(above.at(-1), 2), right, track - 4, ink.overline, "right");
      line(node_x, verdict.best_ms.map(y_of), ink.accent, 2.6);
    } else {
      text("Track, height", left, track - 4, ink.ink2);
      const train = (place, colour) => {
        const node = position.findIndex((one) => one >= place);
        pen.fillStyle = colour;
        pen.fillRect(Math.max(x_of(place) - 26, left), level(heights.at(node)) - 8, 26, 7);
      };
      if (ghost) {
        train(ghost.at, ink.accent);
        dot(x_of(ghost.at), y_of(ghost.speed), 4, ink.accent);
      }
      train(at, ink.ink);
    }
    line(node_x, speeds.map(y_of), ink.ink, 1.8);
    if (verdict?.parting) {
      const x = x_of(verdict.parting.position);
      pen.setLineDash([2, 3]);
      line((i) => [x, x][i], [20, floor], ink.accent, 1);
      pen.setLineDash([]);
      dot(x, y_of(verdict.best_ms[verdict.parting.node]), 5, ink.accent);
    } else if (!verdict) {
      line((i) => [x_of(at), x_of(at)][i], [20, floor], ink.line2, 1);
      dot(x_of(at), y_of(speed), 5, ink.ink);
      const turned = x_of(at) > right - 70;
      // below the mark where the limit has its name
      const cell = Math.max(position.findIndex((place) => place > at) - 1, 0);
      const y = y_of(speed) + (limit[cell] - speed < NEAR_LIMIT_MS ? 18 : -8);
      text(`${figures_of(speed * KMH_PER_MS, 1)} km/h`, x_of(at) + (turned ? -9 : 9), y, ink.ink, turned ? "right" : "left");
    }
    for (let place = 0; place <= end; place += 500) { text(String(place), x_of(place), tall - 6, ink.ink3, place ? "center" : "left"); }
    text("m", right, tall - 6, ink.ink3, "right");
  };
  const fresh = () => { recolour(); again(); };
  recolour();
  new ResizeObserver(fresh).observe(canvas);
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => requestAnimationFrame(fresh), {signal});
  return {draw, recolour};
};
