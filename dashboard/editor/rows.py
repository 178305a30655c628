"""Rows of a scenario's tables: new ones, changed ones, and blocks pasted from spreadsheets and CSV files."""

import csv
import difflib
from collections.abc import Mapping, Sequence
from itertools import pairwise, zip_longest
from typing import Any

from railjoule.core import Scenario
from railjoule.core.csv_text import unguarded
from railjoule.core.scenario import preset_document, preset_names
from railjoule.core.scenario.drive import DriveParameters
from railjoule.dashboard.editor.fields_of import Field, Table

Row = dict[str, Any]

FIRST_NEUTRAL_M = 100.0
"""Assumed: the next rows are copies that are typed over."""
FIRST_LIMIT_KMH, FIRST_STOP_S, FIRST_EFFORT_KN, FIRST_PASS_KMH = 50.0, 30.0, 100.0, 30.0
FIRST_DECELERATION_MS2 = 0.7
"""Of a first braking curve; service braking of passenger trains."""
RISING = {
    "line.stations": "position_m",
    "line.passing_points": "position_m",
    "vehicle.traction.curve": "speed_kmh",
    "vehicle.braking.curve": "speed_kmh",
    "vehicle.braking.permitted_deceleration": "speed_kmh",
}
"""Tables whose rows must rise, and in what."""
OF_ITS_PLACE = ("name", "arrival_s", "earliest_arrival_s", "latest_arrival_s")
"""Columns of a station that a new row between two others does not copy: they belong to one place."""
SPEED_STEP_KMH = 10.0
FIRST_GEARED = {"motors": 4, "gear_ratio": 6.0, "wheel_diameter_m": 0.86}
"""Assumed, where neither the former drive nor a shipped vehicle has values; to be typed over."""
# without torque no power comes out: there the efficiency is zero
FIRST_MAP = [
    [torque, speed, efficiency]
    for torque, efficiency in ((0.0, 0.0), (500.0, 0.9), (1000.0, 0.9))
    for speed in (0.0, 200.0, 400.0)
]
"""An assumed map of one efficiency; to be pasted over."""
BLANKS = dict.fromkeys(map(ord, "\u00a0\u2009\u202f \t"))
"""Spaces that spreadsheets put between thousands."""
LONGEST_SHOWN = 30


class CellError(ValueError):
    """A cell that cannot be accepted; the message is one sentence."""


def changed_rows(
    table: Table, rows: list[Row], scenario: Scenario, what: str, row: int = 0, column: int = 0, text: str = ""
) -> list[Row]:
    """Return the rows of a table after one change.

    Parameters
    ----------
    table : Table
    rows : list of dict
        The rows before the change, by columns.
    scenario : Scenario
        The scenario that has them.
    what : str
        One of cell (a text typed into a cell), insert (a row below this one), remove, up, down, paste (a block, from a
        cell on) and replace (all rows, by a block).
    row, column : int
        The cell.
    text : str
        The text of the cell, or the block.

    Raises
    ------
    CellError
        If a cell cannot be accepted, with row, column, value and bound.
    """
    before, after = rows[:row], rows[row + 1 :]
    match what:
        case "cell":
            field = table.columns[column]
            value = parse_cell(field, text, row + 1)
            others = {name: old for name, old in rows[row].items() if name != field.name}
            return [*before, others if value is None else {**others, field.name: value}, *after]
        case "insert":
            return [*before, *_row_after(table.key, rows, row, scenario), *after] or first_rows(table.key, scenario)
        case "remove":
            return before + after
        case "up" | "down":
            other = min(max(row + (1 if what == "down" else -1), 0), len(rows) - 1)
            moved = list(rows)
            moved[row], moved[other] = rows[other], rows[row]
            return moved
        case "paste":
            none: Row = {}
            pairs = zip_longest(rows[row:], rows_of(text, table.columns, column), fillvalue=none)
            return before + [{**old, **new} for old, new in pairs]
        case "replace":
            return rows_of(text, table.columns)
    return rows


