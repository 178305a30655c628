"""Plan start / cruise / coast / brake runs: one part, several parts with their time divided, from rest or in motion.

Source: Rawicki, (44)-(55): the parts j = 1 to K of a ride have lengths L(j), and times T(j) that sum to the time of the
ride. What a second costs is alike in all parts of the best division.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq, minimize_scalar

from railjoule.core.arrays import FloatArray
from railjoule.core.errors import StrategyRefusedError, TimetableError
from railjoule.core.phase_planning.choice import best_plan, equally_priced
from railjoule.core.phase_planning.plan import FIRST_PHASES, PhasePlan, PlannedPhase
from railjoule.core.phase_planning.search import START, between, search_run
from railjoule.core.phase_planning.tables import PhaseModel, start_table
from railjoule.core.scenario.options import PhasesOptions

BOTTOM_SHARES = (0.4, 0.995)
LEAST_CURRENT_SHARE = 0.15
CURRENTS, SHARES = 7, 9
CURRENT_ACCURACY, SHARE_ACCURACY = 0.004, 0.004
TIMES_A_PART = 25
TWO, DIVISION_ACCURACY = 2, 1e-4
ON_TIME = 1e-9
NO_PHASE = 1e-6


@dataclass(frozen=True, eq=False)
class PhasePlanner:
    """Plans runs of one train over a line without changes.

    Parameters
    ----------
    model : PhaseModel
        The train with its tables.
    options : PhasesOptions
        Which runs it chooses from.
    """

    model: PhaseModel
    options: PhasesOptions

    def __post_init__(self) -> None:
        largest = self.largest_current_a
        current = self.options.starting_current_a
        if largest is None and (current is not None or self.options.free_starting_current):
            raise StrategyRefusedError("needs a drive with a motor current to start with less than the largest.")
        if largest is not None and current is not None and current > largest * (1 + 1e-9):
            raise StrategyRefusedError(
                f"needs phases.starting_current_a = {current:g} to be at most the {largest:.5g} A of the drive."
            )

    @property
    def largest_current_a(self) -> float | None:
        """Current of a full start from rest [A], if the drive's model has one."""
        rest = np.zeros(1)
        current = self.model.drive.current_a(self.model.starting_effort_n(rest), rest)
        return None if current is None else float(current[0])

    def plan(
        self,
        distance_m: float,
        running_time_s: float,
        initial_speed_ms: float = 0.0,
        final_speed_ms: float = 0.0,
    ) -> PhasePlan:
        """Return the run of least energy over a distance [m] in a time [s].

        Parameters
        ----------
        distance_m, running_time_s : float
            What is left of way [m] and time [s].
        initial_speed_ms, final_speed_ms : float
            Speeds at the ends [m/s]; in motion the run may start, coast or brake first.

        Raises
        ------
        TimetableError
            If even the fastest run takes longer; `fastest` is what remains then.
        StrategyRefusedError
            If the brakes do not stop the train on its way, or the options leave no run that takes so long.
        """
        fastest = self.fastest(distance_m, initial_speed_ms, final_speed_ms)
        if running_time_s < fastest.running_time_s * (1 - ON_TIME):
            raise TimetableError(running_time_s, fastest.running_time_s)
        if running_time_s <= fastest.running_time_s * (1 + ON_TIME):
            return fastest
        task = np.array([distance_m, running_time_s, initial_speed_ms, final_speed_ms])
        plan = self._best(task)
        if not np.isfinite(plan.energy_j):
            raise StrategyRefusedError(f"has no run of {running_time_s:.1f} s with these phases.")
        return plan

    def fastest(self, distance_m: float, initial_speed_ms: float = 0.0, final_speed_ms: float = 0.0) -> PhasePlan:
        """Return the fastest run: start, the top speed where it is reached, brake; errors as `plan`."""
        current = self.options.starting_current_a
        start, brake = self._start(current), self.model.braking
        top = min(start[0, -1], self.model.top_speed_ms)
        least = max(initial_speed_ms, final_speed_ms)

        def way(speed: float) -> float:
            return between(start, initial_speed_ms, speed)[1] + between(brake, final_speed_ms, speed)[1]

        if least > top * (1 + 1e-9):
            raise StrategyRefusedError(f"needs speeds at the ends of at most {3.6 * top:.1f} km/h.")
        if way(min(least, top)) > distance_m * (1 + 1e-9):
            raise StrategyRefusedError(
                f"needs {way(least):.0f} m from the initial speed to the final one, but the distance is "
                f"{distance_m:.0f} m."
            )
        peak = top if way(top) <= distance_m else brentq(lambda v: way(v) - distance_m, least, top, xtol=1e-13)
        cruise = max(distance_m - way(peak), 0.0)
        start_time, _, start_energy = between(start, initial_speed_ms, peak)
        brake_time, _, brake_energy = between(brake, final_speed_ms, peak)
        return PhasePlan(
            distance_m=distance_m,
            running_time_s=start_time + cruise / peak + brake_time,
            initial_speed_ms=initial_speed_ms,
            final_speed_ms=final_speed_ms,
            first="start",
            cruise_speed_ms=peak,
            cruise_m=cruise,
            brake_speed_ms=peak,
            cycles=1,
            bottom_speed_ms=peak,
            starting_current_a=current,
            energy_j=start_energy + self.cruise_power_w(peak) * cruise / peak + brake_energy,
            fastest=True,
        )

    def divide_time(
        self, distances_m: Sequence[float], running_time_s: float, initial_speed_ms: float = 0.0
    ) -> tuple[float, ...]:
        """Return the times [s] of parts with stops between them that need the least energy together.

        Parameters
        ----------
        distances_m : sequence of float
            Lengths of the parts [m].
        running_time_s : float
            Time of all parts together, without standing [s].
        initial_speed_ms : float
            Speed at the start of the first part [m/s].

        Raises
        ------
        TimetableError, StrategyRefusedError
            As `plan`.
        """
        speeds = [initial_speed_ms, *[0.0] * (len(distances_m) - 1)]
        least = [self.fastest(way, v).running_time_s for way, v in zip(distances_m, speeds, strict=True)]
        slack = running_time_s - sum(least)
        if slack < -ON_TIME * running_time_s:
            raise TimetableError(running_time_s, sum(least))
        if len(distances_m) == 1 or slack <= ON_TIME * running_time_s:
            shares = [1 / len(distances_m)] * len(distances_m)
            return tuple(time + share * max(slack, 0.0) for time, share in zip(least, shares, strict=True))
        if len(distances_m) == len(least) == TWO:
            return self._two_times(tuple(distances_m), initial_speed_ms, tuple(least), slack)
        prices = [
            self._price_of_time(way, v, shortest, slack)
            for way, v, shortest in zip(distances_m, speeds, least, strict=True)
        ]
        return equally_priced(prices, least, slack)

    def plan_parts(
        self, distances_m: Sequence[float], running_time_s: float, initial_speed_ms: float = 0.0
    ) -> tuple[PhasePlan, ...]:
        """Return the runs of parts with stops between them, their time divided best; arguments as `divide_time`."""
        times = self.divide_time(distances_m, running_time_s, initial_speed_ms)
        speeds = [initial_speed_ms, *[0.0] * (len(times) - 1)]
        return tuple(self.plan(*part) for part in zip(distances_m, times, speeds, strict=True))

    def phases_of(self, plan: PhasePlan) -> tuple[PlannedPhase, ...]:
        """Return the phases of a plan in order, those without length left out."""
        start, brake, coast = self._start(plan.starting_current_a), self.model.braking, self.model.coasting
        tables = {"start": start, "coast": coast, "brake": brake}
        steps: list[tuple[str, float, float]] = [(plan.first, plan.initial_speed_ms, plan.cruise_speed_ms)]
        for _ in range(plan.cycles - 1):
            steps.append(("coast", plan.cruise_speed_ms, plan.bottom_speed_ms))
            steps.append(("start", plan.bottom_speed_ms, plan.cruise_speed_ms))
        steps.append(("cruise", plan.cruise_speed_ms, plan.cruise_speed_ms))
        steps.append(("coast", plan.cruise_speed_ms, plan.brake_speed_ms))
        steps.append(("brake", plan.brake_speed_ms, plan.final_speed_ms))
        phases = []
        for name, before, after in steps:
            if name == "cruise":
                time = plan.cruise_m / before
                numbers = time, plan.cruise_m, time * self.cruise_power_w(before)
            else:
                numbers = between(tables[name], min(before, after), max(before, after))
            if numbers[1] > 1e-9 * plan.distance_m:
                phases.append(PlannedPhase(name, numbers[1], numbers[0], before, after, numbers[2]))
        return tuple(phases)

    def cruise_power_w(self, speed_ms: float) -> float:
        """Return the line power that holds a speed [W]."""
        at = np.array([speed_ms])
        return float(self.model.drive.line_power_w(self.model.resistance_n(at), at)[0])

    def price_of_time_w(self, plan: PhasePlan, step_s: float = 0.05) -> float | None:
        """Return by how much the energy of a plan falls if it may take a second longer, without auxiliaries [J/s]."""
        step = min(step_s, 1e-3 * plan.running_time_s)
        task = np.array([plan.distance_m, plan.running_time_s, plan.initial_speed_ms, plan.final_speed_ms])
        less, more = (
            self._with_current(task + np.array([0, change, 0, 0]), plan.starting_current_a).energy_j
            for change in (-step, step)
        )
        price = (less - more) / (2 * step)
        return price if np.isfinite(price) else None

    def _start(self, current_a: float | None) -> FloatArray:
        return self.model.full_start if current_a is None else start_table(self.model, current_a)

    def _best(self, task: FloatArray) -> PhasePlan:
        """Return the best run for distance, time, initial and final speed; its energy is infinite if there is none."""
        if self.options.free_starting_current:
            return self._best_current(task)
        return self._with_current(task, self.options.starting_current_a)

    def _with_current(self, task: FloatArray, current_a: float | None) -> PhasePlan:
        """Return the best run with one starting current, over all ways to begin and, if asked, over the cycles."""
        start = self._start(current_a)
        ways = range(len(FIRST_PHASES)) if task[2] > 0 else (START,)
        plans = [self._begun(task, start, current_a, first, 1, 1.0) for first in ways]
        if self.options.cycles > 1:
            plans += [self._best_cycles(task, start, current_a, first) for first in ways]
        return min(plans, key=lambda plan: plan.energy_j)

    def _best_cycles(self, task: FloatArray, start: FloatArray, current_a: float | None, first: int) -> PhasePlan:
        def at(share: float) -> PhasePlan:
            return self._begun(task, start, current_a, first, self.options.cycles, share)

        return best_plan(at, *BOTTOM_SHARES, SHARES, SHARE_ACCURACY)

    def _best_current(self, task: FloatArray) -> PhasePlan:
        largest = self.largest_current_a
        assert largest is not None
        return best_plan(
            lambda current: self._with_current(task, current),
            LEAST_CURRENT_SHARE * largest,
            largest,
            CURRENTS,
            CURRENT_ACCURACY,
        )

    def _begun(
        self, task: FloatArray, start: FloatArray, current_a: float | None, first: int, cycles: int, share: float
    ) -> PhasePlan:
        model, options = self.model, self.options
        energy, cruise_speed, brake_speed, cruise = search_run(
            start,
            model.coasting,
            model.braking,
            model.drive.kind,
            model.drive.parameters,
            np.array(model.coefficients),
            task,
            first,
            cycles,
            share,
            options.cruise,
            options.coast,
        )
        # what the search leaves of a phase at the border of its range is none
        if cruise <= NO_PHASE * task[0]:
            cruise = 0.0
        elif not options.cruise:  # even a run that coasts to a stand would be early
            energy = np.inf
        if brake_speed >= cruise_speed * (1 - NO_PHASE):
            brake_speed = cruise_speed
        return PhasePlan(
            distance_m=float(task[0]),
            running_time_s=float(task[1]),
            initial_speed_ms=float(task[2]),
            final_speed_ms=float(task[3]),
            first=FIRST_PHASES[first],
            cruise_speed_ms=cruise_speed,
            cruise_m=cruise,
            brake_speed_ms=brake_speed,
            cycles=cycles,
            bottom_speed_ms=share * cruise_speed,
            starting_current_a=current_a,
            energy_j=energy,
        )

    def _two_times(
        self, distances_m: tuple[float, ...], initial_speed_ms: float, least_s: tuple[float, ...], slack_s: float
    ) -> tuple[float, float]:
        """Return the times of two parts, found by a search over the share of the first."""

        def energy(more: float) -> float:
            first = self._best(np.array([distances_m[0], least_s[0] + more, initial_speed_ms, 0.0])).energy_j
            return first + self._best(np.array([distances_m[1], least_s[1] + slack_s - more, 0.0, 0.0])).energy_j

        found = minimize_scalar(
            energy, bounds=(0.0, slack_s), method="bounded", options={"xatol": DIVISION_ACCURACY * slack_s}
        )
        if not np.isfinite(found.fun):
            raise StrategyRefusedError("has no run over these parts with these phases.")
        return least_s[0] + found.x, least_s[1] + slack_s - found.x

    def _price_of_time(
        self, distance_m: float, initial_speed_ms: float, shortest_s: float, slack_s: float
    ) -> Callable[[float], float]:
        """Return what a second costs in a part, as a function of the time that it has beyond its shortest."""
        extra = slack_s * (np.arange(TIMES_A_PART) / (TIMES_A_PART - 1)) ** 2
        energy = [self.fastest(distance_m, initial_speed_ms).energy_j]
        energy += [
            self._best(np.array([distance_m, shortest_s + more, initial_speed_ms, 0.0])).energy_j for more in extra[1:]
        ]
        if not np.isfinite(energy).all():
            raise StrategyRefusedError(f"has no run of {shortest_s + slack_s:.1f} s over a part with these phases.")
        # over the square root of the slack, as the fastest run has an endless price
        curve = CubicSpline(np.sqrt(extra), energy).derivative()
        return lambda more: -float(curve(np.sqrt(more))) / (2 * np.sqrt(more))
