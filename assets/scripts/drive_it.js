// The lesson that is driven: power, coast and brake against the clock, three tries, then the optimum over one's run.

import {life_of, make, redraw_on} from "./dom.js";
import {
  BRAKE, COAST, POWER, net_energy, next_speed2, nothing_yet, read, with_cell, written,
} from "./driving.js";

const TRIES = 3, RATES = [1, 4, 10], J_PER_KWH = 3.6e6, KMH_PER_MS = 3.6;
// a tab out of sight gets no frames: its clock stands still meanwhile
const LONGEST_FRAME_S = 0.1;
const KEYS = {ArrowUp: POWER, ArrowRight: COAST, " ": COAST, ArrowDown: BRAKE};
const INKS = ["surface", "ink", "ink2", "ink3", "line", "line2", "ground", "limit", "accent", "brake", "coast", "full_power", "overline", "over"];
const PARTS = [
  ["motion", "Motion", "accent"], ["height", "Height", "ink3"], ["resistance", "Resistance", "groundline"],
  ["losses", "Losses", "costbar"], ["returned", "Returned", "good"], ["drawn", "Drawn from the supply", "ink"],
];
// what is rounded to zero has no sign
const figures_of = (value, digits) => value.toFixed(digits).replace(/^-(?=0\.?0*$)/, "").replace("-", "\u2212");
const kwh_of = (joules) => figures_of(joules / J_PER_KWH, 2);
const clock_of = (seconds) => {
  const tenths = Math.round(10 * Math.max(seconds, 0)), rest = tenths % 600;
  return `${Math.floor(tenths / 600)}:${String(Math.floor(rest / 10)).padStart(2, "0")}.${rest % 10}`;
};
const arrival_words = (late_s) => `${figures_of(Math.abs(late_s), 1)} s ${late_s > 0.05 ? "late" : "early"}`;

// --- the figure

// Speed over distance with limit and commands, the height of the track, and later the optimum with the difference.
const figure_on = (canvas, course) => {
  const {position, limit, gradient, length} = course, end = position.at(-1);
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
  const draw = ({speeds, commands, at, speed, verdict}) => {
    const ratio = window.devicePixelRatio || 1, wide = canvas.clientWidth, tall = canvas.clientHeight;
    if (!wide) { return; }
    if (canvas.width !== Math.round(wide * ratio)) { canvas.width = Math.round(wide * ratio); }
    if (canvas.height !== Math.round(tall * ratio)) { canvas.height = Math.round(tall * ratio); }
    const pen = canvas.getContext("2d");
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, wide, tall);
    const left = 34, right = wide - 8, bottom = 0.6 * tall, strip = bottom + 8, track = bottom + 52, floor = tall - 22;
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
    pen.font = "11px Inter, sans-serif";
    text("Speed, km/h", left, 11, ink.ink2);
    for (let kmh = 0; kmh < top * KMH_PER_MS; kmh += 20) {
      const y = y_of(kmh / KMH_PER_MS);
      line((i) => [left, right][i], [y, y], ink.line, 1);
      text(String(kmh), left - 6, y + 4, ink.ink3, "right");
    }
    // what lies above the limit, and its edge
    pen.fillStyle = ink.ground;
    pen.strokeStyle = ink.limit;
    pen.lineWidth = 1.2;
    pen.beginPath();
    limit.forEach((ms, i) => { pen.lineTo(x_of(position[i]), y_of(ms)); pen.lineTo(x_of(position[i + 1]), y_of(ms)); });
    pen.stroke();
    pen.lineTo(right, 16);
    pen.lineTo(left, 16);
    pen.globalAlpha = 0.5;
    pen.fill();
    pen.globalAlpha = 1;
    let before = null;
    limit.forEach((ms, i) => {
      if (ms !== before) { text(`limit ${Math.round(ms * KMH_PER_MS)}`, x_of(position[i]) + 4, y_of(ms) - 4, ink.limit); }
      before = ms;
    });
    // commands so far
    const fills = [ink.full_power, ink.coast, ink.brake];
    pen.fillStyle = ink.line;
    pen.fillRect(left, strip + 8, right - left, 2);
    for (let i = 0; i < commands.length; i++) {
      pen.fillStyle = fills[commands[i]];
      pen.fillRect(x_of(position[i]), strip, x_of(position[i + 1]) - x_of(position[i]) + 0.5, 18);
    }
    if (verdict) {
      const above = verdict.above_kwh, most = Math.max(...above, 0.01), least = Math.min(...above, 0);
      const level = (kwh) => floor - ((floor - track - 6) * (kwh - least)) / (most - least);
      text("You above the best possible so far, kWh", left, track - 4, ink.ink2);
      pen.fillStyle = ink.over;
      pen.beginPath();
      pen.moveTo(left, level(0));
      above.forEach((kwh, i) => pen.lineTo(x_of(position[i]), level(kwh)));
      pen.lineTo(right, level(0));
      pen.fill();
      line((i) => x_of(position[i]), above.map(level), ink.overline, 1.4);
      text(`+${figures_of(above.at(-1), 2)}`, right, track - 4, ink.overline, "right");
      line((i) => x_of(position[i]), verdict.best_ms.map(y_of), ink.accent, 2.6);
    } else {
      const level = (joule) => floor - ((floor - track - 14) * (joule - low)) / Math.max(high - low, 1);
      text("Track, height", left, track - 4, ink.ink2);
      pen.fillStyle = ink.ground;
      pen.beginPath();
      pen.moveTo(left, floor);
      heights.forEach((joule, i) => pen.lineTo(x_of(position[i]), level(joule)));
      pen.lineTo(right, floor);
      pen.fill();
      let node = position.findIndex((place) => place >= at);
      if (node < 0) { node = position.length - 1; }
      pen.fillStyle = ink.ink;
      pen.fillRect(Math.max(x_of(at) - 26, left), level(heights[node]) - 8, 26, 7);
    }
    line((i) => x_of(position[i]), speeds.map(y_of), ink.ink, 1.8);
    if (verdict?.parting) {
      const x = x_of(verdict.parting.position);
      pen.setLineDash([2, 3]);
      line((i) => [x, x][i], [20, floor], ink.accent, 1);
      pen.setLineDash([]);
      pen.fillStyle = ink.accent;
      pen.beginPath();
      pen.arc(x, y_of(verdict.best_ms[verdict.parting.node]), 5, 0, 7);
      pen.fill();
    } else if (!verdict) {
      line((i) => [x_of(at), x_of(at)][i], [20, floor], ink.line2, 1);
      pen.fillStyle = ink.ink;
      pen.beginPath();
      pen.arc(x_of(at), y_of(speed), 5, 0, 7);
      pen.fill();
      const turned = x_of(at) > right - 70;
      text(`${figures_of(speed * KMH_PER_MS, 1)} km/h`, x_of(at) + (turned ? -9 : 9), y_of(speed) - 8, ink.ink, turned ? "right" : "left");
    }
    for (let place = 0; place <= end; place += 500) { text(String(place), x_of(place), tall - 6, ink.ink3, place ? "center" : "left"); }
    text("m", right, tall - 6, ink.ink3, "right");
  };
  return {draw, recolour};
};

