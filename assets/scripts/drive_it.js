// The lesson that is driven: power, coast and brake against the clock, three tries, then the optimum over one's run.

import {life_of, make, redraw_on} from "./dom.js";
import {BRAKE, COAST, POWER, net_energy, next_speed2, nothing_yet, with_cell, written} from "./driving.js";
import {
  KMH_PER_MS, clock_of, dials, energy_bars, frame_meter, kwh_of, lead_to, listen_to, pressing, verdict_of,
} from "./played.js";
import {figure_on} from "./speed_figure.js";

const RATES = [1, 4, 10];
// a tab out of sight gets no frames: its clock stands still in that time
const LONGEST_FRAME_S = 0.1;
const KEYS = {ArrowUp: POWER, ArrowRight: COAST, " ": COAST, ArrowDown: BRAKE};

// --- a train on its way

// The state of one run; `advance` drives on for some seconds with a command for each cell.
const journey = (mesh) => {
  const cells = mesh.length.length, state = {
    speeds: [Math.sqrt(mesh.entering2)], commands: [], sum: nothing_yet(), cell: null, in_cell: 0, arrived: false,
  };
  const enter = (command) => {
    const i = state.commands.length, from2 = state.speeds[i] ** 2, to2 = next_speed2(mesh, i, from2, command);
    state.cell = {i, from2, to2, after: with_cell(mesh, state.sum, i, from2, to2)};
    state.cell.lasts = state.cell.after.time - state.sum.time;
    state.commands.push(command);
  };
  const advance = (seconds, command_at) => {
    let left = seconds;
    while (!state.arrived) {
      if (!state.cell) { enter(command_at(state.commands.length)); }
      if (state.in_cell + left < state.cell.lasts) { state.in_cell += left; return; }
      left -= state.cell.lasts - state.in_cell;
      state.sum = state.cell.after;
      state.speeds.push(Math.sqrt(state.cell.to2));
      state.cell = null;
      state.in_cell = 0;
      state.arrived = state.commands.length === cells;
    }
  };
  // speed rises evenly over the time in a cell
  const now = () => {
    const {cell, in_cell, sum} = state, i = state.speeds.length - 1;
    if (!cell) { return {at: mesh.position[i], speed: state.speeds[i], sum}; }
    const from = Math.sqrt(cell.from2), change = (Math.sqrt(cell.to2) - from) / cell.lasts, speed = from + change * in_cell;
    const gone = 0.5 * (from + speed) * in_cell;
    return {
      at: mesh.position[cell.i] + gone, speed,
      sum: {...with_cell(mesh, sum, cell.i, cell.from2, cell.to2, gone / mesh.length[cell.i]), time: sum.time + in_cell},
    };
  };
  return {state, advance, now};
};

// Position of a run that is given by its times and speeds at the nodes.
export const place_at = ({position}, {times, speeds}, time) => {
  const next = times.findIndex((one) => one > time);
  if (next < 1) { return {at: position.at(-1), speed: speeds.at(-1)}; }
  const share = (time - times[next - 1]) / (times[next] - times[next - 1]), from = speeds[next - 1], to = speeds[next];
  const gone = (share * (2 * from + share * (to - from))) / (from + to);
  return {at: position[next - 1] + gone * (position[next] - position[next - 1]), speed: from + share * (to - from)};
};

// --- the lesson

