"""How a run is driven without looking for energy: full effort to one speed, that speed held, full braking."""

import scipy

from railjoule.core.scenario import Scenario
from railjoule.core.strategies import prepare_task
from railjoule.core.strategies.fastest import fastest
from railjoule.core.trajectory import Trajectory

# of the speed: the time then differs by less than the check of a run allows
TIME_TOLERANCE = 1e-9
# a bracket must begin with a run that is late, and at walking pace every run of a real timetable is
SLOWEST_KMH = 1.0


def one_speed_run(scenario: Scenario) -> Trajectory:
    """Return the fastest run under the one highest speed with which it takes the timetable's time.

    Parameters
    ----------
    scenario : Scenario
        Its timetable counts, and all its limits besides.

    Raises
    ------
    TimetableError
        If the timetable cannot be kept.
    """
    task = prepare_task(scenario)
    task.require_timetable()
    top = scenario.vehicle.traction.max_speed_kmh

    def late_s(speed_kmh: float) -> float:
        return prepare_task(_limited(scenario, speed_kmh)).shortest_time_s - task.running_time_s

    # the shortest time falls steadily with the highest speed, so there is one root
    speed = scipy.optimize.brentq(late_s, min(SLOWEST_KMH, top / 2), top, rtol=TIME_TOLERANCE)
    return fastest(prepare_task(_limited(scenario, float(speed))))


def _limited(scenario: Scenario, speed_kmh: float) -> Scenario:
    return scenario.replace(**{"vehicle.traction.max_speed_kmh": speed_kmh})
