"""The scenario as tables, with its fields named as in the editor; every text of a user is escaped."""

from collections.abc import Iterator, Sequence
from typing import Any

from pydantic import BaseModel

from railjoule.core import Scenario
from railjoule.core.motion.line_profile import section_borders
from railjoule.core.scenario import Line, Vehicle
from railjoule.core.scenario.disturbance import Disturbance
from railjoule.core.scenario.line import NeutralSection, PassingPoint, Section, SpeedLimit, Station
from railjoule.dashboard.editor.fields_of import Field, Table, describe
from railjoule.dashboard.look import words
from railjoule.dashboard.look.key_names import words_of
from railjoule.dashboard.look.markup import Markup, joined, markup
from railjoule.dashboard.parts.html import table

MAX_ROWS = 40
"""A table with more rows ends with how many are left out; all of them stand in the embedded scenario."""
PARTS = {
    "resistance": "Running resistance",
    "traction": "Traction",
    "braking": "Braking",
    "adhesion": "Adhesion",
    "drive": "Powertrain",
}
EVENTS = ("stops", "speed_limits", "voltage_changes", "recuperation_changes")
OF_LINE = ("limits_hold_for", "head_wind_kmh", "rail_condition")
Row = tuple[str, str, str]


def scenario_tables(scenario: Scenario) -> Markup:
    """Return vehicle, line, timetable and what goes otherwise as tables."""
    vehicle = scenario.vehicle
    return joined(
        (
            _fields_table(f"Vehicle: {vehicle.name}", [*_fields(vehicle), *_masses(scenario)]),
            *(_fields_table(title, _fields(getattr(vehicle, part))) for part, title in PARTS.items()),
            _machine_table(vehicle),
            _fields_table("Timetable and mesh", _timetable(scenario)),
            *_line_tables(scenario.line),
            *_disturbance_tables(scenario.disturbance),
        )
    )


def _machine_table(vehicle: Vehicle) -> Markup:
    """Return the induction machine of a drive that has one beside its own loss model."""
    machine = getattr(vehicle.drive, "machine", None)
    return Markup() if machine is None else _fields_table("Induction machine", _fields(machine))


def _fields(part: BaseModel) -> Iterator[Row]:
    """Yield what the fields of a part are called and mean, their values and their units."""
    # what is chosen, not typed, is no field of the editor
    chosen = part.model_dump(include={"preset", "model"}, exclude_none=True)
    yield from ((words_of(key), words_of(value) if key == "model" else value, "") for key, value in chosen.items())
    for field in describe(type(part)):
        value = getattr(part, field.key)
        # the name stands in the title, events have tables of their own
        if value is None or value == () or field.key in {"name", *EVENTS}:
            continue
        if isinstance(field, Table):
            yield _named(field.label, field.help), f"{len(value)} entries", ""
        else:
            yield _row(field, value)


def _row(field: Field, value: Any) -> Row:
    shown = words_of(value) if field.kind == "choice" else _shown(value)
    return _named(field.quantity, field.meaning), shown, field.unit


def _named(quantity: str, meaning: str) -> Markup:
    """Return what a quantity is called, and beneath it what it means where that says more."""
    if meaning.rstrip(".").lower() in {"", quantity.lower()}:
        return markup("{}", quantity)
    return markup('{} <small class="meaning">{}</small>', quantity, meaning)


def _shown(value: Any) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int | float):
        return _number(value)
    if isinstance(value, tuple):
        return "; ".join(_number(each) for each in value)
    return str(value)


def _number(value: float) -> str:
    """Return a number with as many digits as it was given with."""
    text = f"{value:.10g}"
    if "e" in text:
        return text.replace("-", words.MINUS)
    return words.number(value, len(text.partition(".")[2]))


def _masses(scenario: Scenario) -> Iterator[Row]:
    vehicle = scenario.vehicle
    yield "Mass with passengers", words.number(vehicle.total_mass_kg, 0), "kg"
    yield "Effective mass, with rotating parts", words.number(vehicle.total_inertia_kg, 0), "kg"


def _timetable(scenario: Scenario) -> Iterator[Row]:
    yield from _fields(scenario.timetable)
    yield "Length of the track", words.distance(scenario.line.length_m), "km"
    for field in describe(Line):
        value = getattr(scenario.line, field.key)
        if field.key in OF_LINE and isinstance(field, Field) and value is not None:
            yield _row(field, value)
    yield from _fields(scenario.solver)


def _line_tables(line: Line) -> Iterator[Markup]:
    """Yield sections, limits and stations in running order."""
    running = line.in_running_order()
    borders = section_borders(running)
    sections = [
        (
            words.number(start, 0),
            words.number(end, 0),
            words.signed(section.gradient_permille, 1),
            "" if section.speed_limit_kmh is None else words.number(section.speed_limit_kmh, 0),
            words.number(section.curve_radius_m, 0) if section.curve_radius_m else "",
            "" if section.tunnel_factor == 1 else _number(section.tunnel_factor),
        )
        for section, start, end in zip(running.sections, borders[:-1], borders[1:], strict=True)
    ]
    _, *labels = _labels(Section)
    # columns of nothing would not leave the others room enough on paper
    columns = [
        (label, *cells) for label, *cells in zip(("From, m", "To, m", *labels), *sections, strict=True) if any(cells)
    ]
    head, *rows = zip(*columns, strict=True)
    yield _rows_table(f"Track{f': {line.name}' if line.name else ''}", head, rows)
    for title, kind, entries in (
        ("Speed limits", SpeedLimit, running.speed_limits),
        ("Neutral sections", NeutralSection, running.neutral_sections),
        ("Stations", Station, running.stations),
        ("Passing points", PassingPoint, running.passing_points),
    ):
        # what no entry names has no column, as most timetables give no arrivals
        fields = [field for field in describe(kind) if any(getattr(entry, field.key) is not None for entry in entries)]
        cells = [[_cell(getattr(entry, field.key)) for field in fields] for entry in entries]
        yield _rows_table(title, [field.label for field in fields], cells)


def _cell(value: Any) -> str:
    return words.UNKNOWN if value is None or value == "" else _shown(value)


def _labels(kind: type[BaseModel]) -> list[str]:
    return [field.label for field in describe(kind)]


def _disturbance_tables(disturbance: Disturbance) -> Iterator[Markup]:
    """Yield what goes otherwise than planned; nothing where all goes as planned."""
    if disturbance == Disturbance():
        return
    yield _fields_table("Disturbances", _fields(disturbance))
    events = [(number, kind, event) for kind in EVENTS for number, event in enumerate(getattr(disturbance, kind), 1)]
    for number, kind, event in events[:MAX_ROWS]:
        yield _fields_table(f"Event: {words_of(kind).lower().removesuffix('s')} {number}", _fields(event))


def _fields_table(title: str, rows: Iterator[Row] | Sequence[Row]) -> Markup:
    """Return a table of names, values and units; nothing without rows."""
    cells = list(rows)
    return table(title, ("Quantity", "Value", "Unit"), ((row, False) for row in cells)) if cells else Markup()


def _rows_table(title: str, head: Sequence[str], rows: Sequence[Sequence[str]]) -> Markup:
    """Return a table, shortened where it is long; nothing without rows."""
    if not rows:
        return Markup()
    left_out = len(rows) - MAX_ROWS
    more = (
        markup('<p class="note">{} more rows in the scenario that this file carries.</p>', left_out)
        if left_out > 0
        else Markup()
    )
    return table(title, head, ((row, False) for row in rows[:MAX_ROWS])) + more
