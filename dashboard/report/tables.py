"""The scenario as tables, with its fields named as in the editor."""

from collections.abc import Iterable, Iterator, Sequence
from typing import Any, NamedTuple

from pydantic import BaseModel

from railjoule.core import Scenario
from railjoule.core.motion.line_profile import section_borders
from railjoule.core.scenario import Line
from railjoule.core.scenario.disturbance import Disturbance
from railjoule.core.scenario.line import NeutralSection, PassingPoint, Section, SpeedLimit, Station
from railjoule.dashboard.editor.fields_of import Field, Table, describe
from railjoule.dashboard.look import words
from railjoule.dashboard.look.key_names import words_of

MAX_ROWS = 40
"""A table with more rows ends with how many are left out; all of them are in the embedded scenario."""
PARTS = {
    "resistance": "Running resistance",
    "traction": "Traction",
    "braking": "Braking",
    "adhesion": "Adhesion",
    "drive": "Powertrain",
}
EVENTS = ("stops", "speed_limits", "voltage_changes", "recuperation_changes")
OF_LINE = ("limits_hold_for", "head_wind_kmh", "rail_condition")


class FieldRow(NamedTuple):
    """A quantity with its meaning, where that says more than the name, its value and its unit."""

    quantity: str
    value: str
    unit: str
    meaning: str = ""

    @property
    def says_more(self) -> bool:
        """Whether the meaning says more than the name."""
        return self.meaning.rstrip(".").lower() not in {"", self.quantity.lower()}


class FieldTable(NamedTuple):
    """Fields under a title."""

    title: str
    rows: Sequence[FieldRow]


class EntryTable(NamedTuple):
    """Entries under a title, shortened where they are many."""

    title: str
    head: Sequence[str]
    rows: Sequence[Sequence[str]]
    left_out: int


def scenario_tables(scenario: Scenario) -> list[FieldTable | EntryTable]:
    """Return vehicle, line, timetable and disturbances as tables; none is empty."""
    vehicle = scenario.vehicle
    machine = getattr(vehicle.drive, "machine", None)
    masses = [
        FieldRow("Mass with passengers", words.number(vehicle.total_mass_kg, 0), "kg"),
        FieldRow("Effective mass, with rotating parts", words.number(vehicle.total_inertia_kg, 0), "kg"),
    ]
    tables = [
        FieldTable(f"Vehicle: {vehicle.name}", [*_fields(vehicle), *masses]),
        *(FieldTable(title, _fields(getattr(vehicle, part))) for part, title in PARTS.items()),
        # of a drive that has an induction machine beside its own loss model
        *([FieldTable("Induction machine", _fields(machine))] if machine is not None else []),
        FieldTable("Timetable and mesh", list(_timetable(scenario))),
        *_line_tables(scenario.line),
        *_disturbance_tables(scenario.disturbance),
    ]
    return [table for table in tables if table.rows]


def _fields(part: BaseModel) -> list[FieldRow]:
    """Return the fields of a part that have a value."""
    # a choice is no field of the editor
    chosen = part.model_dump(include={"preset", "model"}, exclude_none=True)
    rows = [FieldRow(words_of(key), words_of(value) if key == "model" else value, "") for key, value in chosen.items()]
    for field in describe(type(part)):
        value = getattr(part, field.key)
        # the name is in the title, events have tables of their own
        if value is None or value == () or field.key in {"name", *EVENTS}:
            continue
        if isinstance(field, Table):
            rows.append(FieldRow(field.label, f"{len(value)} entries", "", field.help))
        else:
            rows.append(_row(field, value))
    return rows


def _row(field: Field, value: Any) -> FieldRow:
    shown = words_of(value) if field.kind == "choice" else _shown(value)
    return FieldRow(field.quantity, shown, field.unit, field.meaning)


def _shown(value: Any) -> str:
    if value is None or value == "":
        return words.UNKNOWN
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int | float):
        return _number(value)
    return "; ".join(map(_number, value)) if isinstance(value, tuple) else str(value)


def _number(value: float) -> str:
    """Return a number with as many digits as it was given with."""
    text = f"{value:.10g}"
    if "e" in text:
        return text.replace("-", words.MINUS)
    return words.number(value, len(text.partition(".")[2]))


def _timetable(scenario: Scenario) -> Iterator[FieldRow]:
    yield from _fields(scenario.timetable)
    yield FieldRow("Length of the track", words.distance(scenario.line.length_m), "km")
    for field in describe(Line):
        value = getattr(scenario.line, field.key)
        if field.key in OF_LINE and isinstance(field, Field) and value is not None:
            yield _row(field, value)
    yield from _fields(scenario.solver)


def _line_tables(line: Line) -> Iterator[EntryTable]:
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
    _, *labels = (field.label for field in describe(Section))
    # empty columns would not leave the others room enough on paper
    columns = [column for column in zip(("From, m", "To, m", *labels), *sections, strict=True) if any(column[1:])]
    head, *rows = zip(*columns, strict=True)
    yield _entries(f"Track{f': {line.name}' if line.name else ''}", head, rows)
    for title, kind, entries in (
        ("Speed limits", SpeedLimit, running.speed_limits),
        ("Neutral sections", NeutralSection, running.neutral_sections),
        ("Stations", Station, running.stations),
        ("Passing points", PassingPoint, running.passing_points),
    ):
        # most timetables give no arrivals: such a field has no column
        fields = [field for field in describe(kind) if any(getattr(entry, field.key) is not None for entry in entries)]
        cells = [[_shown(getattr(entry, field.key)) for field in fields] for entry in entries]
        yield _entries(title, [field.label for field in fields], cells)


def _entries(title: str, head: Iterable[str], rows: Sequence[Sequence[str]]) -> EntryTable:
    return EntryTable(title, list(head), rows[:MAX_ROWS], max(len(rows) - MAX_ROWS, 0))


def _disturbance_tables(disturbance: Disturbance) -> Iterator[FieldTable]:
    """Yield the disturbances, if there are any."""
    if disturbance == Disturbance():
        return
    yield FieldTable("Disturbances", _fields(disturbance))
    events = [(number, kind, event) for kind in EVENTS for number, event in enumerate(getattr(disturbance, kind), 1)]
    for number, kind, event in events[:MAX_ROWS]:
        yield FieldTable(f"Event: {words_of(kind).lower().removesuffix('s')} {number}", _fields(event))
