// The lesson that is driven: power, coast and brake against the clock, three tries, then the optimum over one's run.

import {value_at} from "./cursor.js";
import {deep, filled, life_of, put, redraw_on, until} from "./dom.js";
import {BRAKE, COAST, POWER, in_letters, place_at, set_off, stretches} from "./driving.js";
import {written} from "./numbers.js";

// a tab out of sight gets no frames: its clock stands still in that time
const LONGEST_FRAME_S = 0.1, LAID_OUT_WITHIN_MS = 10_000, J_PER_KWH = 3.6e6, KMH_PER_MS = 3.6;
const KEYS = {ArrowUp: POWER, ArrowRight: COAST, " ": COAST, ArrowDown: BRAKE};
// the share of the way from which on the words at the train stand left of it
const TURNS = 0.85;

const kwh_of = (joules) => written(joules / J_PER_KWH, 2);
const clock_of = (seconds) => {
  const tenths = Math.round(10 * seconds), rest = tenths % 600;
  return `${Math.floor(tenths / 600)}:${String(Math.floor(rest / 10)).padStart(2, "0")}.${rest % 10}`;
};

export function render({model}) {
  const signal = life_of(model), root = filled("section", "played drive-it", model.html);
  const one = (selector) => root.querySelector(selector), all = (selector) => [...root.querySelectorAll(selector)];
  const commands = all("[data-command]"), rates = all("[data-rate]"), result = one(".result");
  const [clock, used] = all(".clocks > div").map((dial) => ({value: dial.children[0], note: dial.children[1]}));
  let phase = "opening", trip = null, command = COAST, rate = 4, tape = null, ghost = null, tried = 0, last = 0, drawn = -1;

  const on_the_way = () => ["driving", "watching"].includes(phase);
  const words = {
    ready: () => `Try ${tried + 1} of ${model.given.tries}: press Power to depart.` +
      (ghost ? " The blue train is the run to race." : ""),
    driving: () => `Try ${tried + 1} of ${model.given.tries}: on the way`,
    watching: () => "Your run again",
    asked: () => "Arrived: the best possible run is being computed.",
    judged: () => `Arrived: try ${tried} of ${model.given.tries}.`,
  };
  // wherever the button was that began it, the figure is what is looked at
  const come = () => one(".head").scrollIntoView({block: "start"});

  const fill = (name, x = [], y = [], more = {}) => put(model.sources[name], {x, y, ...more});
  const kmh = (speeds) => speeds.map((ms) => ms * KMH_PER_MS);
  // what is the same until the train is in the next cell
  const draw_so_far = (cell) => {
    const {position} = model.given.mesh, {speeds, commands: given} = trip.run;
    fill("run", position.slice(0, cell + 1), kmh(speeds.slice(0, cell + 1)));
    for (const [which, name] of ["full_power", "coast", "brake"].entries()) {
      const found = stretches(given.slice(0, cell + 1)).filter((stretch) => stretch.command === which);
      const [left, right] = ["from", "to"].map((end) => found.map((stretch) => position[stretch[end]]));
      put(model.sources[name], {left, right});
    }
  };
  const draw_verdict = ({best_ms, parting}) => {
    fill("best", ...(best_ms ? [model.given.mesh.position, kmh(best_ms)] : []));
    fill("parting", ...(parting ? [[parting.position], kmh([best_ms[parting.node]])] : []));
  };
  const draw_trains = ({at, speed, sum}) => {
    const {mesh, heights} = model.given, turned = at > TURNS * mesh.position.at(-1), is_judged = phase === "judged";
    const height = (place) => value_at({x: mesh.position, y: heights}, place);
    const racing = ghost && !is_judged && place_at(mesh, ghost, sum.time);
    fill("train", [at], kmh([speed]), {
      text: [is_judged ? "" : `${written(speed * KMH_PER_MS, 1)} km/h`],
      align: [turned ? "right" : "left"], offset: [turned ? -9 : 9],
    });
    fill("on_track", [at], [height(at)]);
    fill("ghost", ...(racing ? [[racing.at], kmh([racing.speed])] : []));
    fill("ghost_on_track", ...(racing ? [[racing.at], [height(racing.at)]] : []));
  };
  const show = () => {
    root.dataset.phase = phase;
    commands.forEach((button, k) => {
      button.disabled = !trip;
      button.setAttribute("aria-pressed", on_the_way() && k === command);
    });
    for (const button of rates) { button.setAttribute("aria-pressed", Number(button.dataset.rate) === rate); }
    if (!trip) { return; }
    const now = trip.now(), {sum} = now, {timetable_s, mesh} = model.given;
    const to_go = mesh.position.at(-1) - now.at, left = timetable_s - sum.time;
    if (now.cell !== drawn) { draw_so_far(now.cell); }
    drawn = now.cell;
    draw_trains(now);
    clock.value.textContent = clock_of(sum.time);
    clock.note.textContent = trip.has_arrived() ? `timetable ${clock_of(timetable_s)}` : `${Math.round(to_go)} m to go` +
      (left > 0 ? `, ${Math.round((to_go / left) * KMH_PER_MS)} km/h on average needed` : ", late");
    used.value.textContent = `${kwh_of(sum.drawn - sum.returned)} kWh`;
    const widest = Math.max(sum.drawn, Math.abs(sum.height), 1);
    for (const bar of all("[data-part]")) {
      const joules = sum[bar.dataset.part];
      bar.style.width = `${(100 * Math.abs(joules)) / widest}%`;
      bar.classList.toggle("less", joules < -1);
      bar.parentElement.nextElementSibling.textContent = kwh_of(joules);
    }
  };
  const enter = (next) => {
    phase = next;
    drawn = -1;
    draw_verdict(phase === "judged" ? model.verdict : {});
    one("[role=status]").textContent = words[phase]();
    show();
  };

  const frame = (time) => {
    if (!on_the_way() || !root.isConnected) { return; }
    trip.drive(rate * Math.min((time - last) / 1000, LONGEST_FRAME_S), (i) => tape?.[i] ?? command);
    last = time;
    if (tape) { command = trip.run.commands.at(-1); }
    if (!trip.has_arrived()) {
      show();
      requestAnimationFrame(frame);
    } else if (tape) {
      tape = null;
      judge();
    } else {
      enter("asked");
      model.send_msg({what: "done", text: in_letters(trip.run.commands)});
    }
  };
  const depart = (next) => {
    enter(next);
    requestAnimationFrame((time) => { last = time; frame(time); });
  };
  const give = (next) => {
    if (phase === "ready" && next === POWER) { command = next; depart("driving"); }
    if (phase === "driving") { command = next; show(); }
  };
  const begin = () => {
    trip = set_off(model.given.mesh);
    enter("ready");
  };
  const judge = () => {
    const {verdict} = model;
    tried = verdict.tried;
    ghost = {times: verdict.best_s, speeds: verdict.best_ms};
    used.note.textContent = verdict.note;
    result.innerHTML = verdict.head;
    one(".details").innerHTML = verdict.details;
    enter("judged");
    one(".outcome").focus({preventScroll: true});
    come();
  };
  const acts = {
    again: () => {
      if (tried >= model.given.tries) {
        tried = 0;
        ghost = null;
        used.note.textContent = "";
        model.send_msg({what: "reset"});
      }
      begin();
      come();
      commands[0].focus({preventScroll: true});
    },
    watch: () => {
      tape = trip.run.commands;
      trip = set_off(model.given.mesh);
      depart("watching");
      come();
    },
    open: () => model.send_msg({what: "open", text: in_letters(trip.run.commands)}),
  };

  commands.forEach((button, which) => {
    // immediately, not when the finger leaves; a click without a pointer is that of a keyboard or of a screen reader
    button.addEventListener("pointerdown", () => give(which));
    button.addEventListener("click", ({detail}) => { if (detail === 0) { give(which); } });
  });
  root.addEventListener("click", ({target: {dataset}}) => {
    if (dataset.rate) { rate = Number(dataset.rate); show(); }
    acts[dataset.what]?.();
  });
  root.addEventListener("keydown", (event) => {
    const other = event.target.closest("button") && !commands.includes(event.target);
    if (!(event.key in KEYS) || (event.key === " " && other) || event.ctrlKey || event.metaKey || event.altKey) { return; }
    // only what drives: after a try the arrows scroll the page again
    if (phase !== "ready" && !on_the_way()) { return; }
    event.preventDefault();
    if (event.repeat) { return; }
    give(KEYS[event.key]);
    // where the next space means coasting, and not the button that was pressed before
    if (on_the_way()) { commands[command].focus({preventScroll: true}); }
  });
  const prepare = () => {
    if (!model.given.mesh || !model.sources.train || trip) { return; }
    ({ghost} = model.given);
    begin();
  };
  // a link may lead to one of the lessons, once it is laid out
  const lead = async () => {
    const place = () => deep(`.rj-lesson-${model.lead}`)[0];
    if (!model.lead) { return; }
    await until(() => place()?.getBoundingClientRect().height > 0, LAID_OUT_WITHIN_MS);
    requestAnimationFrame(() => place()?.scrollIntoView());
  };
  redraw_on(model, ["given", "sources"], prepare);
  redraw_on(model, ["verdict"], () => { if (phase === "asked") { judge(); } });
  redraw_on(model, ["refusals"], () => { if (phase === "asked") { begin(); } });
  redraw_on(model, ["lead"], lead);
  signal.addEventListener("abort", () => { phase = "opening"; });
  show();
  prepare();
  lead();
  return root;
}