export function render({model}) {
  const signal = life_of(model), root = make("section", {class: "played drive-it", "aria-label": "Drive it"});
  const canvas = make("canvas", {role: "img", "aria-label": "Speed over distance, your commands and the track"});
  const status = make("p", {role: "status"}), {element: clocks, one: clock, other: used} = dials("Clock", "Used so far"), note = frame_meter(root);
  const {bars, show: show_bars} = energy_bars(), button = pressing(signal);
  let mesh = null, figure = null, trip = null, command = COAST, rate = 4, driving = false, watched = null;
  let verdict = null, ghost = null, tried = 0, last = 0, asked = false;

  const give = (next) => {
    if (!mesh || asked || watched || (!driving && (next !== POWER || trip.state.arrived))) { return; }
    command = next;
    if (!driving) { set_off(); }
    press();
  };
  const commands = [
    [POWER, "\u2191 Power", "\u2191"], [COAST, "Coast", "\u2192 or space"], [BRAKE, "\u2193 Brake", "\u2193"],
  ].map(([which, label, key]) => {
    const made = make("button", {type: "button", "aria-pressed": "false", disabled: true}, label, make("kbd", {"aria-hidden": "true"}, key));
    // immediately, not when the finger leaves; a click without a pointer is that of a keyboard or of a screen reader
    made.addEventListener("pointerdown", () => give(which), {signal});
    made.addEventListener("click", (event) => { if (event.detail === 0) { give(which); } }, {signal});
    return made;
  });
  const rates = RATES.map((times) => button(`${times}\u00d7`, () => { rate = times; press(); }, "rate"));
  const press = () => {
    commands.forEach((one, k) => one.setAttribute("aria-pressed", String(driving && k === command)));
    rates.forEach((one, k) => one.setAttribute("aria-pressed", String(RATES[k] === rate)));
  };
  // wherever the button was that began it, the figure is what is looked at
  const come = () => root.querySelector(".drive").scrollIntoView({block: "start"});

  const picture = () => {
    const {at, speed, sum} = trip.now();
    figure.draw({
      speeds: driving ? [...trip.state.speeds, speed] : trip.state.speeds, commands: trip.state.commands, at, speed, verdict,
      ghost: ghost && !verdict && place_at(mesh, ghost, sum.time),
    });
    clock.value.textContent = clock_of(sum.time);
    used.value.textContent = `${kwh_of(net_energy(sum))} kWh`;
    const to_go = mesh.position.at(-1) - at, left = model.given.timetable_s - sum.time;
    clock.note.textContent = trip.state.arrived ? `timetable ${clock_of(model.given.timetable_s)}`
      : `${Math.round(to_go)} m to go` + (left > 0 ? `, ${Math.round((to_go / left) * KMH_PER_MS)} km/h on average needed` : ", late");
    show_bars(sum);
  };
  const frame = (time) => {
    if (!driving || !root.isConnected) { driving = false; return; }
    const begun = performance.now();
    trip.advance(rate * Math.min((time - last) / 1000, LONGEST_FRAME_S), (i) => (watched ? watched[i] : command));
    last = time;
    if (watched && command !== trip.state.commands.at(-1)) { command = trip.state.commands.at(-1); press(); }
    if (trip.state.arrived) { arrive(); } else { requestAnimationFrame(frame); }
    picture();
    note(begun);
  };
  const set_off = () => {
    driving = true;
    status.textContent = watched ? "Your run again" : `Try ${tried + 1} of ${model.given.tries}: on the way`;
    requestAnimationFrame((time) => { last = time; frame(time); });
  };
  const reset = () => {
    trip = journey(mesh);
    verdict = null;
    result.hide();
    root.classList.add("ready");
    figure.recolour();
  };
  const begin = () => {
    reset();
    command = COAST;
    status.textContent = `Try ${tried + 1} of ${model.given.tries}: press Power to depart.` +
      (ghost ? " The blue train is the run to race." : "");
    press();
    picture();
  };
  const arrive = () => {
    driving = false;
    press();
    if (watched) {
      watched = null;
      judge();
      return;
    }
    asked = true;
    status.textContent = "Arrived: the best possible run is being computed.";
    model.send_msg({what: "done", text: written(trip.state.commands)});
  };
  const judge = () => {
    asked = false;
    ({verdict} = model);
    tried = verdict.tried;
    ghost = {times: verdict.best_s, speeds: verdict.best_ms};
    status.textContent = `Arrived: try ${tried} of ${model.given.tries}.`;
    used.note.textContent = verdict.note;
    root.classList.remove("ready");
    result.show();
    picture();
    come();
  };
  const result = verdict_of(model, signal, {
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
      watched = [...trip.state.commands];
      reset();
      set_off();
      come();
    },
  }, () => written(trip.state.commands));

  root.append(make("h2", {}, model.title), make("p", {}, model.text), make("div", {class: "drive"},
    make("div", {class: "head"}, status, result.head), canvas,
    make("div", {class: "account"}, make("h3", {}, "Energy breakdown now, kWh"), bars),
    make("div", {class: "foot"},
      clocks, make("div", {class: "commands", role: "group", "aria-label": "Commands"}, ...commands)),
    make("div", {class: "row", role: "group", "aria-label": "Clock"}, make("span", {}, "Clock"), ...rates)), result.details);
  root.addEventListener("keydown", (event) => {
    const other = event.target.closest?.("button") && !commands.includes(event.target);
    if (!(event.key in KEYS) || (event.key === " " && other) || !mesh || asked || event.ctrlKey || event.metaKey || event.altKey) { return; }
    // only what drives: after a try the arrows scroll the page again
    if (!driving && trip.state.arrived) { return; }
    event.preventDefault();
    if (event.repeat) { return; }
    give(KEYS[event.key]);
    // where the next space means coasting, and not the button that was pressed before
    if (driving) { commands[command].focus({preventScroll: true}); }
  }, {signal});
  const prepare = () => {
    if (!model.given.mesh || mesh) { return; }
    ({mesh} = model.given);
    ({ghost} = model.given);
    figure = figure_on(canvas, mesh, signal, () => { if (!driving) { picture(); } });
    for (const one of commands) { one.disabled = false; }
    begin();
  };
  const lead = () => { if (model.lead) { lead_to(model.lead); } };
  status.textContent = "Opening";
  press();
  listen_to(model, {prepare, judge, refuse: () => { asked = false; begin(); }, asked: () => asked});
  redraw_on(model, ["lead"], lead);
  lead();
  return root;
}
