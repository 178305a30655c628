// A surface over two axes, drawn on a canvas and turned by the mouse, a finger or the arrow keys.
(() => {
  "use strict";
  const canvas = document.querySelector("canvas[data-surface]");
  if (!canvas) return;
  const {titles, ticks, pieces} = JSON.parse(document.getElementById("surface").textContent);
  const STEP = 0.12, PER_PX = 0.008, TALL = 0.62;
  const start = {yaw: -0.72, pitch: 0.5}, view = {...start};
  // as report.css sizes it on paper, where a page that is being printed has no widths of its own yet
  const PAPER = [620, 380, 2];
  let prints = false, held = null;
  const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--rj-${name}`).trim();

  const draw = () => {
    const [width, height, ratio] = prints ? PAPER : [canvas.clientWidth, canvas.clientHeight, devicePixelRatio];
    if (!width) return;
    const ink = Object.assign(canvas, {width: width * ratio, height: height * ratio}).getContext("2d");
    const size = Math.min(width / 2.3, height / 1.4);
    ink.scale(ratio, ratio);
    Object.assign(ink, {font: "11px Inter, sans-serif", textBaseline: "middle", lineCap: "round", lineJoin: "round"});
    const [sy, cy, sp, cp] = [Math.sin(view.yaw), Math.cos(view.yaw), Math.sin(view.pitch), Math.cos(view.pitch)];
    // from shares of the axes to pixels, and how far away
    const project = ([a, b, c]) => {
      const across = (a - 0.5) * cy - (b - 0.5) * sy, away = (a - 0.5) * sy + (b - 0.5) * cy, up = TALL * (c - 0.5);
      return [width / 2 + size * across, 0.47 * height - size * (up * cp + away * sp), away * cp - up * sp];
    };
    const path = (points, stroke, thick, fill) => {
      ink.beginPath();
      points.forEach(([px, py], k) => (k ? ink.lineTo(px, py) : ink.moveTo(px, py)));
      Object.assign(ink, {strokeStyle: stroke, lineWidth: thick});
      if (fill) { ink.fillStyle = fill; ink.fill(); }
      ink.stroke();
    };
    const write = (text, [px, py], token, dx, dy = 0) => {
      Object.assign(ink, {fillStyle: colour(token), textAlign: dx < 0 ? "right" : "left"});
      ink.fillText(text, px + dx, py + dy);
    };
    path([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 0]].map(project), colour("line2"), 1);
    // the axes are at the edges of the floor that lie in front, the heights at its leftmost corner
    const [b] = [0, 1].sort((one, two) => project([0.5, one, 0])[2] - project([0.5, two, 0])[2]);
    const [a] = [0, 1].sort((one, two) => project([one, 0.5, 0])[2] - project([two, 0.5, 0])[2]);
    const places = [(share) => [share, b, 0], (share) => [a, share, 0]];
    places.forEach((place, k) => {
      const middle = project(place(0.5)), side = middle[0] < width / 2 ? -1 : 1;
      for (const [share, text] of ticks[k]) { write(text, project(place(share)), "ink3", 7 * side, 9); }
      write(titles[k], middle, "ink2", 14 * side, 34);
    });
    const corners = [[0, 0], [1, 0], [1, 1], [0, 1]].sort((one, two) => project([...one, 0])[0] - project([...two, 0])[0]);
    path([0, 1].map((share) => project([...corners[0], share])), colour("line2"), 1);
    for (const [share, text] of ticks[2]) { write(text, project([...corners[0], share]), "ink3", -8); }
    // from back to front
    const drawn = pieces.map(([points, stroke, thick, fill, nearer]) => {
      const at = points.map(project);
      return [at.reduce((sum, point) => sum + point[2], 0) / at.length - nearer, at, stroke, thick, fill];
    });
    for (const [, ...piece] of drawn.sort(([one], [two]) => two - one)) { path(...piece); }
  };

  const redraw = () => requestAnimationFrame(draw);
  const turn = (yaw, pitch) => {
    view.yaw += yaw;
    view.pitch = Math.min(Math.max(view.pitch + pitch, 0.05), 1.5);
    redraw();
  };
  canvas.onpointerdown = (event) => { held = event; canvas.setPointerCapture(event.pointerId); };
  canvas.onpointermove = (event) => {
    if (held) { turn(-PER_PX * (event.clientX - held.clientX), PER_PX * (event.clientY - held.clientY)); held = event; }
  };
  canvas.onpointerup = canvas.onpointercancel = () => { held = null; };
  canvas.ondblclick = () => turn(start.yaw - view.yaw, start.pitch - view.pitch);
  canvas.onkeydown = (event) => {
    const moves = {ArrowLeft: [STEP, 0], ArrowRight: [-STEP, 0], ArrowUp: [0, STEP], ArrowDown: [0, -STEP]};
    if (event.key in moves) { event.preventDefault(); turn(...moves[event.key]); }
  };
  new ResizeObserver(redraw).observe(canvas);
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
  // paper does not wait for a frame
  window.addEventListener("beforeprint", () => { prints = true; draw(); });
  window.addEventListener("afterprint", () => { prints = false; redraw(); });
})();
