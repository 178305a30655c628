"""The optimum of a task, by the interior-point method in up to three attempts, and that of one decision."""

from dataclasses import dataclass
from functools import lru_cache

from railjoule.core.arrays import IntArray
from railjoule.core.budget import current_budget
from railjoule.core.errors import SolverError
from railjoule.core.interior_point.solver import CONVERGED, Optimum, minimise_energy
from railjoule.core.physics.mesh_data import lowered_limits
from railjoule.core.task import Task

# Relative gap asked of a smooth drive: a tenth of what a run may lie above its bound and still be called proven
TOLERANCE = 1e-7
RELAXED_TOLERANCE = 1e-5
"""Relative gap asked of free switching: a tenth of what decides whether a run is good enough."""
SWITCHED_TOLERANCE = 1e-6
"""Relative gap asked of a decision: its derivatives may jump, and no step uses what lies below."""
FIRST_ITERATIONS, SECOND_ITERATIONS, LAST_ITERATIONS = 40, 60, 150
"""The barrier falls slowly at first where nearly all energies vanish, as on long descents that only brakes drive."""
FREE_CENTRING, STEADY_CENTRING = 1e-6, 0.2
"""The first attempt may centre as little as it likes; the second always centres, which ends the rare cycles."""
# From quick to patient: nearly all tasks end in the first, whose steps are longest. Iterations, centring, and whether
# exact second derivatives are tried
ATTEMPTS = (
    (FIRST_ITERATIONS, FREE_CENTRING, False),
    (SECOND_ITERATIONS, STEADY_CENTRING, False),
    (LAST_ITERATIONS, STEADY_CENTRING, False),
)
# With idle losses, cost is bilinear in effort and speed where the drive is switched: only its positive part makes
# steps so short that the point lags behind the barrier. Exact second derivatives are tried in each attempt: of 347
# problems the first solves all but nine, of which the second solves eight. Attempts with a barrier that waits for
# the point, before, left ten open, and took five times as long for metros that average 20 km/h
RELAXED_ATTEMPTS = (
    (SECOND_ITERATIONS, FREE_CENTRING, True),
    (LAST_ITERATIONS, STEADY_CENTRING, True),
)
LOOSE_GAP = 0.1
"""A relaxation that ends with a smaller gap still shows where to drive, and its multipliers still prove a bound."""
# Of 950 decisions for ordinary scenarios, coasting exactly made the run late by up to 7e-7 in 35 of the 47 whose run
# would else have broken a limit. A millionth more of the time saves a few millionths of the energy
SPARED_SHARE, SLACK_SHARE = 1e-6, 0.01
"""The optimum of a decision leaves this share of limits and time, or that of the slack if it is less."""


@dataclass(frozen=True, eq=False)
class Solution:
    """The optimum of a task, before it becomes a trajectory.

    Parameters
    ----------
    optimum : Optimum
        Point and multipliers.
    iterations : int
        Of all attempts together.
    energy_j : float
        Net energy at the line, auxiliaries and dwells included [J].
    """

    optimum: Optimum
    iterations: int
    energy_j: float


def minimise(task: Task, tolerance: float = TOLERANCE) -> Solution:
    """Return the optimum of a task; a drive with idle losses may be switched at will within a cell.

    Parameters
    ----------
    task : Task
        Must have slack in its timetable.
    tolerance : float
        Relative gap asked for, at least 1e-5 for such a drive.

    Raises
    ------
    SolverError
        If no attempt converges; for such a drive, if none comes near it either.
    StrategyRefusedError
        If the mesh has more cells than the current budget gives to such a drive.
    """
    if task.mesh.drive.has_idle_losses:
        task.require_few_cells(current_budget().idling_cells)
        tolerance = max(tolerance, RELAXED_TOLERANCE)
    return _minimise(task, tolerance)


@lru_cache(maxsize=4)
def _minimise(task: Task, tolerance: float) -> Solution:
    """Return `minimise`; the last solutions are kept, as a proof needs the optimum of the strategy before it."""
    has_idle_losses, iterations, points = task.mesh.drive.has_idle_losses, 0, []
    given = task.mesh.data, task.fastest_speed2, task.shortest_time_s, task.running_time_s
    for attempt in RELAXED_ATTEMPTS if has_idle_losses else ATTEMPTS:
        points.append(minimise_energy(*given, tolerance, *attempt))
        iterations += points[-1].iterations
        if points[-1].status == CONVERGED:
            break
    # a relaxation is no run to drive: its multipliers are good enough for a bound and a decision where to drive
    closest = min(points, key=lambda point: (point.status, point.relative_gap))
    if closest.status != CONVERGED and not (has_idle_losses and closest.relative_gap < LOOSE_GAP):
        raise SolverError(f"the optimum was not found within {iterations} iterations.")
    return Solution(closest, iterations, closest.energy_j + task.dwell_energy_j)


def minimise_decided(task: Task, modes: IntArray, spared_time_share: float = SPARED_SHARE) -> Optimum:
    """Return the optimum with a decision what the drive does in each cell, whether it has converged or not.

    Coasting exactly afterwards, where it all but coasts, changes efforts and time by some of their last digits, and
    has to find a little left of every limit.

    Parameters
    ----------
    task : Task
        Must have slack in its timetable; its drive has idle losses.
    modes : array of shape (n,)
        DRIVE, BRAKE or OFF of `mesh_data`.
    spared_time_share : float
        Which share of the time is left, at most.
    """
    slack = task.running_time_s - task.shortest_time_s
    # the limits are lowered, and the time shortened, by what coasting exactly may add afterwards
    spared = min(SPARED_SHARE, SLACK_SHARE * slack / task.running_time_s)
    data = lowered_limits(task.mesh.data._replace(mode=modes), spared)
    times = task.shortest_time_s, task.running_time_s * (1 - min(spared, spared_time_share))
    given = data, task.fastest_speed2, *times, SWITCHED_TOLERANCE
    return minimise_energy(*given, SECOND_ITERATIONS, FREE_CENTRING, False)
