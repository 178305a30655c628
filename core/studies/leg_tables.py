"""What each leg of a line needs over its running time: the tables from which its slack is shared out by hand.

Each entry is the optimum of a leg on its own, from rest to rest. Where the prices of a second are equal on all legs the
sum of their energies is least: the multiplier of `railjoule.core.studies.whole_line`'s optimum.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.errors import ScenarioError
from railjoule.core.strategies.line_parts import part_of, shortest_times_s, stop_nodes
from railjoule.core.strategies.optimal import unwindowed_optimum
from railjoule.core.task import Task


@dataclass(frozen=True, eq=False)
class LegTable:
    """Energy and price of one leg over its time supplement.

    Parameters
    ----------
    shortest_time_s : float
        Shortest possible running time [s].
    supplement_s : array of shape (k,)
        What the running time exceeds it by [s].
    energy_j : array of shape (k,)
        Net energy at the line while the train runs, auxiliaries included [J].
    price_of_time_w : array of shape (k,)
        By how much that energy falls if the leg takes a second longer [J/s]; NaN where it is not known.
    """

    shortest_time_s: float
    supplement_s: FloatArray
    energy_j: FloatArray
    price_of_time_w: FloatArray


def leg_tables(task: Task, supplements_s: Sequence[float]) -> tuple[LegTable, ...]:
    """Return a table for each leg of a line, in running order.

    Parameters
    ----------
    task : Task
        Its line may have stations between its ends; windows of arrival and the travel time do not count.
    supplements_s : sequence of float
        Time supplements of a leg to compute [s], above 0.

    Raises
    ------
    ScenarioError
        If a supplement is not above 0.
    TimetableError, SolverError
        As `railjoule.core.strategies.optimal.optimal`.
    """
    supplements = np.asarray(supplements_s, dtype=float)
    if not np.all(supplements > 0):
        raise ScenarioError(f"supplements_s has {supplements[~(supplements > 0)][0]:g}: each must be above 0 s.")
    stops = stop_nodes(task)
    shortest = shortest_times_s(task, stops)
    return tuple(
        _table(task, ends, float(least), supplements) for ends, least in zip(pairwise(stops), shortest, strict=True)
    )


def _table(task: Task, ends: tuple[int, int], shortest_s: float, supplements_s: FloatArray) -> LegTable:
    runs = [unwindowed_optimum(part_of(task, *ends, shortest_s + float(more))) for more in supplements_s]
    prices = [np.nan if run.price_of_time_w is None else run.price_of_time_w for run in runs]
    return LegTable(shortest_s, supplements_s, np.array([run.energy.net_j for run in runs]), np.array(prices))