# ---- new rows and drives


def drive_of_kind(model: str, before: DriveParameters) -> Row:
    """Return a drive of a kind: a shipped vehicle's where one has it, else assumed beside what `before` shares.

    Parameters
    ----------
    model : str
        The kind.
    before : DriveParameters
        The drive that it replaces.
    """
    shipped = [preset_document("vehicles", name)["drive"] for name in preset_names("vehicles")]
    assumed = {name: getattr(before, name, value) for name, value in FIRST_GEARED.items()}
    made = next((drive for drive in shipped if drive["model"] == model), assumed)
    points = {"points": FIRST_MAP} if model == "efficiency_map" else {}
    # the sidebar has a slider of the recuperation, which must not jump
    return {**made, "model": model, **points, "recuperation_factor": before.recuperation_factor}


def first_rows(table: str, scenario: Scenario) -> list[Row]:
    """Return the rows that an empty table begins with; its key is a dotted path."""
    length, traction, braking = scenario.line.length_m, scenario.vehicle.traction, scenario.vehicle.braking
    middle = float(round(length / 2))
    stretch = {"from_m": float(round(length / 3)), "to_m": float(round(2 * length / 3)), "limit_kmh": FIRST_LIMIT_KMH}
    effort = traction.max_effort_kn or FIRST_EFFORT_KN

    def level(effort_kn: float) -> list[Row]:
        return [{"speed_kmh": speed, "effort_kn": effort_kn} for speed in (0.0, traction.max_speed_kmh)]

    rows: Mapping[str, list[Row]] = {
        "line.speed_limits": [stretch],
        "line.neutral_sections": [{"from_m": middle, "to_m": round(min(middle + FIRST_NEUTRAL_M, length), 1)}],
        "line.traction_limits": [{"from_m": stretch["from_m"], "to_m": stretch["to_m"], "effort_factor": 0.8}],
        "line.rail_conditions": [{"from_m": stretch["from_m"], "to_m": stretch["to_m"], "condition": "wet"}],
        "line.passing_points": [_first_passing_point(scenario)],
        "line.stations": [{"name": "Station", "position_m": middle, "dwell_s": FIRST_STOP_S}],
        "disturbance.stops": [{"position_m": middle, "duration_s": FIRST_STOP_S}],
        "disturbance.speed_limits": [stretch],
        "disturbance.voltage_changes": [{"line_voltage_factor": 0.8}],
        "disturbance.recuperation_changes": [{"recuperation_factor": 0.5}],
        "vehicle.resistance.car_kinds": [{"cars": scenario.vehicle.car_count or 1}],
        "vehicle.traction.curve": level(effort),
        "vehicle.braking.curve": level(braking.max_effort_kn or effort),
        "vehicle.braking.permitted_deceleration": [
            {"speed_kmh": 0.0, "deceleration_ms2": braking.max_deceleration_ms2 or FIRST_DECELERATION_MS2}
        ],
    }
    return rows.get(table, [])


def _row_after(table: str, rows: Sequence[Row], index: int, scenario: Scenario) -> list[Row]:
    """Return a row and the new one below it: a section is halved, a rising one lies between, others are alike."""
    if not rows:
        return []
    row, key = rows[index], RISING.get(table)
    if table == "line.sections":
        return [{**row, "length_m": row["length_m"] / 2}] * 2
    if key is None:
        return [row, dict(row)]
    if index + 1 < len(rows):
        beyond = rows[index + 1][key]
    else:
        beyond = scenario.line.length_m if key == "position_m" else row[key] + 2 * SPEED_STEP_KMH
    alike = {name: value for name, value in row.items() if name not in OF_ITS_PLACE}
    return [row, {**alike, key: (row[key] + beyond) / 2}]