// --- a train on its way

// The state of one run; `advance` drives on for some seconds with a command, or with those of a run that is replayed.
const journey = (course) => {
  const cells = course.length.length, state = {
    speeds: [Math.sqrt(course.entering2)], commands: [], sum: nothing_yet(), cell: null, in_cell: 0, arrived: false,
  };
  const enter = (command) => {
    const i = state.commands.length, from2 = state.speeds[i] ** 2, to2 = next_speed2(course, i, from2, command);
    state.cell = {i, from2, to2, after: with_cell(course, state.sum, i, from2, to2)};
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
    if (!cell) { return {at: course.position[i], speed: state.speeds[i], sum}; }
    const from = Math.sqrt(cell.from2), change = (Math.sqrt(cell.to2) - from) / cell.lasts, speed = from + change * in_cell;
    const gone = 0.5 * (from + speed) * in_cell;
    return {
      at: course.position[cell.i] + gone, speed,
      sum: {...with_cell(course, sum, cell.i, cell.from2, cell.to2, gone / course.length[cell.i]), time: sum.time + in_cell},
    };
  };
  return {state, advance, now};
};

// --- the lesson

export function render({model}) {
  const signal = life_of(model), root = make("section", {class: "drive-it", "aria-label": "Drive it"});
  const canvas = make("canvas", {role: "img", "aria-label": "Speed over distance, your commands and the track"});
  const told = make("p", {role: "status"}), clock = make("b"), used = make("b"), clock_note = make("small"), best_note = make("small");
  const bars = make("div", {class: "bars"}), fills = {}, values = {};
  for (const [name, label, colour] of PARTS) {
    fills[name] = make("i", {style: `background: var(--rj-${colour})`});
    values[name] = make("span");
    bars.append(make("span", {}, label), make("div", {}, fills[name]), values[name]);
  }
  const button = (label, act, name = "") => {
    const made = make("button", {type: "button", class: name || null}, label);
    made.addEventListener("click", act, {signal});
    return made;
  };
  let course = null, figure = null, trip = null, command = COAST, rate = RATES[0], driving = false, replayed = null;
  let verdict = null, last = 0, frames = [], asked = false;
  const tries = [];

  const give = (next) => {
    if (!course || asked || replayed) { return; }
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
    const to_go = course.position.at(-1) - at, left = model.timetable_s - sum.time;
    clock_note.textContent = trip.state.arrived ? `timetable ${clock_of(model.timetable_s)}`
      : `timetable ${clock_of(model.timetable_s)}; ${Math.round(to_go)} m to go` +
        (left > 0 ? `, ${Math.round((to_go / left) * KMH_PER_MS)} km/h on average needed` : ", late");
    const widest = Math.max(sum.drawn, Math.abs(sum.height), 1);
    for (const [name] of PARTS) {
      fills[name].style.width = `${(100 * Math.abs(sum[name])) / widest}%`;
      fills[name].classList.toggle("less", sum[name] < -1);
      values[name].textContent = kwh_of(sum[name]);
    }
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
    trip = journey(course);
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
    if (!course || driving) { return; }
    trip = journey(course);
    replayed = read(text, course.length.length);
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
      verdict.counts ? ` \u00b7 ${figures_of(more, 2)} kWh more than needed (+${figures_of(share, 0)} %), ${arrival_words(verdict.late_s)}. Blue is the best possible run, black is yours.`
        : ` \u00b7 on time, nobody can use less than ${figures_of(verdict.bound_kwh, 2)} kWh. Blue is the best possible run, black is yours.`);
    const rows = tries.map((one, k) => make("tr", {class: one === best ? "best" : null}, make("td", {}, String(k + 1)),
      make("td", {}, figures_of(one.kwh, 2)), make("td", {}, `+${figures_of(100 * (one.kwh / one.bound_kwh - 1), 0)} %`),
      make("td", {class: one.counts ? "" : "late"}, arrival_words(one.late_s))));
    const head = make("tr", {}, ...["Try", "kWh", "above the bound", "arrived"].map((word) => make("th", {scope: "col"}, word)));
    const lost = verdict.rows.map(([name, kwh]) => make("tr", {}, make("td", {}, name), make("td", {}, `${kwh < 0 ? "" : "+"}${figures_of(kwh, 2)}`)));
    const left = TRIES - tries.length, copied = make("span", {role: "status"});
    const buttons = make("div", {class: "row"}, button("Open in the workbench", () => model.send_msg({what: "open"}), "main"));
    if (left) { buttons.prepend(button(`Drive again (${left} left)`, () => { begin(); commands[0].focus(); })); }
    buttons.prepend(button("Watch your run", () => watch(verdict.commands)), button("Copy replay link", async () => {
      // the page's own address holds the run
      try {
        await navigator.clipboard.writeText(window.location.href);
        copied.textContent = "Copied.";
      } catch { copied.textContent = "Copy the address of this page: it holds the run."; }
    }), copied);
    const parting = verdict.parting ? make("p", {}, make("b", {}, verdict.parting.here), " ", verdict.parting.there) : "";
    result.replaceChildren(outcome, words, parting, make("div", {class: "stage"},
      make("div", {}, make("h3", {}, "Your tries"), make("table", {}, head, ...rows)),
      make("div", {}, make("h3", {}, "Where it went, kWh against the best possible"), make("table", {}, ...lost))), buttons);
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
    if (!(event.key in KEYS) || (event.key === " " && other) || !course || asked || event.ctrlKey || event.metaKey || event.altKey) { return; }
    // only what drives: after the last try the arrows scroll the page again
    if (!driving && tries.length >= TRIES) { return; }
    event.preventDefault();
    if (event.repeat) { return; }
    give(KEYS[event.key]);
    // where the next space means coasting, and not the button that was pressed before
    if (driving) { commands[command].focus({preventScroll: true}); }
  }, {signal});
  const prepare = () => {
    if (!model.course.length || course) { return; }
    course = model.course;
    figure = figure_on(canvas, course);
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
  redraw_on(model, ["course"], prepare);
  // a link's run may come after the course
  redraw_on(model, ["driven"], () => { if (course && !driving) { replay.hidden = !model.driven; } });
  redraw_on(model, ["verdict"], () => { if (model.verdict.commands && asked) { show(); } });
  redraw_on(model, ["refusals"], () => { if (asked) { asked = false; begin(); } });
  prepare();
  return root;
}
