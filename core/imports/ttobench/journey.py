"""A journey of TTOBench: where a train stops, how long, and when it must be where."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from pydantic import Field

from railjoule.core.errors import ScenarioError
from railjoule.core.imports.findings import Foreign, FromFile, Notes
from railjoule.core.imports.source_file import SourceFile, read_json
from railjoule.core.imports.table import place
from railjoule.core.imports.ttobench.train import Columns, Metadata, notes_on
from railjoule.core.scenario._base import Number
from railjoule.core.scenario._sentences import validated

StopChoice = Literal["all", "ends"]
"""Whether a train stops at all possible stops, or only at the ends."""


WINDOW = ("earliest_arrival_s", "latest_arrival_s")
TimingPoint = tuple[Number, Number | None, Number | None, Number | None, Number | None]


class TimingPoints(Columns):
    """Position, least and largest time, least and largest speed; an empty one is free."""

    values: tuple[TimingPoint, ...] = Field(min_length=2, max_length=2000)


class Journey(Foreign):
    """When a train is where."""

    metadata: Metadata
    timing_points: TimingPoints = Field(alias="timing points")


@dataclass(frozen=True)
class Service(FromFile):
    """A journey as a run: its ends [m], the stops between as tables of stations, and its time and end speeds.

    The last two are as in a scenario's timetable.
    """

    begin_m: float
    end_m: float
    stops: tuple[Mapping[str, Any], ...]
    timetable: Mapping[str, float]


@dataclass(frozen=True)
class _Point:
    """A timing point in s and km/h; None is free."""

    position_m: float
    earliest_s: float | None
    latest_s: float | None
    min_kmh: float | None
    max_kmh: float | None


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
    journey = validated(Journey, read_json(source), source.name)
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
        if not stop.keys() & WINDOW:
            demands.append(_range("the arrival", arrival.earliest_s, arrival.latest_s, "s"))
        if arrival is not departure:
            demands.append(_range("the departure", departure.earliest_s, departure.latest_s, "s"))
        _note_demands(demands, arrival, notes)
    timetable = {
        "travel_time_s": _travel_time(leaves, points[-1], notes),
        "entry_speed_kmh": _speed(points[0], "start", notes),
        "exit_speed_kmh": _speed(points[-1], "end", notes),
    }
    return Service(
        source.name,
        points[0].position_m,
        points[-1].position_m,
        stops_between,
        {key: value for key, value in timetable.items() if value},
        findings=tuple(notes.findings),
        unused=tuple(notes.unused),
    )


def _points(given: TimingPoints, where: str) -> list[_Point]:
    metre = given.factor("position", "m", where)
    factors = [
        given.factor(f"{end} {what} constraint", unit, where)
        for what, unit in (("time", "s"), ("speed", "km/h"))
        for end in ("lower", "upper")
    ]
    points: list[_Point] = []
    for index, (position, *demands) in enumerate(given.values):
        values = (None if one is None else factor * one for one, factor in zip(demands, factors, strict=True))
        point = _Point(metre * position, *values)
        place_words, before = f"{where}.values[{index}]", points[-1].position_m if points else -math.inf
        if point.position_m < before:
            raise ScenarioError(f"{place_words}: position = {point.position_m:g} lies before {before:g}.")
        ranges = ("time", point.earliest_s, point.latest_s), ("speed", point.min_kmh, point.max_kmh)
        for what, low, high in ranges:
            if low is not None and high is not None and low > high:
                raise ScenarioError(f"{place_words}: the least {what} {low:g} is above the largest {high:g}.")
        points.append(point)
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
        elif point.max_kmh == 0:
            halts.append((point, point))
        else:
            passed.append(point)
    return halts, passed


def _stop(arrival: _Point, departure: _Point, leaves_s: float) -> dict[str, Any]:
    """Make a stop with its window of arrival from the start of the run, and the minimum dwell time of its windows."""
    latest = arrival.latest_s if arrival.latest_s is not None else arrival.earliest_s
    dwell = 0.0
    if arrival is not departure and latest is not None and departure.earliest_s is not None:
        dwell = max(departure.earliest_s - latest, 0.0)
    window = dict(zip(WINDOW, (arrival.earliest_s, arrival.latest_s), strict=True))
    times = {key: time - leaves_s for key, time in window.items() if time is not None and time > leaves_s}
    return {"position_m": arrival.position_m, **({"dwell_s": dwell} if dwell else {}), **times}


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
