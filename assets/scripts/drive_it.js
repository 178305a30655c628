// The lesson that is driven: power, coast and brake against the clock, three tries, then the optimum over one's run.

import {life_of, make, redraw_on} from "./dom.js";
import {
  BRAKE, COAST, POWER, net_energy, next_speed2, nothing_yet, read, with_cell, written,
} from "./driving.js";
import {
  KMH_PER_MS, clock_of, energy_bars, figures_of, kwh_of, link_button, pressing, table_of, with_sign,
} from "./played.js";
import {figure_on} from "./speed_figure.js";

const TRIES = 3, RATES = [1, 4, 10];
// a tab out of sight gets no frames: its clock stands still meanwhile
const LONGEST_FRAME_S = 0.1;
const KEYS = {ArrowUp: POWER, ArrowRight: COAST, " ": COAST, ArrowDown: BRAKE};
const arrival_words = (late_s) => `${figures_of(Math.abs(late_s), 1)} s ${late_s > 0.05 ? "late" : "early"}`;

// --- a train on its way

// The state of one run; `advance` drives on for some seconds with a command, or with those of a run that is replayed.
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

// --- the lesson

export function render({model}) {
  const signal = life_of(model), root = make("section", {class: "played drive-it", "aria-label": "Drive it"});
  const canvas = make("canvas", {role: "img", "aria-label": "Speed over distance, your commands and the track"});
  const told = make("p", {role: "status"}), clock = make("b"), used = make("b"), clock_note = make("small"), best_note = make("small");
  const {bars, show: show_bars} = energy_bars(), button = pressing(signal);
  let mesh = null, figure = null, trip = null, command = COAST, rate = RATES[0], driving = false, replayed = null;
  let verdict = null, last = 0, frames = [], asked = false;
  const tries = [];

  const give = (next) => {
    if (!mesh || asked || replayed) { return; }
    if (!driving && (next !== POWER || trip.state.arrived || tries.length >= TRIES)) { return; }
    command = next;
    if (!driving) { set_off(); }
    press();
  };
  const commands = [
    [POWER, "\u2191 Power", "\u2191"], [COAST, "Coast", "\u2192 or space"], [BRAKE, "\u2193 Brake", "\u2193"],
  ].map(([which, label, key]) => {
    const made = make("button", {type: "button", "aria-pressed": "false", disabled: true}, label, make("kbd", {"aria-hidden": "true"}, key));
    // at once, not when the finger leaves; a click without a pointer is that of a keyboard or of a screen reader
    made.addEventListener("pointerdown", () => give(which), {signal});
    made.addEventListener("click", (event) => { if (event.detail === 0) { give(which); } }, {signal});
    return made;
  });
  const rates = RATES.map((times) => button(`${times}\u00d7`, () => { rate = times; press(); }, "rate"));
  const replay = button("Replay the linked run", () => watch(model.driven));
  const result = make("div", {hidden: true});
  const press = () => {
    commands.forEach((one, k) => one.setAttribute("aria-pressed", String(driving && k === command)));
    rates.forEach((one, k) => one.setAttribute("aria-pressed", String(RATES[k] === rate)));
  };

  const picture = () => {
    const {at, speed, sum} = trip.now();
    figure.draw({speeds: driving ? [...trip.state.speeds, speed] : trip.state.speeds, commands: trip.state.commands, at, speed, verdict});
    clock.textContent = clock_of(sum.time);
    used.textContent = `${kwh_of(net_energy(sum))} kWh`;
    const to_go = mesh.position.at(-1) - at, left = model.timetable_s - sum.time;
    clock_note.textContent = trip.state.arrived ? `timetable ${clock_of(model.timetable_s)}`
      : `timetable ${clock_of(model.timetable_s)}; ${Math.round(to_go)} m to go` +
        (left > 0 ? `, ${Math.round((to_go / left) * KMH_PER_MS)} km/h on average needed` : ", late");
    show_bars(sum);
  };
  const frame = (time) => {
    if (!driving || !root.isConnected) { driving = false; return; }
    const begun = performance.now();
    trip.advance(rate * Math.min((time - last) / 1000, LONGEST_FRAME_S), (i) => (replayed ? replayed[i] : command));
    last = time;
    if (replayed && command !== trip.state.commands.at(-1)) { command = trip.state.commands.at(-1); press(); }
    if (trip.state.arrived) { arrive(); } else { requestAnimationFrame(frame); }
    picture();
    frames.push(performance.now() - begun);
  };
  const set_off = () => {
    driving = true;
    verdict = null;
    frames = [];
    result.hidden = true;
    replay.hidden = true;
    figure.recolour();
    told.textContent = replayed ? "Replay" : `Try ${tries.length + 1} of ${TRIES}: on the way`;
    requestAnimationFrame((time) => { last = time; frame(time); });
  };
  const begin = () => {
    trip = journey(mesh);
    verdict = null;
    command = COAST;
    told.textContent = `Try ${tries.length + 1} of ${TRIES}: press Power to depart.`;
    result.hidden = true;
    replay.hidden = !model.driven;
    figure.recolour();
    press();
    picture();
  };
  const watch = (text) => {
    if (!mesh || driving) { return; }
    trip = journey(mesh);
    replayed = read(text, mesh.length.length);
    set_off();
  };
  const arrive = () => {
    driving = false;
    const sorted = frames.toSorted((one, other) => one - other);
    root.dataset.frameMs = String(sorted[Math.floor(sorted.length / 2)] ?? 0);
    press();
    if (replayed) {
      replayed = null;
      const {sum} = trip.state;
      told.textContent = `Replay: ${kwh_of(net_energy(sum))} kWh in ${clock_of(sum.time)}.`;
      verdict = tries.find((one) => one.commands === written(trip.state.commands)) ?? null;
      result.hidden = !verdict;
      again.hidden = false;
      aside.hidden = false;
      return;
    }
    asked = true;
    told.textContent = "Arrived: the best possible run is being computed.";
    model.send_msg({what: "done", commands: written(trip.state.commands)});
  };
  const again = button("Drive again", () => { begin(); aside.hidden = true; commands[0].focus(); });
  const aside = make("div", {class: "row", hidden: true}, again);

  const show = () => {
    asked = false;
    verdict = model.verdict;
    tries.push(verdict);
    told.textContent = `Arrived: try ${tries.length} of ${TRIES}.`;
    const on_time = tries.filter((one) => one.counts), best = on_time.toSorted((one, other) => one.kwh - other.kwh)[0];
    best_note.textContent = best ? `best of your tries ${figures_of(best.kwh, 2)}` : "";
    const more = verdict.kwh - verdict.bound_kwh, share = (100 * more) / verdict.bound_kwh;
    const outcome = make("h2", {class: "outcome", tabindex: "-1"}, verdict.counts
      ? `You used ${figures_of(verdict.kwh, 2)} kWh; nobody on time can use less than ${figures_of(verdict.bound_kwh, 2)}.`
      : `You are ${arrival_words(verdict.late_s)}: this try does not count.`);
    const words = make("p", {}, make("span", {class: verdict.proven ? "proven" : ""}, verdict.proven ? "\u2713 proven" : "not proven"),
      verdict.counts ? ` \u00b7 ${figures_of(more, 2)} kWh more than needed (${with_sign(share, 0)} %), ${arrival_words(verdict.late_s)}. Blue is the best possible run, the thinner line is yours.`
        : ` \u00b7 on time, nobody can use less than ${figures_of(verdict.bound_kwh, 2)} kWh. Blue is the best possible run, the thinner line is yours.`);
    const rows = tries.map((one, k) => ({name: one === best ? "best" : null, cells: [
      // the bound holds for runs on time, and says nothing of a late one
      String(k + 1), figures_of(one.kwh, 2), one.counts ? `${with_sign(100 * (one.kwh / one.bound_kwh - 1), 0)} %` : "\u2013",
      make("span", {class: one.counts ? null : "late"}, arrival_words(one.late_s)),
    ]}));
    const left = TRIES - tries.length;
    const buttons = make("div", {class: "row"}, button("Watch your run", () => watch(verdict.commands)),
      ...link_button(button, "Copy replay link", "learn.driven"));
    if (left) { buttons.append(button(`Drive again (${left} left)`, () => { begin(); commands[0].focus(); })); }
    buttons.append(button("Open in the workbench", () => model.send_msg({what: "open"}), "main"));
    const parting = verdict.parting ? make("p", {}, make("b", {}, verdict.parting.here), " ", verdict.parting.there) : "";
    result.replaceChildren(outcome, words, parting, make("div", {class: "stage"},
      make("div", {}, make("h3", {}, "Your tries"), table_of(["Try", "kWh", "above the bound", "arrived"], rows)),
      make("div", {}, make("h3", {}, `Where it went, kWh against the best possible${verdict.counts ? "" : " on time"}`), table_of([], verdict.rows.map(([name, kwh]) => ({cells: [name, with_sign(kwh, 2)]}))))), buttons);
    result.hidden = false;
    picture();
    outcome.focus();
  };

  root.append(make("h2", {}, "1. Drive it: how little energy can you use and still be on time?"),
    make("p", {}, `A metro, ${model.length_km} km, timetable ${clock_of(model.timetable_s)}. Limits and the last stop are kept for you, and the train never ` +
      "crawls below walking pace; all else is yours, three times. Keys: \u2191 power, \u2192 or space coast, \u2193 brake."),
    told, make("div", {class: "stage"}, canvas, make("div", {},
      make("div", {class: "clocks"}, make("div", {}, "Clock", clock, clock_note), make("div", {}, "Used so far", used, best_note)),
      make("h3", {}, "Where the energy is now, kWh"), bars)),
    make("div", {class: "commands", role: "group", "aria-label": "Commands"}, ...commands),
    make("div", {class: "row", role: "group", "aria-label": "Clock"}, make("span", {}, "Clock"), ...rates, replay), aside, result);
  root.addEventListener("keydown", (event) => {
    const other = event.target.closest?.("button") && !commands.includes(event.target);
    if (!(event.key in KEYS) || (event.key === " " && other) || !mesh || asked || event.ctrlKey || event.metaKey || event.altKey) { return; }
    // only what drives: after the last try the arrows scroll the page again
    if (!driving && tries.length >= TRIES) { return; }
    event.preventDefault();
    if (event.repeat) { return; }
    give(KEYS[event.key]);
    // where the next space means coasting, and not the button that was pressed before
    if (driving) { commands[command].focus({preventScroll: true}); }
  }, {signal});
  const prepare = () => {
    if (!model.mesh.length || mesh) { return; }
    mesh = model.mesh;
    figure = figure_on(canvas, mesh);
    for (const one of commands) { one.disabled = false; }
    begin();
    new ResizeObserver(() => { if (!driving) { figure.recolour(); picture(); } }).observe(canvas);
    window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => requestAnimationFrame(() => {
      figure.recolour();
      picture();
    }), {signal});
  };
  told.textContent = "Opening";
  press();
  replay.hidden = true;
  redraw_on(model, ["mesh"], prepare);
  // a link's run may come after the mesh
  redraw_on(model, ["driven"], () => { if (mesh && !driving) { replay.hidden = !model.driven; } });
  redraw_on(model, ["verdict"], () => { if (model.verdict.commands && asked) { show(); } });
  redraw_on(model, ["refusals"], () => { if (asked) { asked = false; begin(); } });
  prepare();
  return root;
}
