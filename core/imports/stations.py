"""Tables of stations: names, positions, dwell times, arrivals and departures; times become those from the departure."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from railjoule.core.errors import ScenarioError, UnitError
from railjoule.core.imports.cells import Cell, CellTable, read_cells
from railjoule.core.imports.clock import S_PER_DAY, parse_clock, unit_of_times
from railjoule.core.imports.columns import (
    TIME_ROLES,
    VALUE_UNITS,
    WORDS_OF_NAMES,
    ColumnMap,
    resolve_stations,
)
from railjoule.core.imports.findings import FromFile, Notes
from railjoule.core.imports.intervals import chosen_rows, find_decimal
from railjoule.core.imports.numbers import Decimal, parse_position, parse_value, text_of_cell
from railjoule.core.imports.source_file import SourceFile, encoding_mentioned
from railjoule.core.imports.table import DIGITS_M, Interval, place, rows_words
from railjoule.core.imports.table_units import TableUnits
from railjoule.core.imports.units import CLOCK, read_heading
from railjoule.core.scenario._sentences import show, shown_list

MAX_STATIONS = 1000
FASTEST_KMH = 600.0
"""Beyond it the unit of times was another."""
S_PER_MINUTE, ROUNDING_S = 60.0, 0.5


@dataclass(frozen=True)
class StationRow:
    """A station at its chainage [m]; `times_s` has what is given of `TIME_ROLES`, as the table counts [s]."""

    name: str
    position_m: float
    times_s: Mapping[str, float]
    row: int

    @property
    def words(self) -> str:
        """Its row and its name."""
        return f"row {self.row}" + (f", {show(self.name)}," if self.name else "")


@dataclass(frozen=True)
class StationTable(FromFile):
    """A table of stations in rising chainage; `is_clock` if its times are those of a day."""

    rows: tuple[StationRow, ...]
    is_clock: bool = False

    @property
    def has_times(self) -> bool:
        """Whether a row has an arrival, a departure or a window."""
        return any(one.times_s.keys() - {"dwell"} for one in self.rows)


def read_stations(source: SourceFile, columns: ColumnMap | None = None) -> StationTable:
    """Read a table of stations from CSV or a workbook.

    Parameters
    ----------
    source : SourceFile
        The file.
    columns : ColumnMap, optional
        Its columns, of `columns.STATION_ROLES`, and units, as far as they are not to be guessed.

    Raises
    ------
    ScenarioError
        If it is no such table; the sentence names row, column, value and bound.
    """
    wanted = columns or ColumnMap()
    cells = read_cells(source, wanted.sheet)
    with encoding_mentioned(cells.findings):
        return _read_rows(cells, wanted)


def _read_rows(cells: CellTable, wanted: ColumnMap) -> StationTable:
    notes = Notes(cells.source, list(cells.findings), list(cells.unused))
    roles, found = resolve_stations(cells, wanted)
    cells = chosen_rows(cells, "stations", [column for column in roles.values() if column], wanted, notes)
    units = TableUnits(cells.source, "stations", found, wanted)
    position = units.unit("position_unit", dict(cells.column(found.begin)))
    if position.is_assumed:
        notes.add("assumption", f"no unit is named for {found.begin!r}: taken as {position.unit}.")
    times = {role: column for role in TIME_ROLES if (column := roles[role]) is not None}
    decimal = find_decimal(cells, [found.begin, *times.values()], wanted, notes)
    readers = {role: _TimeColumn.of(cells, role, column, wanted, notes) for role, column in times.items()}
    rows, without_place = [], []
    for number, content in cells.rows:
        row: dict[str | None, Cell] = dict(zip(cells.header, content, strict=True))
        if text_of_cell(row[found.begin]) == "":
            without_place.append(number)
            continue
        try:
            column = found.begin
            position_m = round(parse_position(row[column], position.unit, decimal), DIGITS_M)
            given = {}
            for role, reader in readers.items():
                column = reader.column
                if (time_s := reader.read(row[column], decimal)) is not None:
                    given[role] = time_s
        except ValueError as error:
            raise ScenarioError(f"{cells.source}, row {number}: {column} = {show(row[column])} {error}.") from None
        name = " ".join(text_of_cell(row.get(roles["name"], "")).split())[:200]
        rows.append(StationRow(name, position_m, given, number))
    if without_place:
        notes.add_unused(f"{rows_words(without_place, 'is', 'are')} without {found.begin}.")
    if not 1 <= len(rows) <= MAX_STATIONS:
        raise ScenarioError(f"{cells.source}: has {len(rows)} stations, and must have 1 to {MAX_STATIONS}.")
    places = [Interval(one.position_m, one.position_m, None, one.row) for one in rows]
    for doubt in units.size_doubts(places, position, position):
        notes.add("question", doubt)
    clocks = {role: reader.unit == CLOCK for role, reader in readers.items() if role != "dwell"}
    if len(set(clocks.values())) > 1:
        one, other = (
            next(times[role] for role, is_clock in clocks.items() if is_clock == which) for which in (True, False)
        )
        raise ScenarioError(f"{cells.source}: {one!r} has times of a day and {other!r} has not; write both alike.")
    return StationTable(
        cells.source,
        tuple(sorted(rows, key=lambda one: one.position_m)),
        any(clocks.values()),
        findings=tuple(notes.findings),
        unused=tuple(notes.unused),
    )


@dataclass(frozen=True)
class _TimeColumn:
    """A column of times: on a clock, or in a unit, which a cell must not contradict if the heading names it."""

    column: str
    unit: str
    stated: str | None
    is_dwell: bool

    @classmethod
    def of(cls, cells: CellTable, role: str, column: str, wanted: ColumnMap, notes: Notes) -> "_TimeColumn":
        """Find the unit of a column; UnitError if it is in doubt."""
        names = None if role in wanted.columns else WORDS_OF_NAMES
        heading, known = read_heading(column, "stations", names), VALUE_UNITS["stations"]
        unit = unit_of_times(cells, column) or heading.unit or wanted.value_unit
        if unit is None and heading.doubt:
            raise UnitError(cells.source, heading.doubt, ("stations", "value_unit"), known)
        if unit is None and any(text_of_cell(cell) for _, cell in cells.column(column)):
            notes.add("assumption", f"no unit is named for {column!r}: taken as {known[0]}.")
        unit = unit or known[0]
        return cls(column, unit, heading.unit if heading.unit in known else None, role == "dwell")

    def read(self, cell: Cell, decimal: Decimal) -> float | None:
        """Read a time [s], None if there is none; raises ValueError with the end of a sentence."""
        text = text_of_cell(cell)
        if text in {"", "-", "\u2013", "\u2014", "|"}:
            return None
        if ":" not in text:
            if self.unit == CLOCK and not self.is_dwell:
                raise ValueError("must be a time, as 10:15:30, as others of its column are")
            seconds = parse_value(cell, "stations", "s" if self.unit == CLOCK else self.unit, decimal, self.stated)
        elif self.is_dwell and text.count(":") < 2:
            raise ValueError("may be minutes or hours; write 0:00:30, or the number of seconds")
        else:
            seconds = parse_clock(text)
        if seconds < 0:
            raise ValueError("must be at least 0")
        return seconds


def stations_of_run(
    table: StationTable, begin_m: float, end_m: float, reverse: bool, notes: Notes
) -> tuple[list[dict[str, Any]], float | None]:
    """Return the stations of a line as tables of a scenario, at their chainage, and the travel time that they give.

    Parameters
    ----------
    table : StationTable
        The stations.
    begin_m, end_m : float
        The chainage between which the line lies [m].
    reverse : bool
        Whether it is run in falling chainage.
    notes : Notes
        Receives rows that are not used, and how times are taken.

    Returns
    -------
    stations : list of dict
        In rising chainage, with times from the departure at the first one in the direction of travel.
    travel_time_s : float or None
        Time from that departure to the arrival at the end of the line [s], if it is given.

    Raises
    ------
    ScenarioError
        If times do not rise in the direction of travel, or contradict each other.
    """
    rows = [one for one in table.rows if begin_m <= one.position_m <= end_m]
    if outside := [one.row for one in table.rows if one not in rows]:
        words = rows_words(outside, "lies", "lie")
        notes.add_unused(f"{words} outside {place(begin_m)} to {place(end_m)} m.")
    start_m, stop_m = (end_m, begin_m) if reverse else (begin_m, end_m)
    ordered = rows[::-1] if reverse else rows
    if not table.has_times:
        if not any(one.times_s.get("dwell") for one in rows):
            notes.add("assumption", "its stops have no dwell times: 0 s.")
        stations = [_station(one, {"dwell": one.times_s.get("dwell", 0.0)}, start_m, stop_m, notes) for one in ordered]
        return stations[::-1] if reverse else stations, None
    if not ordered or ordered[0].position_m != start_m:
        raise ScenarioError(
            f"{table.source}: its times count from the departure at the first station, but none lies at the begin of "
            f"the run at {place(start_m)} m; begin the line at a station, or leave out the columns of times."
        )
    timed = _timed(table, ordered, reverse)
    stations = [_station(one, times, start_m, stop_m, notes) for one, times in zip(ordered, timed, strict=True)]
    if bare := [one.row for one, times in zip(ordered[1:-1], timed[1:-1], strict=True) if "dwell" not in times]:
        notes.add("assumption", f"{rows_words(bare, 'has', 'have')} no dwell time and no departure: 0 s.")
    last = ordered[-1]
    arrival, latest = (timed[-1].get(role) for role in ("arrival", "latest"))
    travel_time_s = arrival if arrival is not None else latest
    if last.position_m != stop_m:
        travel_time_s = None
    if travel_time_s is not None:
        which = "arrival" if arrival is not None else "latest arrival"
        notes.add("reading", f"{last.words} gives timetable.travel_time_s = {travel_time_s:g} s, its {which}.")
    return stations[::-1] if reverse else stations, travel_time_s


def _station(
    row: StationRow, times: Mapping[str, float], start_m: float, stop_m: float, notes: Notes
) -> dict[str, Any]:
    """Make the table of a station; where the run begins it has no times, and where it ends no dwell time."""
    keys = {"arrival": "arrival_s", "earliest": "earliest_arrival_s", "latest": "latest_arrival_s", "dwell": "dwell_s"}
    ends = {start_m: set(keys), stop_m: {"dwell", "departure"}}.get(row.position_m, set())
    if lost := [role for role in ends & times.keys() & row.times_s.keys() if times[role]]:
        where = "begins" if row.position_m == start_m else "ends"
        notes.add_unused(f"{row.words} where the run {where}: {shown_list(sorted(lost))}.")
    kept = {key: round(times[role], 3) for role, key in keys.items() if times.get(role) and role not in ends}
    return {**({"name": row.name} if row.name else {}), "position_m": row.position_m, **kept}


def _timed(table: StationTable, ordered: Sequence[StationRow], reverse: bool) -> list[dict[str, float]]:
    """Return the times of each station from the departure at the first one [s], in the direction of travel."""
    source = table.source
    try:
        timed = [_with_both(one, index == 0, source) for index, one in enumerate(_on_one_day(table, ordered, source))]
    except ScenarioError:
        # by the clock of the other direction, if that is right
        if len(ordered) > 1 and _runs_well(table, ordered[::-1]):
            way, key = ("rising", "without --reverse") if reverse else ("falling", "as --reverse")
            raise ScenarioError(f"{source}: by its times the train runs in {way} chainage; run it so, {key}.") from None
        raise
    begin_s = timed[0].get("departure", timed[0].get("arrival"))
    if begin_s is None:
        if table.is_clock:
            raise ScenarioError(f"{source}: {ordered[0].words} where the run begins, has no departure; write it.")
        begin_s = 0.0
    from_begin = [{role: s if role == "dwell" else s - begin_s for role, s in times.items()} for times in timed]
    for one, times in zip(ordered, from_begin, strict=True):
        low, high = times.get("earliest", -math.inf), times.get("latest", math.inf)
        if not low <= times.get("arrival", low) <= high:
            raise ScenarioError(f"{source}: {one.words} has an arrival outside its window, or a window without length.")
    return from_begin


def _runs_well(table: StationTable, ordered: Sequence[StationRow]) -> bool:
    try:
        for one in _on_one_day(table, ordered, table.source):
            _with_both(one, True, table.source)
    except ScenarioError:
        return False
    return True


def _on_one_day(table: StationTable, ordered: Sequence[StationRow], source: str) -> list[StationRow]:
    """Return stations with times that rise, past midnight too; ScenarioError if they fall or are none of a train."""
    timed: list[StationRow] = []
    now: float | None = None
    before: StationRow | None = None
    for one in ordered:
        times = dict(one.times_s)
        for role in ("arrival", "departure", "earliest", "latest"):
            if role not in times:
                continue
            if table.is_clock and now is not None:
                # within half a day of what was before
                times[role] += S_PER_DAY * round((now - times[role]) / S_PER_DAY)
            if role in ("arrival", "departure"):
                if now is not None and times[role] < now:
                    raise ScenarioError(
                        f"{source}: {one.words} has an earlier {role} than the time before it; correct its times or "
                        "the order of the stations."
                    )
                if before is not None and now is not None and before.row != one.row:
                    _require_possible(source, before, one, times[role] - now, table.is_clock)
                now, before = times[role], one
        timed.append(StationRow(one.name, one.position_m, times, one.row))
    return timed


def _require_possible(source: str, before: StationRow, one: StationRow, time_s: float, is_clock: bool) -> None:
    distance_m = abs(one.position_m - before.position_m)
    if time_s * FASTEST_KMH / 3.6 >= distance_m:
        return
    words = f"from row {before.row} to row {one.row} a train has {time_s:g} s for {place(distance_m)} m"
    if is_clock:
        raise ScenarioError(f"{source}: {words}; correct the times or the positions.")
    raise UnitError(source, words, ("stations", "value_unit"), VALUE_UNITS["stations"], ("min", "s"))


def _with_both(one: StationRow, is_first: bool, source: str) -> dict[str, float]:
    """Return the times of a station with arrival, dwell time and departure as far as two of them give the third."""
    times = dict(one.times_s)
    arrival, departure, dwell = (times.get(role) for role in ("arrival", "departure", "dwell"))
    if is_first or departure is None:
        return times
    if arrival is None and dwell is None:
        raise ScenarioError(f"{source}: {one.words} has a departure only; write its arrival or its dwell time.")
    if arrival is None:
        return {**times, "arrival": departure - (dwell or 0.0)}
    stands_s = departure - arrival
    # clocks that show whole minutes
    within_s = ROUNDING_S if arrival % S_PER_MINUTE or departure % S_PER_MINUTE else S_PER_MINUTE
    if dwell is not None and abs(stands_s - dwell) > within_s:
        raise ScenarioError(
            f"{source}: {one.words} stands for {stands_s:g} s from arrival to departure, but has a dwell time of "
            f"{dwell:g} s; leave out one of them."
        )
    return {**times, "dwell": stands_s if dwell is None else dwell}
