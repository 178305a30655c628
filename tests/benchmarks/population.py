"""How the solver fares on very many random scenarios, half of them with planned stops."""

import os
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass

import numpy as np

from railjoule.core import SolverError
from railjoule.core.bounds import certify, minimise
from railjoule.core.physics.reference import reference_energy
from railjoule.core.task import Task
from tests.benchmarks.measurement import Measurement
from tests.random_scenarios import random_run

MOST_ITERATIONS = 60
PROVEN_GAP = 1e-6
TIGHT_SHARE = 1.5
"""Every timetable below this many times the shortest time must be proven."""
CHUNK = 50


@dataclass(frozen=True)
class Outcome:
    """What became of one scenario: iterations (NaN where it failed), gap, and time allowed over the shortest."""

    seed: int
    iterations: float
    gap: float
    slack_share: float


def outcome(seed: int) -> Outcome:
    """Solve and prove the random scenario of a seed, odd ones with stops."""
    run = random_run(seed, stops=seed % 2 == 1)
    task = Task(run.scenario, run.course, run.fastest_speed2, run.shortest_time_s, run.running_time_s)
    share = run.running_time_s / run.shortest_time_s
    try:
        solution = minimise(task)
    except SolverError:
        return Outcome(seed, np.nan, np.nan, share)
    above = solution.energy_j - certify(task, solution.optimum).energy_j
    size = reference_energy(task.course.data, solution.energy_j, task.running_time_s)
    return Outcome(seed, solution.iterations, above / size, share)


def population(count: int) -> Iterator[Measurement]:
    """Solve `count` random scenarios."""
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        outcomes = list(pool.map(outcome, range(count), chunksize=CHUNK))
    iterations = np.array([one.iterations for one in outcomes])
    gaps = np.array([one.gap for one in outcomes])
    tight = np.array([one.slack_share < TIGHT_SHARE for one in outcomes])
    words = f"{count:,} random scenarios"
    failed = [one.seed for one in outcomes if np.isnan(one.iterations)]
    yield Measurement(f"{words}: not converged {failed or ''}", len(failed), "", at_most=0)
    yield Measurement(f"{words}: iterations, median", np.nanmedian(iterations), "")
    yield Measurement(f"{words}: iterations, 99 % have at most", np.nanpercentile(iterations, 99), "")
    yield Measurement(f"{words}: iterations, most", np.nanmax(iterations), "", at_most=MOST_ITERATIONS)
    yield Measurement(f"{words}: largest gap below 1.5 x shortest time", gaps[tight].max(), "", at_most=PROVEN_GAP)
    unproven = [one.seed for one in outcomes if one.slack_share < TIGHT_SHARE and not one.gap <= PROVEN_GAP]
    yield Measurement(f"{words}: gap larger below 1.5 x {unproven or ''}", len(unproven), "", at_most=0)
    yield Measurement(f"{words}: proven, all timetables", 100 * np.mean(gaps <= PROVEN_GAP), "%")
