"""The line of a scenario, put together from tables of intervals."""

import math
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import BaseModel

from railjoule.core.arrays import FloatArray
from railjoule.core.csv_text import csv_of_rows
from railjoule.core.errors import ScenarioError
from railjoule.core.imports.columns import TABLE_KINDS, ColumnMap
from railjoule.core.imports.findings import Finding, Imported, Notes
from railjoule.core.imports.intervals import read_intervals
from railjoule.core.imports.source_file import SourceFile
from railjoule.core.imports.stations import StationTable, read_stations, stations_of_run
from railjoule.core.imports.table import DIGITS_M, MIN_STRETCH_M, WHOLE, ImportedTable, Interval, place
from railjoule.core.imports.units import TableKind
from railjoule.core.scenario import Line, Station
from railjoule.core.scenario._sentences import counted, shorten, shown_list, validated
from railjoule.core.scenario.line import SHORTEST_DISTANCE_M

if TYPE_CHECKING:
    import pandas


LineTable = ImportedTable | StationTable


class _LineTable(BaseModel):
    line: Line


@dataclass(frozen=True)
class ImportedLine(Imported):
    """A line from tables, from position 0 in the direction of travel; reversed it runs in falling chainage.

    Its document has a timetable, too, if a table of stations gives the travel time.

    `begin_m` is the chainage of its start, reversed of its end [m]; `tunnels` have positions on the line [m].
    """

    line: Line
    begin_m: float
    is_reversed: bool = False
    tunnels: tuple[Interval, ...] = field(default=(), kw_only=True)

    @property
    def travel_time_s(self) -> float | None:
        """Travel time by the table of stations [s]; None if that does not give it."""
        time_s: float | None = self.document.get("timetable", {}).get("travel_time_s")
        return time_s

    def to_csv(self) -> str:
        """Format the sections as a table that a scenario's `line.file` can name."""
        sections = self.document["line"]["sections"]
        columns = [name for name in type(self.line.sections[0]).model_fields if any(name in one for one in sections)]
        return csv_of_rows([columns, *([section.get(name, "") for name in columns] for section in sections)])


