"""Runs of one start / cruise / coast / brake cycle per stretch of a line, and the best of them for a price of time.

A stretch has one speed limit; its gradients and curves vary. Three speeds describe its cycle: the cruise, the speed at
which coasting ends, and the speed above which the train brakes. Below the cruise the train starts with full effort,
above it the train coasts, and it holds the cruise as far as its effort allows. Down a hill that speeds a coasting train
up, and where a run begins too fast for its time, the brakes hold the third speed. Coasting ends at the next border, or
earlier on the braking curve of the lower limit or stop ahead. The coasting curve is integrated backwards from that end,
and the train coasts from the place where it meets the curve. Each cell has one effort, as in a trajectory, so that
efforts and limits hold exactly.

For a price of time [W] the best speeds minimise energy + price x time. All stretches have one price, so that a second
moved from one stretch to another saves nothing: the equal division of Rawicki, (44)-(55), with stretches for his parts.
"""

import math
from typing import NamedTuple

import numpy as np

from railjoule.core.arrays import BoolArray, FloatArray, IntArray
from railjoule.core.compiled import njit
from railjoule.core.drive.kernels import negligible_effort
from railjoule.core.motion.cell_step import COAST, EXACT, FULL_BRAKE, FULL_TRACTION, STEPS, cell_cost, exit_speed2
from railjoule.core.physics.cell import Cell, mean_speed, needed_force
from railjoule.core.physics.effort_limit import EffortLimit, max_effort
from railjoule.core.physics.mesh_data import MeshData, Train, cell_at, part_of_cell, shared_by_cells

CRUISE, COAST_END, BRAKING = range(3)
"""Rows of the speeds of all stretches."""
# Square of the speed below which a train that slows down counts as standing
SLOWEST2 = 0.1**2
# Two runs whose squares of speed at a border differ by less than this share are the same from there on
SAME_SPEED2 = 1e-10
# Grid of the first guess: one cruise for all stretches, and where coasting ends as a share of it. From 6 x 3 on, the
# descent ends in the same runs in the scenarios tried
CRUISES_TRIED, COASTS_TRIED = 16, 6
MIN_COAST_SHARE = 0.4
# Steps of the descent [m/s]: a parabola through three speeds, whose distance shrinks where none is better
MIN_STEP_MS, SHRINKS, GROWS = 0.03, 0.3, 1.6
MAX_SWEEPS = 60
FLAT, FLAT_GROWS = 1e-12, 3.0
BEYOND_REACHED_MS = 0.3


class Stretches(NamedTuple):
    """A line cut into k stretches, as the search takes it.

    Parameters
    ----------
    mesh : MeshData
        The train and its n cells.
    borders : array of shape (k + 1,)
        Nodes at which stretches begin, and the last node.
    fastest_speed2 : array of shape (n + 1,)
        Squares of the fastest speeds with the brakes of the plan [m2/s2].
    slowest_ms, top_ms : array of shape (k,)
        Bounds of the speeds of each stretch [m/s].
    is_free : array of shape (3, k)
        Whether a speed is searched; else it is the top speed.
    """

    mesh: MeshData
    borders: IntArray
    fastest_speed2: FloatArray
    slowest_ms: FloatArray
    top_ms: FloatArray
    is_free: BoolArray


@njit(cache=True, error_model="numpy")
def _coasting_speed2(cell: Cell, leaving_speed2: float, max_deceleration_ms2: float) -> float:
    """Return the square of speed from which a train coasts through a cell to another one [m2/s2]."""
    half, leaving = 0.5 * cell.quadratic, math.sqrt(leaving_speed2)
    speed2 = leaving_speed2
    # needed_force = 0 solved for w0; the mean speed depends on it, hence the fixed point
    for _ in range(STEPS):
        before = speed2
        resistance = cell.constant_n + cell.linear * mean_speed(math.sqrt(speed2), leaving)
        speed2 = max(((cell.inertia + half) * leaving_speed2 + resistance) / (cell.inertia - half), 0.0)
        if abs(speed2 - before) <= EXACT * speed2:
            break
    most2: float = leaving_speed2 + 2.0 * max_deceleration_ms2 * cell.length_m
    return min(speed2, most2)


