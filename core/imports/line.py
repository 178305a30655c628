"""The line of a scenario, put together from tables of intervals."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.csv_text import csv_of_rows
from railjoule.core.errors import ScenarioError
from railjoule.core.imports.continuity import LEAST_STRETCH_M, WHOLE, place
from railjoule.core.imports.findings import Finding, Imported
from railjoule.core.imports.parts import checked_line
from railjoule.core.imports.source_file import counted, shown_list
from railjoule.core.imports.table import DIGITS_M, ImportedTable, Interval
from railjoule.core.scenario import Line, Station


@dataclass(frozen=True)
class Stop:
    """A stop between the ends of a line.

    Parameters
    ----------
    name : str
        What it is called.
    position_m : float
        Its chainage [m].
    dwell_s : float
        How long the train stands there [s].
    earliest_arrival_s, latest_arrival_s : float or None
        When it must arrive, from the start of the run [s]; written where a scenario's station has these keys.
    """

    name: str
    position_m: float
    dwell_s: float = 0.0
    earliest_arrival_s: float | None = None
    latest_arrival_s: float | None = None

    @property
    def window(self) -> dict[str, float]:
        """The times of arrival that a scenario's station can keep, by its keys."""
        times = {"earliest_arrival_s": self.earliest_arrival_s, "latest_arrival_s": self.latest_arrival_s}
        return {key: time for key, time in times.items() if time is not None and key in Station.model_fields}


@dataclass(frozen=True)
class ImportedLine(Imported):
    """A line from tables.

    Parameters
    ----------
    line : Line
        The line, from position 0 in the direction of travel.
    begin_m : float
        The chainage of its start, or with `is_reversed` of its end [m].
    is_reversed : bool
        Whether it runs in falling chainage.
    tunnels : tuple of Interval
        Where they lie on the line [m], with values as their table says.
    """

    line: Line
    begin_m: float
    is_reversed: bool = False
    tunnels: tuple[Interval, ...] = field(default=(), kw_only=True)

    def to_csv(self) -> str:
        """Return the sections as a table that a scenario's `line.file` can name."""
        sections = self.document["line"]["sections"]
        columns = [name for name in type(self.line.sections[0]).model_fields if any(name in one for one in sections)]
        return csv_of_rows([columns, *([section.get(name, "") for name in columns] for section in sections)])


