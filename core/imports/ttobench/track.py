"""Tracks of TTOBench, and scenarios of a track, a train and optionally a journey."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from pydantic import Field

from railjoule.core.errors import ScenarioError
from railjoule.core.imports.findings import Finding, Foreign, Imported, Notes
from railjoule.core.imports.line import ImportedLine, build_line
from railjoule.core.imports.numbers import STRAIGHT
from railjoule.core.imports.source_file import SourceFile, read_json
from railjoule.core.imports.table import (
    ImportedTable,
    Interval,
    add_continuity,
    bounded,
    place,
    require_rising,
    stepwise,
)
from railjoule.core.imports.ttobench.journey import Service, StopChoice, read_service
from railjoule.core.imports.ttobench.train import (
    Columns,
    Metadata,
    Positive,
    TunnelCoefficients,
    notes_on,
    read_train,
    unit_factor,
)
from railjoule.core.imports.units import IntervalKind
from railjoule.core.scenario import Line, Vehicle
from railjoule.core.scenario._base import Number
from railjoule.core.scenario._sentences import counted, show, shown_list, validated

# a larger radius than a section's key can have is as good as straight
MAX_RADIUS_M = 1e6


class PossibleStops(Foreign):
    """Possible stops; the track reaches from the first to the last."""

    unit: str
    values: tuple[Number, ...] = Field(min_length=2, max_length=1000)


class Steps(Columns):
    """Values that hold from a position on."""

    values: tuple[tuple[Number, Number], ...] = Field(min_length=1, max_length=100_000)


class Curvatures(Columns):
    """Radii at the begin and at the end of a curve or a transition, or 'infinity'."""

    values: tuple[tuple[Number, Number | str, Number | str], ...] = Field(min_length=1, max_length=100_000)


class Tunnels(Columns):
    """Begin, length and cross section of tunnels."""

    values: tuple[tuple[Number, Positive, Positive], ...] = Field(max_length=10_000)


class Track(Foreign):
    """A line."""

    metadata: Metadata
    stops: PossibleStops
    speed_limits: Steps = Field(alias="speed limits")
    gradients: Steps | None = None
    curvatures: Curvatures | None = None
    tunnels: Tunnels | None = None


def read_track(
    source: SourceFile,
    tunnels: TunnelCoefficients | None = None,
    *,
    stops: StopChoice = "all",
    service: Service | None = None,
) -> ImportedLine:
    """Return the line of a track's file.

    Parameters
    ----------
    source : SourceFile
        The file.
    tunnels : TunnelCoefficients, optional
        Effect of tunnels on the train; without it they are not used.
    stops : str
        Make stations of all stops between the ends, or of none.
    service : Service, optional
        A journey with the ends and stops of the line.

    Raises
    ------
    ScenarioError
        If anything is wrong with the file.
    """
    track = validated(Track, read_json(source), source.name)
    name, slopes = source.name, track.gradients
    notes = notes_on(track, name)
    metre = unit_factor(track.stops.unit, "m", f"{name}: stops.unit")
    places = [metre * position for position in track.stops.values]
    require_rising(places, f"{name}: stops.values")
    begin, end = (places[0], places[-1]) if service is None else (service.begin_m, service.end_m)
    if service is not None and (begin < places[0] or end > places[-1]):
        raise ScenarioError(
            f"{service.source}: runs from {place(begin)} to {place(end)} m, and must stay within {place(places[0])} to "
            f"{place(places[-1])} m of {name}."
        )
    line = build_line(
        limits=_steps(track.speed_limits, "limits", "speed limits", "velocity", "km/h", name),
        gradients=_steps(slopes, "gradients", "gradients", "slope", "permille", name) if slopes else None,
        curves=_curves(track.curvatures, notes) if track.curvatures else None,
        tunnels=_tunnels(track.tunnels, tunnels, notes) if track.tunnels and track.tunnels.values else None,
        stations=_stops(places, stops, service, notes),
        begin_m=begin,
        end_m=end,
        name=track.metadata.id,
    )
    return replace(line, findings=(*notes.findings, *line.findings), unused=(*line.unused, *notes.unused))


def _steps(steps: Steps, kind: IntervalKind, key: str, column: str, unit: str, source: str) -> ImportedTable:
    """Return values that hold from their position to that of the next."""
    where = f"{source}: {key}"
    begins, factor = _begins(steps.values, steps, where), steps.factor(column, unit, where)
    values = [
        bounded(f"{where}.values[{index}]", column, row[1], factor * row[1], kind)
        for index, row in enumerate(steps.values)
    ]
    return stepwise(kind, source, begins, values)


def _begins(rows: Sequence[tuple[float, *tuple[Any, ...]]], columns: Columns, where: str) -> list[float]:
    """Return the positions of rows [m]; ScenarioError if they do not rise."""
    metre = columns.factor("position", "m", where)
    begins = [metre * row[0] for row in rows]
    require_rising(begins, f"{where}.values")
    return begins


def _curves(curvatures: Curvatures, notes: Notes) -> ImportedTable:
    """Read curves; a transition has its mean curvature."""
    where = f"{notes.source}: curvatures"
    begins = _begins(curvatures.values, curvatures, where)
    metres = [curvatures.factor(f"radius at {end}", "m", where) for end in ("start", "end")]
    radii, transitions = [], 0
    for index, (_, *ends) in enumerate(curvatures.values):
        first, last = (
            _curvature(radius, metre, f"{where}.values[{index}]") for radius, metre in zip(ends, metres, strict=True)
        )
        transitions += first != last
        mean = _mean_curvature(first, last)
        radii.append(float(f"{1 / mean:.10g}") if mean > 1 / MAX_RADIUS_M else 0.0)
    if transitions:
        notes.add("reading", f"{counted(transitions, 'transition')} between radii: taken at their mean curvature.")
    return stepwise("curves", notes.source, begins, radii)


def _curvature(radius: float | str, metre: float, where: str) -> float:
    if isinstance(radius, str) and radius.lower() in STRAIGHT:
        return 0.0
    if isinstance(radius, str) or radius == 0:
        raise ScenarioError(f"{where}: radius = {show(radius)} must be a number other than 0, or 'infinity'.")
    return 1 / (metre * radius)


def _mean_curvature(first: float, last: float) -> float:
    """Return the mean amount of a curvature that goes linearly from one to another, through 0 between two sides."""
    if first * last >= 0:
        return 0.5 * abs(first + last)
    return 0.5 * (first**2 + last**2) / (abs(first) + abs(last))


def _tunnels(tunnels: Tunnels, coefficients: TunnelCoefficients | None, notes: Notes) -> ImportedTable:
    """Read tunnels with the factor on quadratic resistance, or if that is unknown with the cross section."""
    where = f"{notes.source}: tunnels"
    metre, length = (tunnels.factor(column, "m", where) for column in ("position", "length"))
    area = tunnels.factor("cross section", "m2", where)
    rows = [(metre * begin, metre * begin + length * long, area * section) for begin, long, section in tunnels.values]
    stretches = sorted((Interval(*row, number) for number, row in enumerate(rows, 1)), key=lambda one: one.from_m)
    add_continuity("tunnels", stretches, Notes(where, notes.findings))
    with_factors = []
    for one in stretches:
        factor = coefficients.factor_in(one.value or 0.0) if coefficients else None
        if factor is None:  # a factor of one tunnel would make the others look like open line
            return ImportedTable(notes.source, "tunnels", tuple(stretches), "m2")
        factor = bounded(f"{where}.values[{one.row - 1}]", "factor", factor, factor, "tunnels", "factor")
        with_factors.append(replace(one, value=factor))
    return ImportedTable(notes.source, "tunnels", tuple(with_factors), "factor")


def _stops(
    places: Sequence[float], choice: StopChoice, service: Service | None, notes: Notes
) -> list[Mapping[str, Any]]:
    inner = list(places[1:-1])
    if service is not None:
        served = {stop["position_m"] for stop in service.stops}
        passed = [position for position in inner if position not in served]
        if passed and choice == "all":
            notes.add_unused(f"stops that the journey passes, at {_places(passed)} m.")
        return list(service.stops)
    if inner and choice == "ends":
        notes.add_unused(f"stops between the ends, at {_places(inner)} m.")
    elif inner:
        notes.add("assumption", "its stops have no dwell times: 0 s.")
    return [] if choice == "ends" else [{"position_m": position} for position in inner]


def _places(positions: Sequence[float]) -> str:
    return shown_list([place(position) for position in positions])


@dataclass(frozen=True)
class ImportedScenario(Imported):
    """A scenario; without `travel_time_s` its document lacks the timetable."""

    line: Line
    vehicle: Vehicle
    travel_time_s: float | None = None

    def with_travel_time(self, travel_time_s: float, finding: Finding) -> "ImportedScenario":
        """Return the scenario with a time for the whole run [s], and where that time is from."""
        timetable = {**self.document.get("timetable", {}), "travel_time_s": travel_time_s}
        return replace(
            self,
            document={**self.document, "timetable": timetable},
            travel_time_s=travel_time_s,
            findings=(*self.findings, finding),
        )


def read_ttobench(
    track: SourceFile,
    train: SourceFile,
    journey: SourceFile | None = None,
    *,
    stops: StopChoice = "all",
    travel_time_s: float | None = None,
) -> ImportedScenario:
    """Return the scenario of a track, a train and a journey.

    Parameters
    ----------
    track, train, journey : SourceFile
        JSON files of TTOBench 1.1 to 1.5; of other versions what is known is read.
    stops : str
        Stop at all stops, or only at the ends.
    travel_time_s : float, optional
        Time for the whole run [s]; by default the journey's, without one left open.

    Raises
    ------
    ScenarioError
        If anything is wrong with a file; the sentence names field, value and bound.
    """
    vehicle = read_train(train)
    service = read_service(journey, stops) if journey is not None else None
    line = read_track(track, vehicle.tunnels, stops=stops, service=service)
    findings, unused = [*line.findings, *vehicle.findings], [*line.unused, *vehicle.unused]
    timetable: dict[str, Any] = {}
    if service is not None:
        findings, unused = [*findings, *service.findings], [*unused, *service.unused]
        timetable |= service.timetable
    if travel_time_s is not None:
        timetable["travel_time_s"] = travel_time_s
    if vehicle.vehicle.resistance.curve_constant_m_n_per_kn == 0 and any(s.curve_radius_m for s in line.line.sections):
        sentence = f"{train.name}: no resistance of curves: vehicle.resistance.curve_constant_m_n_per_kn is 0."
        findings.append(Finding("assumption", sentence))
    sources = ", ".join(file.name for file in (track, train, journey) if file is not None)
    document: dict[str, Any] = {"title": f"{line.line.name}, {vehicle.vehicle.name}"[:200]}
    document |= {**vehicle.document, **line.document, **({"timetable": timetable} if timetable else {})}
    return ImportedScenario(
        sources,
        document,
        line.line,
        vehicle.vehicle,
        timetable.get("travel_time_s"),
        findings=tuple(findings),
        unused=tuple(unused),
    )
