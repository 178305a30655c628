"""Decisions that keep a drive on or off for a minimum time: backward induction that remembers what the drive does.

Beside the speed, a state holds what the drive does (off, driving, braking) and for how many cells it still has to, see
`memory`. How many cells a stretch lasts at least follows from the times of the run that the grid is laid around, to the
nearest cell. With no minimum time, states hold no more than the speed and what the drive does.

The result is a decision to be solved and no run: forward, speeds are carried from grid point to grid point.
"""

import math

import numpy as np

from railjoule.core.arrays import FloatArray, IntArray
from railjoule.core.compiled import njit
from railjoule.core.drive.kernels import has_standstill_brake
from railjoule.core.dynamic_programming.backward import Steps, band_of_speeds, tabulate_steps
from railjoule.core.dynamic_programming.memory import Memory, on_off_memory
from railjoule.core.dynamic_programming.power_table import tabulate_powers
from railjoule.core.dynamic_programming.search import TINY, log_price_range, meeting_prices, price_scale_w
from railjoule.core.physics.course_data import BRAKING, DRIVING, OFF, CourseData
from railjoule.core.physics.stretches import BRAKES, DRIVES, NEUTRAL_SECTION, actions_of_run, least_cells

# A kernel's table grows with them. More than so many come where cells are short, next to stops, where a train that
# starts or brakes stays as it is anyway
MOST_BOUND_CELLS = 32
"""For how many cells a stretch is held to last, at most."""
# The decision's own solution meets the time: only what it does where has to be about right
TIME_TOLERANCE = 1e-2
"""How close to the running time a decision's run must come to end the search for its price, as a share of it."""
MOST_LATE = 2.0
"""A run that ends early counts as taking this many running times, so that the bracket stays finite."""


@njit(cache=True, error_model="numpy", nogil=True)
def sweep_back_labels(steps: Steps, grid: FloatArray, price: float, memory: Memory) -> IntArray:
    """Return the cheapest steps from all states, an array of shape (nodes - 1, points, labels); -1 where there is none.

    Parameters
    ----------
    steps : Steps
        As tabulated, with the action of each.
    grid : array of shape (nodes, points)
        Squares of speed [m2/s2].
    price : float
        Cost of a second, auxiliaries included [J/s].
    memory : Memory
        Labels of the states.
    """
    nodes, points = grid.shape
    _, labels, actions = memory.moves.shape
    policy = np.full((nodes - 1, points, labels), -1, dtype=np.int32)
    onward, here = np.zeros((points, labels)), np.empty((points, labels))
    least, best = np.empty(labels), np.empty(labels, dtype=np.int64)
    for i in range(nodes - 2, -1, -1):
        first, end, moves = memory.first[i], memory.end[i], memory.moves[i]
        first_before, end_before = memory.first[max(i - 1, 0)], memory.end[max(i - 1, 0)]
        for k in range(points):
            if k > 0 and grid[i, 0] == grid[i, points - 1]:
                # only the first of the equal points of a fixed speed has steps
                policy[i, k], here[k] = policy[i, 0], here[0]
                continue
            least[:] = np.inf
            for step in range(steps.first[i, k], steps.first[i, k + 1]):
                if steps.energy_j[step] == np.inf:
                    continue
                cost, action = steps.energy_j[step] + price * steps.time_s[step], steps.action[step]
                lower, weight = steps.lower[step], steps.weight[step]
                for label in range(first[action], end[action]):
                    total = cost + _between(onward, lower, weight, label)
                    if total < least[label]:
                        least[label], best[label] = total, step
            here[k] = np.inf
            for before in range(actions):
                # the cell before leads to no other labels
                for label in range(first_before[before], end_before[before]):
                    for action in range(actions):
                        after = moves[label, action]
                        if after >= 0 and least[after] < here[k, label]:
                            here[k, label], policy[i, k, label] = least[after], best[after]
        onward, here = here, onward
    return policy


@njit(cache=True, error_model="numpy")
def _between(rows: FloatArray, lower: int, weight: float, label: int) -> float:
    below: float = rows[lower, label]
    above: float = rows[lower + 1, label]
    # 0 x infinity is no number: a point itself does not depend on its neighbour
    if weight <= 0.0:
        return below
    if weight >= 1.0:
        return above
    return below + weight * (above - below) if max(below, above) < np.inf else np.inf


@njit(cache=True, error_model="numpy")
def _nearest(row: FloatArray, speed2: float, policy: IntArray) -> int:
    """Return the point of a row closest to a square of speed from which a step leads on; -1 if there is none."""
    found, distance = -1, math.inf
    for k in range(row.shape[0]):
        if policy[k] >= 0 and abs(row[k] - speed2) < distance:
            found, distance = k, abs(row[k] - speed2)
    return found


