// The lesson that is drawn: a speed over the distance, snapped to what the train can do, then the best run in its time.

import {life_of, make} from "./dom.js";
import {BRAKE, COAST, POWER, between_points, drive_drawn, force_between, net_energy} from "./driving.js";
import {
  KMH_PER_MS, clock_of, dials, energy_bars, figures_of, frame_meter, kwh_of, listen_to, pressing, verdict_of,
} from "./played.js";
import {figure_on} from "./speed_figure.js";

// of the greatest effort: a train that needs less coasts, as everybody would say
const COASTING_SHARE = 0.01;
const TURNS = {ArrowUp: 1, ArrowDown: -1, PageUp: 5, PageDown: -5}, WALKS = {ArrowRight: 1, ArrowLeft: -1};

export function render({model}) {
  const signal = life_of(model), root = make("section", {class: "played draw-speed", "aria-label": "Draw the speed"});
  const canvas = make("canvas", {
    role: "slider", tabindex: "0", "aria-label": "Drawn speed over distance", "aria-orientation": "vertical",
  });
  const told = make("p", {role: "status"}), {element: clocks, one: clock, other: used} = dials("Time", "Energy"), note = frame_meter(root);
  const {bars, show: show_bars} = energy_bars(), button = pressing(signal);
  let mesh = null, figure = null, points = [], chosen = 0, run = null, verdict = null, asked = false, due = false, held = null;

  const place_of = (k) => (mesh.position.at(-1) * k) / (points.length - 1);
  const kinds = () => {
    const {speed2} = run, least = COASTING_SHARE * mesh.traction.constant;
    return mesh.length.map((_, i) => {
      const force = force_between(mesh, i, speed2[i], speed2[i + 1]);
      return force > least ? POWER : force < -least ? BRAKE : COAST;
    });
  };
  const picture = () => {
    const begun = performance.now(), drawn = between_points(mesh, points).map((kmh) => kmh / KMH_PER_MS);
    run = drive_drawn(mesh, drawn);
    const sum = run.sums.at(-1), spare = model.given.target_s - sum.time, speed = points[chosen];
    figure.draw({
      speeds: run.speed2.map(Math.sqrt), commands: kinds(), at: place_of(chosen), speed: speed / KMH_PER_MS, verdict, drawn,
    });
    clock.value.textContent = clock_of(sum.time);
    clock.note.textContent = `${figures_of(Math.abs(spare), 1)} s ${spare < 0 ? "late" : "to spare"}`;
    clock.note.classList.toggle("late", spare < 0);
    used.value.textContent = `${kwh_of(net_energy(sum))} kWh`;
    show_bars(sum);
    canvas.setAttribute("aria-valuenow", String(speed));
    canvas.setAttribute("aria-valuetext", `${speed} km/h at ${Math.round(place_of(chosen))} m`);
    reveal.disabled = asked || Boolean(verdict);
    note(begun);
  };
  // once a frame, however often a pointer moves in it
  const soon = () => {
    if (due) { return; }
    due = true;
    requestAnimationFrame(() => { due = false; picture(); });
  };
  const changed = () => {
    verdict = null;
    result.hide();
    told.textContent = "";
    soon();
  };
  const set = (k, kmh) => {
    const [least, most] = model.given.ends_kmh;
    points[k] = Math.round(Math.min(Math.max(kmh, least), most));
  };
  const draw_to = (event) => {
    const {at, speed} = figure.place_of(event), last = points.length - 1;
    const k = Math.min(Math.max(Math.round((last * at) / mesh.position.at(-1)), 0), last), kmh = speed * KMH_PER_MS;
    // what a quick hand leaves out lies on a line
    const from = held ?? {k, kmh}, steps = Math.max(Math.abs(k - from.k), 1);
    for (let step = 0; step <= steps; step++) {
      const share = step / steps;
      set(Math.round(from.k + share * (k - from.k)), from.kmh + share * (kmh - from.kmh));
    }
    held = {k, kmh};
    chosen = k;
    changed();
  };
  canvas.addEventListener("pointerdown", (event) => {
    if (!mesh || asked) { return; }
    canvas.setPointerCapture(event.pointerId);
    held = null;
    draw_to(event);
  }, {signal});
  canvas.addEventListener("pointermove", (event) => {
    if (!asked && mesh && canvas.hasPointerCapture(event.pointerId)) { draw_to(event); }
  }, {signal});
  canvas.addEventListener("keydown", (event) => {
    const turn = TURNS[event.key], walk = WALKS[event.key], ends = {Home: 0, End: points.length - 1}[event.key];
    if (!mesh || asked || event.ctrlKey || event.metaKey || event.altKey || (turn ?? walk ?? ends) === undefined) { return; }
    event.preventDefault();
    if (turn !== undefined) {
      set(chosen, points[chosen] + turn);
      changed();
      return;
    }
    const before = chosen;
    chosen = ends ?? Math.min(Math.max(chosen + walk, 0), points.length - 1);
    if (event.shiftKey) {
      for (let k = Math.min(before, chosen); k <= Math.max(before, chosen); k++) { points[k] = points[before]; }
      changed();
    } else { soon(); }
  }, {signal});

  const text = () => points.join(",");
  const reveal = button("Show the best run", () => {
    asked = true;
    reveal.disabled = true;
    told.textContent = "The best run is being computed.";
    model.send_msg({what: "done", text: text()});
  }, "main");
  const clear = button("Clear the drawing", () => {
    points = points.map(() => model.given.ends_kmh[1]);
    chosen = 0;
    changed();
    canvas.focus();
  });
  const result = verdict_of(model, signal, {change: () => { changed(); canvas.focus(); }}, text);
  const judge = () => {
    asked = false;
    ({verdict} = model);
    told.textContent = "";
    result.show();
    picture();
  };

  root.append(make("h2", {}, model.title), make("p", {}, model.text), told, result.head,
    make("div", {class: "stage"}, canvas, make("div", {}, clocks, make("h3", {}, "Where it goes, kWh"), bars)),
    make("div", {class: "row"}, reveal, clear), result.details);
  told.textContent = "Opening";
  reveal.disabled = true;
  const prepare = () => {
    if (mesh || !model.given.mesh) { return; }
    ({mesh} = model.given);
    points = [...model.given.points];
    canvas.setAttribute("aria-valuemin", String(model.given.ends_kmh[0]));
    canvas.setAttribute("aria-valuemax", String(model.given.ends_kmh[1]));
    figure = figure_on(canvas, mesh, signal, picture);
    told.textContent = "Press on the figure and draw.";
    picture();
  };
  listen_to(model, {prepare, judge, refuse: () => { asked = false; told.textContent = ""; picture(); }, asked: () => asked});
  return root;
}
