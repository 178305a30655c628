// A train driven by hand, cell by cell of its mesh, with the rules of the library: core/motion/cell_step, the account
// of core/physics/account for a constant efficiency, and the train protection of core/simulation/manual.

export const POWER = 0;
export const COAST = 1;
export const BRAKE = 2;
const NEARLY_AT_REST = 1e-9, STEPS = 40, EXACT = 1e-13, LETTERS = "pcb";

const exit_speed2 = (mesh, i, entering, command) => {
  const inertia = mesh.half_inertia / mesh.length[i], half = 0.5 * mesh.quadratic, entry = Math.sqrt(entering);
  let leaving = entering, last = 0;
  for (let k = 0; k < STEPS; k++) {
    const v = Math.max(0.5 * (entry + Math.sqrt(Math.max(leaving, 0))), NEARLY_AT_REST);
    const force = [Math.min(mesh.traction, mesh.power / v), 0, -mesh.braking][command], before = leaving;
    leaving = ((inertia - half) * entering - mesh.constant[i] + force) / (inertia + half);
    const change = leaving - before;
    if (change * last < 0 && Math.abs(change) > 0.5 * Math.abs(last)) { leaving = before + 0.5 * change; }
    last = change;
    if (Math.abs(leaving - before) <= EXACT * entering) { break; }
  }
  return leaving;
};

// The square of speed at the end of a cell: what the command leads to, under train protection.
export const next_speed2 = (mesh, i, entering, command) => {
  let after = exit_speed2(mesh, i, entering, command);
  if (after < mesh.pace2) {
    after = Math.max(after, Math.min(exit_speed2(mesh, i, entering, POWER), mesh.pace2));
  }
  return Math.min(after, mesh.highest2[i + 1]);
};

// Nothing has moved yet: seconds, and joules of each kind.
export const nothing_yet = () => ({time: 0, drawn: 0, returned: 0, motion: 0, height: 0, resistance: 0, losses: 0});

// The account so far, with a cell from one square of speed to another; `share` of a cell that the train is still in.
export const with_cell = (mesh, sum, i, from2, to2, share = 1) => {
  const length = mesh.length[i], v = 0.5 * (Math.sqrt(from2) + Math.sqrt(to2)), part = share * length / v;
  const running = mesh.running_constant + mesh.quadratic * 0.5 * (from2 + to2);
  const climbing = mesh.gradient[i], resisting = running + mesh.constant[i] - mesh.running_constant - climbing;
  const force = (mesh.half_inertia / length) * (to2 - from2) + resisting + climbing;
  const power = force < 0 ? mesh.braking_efficiency * force * v : force * v / mesh.driving_efficiency;
  const taken = Math.max(power, mesh.recuperated * power);
  return {
    time: sum.time + part,
    drawn: sum.drawn + Math.max(taken, 0) * part,
    returned: sum.returned + Math.max(-taken, 0) * part,
    motion: sum.motion + share * mesh.half_inertia * (to2 - from2),
    height: sum.height + share * climbing * length,
    resistance: sum.resistance + share * resisting * length,
    losses: sum.losses + (taken - force * v) * part,
  };
};

// Stretches of one command: which, and the cells where it begins and ends.
export const stretches = (commands) => {
  const starts = [...commands.keys()].filter((i) => commands[i] !== commands[i - 1]);
  return starts.map((from, k) => ({command: commands[from], from, to: starts[k + 1] ?? commands.length}));
};
// Commands as a text that fits into a link, such as p0c45b600: a letter, and the cell from which it holds.
export const in_letters = (commands) =>
  stretches(commands).map(({command, from}) => `${LETTERS[command]}${from}`).join("");

// Place, speed and cell at a time of a run with these times and speeds at its nodes; the speed rises evenly within a cell.
export const place_at = ({position}, {times, speeds}, time) => {
  const cell = times.findIndex((one) => one > time) - 1, last = times.length - 1;
  if (cell < 0) { return {at: position[last], speed: speeds[last], cell: last, share: 0}; }
  const part = (time - times[cell]) / (times[cell + 1] - times[cell]), from = speeds[cell], to = speeds[cell + 1];
  const share = part * (2 * from + part * (to - from)) / (from + to);
  const at = position[cell] + share * (position[cell + 1] - position[cell]);
  return {at, speed: from + part * (to - from), cell, share};
};

// A train on its way: the cell that it is in has its end already. `drive` goes on for some seconds with a command for
// each cell.
export const set_off = (mesh) => {
  const run = {commands: [], times: [0], speeds: [Math.sqrt(mesh.entering2)], sums: [nothing_yet()], time: 0};
  const has_arrived = () => run.commands.length === mesh.length.length && run.time >= run.times.at(-1);
  const drive = (seconds, command_at) => {
    run.time += seconds;
    while (run.time >= run.times.at(-1) && !has_arrived()) {
      const i = run.commands.length, from2 = run.speeds[i] ** 2;
      run.commands.push(command_at(i));
      const to2 = next_speed2(mesh, i, from2, run.commands[i]);
      run.sums.push(with_cell(mesh, run.sums[i], i, from2, to2));
      run.speeds.push(Math.sqrt(to2));
      run.times.push(run.sums[i + 1].time);
    }
    run.time = Math.min(run.time, run.times.at(-1));
  };
  const now = () => {
    const {at, speed, cell, share} = place_at(mesh, run, run.time);
    const [from2, to2] = run.speeds.slice(cell, cell + 2).map((one) => one ** 2);
    return {at, speed, cell, sum: share ? with_cell(mesh, run.sums[cell], cell, from2, to2, share) : run.sums[cell]};
  };
  return {run, drive, now, has_arrived};
};
