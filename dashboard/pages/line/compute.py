"""A whole line with its stations: the optimum beside the two rules of timetable practice and a given timetable."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from typing import Any

from railjoule.core import RailjouleError, Scenario, ScenarioError, load_scenario
from railjoule.core.energy import share_above
from railjoule.core.strategies import prepare_task
from railjoule.core.strategies.arrival_windows import missed_windows
from railjoule.core.studies.whole_line import Sharing, WholeLine, shared_line
from railjoule.core.task import Task

RULES: tuple[Sharing, ...] = ("proportional", "equal")
EXAMPLE, EXAMPLE_TITLE = "metro-10-stations", "Metro, ten stations"
# A load or a day's weather off by a few per cent moves the energy by more. On a metro of even legs the optimum saves
# less than this beside equal slack, on a hilly suburban line several times as much.
WORTH_SHARE = 0.01
"""From this share of the energy on, a better sharing of the slack is worth a new timetable."""


@dataclass(frozen=True, eq=False)
class LineRuns:
    """The same line with its time shared in several ways.

    Parameters
    ----------
    scenario : Scenario
        The request.
    runs : mapping
        The whole lines by their sharing; the given timetable is one of them where there is one that can be kept.
    shortest_time_s : float
        Shortest possible time, dwells included [s].
    missed : mapping
        Sentences on the windows of arrival that a rule or the given timetable misses, by its sharing.
    refusal : str
        Why the given timetable cannot be kept.
    is_example : bool
        Whether it is the example, and not the line of the page's scenario.
    """

    scenario: Scenario
    runs: Mapping[Sharing, WholeLine]
    shortest_time_s: float
    missed: Mapping[Sharing, tuple[str, ...]] = field(default_factory=dict)
    refusal: str = ""
    is_example: bool = False

    @property
    def best(self) -> WholeLine:
        """The optimum."""
        return self.runs["optimum"]

    @property
    def measured_by(self) -> tuple[Sharing, ...]:
        """Runs with which the optimum is compared: the given timetable or else both rules, if they keep the windows."""
        others: tuple[Sharing, ...] = ("given",) if "given" in self.runs else RULES
        return tuple(other for other in others if not self.missed.get(other))

    @property
    def pays(self) -> bool:
        """Whether sharing the slack by the optimum saves a share that is worth a new timetable."""
        best = self.best.run.energy_kwh
        return any(share_above(self.runs[other].run.energy_kwh, best) >= WORTH_SHARE for other in self.measured_by)

    def with_drag(self, found: WholeLine | str) -> "LineRuns":
        """Return the runs with the given timetable of a drag, or the reason against it."""
        return replace(self, refusal=found) if isinstance(found, str) else self.with_given(found)

    def with_given(self, line: WholeLine | None, refusal: str = "", missed: tuple[str, ...] = ()) -> "LineRuns":
        """Return the runs with another given timetable, or why there is none."""
        runs: dict[Sharing, WholeLine] = {name: run for name, run in self.runs.items() if name != "given"}
        if line is None:
            return replace(self, runs=runs, refusal=refusal)
        return replace(self, runs={**runs, "given": line}, refusal="", missed={**self.missed, "given": missed})


@cache
def example_scenario() -> Scenario:
    """Load the shipped scenario that is shown where a line has no stations between its ends."""
    return load_scenario(EXAMPLE)


def compute_line(scenario: Scenario, is_example: bool = False) -> LineRuns:
    """Compute a line with its time shared in each way that there is.

    Raises
    ------
    RailjouleError
        If the timetable or a window of arrival cannot be kept, or the line not be run over.
    """
    task = prepare_task(scenario)
    runs = {sharing: shared_line(task, sharing) for sharing in ("optimum", *RULES)}
    missed = {rule: missed_windows(task, runs[rule].run) for rule in RULES}
    shown = LineRuns(scenario, runs, task.shortest_travel_time_s, missed, is_example=is_example)
    is_given = any(station.arrival_s is not None for station in scenario.line.inner_stations)
    return _with_given(shown, task) if is_given else shown


def compute_given(scenario: Scenario, stations: Sequence[Mapping[str, Any]]) -> WholeLine | str:
    """Compute the line with the given timetable of stations, as in its file, or return why it cannot be kept."""
    try:
        return shared_line(prepare_task(scenario.replace(**{"line.stations": stations})), "given")
    except RailjouleError as refusal:
        return str(refusal)


def _with_given(runs: LineRuns, task: Task) -> LineRuns:
    # a timetable that cannot be kept is no reason to show no optimum
    try:
        line = shared_line(task, "given")
    except ScenarioError as error:
        return runs.with_given(None, str(error))
    return runs.with_given(line, missed=missed_windows(task, line.run))
