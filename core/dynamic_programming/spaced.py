"""Decisions whose switchings lie apart: backward induction that knows for how long the drive must stay as it is.

Beside the speed, a state holds what the drive does (off, driving, braking) and for how many cells it still has to. The
steps are those of any other sweep, each of which does one of the three, so that a state costs no step of its own: the
least cost over the steps of each kind is found once for each number of cells still bound, and whoever is free to switch
takes the cheapest kind. How many cells a stretch lasts at least follows from the times of the run that the grid is laid
around, to the nearest cell.

What comes out is a decision to be solved, no run: forward, speeds are carried from grid point to grid point.
"""

import math
from typing import NamedTuple

import numpy as np

from railjoule.core.arrays import FloatArray, IntArray
from railjoule.core.compiled import njit
from railjoule.core.drive.kernels import has_standstill_brake
from railjoule.core.dynamic_programming.backward import Steps, band_of_speeds, cost_between, tabulate_steps
from railjoule.core.dynamic_programming.search import TINY, log_price_range, meeting_prices, price_scale_w
from railjoule.core.physics.account import account_of_cell
from railjoule.core.physics.course_data import OFF, CourseData, cell_of, shared_by_cells
from railjoule.core.physics.stretches import (
    ACTIONS,
    NEUTRAL_SECTION,
    NOTHING,
    STOP,
    action_of_cell,
    actions_of_run,
    least_cells,
)

# A kernel's table grows with them. More than so many come where cells are short, next to stops, where a train that
# starts or brakes stays as it is anyway
MOST_BOUND_CELLS = 32
"""For how many cells a stretch is held to last, at most."""
# The decision's own solution meets the time: only what it does where has to be about right
TIME_TOLERANCE = 1e-3
"""How close to the running time a decision's run must come to end the search for its price, as a share of it."""
MOST_LATE = 2.0
"""Over the running time: what a run that gets nowhere counts as."""
PRICE_FACTOR = 1.2
"""By how much the bracket of the price first widens."""


class StepActions(NamedTuple):
    """What the drive does in each step, as `action_of_cell` counts and as a decision says it; arrays of shape (s,)."""

    action: IntArray
    machines: FloatArray


@njit(cache=True, error_model="numpy", nogil=True)
def actions_of_steps(course: CourseData, grid: FloatArray, steps: Steps) -> StepActions:
    """Return what the drive does in each of the steps of a grid of speeds."""
    nodes, points = grid.shape
    action = np.zeros(steps.lower.shape[0], dtype=np.int64)
    machines = np.full(steps.lower.shape[0], OFF)
    train, traction, braking, drive = shared_by_cells(course)
    another = has_standstill_brake(course.drive_kind, course.drive_parameters)
    for i in range(nodes - 1):
        cell = cell_of(course, i)
        for k in range(points):
            for step in range(steps.first[i, k], steps.first[i, k + 1]):
                if steps.energy_j[step] < np.inf:
                    leaving = steps.leaving_speed2[step]
                    account = account_of_cell(cell, train, traction, braking, drive, grid[i, k], leaving)
                    action[step], machines[step] = action_of_cell(account, traction, another)
    return StepActions(action, machines)


class Policy(NamedTuple):
    """What is cheapest from each state on; r is the number of cells that a stretch may be bound to last.

    Parameters
    ----------
    best : array of shape (nodes - 1, points, 3, r)
        The cheapest step of each action with so many cells bound after it; -1 where there is none.
    action : array of shape (nodes - 1, points, 3)
        What to do where nothing is bound, by what was done.
    """

    best: IntArray
    action: IntArray


