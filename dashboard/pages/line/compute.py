"""A whole line with its stations: the optimum beside the two rules of timetable practice."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import get_args

from railjoule.core import Scenario
from railjoule.core.strategies import prepare_task
from railjoule.core.studies.whole_line import Sharing, WholeLine, shared_line

SHARINGS: tuple[Sharing, ...] = get_args(Sharing)


@dataclass(frozen=True)
class LineRequest:
    """A scenario whose line has stations, and which of their arrivals are fixed [s], by their numbers from 0."""

    scenario: Scenario
    arrivals_s: tuple[tuple[int, float], ...]


@dataclass(frozen=True, eq=False)
class LineRuns:
    """The same line with its time shared in each of three ways.

    Parameters
    ----------
    request : LineRequest
        What was asked for.
    runs : mapping
        The whole lines by their sharing.
    shortest_time_s : float
        Shortest possible time, dwells included [s].
    """

    request: LineRequest
    runs: Mapping[Sharing, WholeLine]
    shortest_time_s: float

    @property
    def best(self) -> WholeLine:
        """The optimum."""
        return self.runs["optimum"]


def compute_line(request: LineRequest) -> LineRuns:
    """Return the line with its time shared in three ways.

    Raises
    ------
    RailjouleError
        If the timetable or a fixed arrival cannot be kept, or the line not be run over.
    """
    task = prepare_task(request.scenario)
    runs = {sharing: shared_line(task, sharing, dict(request.arrivals_s)) for sharing in SHARINGS}
    return LineRuns(request, runs, task.shortest_travel_time_s)
