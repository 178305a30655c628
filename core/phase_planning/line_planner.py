"""Plan one start / cruise / coast / brake cycle per stretch of a line, with one price of time for all of them.

The higher the price of time, the faster the best run. A search brackets the price whose run takes the running time;
between the two runs of the bracket all speeds are interpolated until the time is met. The compiled search for the
speeds at one price is in `railjoule.core.phase_planning.stretches`.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.errors import StrategyRefusedError, TimetableError
from railjoule.core.motion import MeshedLine, max_speeds
from railjoule.core.motion.passes import MOVED
from railjoule.core.phase_planning.plan import best_plan
from railjoule.core.phase_planning.planner import (
    ACCURACY,
    CURRENTS_SCANNED,
    MIN_CURRENT_FRACTION,
    ON_TIME,
    PhasePlanner,
)
from railjoule.core.phase_planning.stretches import Stretches, descend, drive_stretches, guess_speeds
from railjoule.core.phase_planning.tables import phase_model
from railjoule.core.physics.effort_limit import SLOWEST_MS, fitted_limit, table_speeds
from railjoule.core.physics.mesh_data import MeshData
from railjoule.core.scenario.options import PhasesOptions
from railjoule.core.scenario.scenario import Scenario

# Limits of neighbouring cells that differ by a smaller share are one limit
SAME_LIMIT = 1e-9
# The slowest cruise over the highest speed of a stretch
SLOWEST_SHARE = 0.02
# First steps of the descent [m/s]: from the grid, and from the best run of another price
FIRST_STEP_MS, NEXT_STEP_MS = 1.5, 0.4
# A bracket of the price grows by this factor; beyond its range the fastest or slowest run takes the place of a best one
PRICE_FACTOR, PRICE_RANGE = 4.0, 1e4
# The bracket is narrow enough where its two runs differ by this share of the running time
NARROW = 2e-3
# So close, two prices lie at a jump of the time from one local optimum to another
SAME_PRICE = 1e-2
MAX_PRICES = 24
# An interpolation between the prices of a bracket stays away from its ends by this share
INSIDE = 0.3
# Halvings of an interval of doubles down to neighbouring numbers
HALVINGS = 53


@dataclass(frozen=True, eq=False)
class LinePlan:
    """One cycle per stretch of a line.

    Parameters
    ----------
    border_m : array of shape (k + 1,)
        Places where stretches begin, and the end of the line [m].
    speeds_ms : array of shape (3, k)
        Cruise, speed at which coasting ends, and speed above which the train brakes, as planned [m/s].
    running_time_s, energy_j : float
        Time [s] and line energy without auxiliaries [J] of all stretches.
    speed2 : array of shape (n + 1,)
        Squares of speed at the nodes [m2/s2].
    price_of_time_w : float or None
        Energy that a second more of running time saves, without auxiliaries [J/s].
    starting_current_a : float or None
        Largest driving current of a motor [A]; that of the drive where None.
    """

    border_m: FloatArray
    speeds_ms: FloatArray
    running_time_s: float
    energy_j: float
    speed2: FloatArray
    price_of_time_w: float | None
    starting_current_a: float | None = None


NO_PLAN = LinePlan(np.zeros(0), np.zeros((3, 0)), 0.0, math.inf, np.zeros(0), None)
"""The plan at a starting current with which there is no run."""


@dataclass(frozen=True, eq=False)
class LinePlanner:
    """Plans runs of one train over a line with several limits and gradients.

    Parameters
    ----------
    mesh : MeshedLine
        The train and its line.
    stretches : Stretches
        The line as the compiled search takes it.
    """

    mesh: MeshedLine
    stretches: Stretches

    def plan(self, running_time_s: float) -> LinePlan | None:
        """Return the run of least energy in a time [s]; None if no run of these phases takes so long or so short."""
        fastest = self.drive(self.fastest_speeds_ms)
        if running_time_s < fastest.running_time_s * (1 - ON_TIME):
            return None
        if running_time_s <= fastest.running_time_s * (1 + ON_TIME):
            return fastest
        bracket = self._bracket(running_time_s, fastest)
        return None if bracket is None else self._in_time(running_time_s, *bracket)

    def drive(self, speeds_ms: FloatArray, price_w: float | None = None) -> LinePlan:
        """Return the run with given speeds of all stretches; shape (3, k) [m/s]."""
        times, energies, speed2 = drive_stretches(self.stretches, speeds_ms)
        border, totals = self.mesh.position_m[self.stretches.borders], (float(times.sum()), float(energies.sum()))
        return LinePlan(border, speeds_ms, *totals, frozen_array(speed2), price_w)

    @property
    def fastest_speeds_ms(self) -> FloatArray:
        """Speeds of the fastest run; shape (3, k) [m/s]."""
        return np.tile(self.stretches.top_ms, (3, 1))

    @property
    def slowest_speeds_ms(self) -> FloatArray:
        """Speeds of the slowest run that the options allow; shape (3, k) [m/s]."""
        return np.where(self.stretches.is_free, self.stretches.slowest_ms, self.stretches.top_ms)

    def _bracket(self, running_time_s: float, fastest: LinePlan) -> tuple[LinePlan, LinePlan] | None:
        """Return the best runs at two prices, the first too late, the second in time; None if none is too late."""
        kinetic = self.mesh.data.half_inertia_kg * (self.mesh.length_m / running_time_s) ** 2
        first = price = kinetic / running_time_s
        early, late = fastest, self.drive(self.slowest_speeds_ms, 0.0)
        if late.running_time_s < running_time_s:
            return None
        prices = [0.0, math.inf]
        for _ in range(MAX_PRICES):
            # each price begins at the cheapest of three runs, so that no local optimum of another price is followed
            guess = self.drive(guess_speeds(self.stretches, price))
            start = min((guess, late, early), key=lambda run: run.energy_j + price * run.running_time_s)
            step = FIRST_STEP_MS if start is guess else NEXT_STEP_MS
            found = self.drive(descend(self.stretches, price, start.speeds_ms, step), price)
            is_late = found.running_time_s > running_time_s
            late, early = (found, early) if is_late else (late, found)
            prices[not is_late] = price
            if late.running_time_s - early.running_time_s <= NARROW * running_time_s:
                break
            if prices[1] <= (1 + SAME_PRICE) * prices[0]:
                break
            if not first / PRICE_RANGE < price < first * PRICE_RANGE:
                break
            if prices[0] == 0.0:
                price /= PRICE_FACTOR
            elif prices[1] == math.inf:
                price *= PRICE_FACTOR
            else:
                share = (late.running_time_s - running_time_s) / (late.running_time_s - early.running_time_s)
                share = min(max(share, INSIDE), 1 - INSIDE)
                price = prices[0] ** (1 - share) * prices[1] ** share
        return late, early

    def _in_time(self, running_time_s: float, late: LinePlan, early: LinePlan) -> LinePlan:
        """Return the run between two others that takes a time [s].

        The speeds change from those of the late run to those of the early one, one after another: so only one of them
        lies between two values that are best.
        """
        price = late.price_of_time_w or early.price_of_time_w
        speeds, run = late.speeds_ms, early
        for place in np.ndindex(speeds.shape):
            faster = speeds.copy()
            faster[place] = early.speeds_ms[place]
            if self.drive(faster).running_time_s <= running_time_s:
                run = self._bisect(running_time_s, speeds, faster)
                break
            speeds = faster
        # the time may jump over the one asked for where a coasting curve ends in a hill: another speed takes it up
        for place in np.ndindex(speeds.shape):
            if run.running_time_s >= running_time_s * (1 - ON_TIME):
                break
            slower = run.speeds_ms.copy()
            slower[place] = self.slowest_speeds_ms[place]
            if self.drive(slower).running_time_s > running_time_s:
                run = self._bisect(running_time_s, slower, run.speeds_ms)
        return replace(run, price_of_time_w=price)

    def _bisect(self, running_time_s: float, slow_ms: FloatArray, fast_ms: FloatArray) -> LinePlan:
        """Return the slowest run in time [s] between speeds that are too slow and speeds that are not."""
        # bisection, as a run that comes to a stand has an infinite time
        for _ in range(HALVINGS):
            middle = 0.5 * (slow_ms + fast_ms)
            is_late = self.drive(middle).running_time_s > running_time_s
            slow_ms, fast_ms = (middle, fast_ms) if is_late else (slow_ms, middle)
        return self.drive(fast_ms)


def plan_line(scenario: Scenario, mesh: MeshedLine, running_time_s: float) -> LinePlan:
    """Return the best run in phases over a line with several limits or gradients.

    Parameters
    ----------
    scenario : Scenario
        The vehicle and the options of the strategy.
    mesh : MeshedLine
        The line.
    running_time_s : float
        Running time, without dwells [s].

    Raises
    ------
    TimetableError
        If the fastest run of these phases takes longer.
    StrategyRefusedError
        If no run of these phases takes so long, or an option needs a plain line or another drive.
    """
    options, vehicle = scenario.phases, scenario.vehicle
    if options.cycles > 1:
        raise StrategyRefusedError(
            f"needs phases.cycles = 1, not {options.cycles}, on a line whose limit, gradient or curve changes."
        )
    # for its checks of the starting current
    planner = PhasePlanner(phase_model(vehicle, 0.0, float(np.max(mesh.cell_limit_ms))), options)
    if not options.free_starting_current:
        return _plan_with_current(scenario, mesh, running_time_s, options.starting_current_a)
    largest = planner.largest_current_a
    assert largest is not None

    def plan_at(current_a: float) -> LinePlan:
        try:
            return _plan_with_current(scenario, mesh, running_time_s, current_a)
        except (StrategyRefusedError, TimetableError):
            return NO_PLAN

    best = best_plan(plan_at, MIN_CURRENT_FRACTION * largest, largest, CURRENTS_SCANNED, ACCURACY)
    return best if np.isfinite(best.energy_j) else _plan_with_current(scenario, mesh, running_time_s, None)


def _plan_with_current(
    scenario: Scenario, mesh: MeshedLine, running_time_s: float, current_a: float | None
) -> LinePlan:
    """Return the best run with a largest driving current [A]; errors as `plan_line`."""
    min_s = math.inf
    for planner in _planners(scenario, mesh, current_a):
        fastest = planner.drive(planner.fastest_speeds_ms).running_time_s
        min_s = min(fastest, min_s)
        plan = planner.plan(running_time_s)
        if plan is not None:
            return replace(plan, starting_current_a=current_a)
    if min_s > running_time_s:
        raise TimetableError(running_time_s, min_s)
    raise StrategyRefusedError(f"has no run of {running_time_s:.1f} s with these phases.")


def _planners(scenario: Scenario, mesh: MeshedLine, current_a: float | None) -> Iterator[LinePlanner]:
    """Yield planners in order of preference: with electric brakes, then with all brakes."""
    data = mesh.data if current_a is None else _with_current(mesh, current_a)
    brakes = [data]
    if scenario.vehicle.braking.max_effort_kn != 0 and data.friction_effort_n > 0:
        brakes.insert(0, data._replace(friction_effort_n=0.0))
    for braked in brakes:
        greatest2, obstacle, _ = max_speeds(braked)
        if obstacle == MOVED:
            yield LinePlanner(mesh, cut_line(mesh, braked, greatest2, scenario.phases))


def _with_current(mesh: MeshedLine, current_a: float) -> MeshData:
    """Return the data of a meshed line whose motors drive with a current at most [A]."""
    full, drive = mesh.data.traction, mesh.drive
    top = float(np.max(mesh.cell_limit_ms))

    def limit_n(speed_ms: FloatArray) -> FloatArray:
        speed = np.maximum(speed_ms, SLOWEST_MS)
        return np.minimum(full.effort_n(speed), drive.effort_at_current_n(current_a, speed))

    constant = float(np.max(limit_n(table_speeds(top))))
    return mesh.data._replace(traction=fitted_limit(constant, limit_n, top, drive.limit_corners_ms(False)))


def cut_line(mesh: MeshedLine, data: MeshData, fastest_speed2: FloatArray, options: PhasesOptions) -> Stretches:
    """Return a line cut where its limit changes and where the train stops.

    Parameters
    ----------
    mesh : MeshedLine
        The line.
    data : MeshData
        Its data with the brakes of the plan.
    fastest_speed2 : array of shape (n + 1,)
        The fastest run with them [m2/s2].
    options : PhasesOptions
        The runs to choose from.
    """
    limit = mesh.cell_limit_ms
    changes = np.abs(np.diff(limit)) > SAME_LIMIT * np.max(limit)
    inner = np.flatnonzero(changes | (data.fixed_speed2[1:-1] >= 0)) + 1
    borders = np.concatenate([[0], inner, [mesh.cell_count]]).astype(np.int64)
    top = limit[borders[:-1]]
    # a train that coasts gains speed somewhere, or the run begins in motion
    brakes = np.minimum.reduceat(data.resistance_constant_n + data.line_force_n, borders[:-1]) < 0
    brakes[0] |= fastest_speed2[0] > 0
    is_free = np.array([np.full(len(top), options.cruise), np.full(len(top), options.coast), brakes])
    return Stretches(data, borders, fastest_speed2, SLOWEST_SHARE * top, top, is_free)