def build_line(
    *,
    gradients: ImportedTable | None = None,
    heights: ImportedTable | None = None,
    limits: ImportedTable | None = None,
    curves: ImportedTable | None = None,
    tunnels: ImportedTable | None = None,
    neutral: ImportedTable | None = None,
    stations: StationTable | Sequence[Mapping[str, Any]] = (),
    begin_m: float | None = None,
    end_m: float | None = None,
    reverse: bool = False,
    name: str = "",
) -> ImportedLine:
    """Put a line together from tables.

    Parameters
    ----------
    gradients, heights, limits, curves, tunnels, neutral : ImportedTable, optional
        Tables of the line, over one chainage; at least one of them. Gradients come from one of the first two.
    stations : StationTable or sequence of mapping
        Its stations: a table, or the tables of a scenario's stations with positions as chainage.
    begin_m, end_m : float, optional
        The chainage between which it lies [m]; by default from the first to the last station of a table, or row of
        gradients and limits.
    reverse : bool
        Run it in falling chainage: positions are mirrored, and gradients change their signs.
    name : str
        Its name.

    Raises
    ------
    ScenarioError
        If there is no table, no end, or no such line can be.
    """
    if heights is not None and gradients is not None:
        raise ScenarioError(f"{gradients.source} and {heights.source} both give the gradients; leave out one of them.")
    gradients = heights or gradients
    tables = [table for table in (gradients, limits, curves, tunnels, neutral) if table is not None]
    source = ", ".join(dict.fromkeys(table.source for table in tables))
    notes = Notes(stations.source if isinstance(stations, StationTable) else source)
    if isinstance(stations, StationTable):
        begin_m, end_m = _ends_of_run(stations, begin_m, end_m, notes)
        source = f"{source}, {stations.source}" if tables else source
    begin, end = _extent(tables, begin_m, end_m)
    findings = [finding for table in tables for finding in (*table.findings, *_missing_ends(table, begin, end))]
    if gradients is None:
        findings.append(Finding("assumption", f"{source}: no gradients are given: a level line."))
    findings += _jumps([table for table in tables if table.kind in WHOLE])
    unused = [sentence for table in tables for sentence in (*table.unused, *_outside(table, begin, end))]
    # cut to the line, as positions from its begin
    placed: dict[str, tuple[Interval, ...]] = {
        table.kind: tuple(
            _moved(one, max(one.from_m, begin) - begin, min(one.to_m, end) - begin)
            for one in table.intervals
            if one.to_m > begin and one.from_m < end
        )
        for table in tables
    }
    with_factor = tunnels is not None and tunnels.value_unit == "factor"
    length = round(end - begin, DIGITS_M)
    sections = _sections(length, placed if with_factor else {**placed, "tunnels": ()})
    if reverse:
        # the sections and not the rows: which of two rows counts depends on the order of the chainage
        sections = [
            {key: -value if key == "gradient_permille" else value for key, value in section.items()}
            for section in reversed(sections)
        ]
        placed = {
            kind: tuple(_moved(one, length - one.to_m, length - one.from_m) for one in reversed(intervals))
            for kind, intervals in placed.items()
        }
    if tunnels is not None and not with_factor and placed["tunnels"]:
        stretches = shown_list([f"{place(one.from_m)} to {place(one.to_m)} m" for one in placed["tunnels"]])
        unused.append(f"{tunnels.source}: tunnels without a factor on quadratic resistance: {stretches} of the line.")
    document: dict[str, Any] = {**({"name": name} if name else {}), "sections": sections}
    # a stretch may have no length after rounding
    if neutrals := [one for one in placed.get("neutral", ()) if one.to_m > one.from_m]:
        document["neutral_sections"] = [{"from_m": one.from_m, "to_m": one.to_m} for one in neutrals]
    travel_time_s = None
    if isinstance(stations, StationTable):
        findings, unused = [*stations.findings, *findings], [*stations.unused, *unused]
        stations, travel_time_s = stations_of_run(stations, begin, end, reverse, notes)
        findings, unused = findings + notes.findings, unused + notes.unused
    elif outside := [place(one["position_m"]) for one in stations if not begin <= one["position_m"] <= end]:
        unused.append(f"stations outside {place(begin)} to {place(end)} m: at {shown_list(outside)} m.")
    if placed_stations := _stations(stations, begin, end, reverse):
        document["stations"] = placed_stations
    line = validated(_LineTable, {"line": document}, source).line
    return ImportedLine(
        source,
        {"line": document, **({} if travel_time_s is None else {"timetable": {"travel_time_s": travel_time_s}})},
        line,
        begin,
        reverse,
        tunnels=placed.get("tunnels", ()),
        findings=tuple(findings),
        unused=tuple(unused),
    )


def _extent(tables: Sequence[ImportedTable], begin_m: float | None, end_m: float | None) -> tuple[float, float]:
    """Return between which chainages the line lies [m]."""
    if not tables:
        raise ScenarioError("no table of the line is given: gradients, limits, curves, tunnels or neutral.")
    whole = [table for table in tables if table.kind in WHOLE] or list(tables)
    begin = min(table.begin_m for table in whole) if begin_m is None else begin_m
    end = max(table.end_m for table in whole) if end_m is None else end_m
    if end <= begin and end_m is None and begin_m is None:
        sources = ", ".join(dict.fromkeys(table.source for table in tables))
        raise ScenarioError(f"{sources}: no row has the end of the line; name it.")
    if end <= begin:
        raise ScenarioError(f"the line's end at {place(end)} m must lie beyond its begin at {place(begin)} m.")
    return begin, end


