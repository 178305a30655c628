"""A journey of TTOBench: where a train stops, how long, and when it must be where."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Literal

from railjoule.core.errors import ScenarioError
from railjoule.core.imports.findings import Finding, Notes
from railjoule.core.imports.line import Stop
from railjoule.core.imports.source_file import SourceFile, json_of
from railjoule.core.imports.table import place
from railjoule.core.imports.ttobench.train import (
    KMH_UNITS,
    M_UNITS,
    SECOND_UNITS,
    Journey,
    TimingPoints,
    column_factor,
    notes_on,
)
from railjoule.core.scenario._sentences import validated

StopChoice = Literal["all", "ends"]
"""Whether a train stops at all possible stops, or only at the ends."""


@dataclass(frozen=True)
class Service:
    """A journey as a run: its ends [m], the stops between, the maximum time [s], and the speeds at the ends [km/h]."""

    source: str
    begin_m: float
    end_m: float
    stops: tuple[Stop, ...]
    travel_time_s: float | None
    entry_kmh: float
    exit_kmh: float
    findings: tuple[Finding, ...] = field(default=(), kw_only=True)
    unused: tuple[str, ...] = field(default=(), kw_only=True)

    def ends_within(self, first_m: float, last_m: float, track: str) -> tuple[float, float]:
        """Return the ends of the journey [m].

        Raises
        ------
        ScenarioError
            If that is not on the track.
        """
        if self.begin_m < first_m or self.end_m > last_m:
            raise ScenarioError(
                f"{self.source}: runs from {place(self.begin_m)} to {place(self.end_m)} m, and must stay within "
                f"{place(first_m)} to {place(last_m)} m of {track}."
            )
        return self.begin_m, self.end_m


@dataclass(frozen=True)
class _Point:
    """A timing point in s and km/h; None is free."""

    position_m: float
    earliest_s: float | None
    latest_s: float | None
    min_kmh: float | None
    max_kmh: float | None

    @property
    def stands(self) -> bool:
        """Whether the train stands there."""
        return self.max_kmh == 0


def read_service(source: SourceFile, stops: StopChoice = "all") -> Service:
    """Read the demands of a journey's file.

    Parameters
    ----------
    source : SourceFile
        The file.
    stops : str
        Keep all its stops, or none between the ends.

    Raises
    ------
    ScenarioError
        If anything is wrong with the file.
    """
    journey = validated(Journey, json_of(source), source.name)
    notes = notes_on(journey, source.name)
    points = _points(journey.timing_points, f"{source.name}: timing points")
    halts, passed = _halts_and_passed(points)
    for point in passed:
        demands = [_range("the time", point.earliest_s, point.latest_s, "s")]
        demands.append(_range("the speed", point.min_kmh, point.max_kmh, "km/h"))
        _note_demands(demands, point, notes)
    if stops == "ends":
        for arrival, _ in halts:
            notes.add_unused(f"the stop at {place(arrival.position_m)} m.")
        halts = []
    leaves = points[0].earliest_s if points[0].earliest_s is not None else points[0].latest_s or 0.0
    stops_between = tuple(_stop(arrival, departure, leaves) for arrival, departure in halts)
    for (arrival, departure), stop in zip(halts, stops_between, strict=True):
        demands = []  # the dwell between them is used
        if not stop.window:
            demands.append(_range("the arrival", arrival.earliest_s, arrival.latest_s, "s"))
        if arrival is not departure:
            demands.append(_range("the departure", departure.earliest_s, departure.latest_s, "s"))
        _note_demands(demands, arrival, notes)
    travel_time = _travel_time(leaves, points[-1], notes)
    entry, leaving = _speed(points[0], "start", notes), _speed(points[-1], "end", notes)
    return Service(
        source.name,
        points[0].position_m,
        points[-1].position_m,
        stops_between,
        travel_time,
        entry,
        leaving,
        findings=tuple(notes.findings),
        unused=tuple(notes.unused),
    )


def _points(given: TimingPoints, where: str) -> list[_Point]:
    metre = column_factor(given.units, "position", M_UNITS, where)
    times = [column_factor(given.units, f"{end} time constraint", SECOND_UNITS, where) for end in ("lower", "upper")]
    speeds = [column_factor(given.units, f"{end} speed constraint", KMH_UNITS, where) for end in ("lower", "upper")]
    points = [
        _Point(
            metre * row[0],
            *(
                None if value is None else factor * value
                for value, factor in zip(row[1:], (*times, *speeds), strict=True)
            ),
        )
        for row in given.values
    ]
    for index, (earlier, later) in enumerate(pairwise(points), 1):
        if later.position_m < earlier.position_m:
            raise ScenarioError(
                f"{where}.values[{index}]: position = {later.position_m:g} lies before {earlier.position_m:g}."
            )
    for index, point in enumerate(points):
        for low, high, what in (
            (point.earliest_s, point.latest_s, "time"),
            (point.min_kmh, point.max_kmh, "speed"),
        ):
            if low is not None and high is not None and low > high:
                raise ScenarioError(f"{where}.values[{index}]: the least {what} {low:g} is above the largest {high:g}.")
    return points


def _halts_and_passed(points: Sequence[_Point]) -> tuple[list[tuple[_Point, _Point]], list[_Point]]:
    """Return arrival and departure of each stop between the ends, and the points between that are passed."""
    halts: list[tuple[_Point, _Point]] = []
    passed: list[_Point] = []
    first, last = points[0].position_m, points[-1].position_m
    for point in points:
        if point.position_m in {first, last}:
            continue
        if halts and halts[-1][0].position_m == point.position_m:
            halts[-1] = (halts[-1][0], point)  # two points at one place are arrival and departure
        elif passed and passed[-1].position_m == point.position_m:
            halts.append((passed.pop(), point))
        elif point.stands:
            halts.append((point, point))
        else:
            passed.append(point)
    return halts, passed


def _stop(arrival: _Point, departure: _Point, leaves_s: float) -> Stop:
    """Make a stop with its window of arrival from the start of the run, and the minimum dwell time of its windows."""
    latest = arrival.latest_s if arrival.latest_s is not None else arrival.earliest_s
    dwell = 0.0
    if arrival is not departure and latest is not None and departure.earliest_s is not None:
        dwell = max(departure.earliest_s - latest, 0.0)
    window = (
        None if time is None or time <= leaves_s else time - leaves_s for time in (arrival.earliest_s, arrival.latest_s)
    )
    return Stop("", arrival.position_m, dwell, *window)


def _travel_time(leaves_s: float, last: _Point, notes: Notes) -> float | None:
    arrives = last.latest_s if last.latest_s is not None else last.earliest_s
    if arrives is None or arrives <= leaves_s:
        return None
    if last.earliest_s is not None and last.earliest_s != arrives:
        notes.add("assumption", f"arrives from {last.earliest_s:g} to {arrives:g} s: the latest is taken.")
    return arrives - leaves_s


def _speed(point: _Point, end: str, notes: Notes) -> float:
    """Return the speed at an end [km/h]: the minimum that is allowed."""
    speed = point.min_kmh or 0.0
    if point.max_kmh != speed:
        notes.add("assumption", f"the speed at the {end} is free: {speed:g} km/h.")
    return speed


def _note_demands(demands: Sequence[str], point: _Point, notes: Notes) -> None:
    words = " and ".join(filter(None, demands))
    notes.add_unused(f"{words} at {place(point.position_m)} m." if words else "")


def _range(what: str, low: float | None, high: float | None, unit: str) -> str:
    """Format a range, such as 'the time from 10 to 20 s'; empty if both ends are free."""
    ends = [f"{word} {end:g}" for word, end in (("from", low), ("to", high)) if end is not None]
    return f"{what} {' '.join(ends)} {unit}" if ends else ""