@njit(cache=True, error_model="numpy")
def _fill_target(line: Stretches, stretch: int, cruise_ms: float, coast_end_ms: float, target2: FloatArray) -> None:
    """Fill the squares of speed at the nodes of a stretch that its train aims at: the cruise, then the coasting."""
    mesh, greatest2 = line.mesh, line.fastest_speed2
    first, last = line.borders[stretch], line.borders[stretch + 1]
    cruise2, speed2 = cruise_ms * cruise_ms, coast_end_ms * coast_end_ms
    for i in range(first, last + 1):
        target2[i] = cruise2
    if speed2 >= cruise2:
        return
    # the last node before the braking curve falls below the speed at which coasting ends
    node = last
    while node > first and greatest2[node] < speed2:
        node -= 1
    if greatest2[node] < speed2:
        return
    limit = mesh.max_deceleration_ms2
    if node < last:
        share = (greatest2[node] - speed2) / (greatest2[node] - greatest2[node + 1])
        if share > 0.0:
            cell = cell_at(mesh, node)
            speed2 = _coasting_speed2(part_of_cell(cell, share * cell.length_m), speed2, limit)
    after2 = 0.0
    # down a steep hill the curve falls backwards: the train coasts there anyway, as it is faster than its cruise
    while after2 <= speed2 < cruise2:
        target2[node] = after2 = speed2
        node -= 1
        if node < first:
            break
        speed2 = _coasting_speed2(cell_at(mesh, node), speed2, limit)


@njit(cache=True, error_model="numpy")
def _next_speed2(
    cell: Cell,
    train: Train,
    traction: EffortLimit,
    braking: EffortLimit,
    speed2: float,
    wanted2: float,
    braking2: float,
    ceiling2: float,
    negligible_n: float,
) -> float:
    """Return the square of speed after a cell [m2/s2]: the wanted one, as far as effort or coasting lead there.

    The train brakes above `braking2`, as far as its brakes allow, and for `ceiling2` in any case. The result is
    negative where the train comes to a stand.
    """
    wanted2 = min(wanted2, ceiling2)
    v = mean_speed(math.sqrt(speed2), math.sqrt(wanted2))
    force = needed_force(cell, speed2, wanted2, v)
    if force > negligible_n:
        rise = wanted2 - speed2
        if force <= max_effort(traction, v) and rise <= 2.0 * train.max_acceleration_ms2 * cell.length_m:
            return wanted2
        return min(exit_speed2(cell, train, traction, braking, speed2, FULL_TRACTION), ceiling2)
    coasted2 = exit_speed2(cell, train, traction, braking, speed2, COAST)
    # up a hill so steep that coasting slows the train down more than it may, it takes the effort that this needs
    coasted2 = max(coasted2, speed2 - 2.0 * train.max_deceleration_ms2 * cell.length_m)
    if coasted2 > braking2:
        coasted2 = max(braking2, exit_speed2(cell, train, traction, braking, speed2, FULL_BRAKE))
    return min(coasted2, ceiling2)


@njit(cache=True, error_model="numpy")
def _drive_stretch(
    line: Stretches, stretch: int, speeds_ms: FloatArray, speed2: float, target2: FloatArray, run2: FloatArray
) -> tuple[float, float, float]:
    """Return time [s], line energy without auxiliaries [J] and last square of speed over a stretch.

    The time is infinite where the train comes to a stand. `target2` and `run2`, of shape (n + 1,), are written over.
    """
    _fill_target(line, stretch, speeds_ms[CRUISE, stretch], speeds_ms[COAST_END, stretch], target2)
    mesh = line.mesh
    train, traction, braking, drive = shared_by_cells(mesh).own
    negligible_n = negligible_effort(train.drive_kind, drive)
    # the train does not brake below its cruise
    braking2 = max(speeds_ms[BRAKING, stretch], speeds_ms[CRUISE, stretch]) ** 2
    time = energy = 0.0
    for i in range(line.borders[stretch], line.borders[stretch + 1]):
        cell = cell_at(mesh, i)
        ceiling2 = line.fastest_speed2[i + 1]
        after2 = _next_speed2(cell, train, traction, braking, speed2, target2[i + 1], braking2, ceiling2, negligible_n)
        if after2 < 0.0 or (after2 < SLOWEST2 and after2 < speed2 and after2 < ceiling2):
            return math.inf, math.inf, 0.0
        taken, duration, _ = cell_cost(cell, train, traction, braking, drive, speed2, after2)
        time += duration
        energy += taken
        speed2 = after2
        run2[i + 1] = speed2
    return time, energy, speed2