def _missing_ends(table: ImportedTable, begin: float, end: float) -> list[Finding]:
    """Find gaps at the ends of the line in a table of the whole line."""
    if table.kind not in WHOLE:
        return []
    last = table.intervals[-1]
    reached = end if math.isinf(last.to_m) else table.end_m
    if math.isinf(last.to_m) and end <= last.from_m:
        sentence = f"{table.source}: no row has the end of row {last.row}, and the line ends where it begins."
        return [Finding("gap", sentence)]
    return [
        Finding(
            "gap",
            f"{table.source}: nothing from {place(start)} to {place(stop)} m, at the line's {which}: taken as "
            f"{WHOLE[table.kind]}.",
        )
        for which, start, stop in (("begin", begin, table.begin_m), ("end", reached, end))
        if stop - start > MIN_STRETCH_M
    ]


def _outside(table: ImportedTable, begin: float, end: float) -> list[str]:
    """Return in words the rows of a table that do not lie on the line."""
    outside = [one.row for one in table.intervals if one.to_m <= begin or one.from_m >= end]
    if not outside:
        return []
    rows = shown_list([str(row) for row in outside])
    return [f"{table.source}: {counted(len(outside), 'row')} outside {place(begin)} to {place(end)} m: {rows}."]


def _jumps(tables: Sequence[ImportedTable]) -> list[Finding]:
    """Return gaps that all tables share, as a jump of the chainage leaves them."""
    if len(tables) < 2:
        return []
    gaps = [{one.stretch_m for one in table.findings if one.stretch_m is not None} for table in tables]
    return [
        Finding(
            "question",
            f"no table has anything from {place(start)} to {place(stop)} m: does the chainage jump there? The line is "
            f"taken to have these {place(stop - start)} m.",
        )
        for start, stop in sorted(set.intersection(*gaps))
    ]


def _moved(interval: Interval, from_m: float, to_m: float) -> Interval:
    return replace(interval, from_m=round(from_m, DIGITS_M), to_m=round(to_m, DIGITS_M))


def _sections(length_m: float, placed: Mapping[str, Sequence[Interval]]) -> list[dict[str, Any]]:
    """Return the sections between all places where something changes."""
    kinds = ("gradients", "limits", "curves", "tunnels")
    ends = [place_m for kind in kinds for one in placed.get(kind, ()) for place_m in (one.from_m, one.to_m)]
    borders = np.unique(np.array([0.0, length_m, *ends]))
    gradient, tunnel = np.zeros(len(borders) - 1), np.ones(len(borders) - 1)
    limit, curvature = np.full(len(borders) - 1, np.inf), np.zeros(len(borders) - 1)
    for values, kind in ((gradient, "gradients"), (tunnel, "tunnels")):
        # the interval that begins last counts
        for one, cells in _covered_cells(borders, sorted(placed.get(kind, ()), key=lambda interval: interval.from_m)):
            values[cells] = one.value
    for one, cells in _covered_cells(borders, placed.get("limits", ())):
        np.minimum(limit[cells], one.value or np.inf, out=limit[cells])
    for one, cells in _covered_cells(borders, placed.get("curves", ())):
        if one.value:
            np.maximum(curvature[cells], 1 / one.value or np.inf, out=curvature[cells])
    values = np.column_stack([gradient, limit, curvature, tunnel])
    begins = np.flatnonzero(np.append(True, np.any(values[1:] != values[:-1], axis=1)))
    lengths = np.diff(np.append(borders[begins], length_m))
    return [_section(length, *row) for length, row in zip(lengths, values[begins], strict=True)]


def _ends_of_run(
    stations: StationTable, begin_m: float | None, end_m: float | None, notes: Notes
) -> tuple[float | None, float | None]:
    """Return the ends that are given, else the first and the last station of a table, if it has two."""
    first, last = stations.rows[0], stations.rows[-1]
    if last.position_m - first.position_m < SHORTEST_DISTANCE_M:
        return begin_m, end_m
    if begin_m is None or end_m is None:
        words = " and ".join(one.name or f"the station at {place(one.position_m)} m" for one in (first, last))
        notes.add("assumption", f"the run lies between {words}, the first and the last of it (else --begin, --end).")
    return first.position_m if begin_m is None else begin_m, last.position_m if end_m is None else end_m


