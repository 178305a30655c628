"""A journey of TTOBench: where a train stops, how long, and when it must be where."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Literal

from railjoule.core.errors import ScenarioError
from railjoule.core.imports.continuity import place
from railjoule.core.imports.findings import Finding
from railjoule.core.imports.foreign import checked, unknown_keys
from railjoule.core.imports.line import Stop
from railjoule.core.imports.source_file import SourceFile, json_of
from railjoule.core.imports.ttobench.format import (
    KMH_UNITS,
    M_UNITS,
    SECOND_UNITS,
    Journey,
    TimingPoints,
    column_factor,
    version_findings,
)

StopChoice = Literal["all", "ends"]
"""Whether a train stops wherever it may, or at the ends alone."""


@dataclass(frozen=True)
class Service:
    """What a journey asks of a run.

    Parameters
    ----------
    source : str
        The file.
    begin_m, end_m : float
        Where it begins and ends [m].
    stops : tuple of Stop
        The stops between.
    travel_time_s : float or None
        The longest time for all of it [s], where one is given.
    entry_kmh, exit_kmh : float
        Speeds at the ends [km/h].
    findings, unused
        See `Imported`.
    """

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
        """Return where the journey begins and ends [m].

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
    least_kmh: float | None
    most_kmh: float | None

    @property
    def stands(self) -> bool:
        """Whether the train stands there."""
        return self.most_kmh == 0


def read_service(source: SourceFile, stops: StopChoice = "all") -> Service:
    """Return what a journey's file asks.

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
    journey = checked(Journey, json_of(source), source.name)
    points = _points(journey.timing_points, f"{source.name}: timing points")
    findings = version_findings(journey.metadata, source.name)
    unused = unknown_keys(journey, source.name)
    halts, passed = _halts_and_passed(points)
    unused += [told for point in passed for told in _demands(point, source.name)]
    if stops == "ends":
        unused += [f"{source.name}: the stop at {place(arrival.position_m)} m." for arrival, _ in halts]
        halts = []
    leaves = _departure_s(points[0])
    stops_between = tuple(_stop(arrival, departure, leaves) for arrival, departure in halts)
    for (arrival, departure), stop in zip(halts, stops_between, strict=True):
        unused += _windows(arrival, departure, bool(stop.window), source.name)
    travel_time, told = _travel_time(points[0], points[-1], source.name)
    (entry, of_entry), (leaving, of_exit) = (
        _speed(point, end, source.name) for point, end in ((points[0], "start"), (points[-1], "end"))
    )
    return Service(
        source.name,
        points[0].position_m,
        points[-1].position_m,
        stops_between,
        travel_time,
        entry,
        leaving,
        findings=(*findings, *told, *of_entry, *of_exit),
        unused=tuple(unused),
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
            (point.least_kmh, point.most_kmh, "speed"),
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


def _dwell(arrival: _Point, departure: _Point) -> float:
    """Return the least dwell time that the windows ask for [s]: from latest arrival to earliest departure."""
    latest = arrival.latest_s if arrival.latest_s is not None else arrival.earliest_s
    if arrival is departure or latest is None or departure.earliest_s is None:
        return 0.0
    return max(departure.earliest_s - latest, 0.0)


def _stop(arrival: _Point, departure: _Point, leaves_s: float) -> Stop:
    """Return a stop with its window of arrival from the start of the run."""
    earliest, latest = (
        None if time is None or time <= leaves_s else time - leaves_s for time in (arrival.earliest_s, arrival.latest_s)
    )
    return Stop("", arrival.position_m, _dwell(arrival, departure), earliest, latest)


def _departure_s(first: _Point) -> float:
    return first.earliest_s if first.earliest_s is not None else first.latest_s or 0.0


def _travel_time(first: _Point, last: _Point, source: str) -> tuple[float | None, list[Finding]]:
    leaves = _departure_s(first)
    arrives = last.latest_s if last.latest_s is not None else last.earliest_s
    if arrives is None or arrives <= leaves:
        return None, []
    told = []
    if last.earliest_s is not None and last.earliest_s != arrives:
        sentence = f"{source}: arrives from {last.earliest_s:g} to {arrives:g} s: the latest is taken."
        told.append(Finding("assumption", sentence))
    return arrives - leaves, told


def _speed(point: _Point, end: str, source: str) -> tuple[float, list[Finding]]:
    """Return the speed at an end [km/h]: the least that is allowed."""
    speed = point.least_kmh or 0.0
    if point.most_kmh == speed:
        return speed, []
    return speed, [Finding("assumption", f"{source}: the speed at the {end} is free: {speed:g} km/h.")]


def _demands(point: _Point, source: str) -> list[str]:
    """Return in words what is asked of a place that the train passes."""
    told = [
        f"{what} {_range(low, high, unit)}"
        for what, low, high, unit in (
            ("the time", point.earliest_s, point.latest_s, "s"),
            ("the speed", point.least_kmh, point.most_kmh, "km/h"),
        )
        if low is not None or high is not None
    ]
    return [f"{source}: {' and '.join(told)} at {place(point.position_m)} m."] if told else []


def _windows(arrival: _Point, departure: _Point, keeps_arrival: bool, source: str) -> list[str]:
    """Return in words the times of a stop that are not used; the dwell between them is."""
    told = [
        f"the {what} {_range(point.earliest_s, point.latest_s, 's')}"
        for what, point in (("arrival", arrival), ("departure", departure))
        if (point.earliest_s is not None or point.latest_s is not None)
        and not (keeps_arrival if what == "arrival" else arrival is departure)
    ]
    return [f"{source}: {' and '.join(told)} at {place(arrival.position_m)} m."] if told else []


def _range(low: float | None, high: float | None, unit: str) -> str:
    if low is None:
        return f"to {high:g} {unit}"
    return f"from {low:g} {unit}" if high is None else f"from {low:g} to {high:g} {unit}"
