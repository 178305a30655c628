// Surfaces over two axes, drawn on a canvas and turned by the mouse, a finger or the arrow keys.
(() => {
  "use strict";
  const VIEW = {yaw: -0.72, pitch: 0.5}, TURN = 0.008, STEP = 0.12, FLAT = 0.05, STEEP = 1.5;
  const system = window.matchMedia("(prefers-color-scheme: dark)");
  const paper = window.matchMedia("print");
  // as report.css sizes it on paper, where a page that is being printed has no widths of its own yet
  const PAPER = {width: 620, height: 380, ratio: 2};
  const BEFORE_FACES = 0.02; // so much nearer to the eye, lines and dots stand before the faces on which they lie
  const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--rj-${name}`).trim();

  const start = (canvas, surface) => {
    const {x, y, z} = surface;
    const finite = z.flat().filter((value) => value !== null);
    const low = Math.min(...finite), high = Math.max(...finite), height = Math.max(high - low, 1e-12);
    const along = (values, value) => (value - values[0]) / (values[values.length - 1] - values[0]) - 0.5;
    const share = (values) => values.map((value) => along(values, value));
    const u = share(x), v = share(y);
    const lift = (value) => 0.62 * ((value - low) / height - 0.5);
    const on = ([a, b, c]) => [along(x, a), along(y, b), lift(c)];
    const ridge = surface.line.map(on), dots = surface.points.map(on);
    const view = {...VIEW};
    let waiting = false, prints = false;

    const shade = (value, scale) => {
      const place = ((value - low) / height) * (scale.length - 1), k = Math.min(Math.floor(place), scale.length - 2);
      const part = (text) => [1, 3, 5].map((from) => parseInt(text.slice(from, from + 2), 16));
      const [from, to] = [part(scale[Math.max(k, 0)]), part(scale[Math.max(k, 0) + 1])];
      return `rgb(${from.map((one, c) => Math.round(one + (place - k) * (to[c] - one))).join(",")})`;
    };

    const draw = () => {
      waiting = false;
      const width = prints ? PAPER.width : canvas.clientWidth, tall = prints ? PAPER.height : canvas.clientHeight;
      const ratio = prints ? PAPER.ratio : window.devicePixelRatio || 1;
      if (!width) return;
      canvas.width = width * ratio;
      canvas.height = tall * ratio;
      const ink = canvas.getContext("2d");
      ink.scale(ratio, ratio);
      const [sy, cy, sp, cp] = [Math.sin(view.yaw), Math.cos(view.yaw), Math.sin(view.pitch), Math.cos(view.pitch)];
      const size = Math.min(width / 2.3, tall / 1.4);
      const project = (a, b, c) => {
        const right = a * cy - b * sy, away = a * sy + b * cy;
        return [width / 2 + size * right, 0.47 * tall - size * (c * cp + away * sp), away * cp - c * sp];
      };
      const line = (points, style, thick = 1) => {
        ink.strokeStyle = style;
        ink.lineWidth = thick;
        ink.beginPath();
        points.forEach(([px, py], k) => (k ? ink.lineTo(px, py) : ink.moveTo(px, py)));
        ink.stroke();
      };
      const floor = -0.31, grid = colour("line2"), words = colour("ink3");
      line([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5], [-0.5, -0.5]].map(([a, b]) => project(a, b, floor)), grid);
      // the axes stand on the edges of the floor that lie in front, the heights on its leftmost corner
      const front = (one, other) => (project(...one, floor)[2] < project(...other, floor)[2] ? one : other);
      const bx = front([0, -0.5], [0, 0.5])[1], ay = front([-0.5, 0], [0.5, 0])[0];
      const corners = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
      const corner = corners.reduce((one, two) => (project(...two, 0)[0] < project(...one, 0)[0] ? two : one));
      ink.font = "11px Inter, sans-serif";
      ink.fillStyle = words;
      const sign = (text, [px, py], away) => {
        const [dx, dy] = [px - width / 2, py - project(0, 0, floor)[1]], far = Math.hypot(dx, dy) || 1;
        ink.textAlign = dx < -0.15 * far ? "right" : dx > 0.15 * far ? "left" : "center";
        ink.textBaseline = "middle";
        ink.fillText(text, px + (away * dx) / far, py + (away * dy) / far);
      };
      surface.ticks.x.forEach(([at, text]) => sign(text, project(at - 0.5, bx, floor), 12));
      surface.ticks.y.forEach(([at, text]) => sign(text, project(ay, at - 0.5, floor), 12));
      surface.ticks.z.forEach(([at, text]) => {
        const [px, py] = project(...corner, 0.62 * (at - 0.5));
        ink.textAlign = "right";
        ink.textBaseline = "middle";
        ink.fillText(text, px - 8, py);
      });
      line([project(...corner, -0.31), project(...corner, 0.31)], grid);
      ink.fillStyle = colour("ink2");
      // below the signs of the axis, on its outer side
      [project(0, bx, floor), project(ay, 0, floor)].forEach(([px, py], k) => {
        const side = px < width / 2 ? -1 : 1;
        ink.textAlign = side < 0 ? "right" : "left";
        ink.fillText(surface.titles[k], px + 14 * side, py + 34);
      });
      const faces = [];
      for (let r = 0; r + 1 < y.length; r++) {
        for (let c = 0; c + 1 < x.length; c++) {
          const at = [[r, c], [r, c + 1], [r + 1, c + 1], [r + 1, c]];
          const values = at.map(([i, j]) => z[i][j]);
          if (values.includes(null)) continue;
          const points = at.map(([i, j], k) => project(u[j], v[i], lift(values[k])));
          faces.push({
            points,
            depth: points.reduce((sum, point) => sum + point[2], 0) / points.length,
            value: values.reduce((sum, value) => sum + value, 0) / 4,
          });
        }
      }
      const fine = faces.length > 400;
      ridge.slice(1).forEach((end, k) => {
        const points = [ridge[k], end].map((one) => project(...one));
        faces.push({points, thick: 3, depth: (points[0][2] + points[1][2]) / 2 - BEFORE_FACES});
      });
      for (const dot of dots) {
        const points = [project(...dot)];
        faces.push({points, depth: points[0][2] - 2 * BEFORE_FACES});
      }
      faces.sort((one, two) => two.depth - one.depth);
      const dark = system.matches && !paper.matches && !prints;
      const scale = dark ? surface.scale.dark : surface.scale.light;
      for (const {points, value, thick} of faces) {
        if (thick) {
          line(points, "#FFFFFF", thick);
          continue;
        }
        if (points.length === 1) {
          ink.beginPath();
          ink.arc(...points[0].slice(0, 2), 5, 0, 2 * Math.PI);
          ink.fillStyle = colour("accent");
          ink.fill();
          ink.strokeStyle = "#FFFFFF";
          ink.lineWidth = 2;
          ink.stroke();
          continue;
        }
        ink.fillStyle = shade(value, scale);
        ink.strokeStyle = fine ? ink.fillStyle : colour("surface");
        ink.lineWidth = fine ? 0.7 : 0.5;
        ink.beginPath();
        points.forEach(([px, py], k) => (k ? ink.lineTo(px, py) : ink.moveTo(px, py)));
        ink.closePath();
        ink.fill();
        ink.stroke();
      }
    };

    const redraw = () => {
      if (waiting) return;
      waiting = true;
      requestAnimationFrame(draw);
    };
    const turn = (yaw, pitch) => {
      view.yaw += yaw;
      view.pitch = Math.min(Math.max(view.pitch + pitch, FLAT), STEEP);
      redraw();
    };
    let held = null;
    canvas.addEventListener("pointerdown", (event) => {
      held = [event.clientX, event.clientY];
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (!held) return;
      turn(-TURN * (event.clientX - held[0]), TURN * (event.clientY - held[1]));
      held = [event.clientX, event.clientY];
    });
    for (const end of ["pointerup", "pointercancel"]) { canvas.addEventListener(end, () => { held = null; }); }
    canvas.addEventListener("dblclick", () => { Object.assign(view, VIEW); redraw(); });
    canvas.addEventListener("keydown", (event) => {
      const moves = {ArrowLeft: [STEP, 0], ArrowRight: [-STEP, 0], ArrowUp: [0, STEP], ArrowDown: [0, -STEP]};
      if (!(event.key in moves)) return;
      event.preventDefault();
      turn(...moves[event.key]);
    });
    new ResizeObserver(redraw).observe(canvas);
    system.addEventListener("change", redraw);
    // paper does not wait for a frame
    window.addEventListener("beforeprint", () => { prints = true; draw(); });
    window.addEventListener("afterprint", () => { prints = false; redraw(); });
    draw();
  };

  for (const [name, surface] of Object.entries(JSON.parse(document.getElementById("surfaces").textContent))) {
    const canvas = document.querySelector(`canvas[data-surface="${name}"]`);
    if (canvas) start(canvas, surface);
  }
})();