@njit(cache=True, error_model="numpy", nogil=True)
def follow(
    steps: Steps, grid: FloatArray, policy: IntArray, memory: Memory, has_standstill_brake: bool
) -> tuple[FloatArray, float]:
    """Return the decision of a policy, an array of shape (n,), and about its time [s], infinite if it ends early."""
    nodes = grid.shape[0]
    decision, time = np.full(nodes - 1, OFF), 0.0
    speed2, label = grid[0, 0], 0
    for i in range(nodes - 1):
        k = _nearest(grid[i], speed2, policy[i, :, label])
        if k < 0:
            return decision, math.inf
        step = policy[i, k, label]
        action = steps.action[step]
        if action == DRIVES:
            decision[i] = DRIVING
        elif action == BRAKES and not (has_standstill_brake and steps.energy_j[step] >= 0.0):
            decision[i] = BRAKING
        time, label = time + steps.time_s[step], memory.moves[i, label, action]
        # as far from a grid point as before: rounding to the nearest would change the time
        speed2 = steps.leaving_speed2[step] + speed2 - grid[i, k]
        speed2 = min(max(speed2, grid[i + 1, 0]), grid[i + 1, -1])
    return decision, time


class OnOffBand:
    """A band of speeds around a run, and the decisions in it that keep a minimum on/off time.

    Parameters
    ----------
    course : CourseData
        The line and the train.
    greatest_speed2, centre_speed2 : array of shape (nodes,)
        Greatest feasible squares of speed, and those in the middle of the band [m2/s2].
    time_s, least_on_off_s : float
        Running time allowed, and for how long the drive stays as it is at least [s].
    half_width_share, points : float and int
        Half of the width of the band over the top speed, and how many speeds each node has.
    """

    def __init__(
        self,
        course: CourseData,
        greatest_speed2: FloatArray,
        time_s: float,
        centre_speed2: FloatArray,
        least_on_off_s: float,
        half_width_share: float,
        points: int,
    ) -> None:
        self.course, self.time_s = course, time_s
        done = actions_of_run(course, centre_speed2)
        lasting = np.minimum(least_cells(done.duration_s, least_on_off_s), MOST_BOUND_CELLS)
        lasting[done.interrupted_by == NEUTRAL_SECTION] = 1
        self.memory = on_off_memory(lasting, done.interrupted_by)
        half_width_ms = half_width_share * math.sqrt(greatest_speed2.max())
        self.grid = band_of_speeds(course, greatest_speed2, centre_speed2, half_width_ms, points)
        self.steps = tabulate_steps(course, self.grid, tabulate_powers(course))
        self.has_standstill_brake = bool(has_standstill_brake(course.drive_kind, course.drive_parameters))
        self.found: dict[float, tuple[FloatArray, float]] = {}

    def decisions(self, price_w: float, factor: float) -> tuple[list[FloatArray], float]:
        """Return the decisions of the runs that bracket the timetable, and the price of the more punctual one [J/s].

        There are two decisions, the more punctual one first, or one, or none where the band holds no such run: arrays
        of shape (n,) of DRIVING, BRAKING or OFF of `course_data`.

        Parameters
        ----------
        price_w, factor : float
            First price of a second, auxiliaries included [J/s], and the factor by which its bracket widens.
        """
        first = math.log(max(price_w, TINY))
        # a band that no run passes at one price holds none at another
        if not self._has_run(first):
            return [], price_w
        prices = log_price_range(self.course, price_scale_w(self.course, self.time_s))
        pair = meeting_prices(self._lateness_s, first, factor, prices, TIME_TOLERANCE * self.time_s)
        closest = sorted(dict.fromkeys(pair), key=lambda price: abs(self._lateness_s(price)))
        return [self.found[price][0] for price in closest if self._has_run(price)], math.exp(closest[0])

    @property
    def sweeps(self) -> int:
        """How many backward inductions it took so far."""
        return len(self.found)

    def _lateness_s(self, log_price: float) -> float:
        """Return by how much a decision's run is late at a price [s], less than once the running time."""
        if log_price not in self.found:
            policy = sweep_back_labels(self.steps, self.grid, math.exp(log_price), self.memory)
            given = self.steps, self.grid, policy, self.memory, self.has_standstill_brake
            self.found[log_price] = follow(*given)
        return min(self.found[log_price][1], MOST_LATE * self.time_s) - self.time_s

    def _has_run(self, log_price: float) -> bool:
        """Return whether a run reaches the end at a price."""
        return self._lateness_s(log_price) < (MOST_LATE - 1.0) * self.time_s