def line_of(
    *,
    gradients: ImportedTable | None = None,
    limits: ImportedTable | None = None,
    curves: ImportedTable | None = None,
    tunnels: ImportedTable | None = None,
    neutral: ImportedTable | None = None,
    stops: Sequence[Stop] = (),
    begin_m: float | None = None,
    end_m: float | None = None,
    reverse: bool = False,
    name: str = "",
) -> ImportedLine:
    """Return the line that tables describe.

    Parameters
    ----------
    gradients, limits, curves, tunnels, neutral : ImportedTable, optional
        What is known of the line, over one chainage; at least one of them.
    stops : sequence of Stop
        Where the train stops between the ends.
    begin_m, end_m : float, optional
        The chainage between which it lies [m]; by default from the first to the last row of gradients and limits.
    reverse : bool
        Run it in falling chainage: positions are mirrored, and gradients change their signs.
    name : str
        Its name.

    Raises
    ------
    ScenarioError
        If there is no table, no end, or no such line can be.
    """
    tables = [table for table in (gradients, limits, curves, tunnels, neutral) if table is not None]
    source = ", ".join(dict.fromkeys(table.source for table in tables))
    begin, end = _extent(tables, begin_m, end_m)
    findings = [finding for table in tables for finding in (*table.findings, *_missing_ends(table, begin, end))]
    if gradients is None:
        findings.append(Finding("assumption", f"{source}: no gradients are given: a level line."))
    findings += _jumps([table for table in tables if table.kind in WHOLE])
    unused = [sentence for table in tables for sentence in (*table.unused, *_outside(table, begin, end))]
    placed: dict[str, tuple[Interval, ...]] = {table.kind: _on_line(table, begin, end) for table in tables}
    with_factor = tunnels is not None and tunnels.value_unit == "factor"
    length = round(end - begin, DIGITS_M)
    sections = _sections(length, placed if with_factor else {**placed, "tunnels": ()})
    if reverse:
        # the sections and not the rows: which of two rows counts is told in the order of the chainage
        sections = [_against(section) for section in reversed(sections)]
        placed = {kind: _turned(intervals, length) for kind, intervals in placed.items()}
    unused += _without_factor(tunnels if not with_factor else None, placed)
    document: dict[str, Any] = {**({"name": name} if name else {}), "sections": sections}
    if without_power := _neutral_sections(placed.get("neutral", ())):
        document["neutral_sections"] = without_power
    if stations := _stations(stops, begin, end, reverse):
        document["stations"] = stations
    line = checked_line(document, source)
    return ImportedLine(
        source,
        {"line": document},
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
        raise ScenarioError(f"{sources}: no row says where the line ends; name its end.")
    if end <= begin:
        raise ScenarioError(f"the line's end at {place(end)} m must lie beyond its begin at {place(begin)} m.")
    return begin, end


def _missing_ends(table: ImportedTable, begin: float, end: float) -> list[Finding]:
    """Return where a table that tells of the whole line does not reach to its ends."""
    if table.kind not in WHOLE:
        return []
    last = table.intervals[-1]
    reached = end if math.isinf(last.to_m) else table.end_m
    if math.isinf(last.to_m) and end <= last.from_m:
        sentence = f"{table.source}: no row says where row {last.row} ends, and the line ends where it begins."
        return [Finding("gap", sentence, (last.row,), last.from_m)]
    return [
        Finding(
            "gap",
            f"{table.source}: nothing from {place(start)} to {place(stop)} m, at the line's {which}: taken as "
            f"{WHOLE[table.kind]}.",
            (),
            start,
            stop,
        )
        for which, start, stop in (("begin", begin, table.begin_m), ("end", reached, end))
        if stop - start > LEAST_STRETCH_M
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
    gaps = [{(one.from_m, one.to_m) for one in table.findings if one.kind == "gap"} for table in tables]
    return [
        Finding(
            "question",
            f"no table says anything from {place(start)} to {place(stop)} m: does the chainage jump there? The line is "
            f"taken to have these {place(stop - start)} m.",
            (),
            start,
            stop,
        )
        for start, stop in sorted(set.intersection(*gaps))
        if start is not None and stop is not None
    ]


def _on_line(table: ImportedTable, begin: float, end: float) -> tuple[Interval, ...]:
    """Return the intervals of a table within the line, as positions from its begin."""
    return tuple(
        _moved(one, max(one.from_m, begin) - begin, min(one.to_m, end) - begin)
        for one in table.intervals
        if one.to_m > begin and one.from_m < end
    )


def _turned(intervals: Sequence[Interval], length_m: float) -> tuple[Interval, ...]:
    """Return intervals as they lie on the line that is run from its end."""
    return tuple(_moved(one, length_m - one.to_m, length_m - one.from_m) for one in reversed(intervals))


def _moved(interval: Interval, from_m: float, to_m: float) -> Interval:
    return replace(interval, from_m=round(from_m, DIGITS_M), to_m=round(to_m, DIGITS_M))


def _sections(length_m: float, placed: Mapping[str, Sequence[Interval]]) -> list[dict[str, Any]]:
    """Return the sections between all places where something changes."""
    kinds = ("gradients", "limits", "curves", "tunnels")
    ends = [place_m for kind in kinds for one in placed.get(kind, ()) for place_m in (one.from_m, one.to_m)]
    borders = np.unique(np.array([0.0, length_m, *ends]))
    gradient = _last_of(borders, placed.get("gradients", ()), 0.0)
    tunnel = _last_of(borders, placed.get("tunnels", ()), 1.0)
    limit = np.full(len(borders) - 1, np.inf)
    curvature = np.zeros(len(borders) - 1)
    for values, kind in ((limit, "limits"), (curvature, "curves")):
        for one, cells in _cells_of(borders, placed.get(kind, ())):
            if kind == "limits":
                np.minimum(values[cells], one.value or np.inf, out=values[cells])
            elif one.value:
                np.maximum(values[cells], 1 / one.value or np.inf, out=values[cells])
    values = np.column_stack([gradient, limit, curvature, tunnel])
    begins = np.flatnonzero(np.append(True, np.any(values[1:] != values[:-1], axis=1)))
    lengths = np.diff(np.append(borders[begins], length_m))
    return [_section(length, *row) for length, row in zip(lengths, values[begins], strict=True)]


def _against(section: Mapping[str, Any]) -> dict[str, Any]:
    """Return a section as a train meets it that comes from the other side."""
    return {key: -value if key == "gradient_permille" else value for key, value in section.items()}


def _stations(stops: Sequence[Stop], begin: float, end: float, reverse: bool) -> list[dict[str, Any]]:
    """Return the stations of a line in the direction of travel."""
    inner = sorted((stop for stop in stops if begin < stop.position_m < end), key=lambda stop: stop.position_m)
    return [
        {
            **({"name": stop.name} if stop.name else {}),
            "position_m": round(end - stop.position_m if reverse else stop.position_m - begin, DIGITS_M),
            **({"dwell_s": stop.dwell_s} if stop.dwell_s else {}),
            **stop.window,
        }
        for stop in (reversed(inner) if reverse else inner)
    ]


def _neutral_sections(intervals: Sequence[Interval]) -> list[dict[str, float]]:
    """Return the neutral sections of a line; what rounding leaves no length of is none."""
    return [{"from_m": one.from_m, "to_m": one.to_m} for one in intervals if one.to_m > one.from_m]


def _last_of(borders: FloatArray, intervals: Sequence[Interval], default: float) -> FloatArray:
    """Return the value in each cell of the interval that begins last of those over it."""
    values = np.full(len(borders) - 1, default)
    for one, cells in _cells_of(borders, sorted(intervals, key=lambda interval: interval.from_m)):
        values[cells] = one.value
    return values


def _cells_of(borders: FloatArray, intervals: Sequence[Interval]) -> list[tuple[Interval, slice]]:
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


def _without_factor(tunnels: ImportedTable | None, placed: Mapping[str, Sequence[Interval]]) -> list[str]:
    """Return in words which tunnels a scenario's line has no key for."""
    if tunnels is None or not placed["tunnels"]:
        return []
    stretches = [f"{place(one.from_m)} to {place(one.to_m)} m" for one in placed["tunnels"]]
    return [f"{tunnels.source}: tunnels without a factor on quadratic resistance: {shown_list(stretches)} of the line."]
