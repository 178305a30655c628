"""The lower bound that the optimum of one travel time proves for all others: a line below the least energy.

The multipliers of one optimum, with T its time and lambda its price of a second, prove for every run on the mesh

    E + lambda (t - T) >= B,

E being the run's energy, auxiliaries included, and t the time that it takes: the proof of
`railjoule.core.interior_point.certificate` prices the time and never asks how much of it there is. A run that may take
t' takes no more, and lambda >= 0, so that

    E >= B - lambda (t' - T)

for each t', shorter or longer than T: a line that touches the least energy at T.

One step of the proof for T itself does look at the time: speeds are left out that only runs of more energy than the
optimum's reach. Here they stay in, so that the runs are all that are nowhere faster than the fastest one.
"""

from typing import NamedTuple

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.bounds.certified import slowest_proven_ms, switched_bound_j
from railjoule.core.bounds.minimum import minimise
from railjoule.core.errors import SolverError, StrategyRefusedError
from railjoule.core.interior_point.certificate import fastest_of_better_runs, usable_prices
from railjoule.core.interior_point.proof import prove
from railjoule.core.interior_point.solver import Optimum
from railjoule.core.task import Task
from railjoule.core.trajectory import PROVEN_GAP


class TimeLine(NamedTuple):
    """A line below the least energy of a task over its running time, at the task's own time.

    Parameters
    ----------
    energy_j : float
        Its height there [J], dwells included.
    price_of_time_w : float
        By how much it falls with each second, at least 0 [J/s].
    slowest_ms : array of shape (n + 1,)
        The least speeds at the nodes of the runs that it covers [m/s].
    """

    energy_j: float
    price_of_time_w: float
    slowest_ms: FloatArray


def time_line(task: Task) -> TimeLine | None:
    """Return the line that the optimum of a task proves, whatever its drive; None where no optimum is found.

    Parameters
    ----------
    task : Task
        Must have slack in its timetable; its windows of arrival do not count.
    """
    try:
        optimum = minimise(task).optimum
    except (SolverError, StrategyRefusedError):
        return None
    slowest = slowest_proven_ms(optimum)
    if task.course.drive.jumps_at_no_effort:
        # this proof prices the time alone, and leaves no speeds out
        proven, price = switched_bound_j(task, optimum)
        return TimeLine(proven + task.dwell_energy_j, price, slowest)
    return TimeLine(proven_of_all_times_j(task, optimum), usable_prices(task.course.data, optimum)[0], slowest)


def proven_of_all_times_j(task: Task, optimum: Optimum) -> float:
    """Return B of the line that the multipliers of an optimum prove [J], dwells included."""
    data, fastest = task.course.data, task.greatest_speed2
    # without a budget no speeds are cut into intervals, whose proof would aim at the energy of this time
    given = fastest, task.running_time_s, PROVEN_GAP, 0
    return float(prove(data, with_all_speeds(task, optimum), *given).bound_j) + task.dwell_energy_j


def with_all_speeds(task: Task, optimum: Optimum) -> Optimum:
    """Return an optimum with so much energy that every speed up to the fastest run's may be that of a better run."""
    data, fastest = task.course.data, task.greatest_speed2
    # what full speed holds and what the optimum takes, and more where the first slopes take more than they give back
    energy = abs(optimum.energy_j) + data.half_inertia_kg * float(np.max(fastest))
    raised = optimum._replace(energy_j=energy)
    while np.any(fastest_of_better_runs(data, raised, fastest, task.running_time_s) < np.sqrt(fastest)):
        raised = raised._replace(energy_j=2 * raised.energy_j)
    return raised