@njit(cache=True, error_model="numpy")
def _cheapest_by_action(
    steps: Steps,
    action: IntArray,
    place: tuple[int, int],
    price: float,
    onward: FloatArray,
    least: FloatArray,
    best: IntArray,
) -> None:
    """Write the least cost of each action and number of bound cells into `least`, and the steps that have it."""
    least[:] = np.inf
    for step in range(steps.first[place], steps.first[place[0], place[1] + 1]):
        if steps.energy_j[step] == np.inf:
            continue
        cost, does = steps.energy_j[step] + price * steps.time_s[step], action[step]
        for bound in range(least.shape[1]):
            total = cost + cost_between(onward[does, bound], steps.lower[step], steps.weight[step])
            if total < least[does, bound]:
                least[does, bound], best[does, bound] = total, step


@njit(cache=True, error_model="numpy", nogil=True)
def sweep_back_spaced(
    steps: Steps, action: IntArray, grid: FloatArray, price: float, lasting: IntArray, interrupted_by: IntArray
) -> Policy:
    """Return the cheapest policy whose stretches last.

    Parameters
    ----------
    steps, action : Steps and array of shape (s,)
        As tabulated, and what the drive does in each.
    grid : array of shape (nodes, points)
        Squares of speed [m2/s2].
    price : float
        Cost of a second, auxiliaries included [J/s].
    lasting : array of shape (nodes - 1,)
        How many cells a stretch lasts at least that begins with a cell.
    interrupted_by : array of shape (nodes - 1,)
        What interrupts the drive before each cell, so that nothing is bound there.
    """
    nodes, points = grid.shape
    most = int(lasting.max())
    best = np.full((nodes - 1, points, ACTIONS, most), -1, dtype=np.int64)
    policy = np.zeros((nodes - 1, points, ACTIONS), dtype=np.int64)
    onward, here = np.zeros((ACTIONS, most, points)), np.empty((ACTIONS, most, points))
    least = np.empty((ACTIONS, most))
    for i in range(nodes - 2, -1, -1):
        # a stretch that begins here has this cell behind it when the next node is reached
        bound = lasting[i] - 1
        is_free = interrupted_by[i] != NOTHING
        for k in range(points):
            if k > 0 and grid[i, 0] == grid[i, points - 1]:
                # only the first of the equal points of a fixed speed has steps
                best[i, k], policy[i, k], here[:, :, k] = best[i, 0], policy[i, 0], here[:, :, 0]
                continue
            _cheapest_by_action(steps, action, (i, k), price, onward, least, best[i, k])
            cheapest = int(np.argmin(least[:, bound]))
            for before in range(ACTIONS):
                goes_on = not is_free and least[before, 0] <= least[cheapest, bound]
                policy[i, k, before] = before if goes_on else cheapest
                here[before, 0, k] = least[before, 0] if goes_on else least[cheapest, bound]
                for cells in range(1, most):
                    here[before, cells, k] = least[cheapest, bound] if is_free else least[before, cells - 1]
        onward, here = here, onward
    return Policy(best, policy)


@njit(cache=True, error_model="numpy")
def _nearest(row: FloatArray, speed2: float, best: IntArray) -> int:
    """Return the point of a row closest to a square of speed from which a step leads on; -1 if there is none."""
    found, distance = -1, math.inf
    for k in range(row.shape[0]):
        if best[k] >= 0 and abs(row[k] - speed2) < distance:
            found, distance = k, abs(row[k] - speed2)
    return found


@njit(cache=True, error_model="numpy")
def _begins_at(row: FloatArray, speed2: float, best: IntArray, does: int, interrupted_by: int) -> int:
    """Return the point of a row at which to ask what to do; -1 if there is none.

    `best` is that of `Policy` for the row, and `does` what the drive has done so far.
    """
    if interrupted_by == STOP:
        return 0
    found = _nearest(row, speed2, best[:, does, 0])
    if interrupted_by == NEUTRAL_SECTION:
        # what was done before may not be possible any more
        for another in range(ACTIONS):
            k = _nearest(row, speed2, best[:, another, 0])
            if k >= 0 and (found < 0 or abs(row[k] - speed2) < abs(row[found] - speed2)):
                found = k
    return found