def _stations(stations: Sequence[Mapping[str, Any]], begin: float, end: float, reverse: bool) -> list[dict[str, Any]]:
    """Return the stations on a line in the direction of travel."""
    on_line = [one for one in stations if begin <= one["position_m"] <= end]
    placed = [
        {**one, "position_m": round(end - one["position_m"] if reverse else one["position_m"] - begin, DIGITS_M)}
        for one in on_line
    ]
    return sorted(placed, key=lambda one: one["position_m"])


def _covered_cells(borders: FloatArray, intervals: Sequence[Interval]) -> list[tuple[Interval, slice]]:
    firsts = np.searchsorted(borders, [one.from_m for one in intervals])
    beyond = np.searchsorted(borders, [one.to_m for one in intervals])
    return [(one, slice(first, stop)) for one, first, stop in zip(intervals, firsts, beyond, strict=True)]


def _section(length: float, gradient: float, limit: float, curvature: float, tunnel: float) -> dict[str, Any]:
    """Return a section with the keys that differ from their defaults."""
    section = {"length_m": round(float(length), DIGITS_M)}
    if gradient:
        section["gradient_permille"] = float(gradient)
    if np.isfinite(limit):
        section["speed_limit_kmh"] = float(limit)
    if curvature:
        section["curve_radius_m"] = float(f"{1 / curvature:.10g}")
    if tunnel != 1:
        section["tunnel_factor"] = float(tunnel)
    return section


def read_line_table(source: SourceFile, kind: TableKind, columns: ColumnMap | None = None) -> LineTable:
    """Read a table of any kind that describes a line; arguments and errors as of `read_intervals`."""
    return read_stations(source, columns) if kind == "stations" else read_intervals(source, kind, columns)


def line_from_tables(
    tables: Mapping[TableKind, "str | Path | pandas.DataFrame | Sequence[Station] | None"],
    settings: Mapping[str, str],
    begin_m: float | None,
    end_m: float | None,
    reverse: bool,
    name: str,
) -> Line:
    """Return the line that tables describe; arguments as in `Line.from_tables`."""
    maps: dict[str, ColumnMap] = {}
    for path, value in settings.items():
        kind, _, key = path.partition(".")
        if kind not in TABLE_KINDS or not key:
            raise ScenarioError(
                f"settings: {shorten(path)} must begin with the kind of its table and a dot; choose one of "
                f"{', '.join(TABLE_KINDS)}."
            )
        maps[kind] = ColumnMap.of(key, value).over(maps.get(kind, ColumnMap()))
    read: dict[str, Any] = {
        kind: [one.model_dump(exclude_defaults=True) for one in table]
        if isinstance(table, list | tuple) and all(isinstance(one, Station) for one in table)
        else read_line_table(_source(kind, table), kind, maps.get(kind))
        for kind, table in tables.items()
        if table is not None
    }
    found = build_line(**read, begin_m=begin_m, end_m=end_m, reverse=reverse, name=name)
    for sentence in found.sentences:
        # the reader of a table should know what was assumed, and a program has no page that lists it
        warnings.warn(sentence, stacklevel=3)
    return found.line


def _source(kind: str, table: Any) -> SourceFile:
    """Return a table as a file that the readers of imports take."""
    if isinstance(table, str | Path):
        return SourceFile.read(table)
    if not hasattr(table, "to_csv"):
        raise ScenarioError(
            f"{kind} has the type {type(table).__name__}; it must be the path of a table or a DataFrame."
        )
    return SourceFile(kind, table.to_csv(index=False).encode())
