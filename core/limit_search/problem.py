"""A task as a search for limits sees it, and one evaluation of it."""

from dataclasses import dataclass, replace

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.limit_search.projection import scale_to_time
from railjoule.core.limit_search.regulation import Regulation, regulation_of
from railjoule.core.limit_search.trip import trip
from railjoule.core.limit_search.whole_cells import trip_cost, trip_over_cells
from railjoule.core.motion.course import Course

CUTS_PER_CELL = 8
"""A trip has room for so many nodes a cell; a regulator changes its effort two or three times within one at most."""
LEAST_SECTION_M = 1.0
"""A section that the search may move is never shorter."""


@dataclass(frozen=True, eq=False)
class Evaluation:
    """One vector of limits that a search looked at.

    Parameters
    ----------
    stage : str
        'sample' in the first, even search, 'refine' in the second, 'given' where there is no search.
    unscaled_ms, limits_ms : array of shape (k,)
        Limits as they were drawn and as they were scaled to the time [m/s].
    boundaries_m : array of shape (k - 1,)
        Between the sections [m].
    running_time_s, energy_j : float
        Of the trip: time [s], and net energy at the line [J], infinite if it is late.
    """

    stage: str
    unscaled_ms: FloatArray
    limits_ms: FloatArray
    boundaries_m: FloatArray
    running_time_s: float
    energy_j: float


@dataclass(frozen=True, eq=False)
class LimitProblem:
    """Trips of a train under limits of sections, in a given time.

    Parameters
    ----------
    course : Course
        What the train obeys.
    regulation : Regulation
        The same for its regulator.
    least_ms, most_ms : float
        Between which limits stay [m/s].
    running_time_s : float
        The longest time that a trip may take [s].
    """

    course: Course
    regulation: Regulation
    least_ms: float
    most_ms: float
    running_time_s: float

    def evaluate(self, stage: str, limits_ms: FloatArray, boundaries_m: FloatArray) -> Evaluation:
        """Return what becomes of limits [m/s] and boundaries [m], scaled until the trip takes the allowed time."""
        scaled, time, energy, _ = scale_to_time(
            self.course.data, self.regulation, boundaries_m, limits_ms, self.least_ms, self.most_ms, self.running_time_s
        )
        # the scaling meets the time to 1e-9 where any factor does; what it misses by more has none
        late = time > self.running_time_s * (1 + 1e-6)
        return Evaluation(
            stage, limits_ms, scaled, boundaries_m, time, np.inf if late else self._with_auxiliaries(time, energy)
        )

    def as_given(self, limits_ms: FloatArray, boundaries_m: FloatArray) -> Evaluation:
        """Return the trip under limits [m/s] as they are, whatever its time."""
        time, energy = trip_cost(self.course.data, self.regulation, boundaries_m, limits_ms)
        return Evaluation("given", limits_ms, limits_ms, boundaries_m, time, self._with_auxiliaries(time, energy))

    def over(self, course: Course, whole_cells: bool = False) -> "LimitProblem":
        """Return the same problem over another mesh; with `whole_cells` its trips are runs over that mesh."""
        regulation = regulation_of(course, self.regulation.deceleration_ms2, self.regulation.brakes)
        return replace(self, course=course, regulation=regulation._replace(whole_cells=whole_cells))

    def nodes_of(self, limits_ms: FloatArray, boundaries_m: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return places [m] and squares of speed [m2/s2] of a trip, cut wherever its regulator changes its effort.

        A trip that fails ends where it does.
        """
        most = CUTS_PER_CELL * (self.course.cell_count + len(limits_ms)) + CUTS_PER_CELL
        position, speed2 = np.empty(most), np.empty(most)
        drive = trip_over_cells if self.regulation.whole_cells else trip
        nodes, _, _ = drive(self.course.data, self.regulation, boundaries_m, limits_ms, position, speed2)
        return frozen_array(position[:nodes]), frozen_array(speed2[:nodes])

    def _with_auxiliaries(self, time_s: float, energy_j: float) -> float:
        dwell = float(self.course.dwell_s.sum())
        return energy_j + self.course.data.auxiliary_power_w * (time_s + dwell)


def limit_problem(
    course: Course, stop_deceleration_ms2: float, brakes: bool, least_ms: float, most_ms: float, running_time_s: float
) -> LimitProblem:
    """Return the problem of a course; `brakes` tells a regulator that brakes for sections from one that coasts."""
    return LimitProblem(course, regulation_of(course, stop_deceleration_ms2, brakes), least_ms, most_ms, running_time_s)
