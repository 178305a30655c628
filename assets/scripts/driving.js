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

// --- a run that is drawn: core/simulation/manual, with the passes of core/motion/passes

const HALVINGS = 60;
// The force at the wheels [N] that leads from one square of speed to another in a cell; braking is negative.
export const force_between = (mesh, i, from2, to2) => {
  const v = Math.max(0.5 * (Math.sqrt(from2) + Math.sqrt(to2)), NEARLY_AT_REST);
  const resistance = mesh.constant[i] + mesh.linear * v + mesh.quadratic[i] * 0.5 * (from2 + to2);
  return (mesh.half_inertia / mesh.length[i]) * (to2 - from2) + resistance;
};

// Whether full effort leads from the known square of speed to another, or full braking from the other to the known one.
const can = (mesh, i, known, other, braking) => {
  const v = Math.max(0.5 * (Math.sqrt(known) + Math.sqrt(other)), NEARLY_AT_REST);
  return braking ? -force_between(mesh, i, other, known) <= mesh.friction + max_effort(mesh.braking, v)
    : force_between(mesh, i, known, other) <= max_effort(mesh.traction, v);
};

const greatest = (mesh, i, known, bound, braking) => {
  if (can(mesh, i, known, bound, braking)) { return bound; }
  let low = 0, high = bound;
  for (let k = 0; k < HALVINGS; k++) {
    const middle = 0.5 * (low + high);
    if (can(mesh, i, known, middle, braking)) { low = middle; } else { high = middle; }
  }
  return low;
};

// The fastest run below a speed [m/s] that is drawn at each node: squares of speed, and the account after each cell.
export const drive_drawn = (mesh, drawn) => {
  const {length, highest2, pace2, most_acceleration, most_deceleration} = mesh, cells = length.length;
  const speed2 = drawn.map((speed, i) => Math.min(Math.max(speed * speed, pace2), highest2[i]));
  speed2[0] = Math.min(mesh.entering2, speed2[0]);
  for (let i = 0; i < cells; i++) {
    const most = speed2[i] + 2 * (most_acceleration ?? Infinity) * length[i];
    speed2[i + 1] = greatest(mesh, i, speed2[i], Math.min(speed2[i + 1], most), false);
  }
  for (let i = cells - 1; i >= 0; i--) {
    const most = speed2[i + 1] + 2 * (most_deceleration ?? Infinity) * length[i];
    speed2[i] = greatest(mesh, i, speed2[i + 1], Math.min(speed2[i], most), true);
  }
  const sums = [nothing_yet()];
  length.forEach((_, i) => { sums.push(with_cell(mesh, sums[i], i, speed2[i], speed2[i + 1])); });
  return {speed2, sums};
};

// A speed between points that stand at even distances.
export const between_points = (mesh, points) => {
  const end = mesh.position.at(-1), steps = points.length - 1;
  return mesh.position.map((place) => {
    const along = (steps * place) / end, k = Math.min(Math.floor(along), steps - 1);
    return points[k] + (along - k) * (points[k + 1] - points[k]);
  });
};

// Commands as a text that fits into a link, such as p0c45b600: a letter, and the cell from which it holds.
const LETTERS = "pcb";
export const written = (commands) =>
  commands.map((one, i) => (i && commands[i - 1] === one ? "" : `${LETTERS[one]}${i}`)).join("");