def _first_passing_point(scenario: Scenario) -> Row:
    """Return a passing point away from the stations: in the middle between the two stops with the largest distance."""
    line = scenario.line
    stops = sorted({0.0, *(station.position_m for station in line.stations), line.length_m})
    start, end = max(pairwise(stops), key=lambda ends: ends[1] - ends[0])
    limits = [section.speed_limit_kmh or FIRST_PASS_KMH for section in line.sections]
    limits += [limit.limit_kmh for limit in line.speed_limits]
    speed_kmh = min(FIRST_PASS_KMH, *limits)
    return {"name": "Passing point", "position_m": round((start + end) / 2, 1), "speed_kmh": speed_kmh}


# ---- pasted blocks


def rows_of(text: str, columns: Sequence[Field], first: int = 0) -> list[Row]:
    """Return the rows of a block, with values by the names of columns; empty cells of optional columns are left out.

    Tabs separate cells; where there are none semicolons, and where there are none of these commas. So decimals may
    have a comma unless commas separate.

    Parameters
    ----------
    text : str
        The block; its first row may name the columns, as a CSV file's does.
    columns : sequence of Field
        The columns of the table.
    first : int
        The column that a block without names begins in.

    Raises
    ------
    CellError
        If a column is unknown or a cell cannot be accepted, with row, column, value and bound.
    """
    separator = next((mark for mark in "\t;" if mark in text), ",")
    try:
        # not stripped of tabs, which stand for empty cells at both ends of a block
        read = list(csv.reader(text.strip("\r\n\ufeff").splitlines(), delimiter=separator))
    except csv.Error as error:
        raise CellError(f"This is not a table: {error}.") from None
    rows = [[unguarded(cell.strip()) for cell in row] for row in read if any(cell.strip() for cell in row)]
    if not rows:
        raise CellError("The table is empty.")
    named = _named(rows[0], columns)
    if named is None:
        return [_row(row, columns[first:], number) for number, row in enumerate(rows, 1)]
    return [_row(row, named, number) for number, row in enumerate(rows[1:], 2)]


def _named(row: Sequence[str], columns: Sequence[Field]) -> list[Field] | None:
    """Return the columns that the first row names, None where it names none."""
    # a label holds a comma, which may have been taken for a separator
    known = {
        name.lower(): column for column in columns for name in (column.label.split(",")[0], column.label, column.name)
    }
    if not any(cell.lower() in known for cell in row):
        return None
    for cell in row:
        if cell.lower() not in known:
            names = ", ".join(column.name for column in columns)
            close = difflib.get_close_matches(cell.lower(), known, n=1)
            hint = f"did you mean {known[close[0]].name}?" if close else f"choose one of {names}."
            raise CellError(f"Row 1: unknown column {_shown(cell)}, {hint}")
    found = [known[cell.lower()] for cell in row]
    if len(set(found)) < len(found):
        raise CellError("Row 1: a column appears twice.")
    return found


def _row(cells: list[str], order: Sequence[Field], number: int) -> Row:
    # spreadsheets fill rows up with empty cells when they save them
    while len(cells) > len(order) and not cells[-1]:
        cells = cells[:-1]
    if len(cells) > len(order):
        raise CellError(f"Row {number}: {len(cells)} cells for {len(order)} columns.")
    # not strict: where a row ends early, the rest of its cells is empty
    values = {column.name: parse_cell(column, cell, number) for column, cell in zip(order, cells, strict=False)}
    return {name: value for name, value in values.items() if value is not None}


def parse_cell(column: Field, cell: str, row: int) -> Any:
    """Return the value of a cell; None where it is empty.

    Raises
    ------
    CellError
        If it cannot be accepted, with row, column, value and bound.
    """
    text = cell if column.kind in {"text", "choice"} else cell.translate(BLANKS)
    if not text:
        return None
    try:
        return column.parse(text)
    except ValueError as error:
        raise CellError(f"Row {row}, {column.label}: {_shown(cell)}. {error}") from None


def _shown(cell: str) -> str:
    return repr(cell if len(cell) <= LONGEST_SHOWN else cell[: LONGEST_SHOWN - 3] + "...")
