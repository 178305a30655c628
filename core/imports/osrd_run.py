"""The lines of runs that OSRD exports as CSV: limits, neutral sections and stops; `core.measured` reads the run."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import groupby, pairwise

from railjoule.core.errors import ScenarioError
from railjoule.core.imports.cells import CellTable, read_cells
from railjoule.core.imports.findings import Finding, Notes
from railjoule.core.imports.line import ImportedLine, Stop, line_of
from railjoule.core.imports.numbers import M_PER_KM, decimal_of, number_of, text_of_cell
from railjoule.core.imports.source_file import SourceFile, shown_list
from railjoule.core.imports.table import DIGITS_M, ImportedTable, Interval, bounded
from railjoule.core.imports.units import IntervalKind
from railjoule.core.scenario._sentences import show

NEEDED = ("seconds", "position", "speed", "speedLimit")
USED = (*NEEDED, "time", "op", "electrificationType")
NEUTRAL = "neutral_section"


@dataclass(frozen=True)
class _Row:
    number: int
    position_m: float
    time_s: float
    speed_kmh: float
    limit_kmh: float | None
    is_neutral: bool
    point: str


def read_osrd_line(source: SourceFile, name: str = "", sheet: str | None = None) -> ImportedLine:
    """Return the line of a simulation's CSV: its limits, neutral sections and stops; it tells no gradients.

    Parameters
    ----------
    source : SourceFile
        CSV, or a workbook.
    name : str
        The line's.
    sheet : str, optional
        Of a workbook; by default its only one.

    Raises
    ------
    ScenarioError
        If it is no such file; the sentence names row, column, value and bound.
    """
    cells, notes = _cells(source, sheet)
    rows = _in_order(_rows(cells), source.name, notes)
    # a row holds up to the next; where a limit changes, two rows stand at one place
    stretches = [
        (row, round(row.position_m, DIGITS_M), round(later.position_m, DIGITS_M))
        for row, later in pairwise(rows)
        if later.position_m > row.position_m
    ]
    limits = _joined(stretches, lambda row: row.limit_kmh)
    neutral = _joined(stretches, lambda row: 0.0 if row.is_neutral else None)
    if not limits:
        raise ScenarioError(f"{source.name}: no row has a speedLimit and a length.")
    line = line_of(
        limits=_table("limits", source.name, limits),
        neutral=_table("neutral", source.name, neutral) if neutral else None,
        stops=_stops(rows),
        begin_m=rows[0].position_m,
        end_m=rows[-1].position_m,
        name=name,
    )
    return replace(line, findings=(*notes.findings, *line.findings), unused=(*notes.unused, *line.unused))


def _cells(source: SourceFile, sheet: str | None) -> tuple[CellTable, Notes]:
    cells = read_cells(source, sheet)
    missing = [name for name in NEEDED if name not in cells.header]
    if missing:
        columns = shown_list(list(cells.header))
        raise ScenarioError(f"{source.name}: not a run of OSRD: the column {missing[0]} is missing; it has {columns}.")
    others = [column for column in cells.header if column not in USED]
    unused = [f"{source.name}: columns not used: {shown_list(others)}."] if others else []
    return cells, Notes(list(cells.findings), [*cells.unused, *unused])


def _rows(cells: CellTable) -> list[_Row]:
    index = {name: cells.header.index(name) for name in USED if name in cells.header}
    numbers = [(number, row[index[name]]) for name in NEEDED for number, row in cells.rows]
    decimal, _ = decimal_of(numbers, cells.separator, cells.source)
    found = []
    for number, row in cells.rows:
        values = {}
        for name in NEEDED:
            cell = row[index[name]]
            try:
                values[name] = None if text_of_cell(cell) == "" and name == "speedLimit" else number_of(cell, decimal)
            except ValueError as error:
                raise ScenarioError(f"{cells.source}, row {number}: {name} = {show(cell)} {error}.") from None
        texts = {name: text_of_cell(row[index[name]]) for name in ("op", "electrificationType") if name in index}
        limit, place = values["speedLimit"], f"{cells.source}, row {number}"
        found.append(
            _Row(
                number,
                M_PER_KM * (values["position"] or 0.0),
                values["seconds"] or 0.0,
                values["speed"] or 0.0,
                None if limit is None else bounded(place, "speedLimit", row[index["speedLimit"]], limit, "limits", ""),
                texts.get("electrificationType") == NEUTRAL,
                texts.get("op", ""),
            )
        )
    return found


def _in_order(rows: list[_Row], source: str, notes: Notes) -> list[_Row]:
    """Return rows by position; those that lie before the row above are told."""
    back = [str(later.number) for row, later in pairwise(rows) if later.position_m < row.position_m]
    if back:
        sentence = f"{source}: rows that lie before the row above, put in order: {shown_list(back)}."
        notes.findings.append(Finding("order", sentence))
    return sorted(rows, key=lambda row: row.position_m)


def _joined(stretches: list[tuple[_Row, float, float]], value_of: Callable[[_Row], float | None]) -> list[Interval]:
    """Return intervals of one value each; stretches without a value are left out."""
    joined = []
    for value, group in groupby(stretches, key=lambda stretch: value_of(stretch[0])):
        members = list(group)
        if value is not None:
            joined.append(Interval(members[0][1], members[-1][2], value, members[0][0].number))
    return joined


def _table(kind: IntervalKind, source: str, intervals: list[Interval]) -> ImportedTable:
    return ImportedTable(kind, source, tuple(intervals))


def _stops(rows: list[_Row]) -> list[Stop]:
    """Return where the train stands for some time."""
    stops = []
    for position, group in groupby(rows, key=lambda row: row.position_m):
        standing = [row for row in group if row.speed_kmh == 0]
        if standing and (dwell := standing[-1].time_s - standing[0].time_s) > 0:
            name = next((row.point for row in standing if row.point), "")
            stops.append(Stop(name[:200], position, round(dwell, 3)))
    return stops