@njit(cache=True, error_model="numpy", nogil=True)
def drive_stretches(line: Stretches, speeds_ms: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the times [s] and energies [J] of stretches, shape (k,), and the squares of speed at the nodes.

    Parameters
    ----------
    line : Stretches
        The line.
    speeds_ms : array of shape (3, k)
        Cruise, speed at which coasting ends, and speed above which the train brakes, of each stretch [m/s].
    """
    k, nodes = speeds_ms.shape[1], line.fastest_speed2.shape[0]
    times, energies, run2, target2 = np.empty(k), np.empty(k), np.empty(nodes), np.empty(nodes)
    speed2 = line.fastest_speed2[0]
    run2[0] = speed2
    for j in range(k):
        times[j], energies[j], speed2 = _drive_stretch(line, j, speeds_ms, speed2, target2, run2)
        if times[j] == math.inf:
            times[j:], energies[j:] = math.inf, math.inf
            break
    return times, energies, run2


class _State(NamedTuple):
    """The current run of a descent: arrays of k stretches, and two of the nodes to write in.

    Parameters
    ----------
    entering_speed2 : array of shape (k,)
        Squares of speed at which stretches begin [m2/s2].
    cost_j : array of shape (k,)
        Energy + price x time of each [J].
    target2, run2 : array of shape (n + 1,)
        Written over by each drive.
    """

    entering_speed2: FloatArray
    cost_j: FloatArray
    target2: FloatArray
    run2: FloatArray


@njit(cache=True, error_model="numpy")
def _cost_change(
    line: Stretches, price_w: float, speeds_ms: FloatArray, stretch: int, state: _State, is_kept: bool
) -> float:
    """Return by how much the cost changes with the speeds of one stretch [J]; keep the new costs if asked."""
    change, speed2 = 0.0, state.entering_speed2[stretch]
    for j in range(stretch, speeds_ms.shape[1]):
        if j > stretch:
            before2 = state.entering_speed2[j]
            # from here on it is the run that it was
            if abs(speed2 - before2) <= SAME_SPEED2 * before2:
                break
            if is_kept:
                state.entering_speed2[j] = speed2
        time, energy, speed2 = _drive_stretch(line, j, speeds_ms, speed2, state.target2, state.run2)
        if time == math.inf:
            return math.inf
        cost = energy + price_w * time
        change += cost - state.cost_j[j]
        if is_kept:
            state.cost_j[j] = cost
    return change


@njit(cache=True, error_model="numpy", nogil=True)
def guess_speeds(line: Stretches, price_w: float) -> FloatArray:
    """Return the best speeds of a grid: one cruise for all stretches, one share of it at which coasting ends."""
    k = line.top_ms.shape[0]
    best, best_cost, tried = np.empty((3, k)), math.inf, np.empty((3, k))
    for step in range(CRUISES_TRIED, 0, -1):
        cruise = np.max(line.top_ms) * step / CRUISES_TRIED
        for part in range(COASTS_TRIED, 0, -1):
            share = MIN_COAST_SHARE + (1.0 - MIN_COAST_SHARE) * part / COASTS_TRIED
            for j in range(k):
                held = min(max(cruise, line.slowest_ms[j]), line.top_ms[j])
                tried[:, j] = line.top_ms[j]
                if line.is_free[CRUISE, j]:
                    tried[CRUISE, j] = held
                if line.is_free[COAST_END, j]:
                    tried[COAST_END, j] = max(share * held, line.slowest_ms[j])
            times, energies, _ = drive_stretches(line, tried)
            cost = np.sum(energies) + price_w * np.sum(times)
            # the fastest is the first: it always arrives
            if cost < best_cost or step == CRUISES_TRIED == part:
                best_cost, best[:] = cost, tried
    return best


@njit(cache=True, error_model="numpy", nogil=True)
def descend(line: Stretches, price_w: float, speeds_ms: FloatArray, step_ms: float) -> FloatArray:
    """Return the speeds of the least energy + price x time near other speeds; shapes (3, k).

    Parameters
    ----------
    line : Stretches
        The line.
    price_w : float
        Price of time [W].
    speeds_ms : array of shape (3, k)
        First speeds [m/s].
    step_ms : float
        First step [m/s].
    """
    best = speeds_ms.copy()
    k, nodes = best.shape[1], line.fastest_speed2.shape[0]
    times, energies, run2 = drive_stretches(line, best)
    state = _State(run2[line.borders[:-1]].copy(), energies + price_w * times, np.empty(nodes), np.empty(nodes))
    steps = np.where(line.is_free, step_ms, 0.0)
    for _ in range(MAX_SWEEPS):
        for j in range(k):
            _approach_reached(line, best, state, j)
            for row in range(3):
                if steps[row, j] >= MIN_STEP_MS:
                    _improve(line, price_w, best, state, steps, row, j)
        if np.max(steps) < MIN_STEP_MS:
            break
    return best


@njit(cache=True, error_model="numpy")
def _approach_reached(line: Stretches, speeds_ms: FloatArray, state: _State, stretch: int) -> None:
    """Move speeds that the train does not reach close to those that it does; the run stays the same."""
    first, last = line.borders[stretch], line.borders[stretch + 1]
    speed2 = state.entering_speed2[stretch]
    _, _, leaving2 = _drive_stretch(line, stretch, speeds_ms, speed2, state.target2, state.run2)
    peak2 = speed2
    for i in range(first + 1, last + 1):
        peak2 = max(peak2, state.run2[i])
    # within a cell it may be a little faster than at its ends
    reached_ms = max(math.sqrt(peak2) + BEYOND_REACHED_MS, line.slowest_ms[stretch])
    for row in (CRUISE, BRAKING):
        if line.is_free[row, stretch]:
            speeds_ms[row, stretch] = min(speeds_ms[row, stretch], reached_ms)
    # a train that coasts over the border without braking
    if line.is_free[COAST_END, stretch] and leaving2 < line.fastest_speed2[last] * (1.0 - SAME_SPEED2):
        slow_ms = math.sqrt(leaving2) - BEYOND_REACHED_MS
        speeds_ms[COAST_END, stretch] = max(speeds_ms[COAST_END, stretch], slow_ms)


@njit(cache=True, error_model="numpy")
def _improve(
    line: Stretches, price_w: float, speeds_ms: FloatArray, state: _State, steps: FloatArray, row: int, stretch: int
) -> None:
    """Move one speed to the best of three, or of the parabola through them; change its step by what was best."""
    middle, step = speeds_ms[row, stretch], steps[row, stretch]
    low, high = max(middle - step, line.slowest_ms[stretch]), min(middle + step, line.top_ms[stretch])
    best, least = middle, 0.0
    changes = np.full(2, math.inf)
    for side in range(2):
        speed = high if side else low
        if speed != middle:
            speeds_ms[row, stretch] = speed
            changes[side] = _cost_change(line, price_w, speeds_ms, stretch, state, False)
            if changes[side] < least:
                best, least = speed, changes[side]
    factor = GROWS if best != middle else SHRINKS
    if (
        max(abs(changes[0]), abs(changes[1])) <= FLAT * abs(state.cost_j[stretch])
        or changes[0] == changes[1] == math.inf
    ):
        # a speed that the train does not reach changes nothing: it is looked for further away, up to the whole range
        factor = 0.0 if low == line.slowest_ms[stretch] and high == line.top_ms[stretch] else FLAT_GROWS
    left, right = middle - low, high - middle
    # vertex of Lagrange's parabola whose value in the middle is 0
    slopes = changes[0] * right * right - changes[1] * left * left
    curvature = changes[0] * right + changes[1] * left
    if math.isfinite(slopes) and curvature > 0.0:
        vertex = min(max(middle + 0.5 * slopes / curvature, low), high)
        if vertex not in (low, middle, high):
            speeds_ms[row, stretch] = vertex
            change = _cost_change(line, price_w, speeds_ms, stretch, state, False)
            if change < least:
                best, least, factor = vertex, change, SHRINKS if abs(vertex - middle) < 0.5 * step else 1.0
    speeds_ms[row, stretch] = best
    steps[row, stretch] = step * factor
    if best != middle:
        _cost_change(line, price_w, speeds_ms, stretch, state, True)
