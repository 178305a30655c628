"""The lower bound that the optimum of one travel time proves for all others: a line below the least energy.

The prices of one optimum, with T its time and lambda its price of a second, prove for every driving that takes t

    E + lambda t >= D,

see `railjoule.core.continuous_bound.bound`, which never asks how much time there is. A run that may take t' takes no
more, and lambda >= 0, so that E >= (D - lambda T) - lambda (t' - T) for each t', shorter or longer than T.
"""

from typing import NamedTuple

from railjoule.core.bounds.certified import every_run_bound
from railjoule.core.bounds.minimum import minimise
from railjoule.core.errors import SolverError, StrategyRefusedError
from railjoule.core.task import Task


class TimeLine(NamedTuple):
    """A line below the least energy of a task over its running time, at the task's own time.

    Parameters
    ----------
    energy_j : float
        Its height there [J], dwells included.
    price_of_time_w : float
        By how much it falls with each second, at least 0 [J/s].
    """

    energy_j: float
    price_of_time_w: float


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
    proven = every_run_bound(task, optimum)
    return TimeLine(proven.energy_j + task.dwell_energy_j, proven.price_of_time_w)