@njit(cache=True, error_model="numpy", nogil=True)
def follow(
    steps: Steps, actions: StepActions, grid: FloatArray, policy: Policy, lasting: IntArray, interrupted_by: IntArray
) -> tuple[FloatArray, float]:
    """Return the decision of a policy, an array of shape (nodes - 1,), and about its time [s], infinite if it ends.

    Parameters are those of `sweep_back_spaced`.
    """
    nodes = grid.shape[0]
    decision, time = np.full(nodes - 1, OFF), 0.0
    speed2, does, bound = grid[0, 0], 0, 0
    for i in range(nodes - 1):
        row, is_free = grid[i], interrupted_by[i] != NOTHING
        if bound == 0 or is_free:
            k = _begins_at(row, speed2, policy.best[i], does, interrupted_by[i])
            chosen = policy.action[i, max(k, 0), does]
            bound = lasting[i] if is_free or chosen != does else 1
            does = chosen
        bound -= 1
        k = _nearest(row, speed2, policy.best[i, :, does, bound])
        if k < 0:
            return decision, math.inf
        step = policy.best[i, k, does, bound]
        decision[i], time = actions.machines[step], time + steps.time_s[step]
        # as far from a grid point as before: rounding to the nearest would change the time
        speed2 = steps.leaving_speed2[step] + speed2 - row[k]
        speed2 = min(max(speed2, grid[i + 1, 0]), grid[i + 1, -1])
    return decision, time


def spaced_decisions(
    course: CourseData,
    greatest_speed2: FloatArray,
    time_s: float,
    centre_speed2: FloatArray,
    price_w: float,
    half_width_ms: float,
    points: int,
    least_switching_s: float,
) -> tuple[list[FloatArray], int]:
    """Return what the drive does in runs near another one that switch seldom enough, and the number of sweeps.

    There are two, of the prices between which the runs meet the timetable, the one closer to it first, or one, or none
    where the band holds no such run; each an array of shape (n,) of DRIVING, BRAKING or OFF of `course_data`.

    Parameters
    ----------
    course : CourseData
        What the run obeys.
    greatest_speed2, centre_speed2 : array of shape (nodes,)
        Greatest feasible squares of speed, and those in the middle of the band [m2/s2].
    time_s, least_switching_s : float
        Running time allowed, and for how long the drive stays as it is at least [s].
    price_w : float
        About what a second costs, auxiliaries included [J/s].
    half_width_ms, points : float and int
        Half of the width of the band [m/s], and how many speeds each node has.
    """
    grid = band_of_speeds(course, greatest_speed2, centre_speed2, half_width_ms, points)
    steps = tabulate_steps(course, grid)
    actions = actions_of_steps(course, grid, steps)
    done = actions_of_run(course, centre_speed2)
    lasting = np.minimum(least_cells(done.duration_s, least_switching_s), MOST_BOUND_CELLS)
    lasting[done.interrupted_by == NEUTRAL_SECTION] = 1
    found: dict[float, tuple[FloatArray, float]] = {}

    def lateness_s(log_price: float) -> float:
        if log_price not in found:
            policy = sweep_back_spaced(steps, actions.action, grid, math.exp(log_price), lasting, done.interrupted_by)
            found[log_price] = follow(steps, actions, grid, policy, lasting, done.interrupted_by)
        # what gets nowhere is late, by no more than a bracket can be drawn with
        return min(found[log_price][1], MOST_LATE * time_s) - time_s

    first = math.log(max(price_w, TINY))
    prices = log_price_range(course, price_scale_w(course, time_s))
    if lateness_s(first) >= (MOST_LATE - 1.0) * time_s:
        # a band that no run passes at one price holds none at another
        return [], 1
    pair = meeting_prices(lateness_s, first, PRICE_FACTOR, prices, TIME_TOLERANCE * time_s)
    closest = sorted(dict.fromkeys(pair), key=lambda price: abs(lateness_s(price)))
    return [found[price][0] for price in closest if found[price][1] < math.inf], len(found)
