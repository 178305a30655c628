// A train driven by hand, cell by cell of its mesh, with the rules of the library: core/motion/cell_step, the account
// of core/physics/account for a constant efficiency, and the train protection of core/simulation/manual.

export const POWER = 0;
export const COAST = 1;
export const BRAKE = 2;
const NEARLY_AT_REST = 1e-9, STEPS = 40, EXACT = 1e-13;

// A table holds a cubic from each of its speeds on; without one, a power limits the effort.
const max_effort = (limit, speed) => {
  const {constant, power, table} = limit;
  if (!table.length) { return power === null ? constant : Math.min(constant, power / speed); }
  let low = 0, high = table.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (table[middle][0] <= speed) { low = middle; } else { high = middle - 1; }
  }
  const [begin, c0, c1, c2, c3] = table[low], x = speed - begin;
  return Math.min(constant, ((c3 * x + c2) * x + c1) * x + c0);
};

const exit_speed2 = (mesh, i, entering, command) => {
  const {traction, braking, friction, linear, most_acceleration, most_deceleration} = mesh;
  const length = mesh.length[i], inertia = mesh.half_inertia / length, half = 0.5 * mesh.quadratic[i];
  const entry = Math.sqrt(entering);
  let leaving = entering, last = 0;
  for (let k = 0; k < STEPS; k++) {
    const v = Math.max(0.5 * (entry + Math.sqrt(Math.max(leaving, 0))), NEARLY_AT_REST);
    let force = 0;
    if (command === POWER) { force = max_effort(traction, v); }
    if (command === BRAKE) { force = -(max_effort(braking, v) + friction); }
    const before = leaving;
    leaving = ((inertia - half) * entering - mesh.constant[i] - linear * v + force) / (inertia + half);
    const change = leaving - before;
    if (change * last < 0 && Math.abs(change) > 0.5 * Math.abs(last)) { leaving = before + 0.5 * change; }
    last = change;
    if (Math.abs(leaving - before) <= EXACT * entering) { break; }
  }
  if (command === POWER && most_acceleration !== null) {
    leaving = Math.min(leaving, entering + 2 * most_acceleration * length);
  }
  if (command === BRAKE && most_deceleration !== null) {
    leaving = Math.max(leaving, entering - 2 * most_deceleration * length);
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
export const nothing_yet = () => ({time: 0, drawn: 0, returned: 0, auxiliary: 0, motion: 0, height: 0, resistance: 0, losses: 0});

// The account so far, with a cell from one square of speed to another; `share` of a cell that the train is still in.
export const with_cell = (mesh, sum, i, from2, to2, share = 1) => {
  const length = mesh.length[i], v = 0.5 * (Math.sqrt(from2) + Math.sqrt(to2)), time = length / v;
  const running = mesh.running_constant + mesh.linear * v + mesh.quadratic[i] * 0.5 * (from2 + to2);
  const climbing = mesh.gradient[i], curve = mesh.constant[i] - mesh.running_constant - climbing;
  const force = (mesh.half_inertia / length) * (to2 - from2) + running + curve + climbing;
  let power = force * v / mesh.driving_efficiency;
  if (force < 0) {
    const braked = mesh.friction > 0 ? Math.min(-force, max_effort(mesh.braking, v)) : -force;
    power = -mesh.braking_efficiency * braked * v;
  }
  const taken = Math.max(power, mesh.recuperated * power), part = share * time;
  return {
    time: sum.time + part,
    drawn: sum.drawn + Math.max(taken, 0) * part,
    returned: sum.returned + Math.max(-taken, 0) * part,
    auxiliary: sum.auxiliary + mesh.auxiliary * part,
    motion: sum.motion + share * mesh.half_inertia * (to2 - from2),
    height: sum.height + share * climbing * length,
    resistance: sum.resistance + share * (running + curve) * length,
    losses: sum.losses + (taken - force * v) * part,
  };
};

export const net_energy = (sum) => sum.drawn - sum.returned + sum.auxiliary;

// Commands as a text that fits into a link, such as p0c45b600: a letter, and the cell from which it holds.
const LETTERS = "pcb";
export const written = (commands) =>
  commands.map((one, i) => (i && commands[i - 1] === one ? "" : `${LETTERS[one]}${i}`)).join("");
