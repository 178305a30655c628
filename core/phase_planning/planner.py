"""Plan start / cruise / coast / brake runs: one part, several parts with their time divided, from rest or in motion.

Source: Rawicki, (44)-(55): the parts j = 1 to K of a run have lengths L(j), and times T(j) that sum to the time of the
run. The marginal energy per second is equal in all parts of the best division: as long as one part saves more by a
second than another loses, a second that is moved from the one to the other saves energy.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from railjoule.core.errors import StrategyRefusedError, TimetableError
from railjoule.core.phase_planning.plan import FIRST_PHASES, PhasePlan, PlannedPhase, best_plan, equally_priced
from railjoule.core.phase_planning.search import START, Opening, PhaseTables, PhaseTask, between, search_run
from railjoule.core.phase_planning.tables import PhaseModel
from railjoule.core.scenario.options import PhasesOptions

# The following numbers were halved and doubled over 30 tasks: four shipped scenarios with up to 3 cycles and free
# currents, and trams with 1 to 3 stops. Parts per million are of the run's energy.

# Range of the speed at which a start may begin again, over the cruising speed. 1 would be no cycle. The best lies
# inside: 0.2 or 0.8 instead of 0.4, and 0.98 instead of 0.995 change 12 ppm at most, as they shift the scanned points
RESTART_FRACTIONS = (0.4, 0.995)
# The least current of a start, over the largest. With half of this the tram does not overcome its resistance and the
# strategy is refused; with 0.3 energies rise by up to 7 ppm, with 0.5 by up to 2500 ppm
MIN_CURRENT_FRACTION = 0.15
# Points of the scans before parabolas. 4 currents miss the best valley (up to 1900 ppm), 14 change 15 ppm at most; 5 or
# 18 restarts change 12 ppm
CURRENTS_SCANNED, FRACTIONS_SCANNED = 7, 9
# Within this share of its range a current or a restart is found. Energy is flat at its minimum, so that half of it
# changes 12 ppm at most; 0.03 costs up to 1300 ppm
ACCURACY = 0.004
# Samples of energy over time in each part, joined by a cubic. 13 change 2 ppm at most, 49 less than 0.2 ppm
TIMES_A_PART = 25
# How close the time of two parts is divided, as a share of the slack: 1e-2 costs up to 4 ppm, 1e-3 less than 0.1 ppm
DIVISION_ACCURACY = 1e-4
# A run that is later or earlier by this share of its time is in time: the rounding of a sum of some hundred cells
ON_TIME = 1e-9
# A cruise of this share of the distance, or coasting over this share of the speed, is none: it is what the bisection of
# a border leaves. 1e-8 and 1e-4 give the same runs
NO_PHASE = 1e-6
# A phase of this share of the distance is not listed: a cell of micrometres is the rounding of its ends
NO_LENGTH = 1e-9


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
            Remaining distance [m] and time [s].
        initial_speed_ms, final_speed_ms : float
            Speeds at the ends [m/s]; in motion the run may start, coast or brake first.

        Raises
        ------
        TimetableError
            If even the fastest run takes longer; `fastest` returns that one.
        StrategyRefusedError
            If the brakes do not stop the train within the distance, or the options leave no run that takes so long.
        """
        fastest = self.fastest(distance_m, initial_speed_ms, final_speed_ms)
        if running_time_s < fastest.running_time_s * (1 - ON_TIME):
            raise TimetableError(running_time_s, fastest.running_time_s)
        if running_time_s <= fastest.running_time_s * (1 + ON_TIME):
            return fastest
        # floats: numba would compile the search again for a distance that came as an int
        plan = self._best(PhaseTask(*map(float, (distance_m, running_time_s, initial_speed_ms, final_speed_ms))))
        if not np.isfinite(plan.energy_j):
            raise StrategyRefusedError(f"has no run of {running_time_s:.1f} s with these phases.")
        return plan

    def fastest(self, distance_m: float, initial_speed_ms: float = 0.0, final_speed_ms: float = 0.0) -> PhasePlan:
        """Return the fastest run: start, the top speed where it is reached, brake; errors as `plan`."""
        current = self.options.starting_current_a
        start, brake = self.model.table("start", current), self.model.braking
        top = min(start[0, -1], self.model.top_speed_ms)
        least = max(initial_speed_ms, final_speed_ms)

        def needed_m(speed: float) -> float:
            return between(start, initial_speed_ms, speed)[1] + between(brake, final_speed_ms, speed)[1]

        if least > top * (1 + 1e-9):
            raise StrategyRefusedError(f"needs speeds at the ends of at most {3.6 * top:.1f} km/h.")
        if needed_m(min(least, top)) > distance_m * (1 + 1e-9):
            raise StrategyRefusedError(
                f"needs {needed_m(least):.0f} m from the initial speed to the final one, but the distance is "
                f"{distance_m:.0f} m."
            )
        reaches_top = needed_m(top) <= distance_m
        peak = top if reaches_top else scipy.optimize.brentq(lambda v: needed_m(v) - distance_m, least, top, xtol=1e-13)
        cruise = max(distance_m - needed_m(peak), 0.0)
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
            restart_speed_ms=peak,
            starting_current_a=current,
            energy_j=start_energy + self.cruise_power_w(peak) * cruise / peak + brake_energy,
            fastest=True,
        )

    def plan_parts(
        self, distances_m: Sequence[float], running_time_s: float, initial_speed_ms: float = 0.0
    ) -> tuple[PhasePlan, ...]:
        """Return the runs of parts with stops between them whose times need the least energy together.

        Parameters
        ----------
        distances_m : sequence of float
            Lengths of at least two parts [m].
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
        times = [self.fastest(*part).running_time_s for part in zip(distances_m, speeds, strict=True)]
        slack = running_time_s - sum(times)
        if slack < -ON_TIME * running_time_s:
            raise TimetableError(running_time_s, sum(times))
        if slack > ON_TIME * running_time_s:
            # one number divides the time of two parts: a search for it needs no derivative of the energies
            divide = self._two_times if len(times) == 2 else self._equally_priced_times
            times = divide(distances_m, initial_speed_ms, times, slack)
        return tuple(self.plan(*part) for part in zip(distances_m, times, speeds, strict=True))

    def planned_phases(self, plan: PhasePlan) -> tuple[PlannedPhase, ...]:
        """Return the phases of a plan in order, without those that have no length."""
        phases = []
        for name, before, after in plan.legs:
            if name == "cruise":
                time, distance = plan.cruise_m / before, plan.cruise_m
                energy = time * self.cruise_power_w(before)
            else:
                time, distance, energy = between(
                    self.model.table(name, plan.starting_current_a), min(before, after), max(before, after)
                )
            if distance > NO_LENGTH * plan.distance_m:
                phases.append(PlannedPhase(name, distance, time, before, after, energy))
        return tuple(phases)

    def cruise_power_w(self, speed_ms: float) -> float:
        """Return the line power that holds a speed [W]."""
        at = np.array([speed_ms])
        return float(self.model.drive.supply_power_w(self.model.resistance_n(at), at)[0])

    def price_of_time_w(self, plan: PhasePlan, step_s: float = 0.05) -> float | None:
        """Return by how much the energy of a plan falls if it may take a second longer, without auxiliaries [J/s]."""
        # energies are known to some 1e-12 of themselves, and the third derivative of the energy is small: the step may
        # be anything between a millisecond and a second
        step = min(step_s, 1e-3 * plan.running_time_s)
        less, more = (
            self._with_current(
                PhaseTask(plan.distance_m, plan.running_time_s + change, plan.initial_speed_ms, plan.final_speed_ms),
                plan.starting_current_a,
            ).energy_j
            for change in (-step, step)
        )
        price = (less - more) / (2 * step)
        return price if np.isfinite(price) else None

    def _best(self, task: PhaseTask) -> PhasePlan:
        """Return the best run for distance, time, initial and final speed; its energy is infinite if there is none."""
        if not self.options.free_starting_current:
            return self._with_current(task, self.options.starting_current_a)
        # `__post_init__` refuses a drive without a current
        most = self.largest_current_a or 0.0
        bounds = MIN_CURRENT_FRACTION * most, most
        return best_plan(lambda current: self._with_current(task, current), *bounds, CURRENTS_SCANNED, ACCURACY)

    def _with_current(self, task: PhaseTask, current_a: float | None) -> PhasePlan:
        """Return the best run with one starting current, over all ways to begin and, if asked, over the cycles."""
        # a train at rest can only start
        firsts = range(len(FIRST_PHASES)) if task.initial_speed_ms > 0 else (START,)
        plans = [self._searched(task, current_a, Opening(first, 1, 1.0)) for first in firsts]
        for first in firsts if self.options.cycles > 1 else ():

            def at(fraction: float, first: int = first) -> PhasePlan:
                return self._searched(task, current_a, Opening(first, self.options.cycles, fraction))

            plans.append(best_plan(at, *RESTART_FRACTIONS, FRACTIONS_SCANNED, ACCURACY))
        return min(plans, key=lambda plan: plan.energy_j)

    def _searched(self, task: PhaseTask, current_a: float | None, opening: Opening) -> PhasePlan:
        """Return the best run with one start and one opening; its energy is infinite if there is none."""
        model, options, start = self.model, self.options, self.model.table("start", current_a)
        drive = model.drive
        tables = PhaseTables(start, model.coasting, model.braking, drive.kind, drive.parameters, model.coefficients)
        energy, cruise_speed, brake_speed, cruise = search_run(tables, task, opening, options.cruise, options.coast)
        # a phase at the border of its range is shorter than the accuracy of the search
        if cruise <= NO_PHASE * task.distance_m:
            cruise = 0.0
        elif not options.cruise:  # even a run that coasts to a stand would be early
            energy = np.inf
        if brake_speed >= cruise_speed * (1 - NO_PHASE):
            brake_speed = cruise_speed
        return PhasePlan(
            **task._asdict(),
            first=FIRST_PHASES[opening.first],
            cruise_speed_ms=cruise_speed,
            cruise_m=cruise,
            brake_speed_ms=brake_speed,
            cycles=opening.cycles,
            restart_speed_ms=opening.restart_fraction * cruise_speed,
            starting_current_a=current_a,
            energy_j=energy,
        )

    def _two_times(
        self, distances_m: Sequence[float], initial_speed_ms: float, min_s: Sequence[float], slack_s: float
    ) -> list[float]:
        """Return the times of two parts, found by a search over the share of the first."""

        def energy(more: float) -> float:
            first = PhaseTask(distances_m[0], min_s[0] + more, initial_speed_ms, 0.0)
            second = PhaseTask(distances_m[1], min_s[1] + slack_s - more, 0.0, 0.0)
            return self._best(first).energy_j + self._best(second).energy_j

        found = scipy.optimize.minimize_scalar(
            energy, bounds=(0.0, slack_s), method="bounded", options={"xatol": DIVISION_ACCURACY * slack_s}
        )
        if not np.isfinite(found.fun):
            raise StrategyRefusedError("has no run over these parts with these phases.")
        return [min_s[0] + found.x, min_s[1] + slack_s - found.x]

    def _equally_priced_times(
        self, distances_m: Sequence[float], initial_speed_ms: float, min_s: Sequence[float], slack_s: float
    ) -> list[float]:
        """Return the times of parts with equal marginal energy per second."""
        # the samples are even over the square root of the slack, as is the curve below
        extra = slack_s * (np.arange(TIMES_A_PART) / (TIMES_A_PART - 1)) ** 2
        prices = []
        for k, (distance, shortest) in enumerate(zip(distances_m, min_s, strict=True)):
            initial = initial_speed_ms if k == 0 else 0.0
            later = [PhaseTask(distance, shortest + more, initial, 0.0) for more in extra[1:].tolist()]
            energy = [self.fastest(distance, initial).energy_j, *(self._best(task).energy_j for task in later)]
            if not np.isfinite(energy).all():
                raise StrategyRefusedError(f"has no run of {shortest + slack_s:.1f} s over a part with these phases.")
            # The marginal energy diverges at the shortest time: coasting for x before the brake saves energy as x, but
            # loses time as x^2. Over the root of the slack, energy is smooth, and dE/dt = dE/d(root) / (2 root).
            curve = scipy.interpolate.CubicSpline(np.sqrt(extra), energy).derivative()
            prices.append(lambda more, curve=curve: -float(curve(np.sqrt(more))) / (2 * np.sqrt(more)))
        return equally_priced(prices, min_s, slack_s)
