"""The scenario as tables, with its fields named as in the editor."""

from collections.abc import Sequence
from typing import Any, NamedTuple

from pydantic import BaseModel

from railjoule.core import Scenario
from railjoule.core.motion.line_profile import section_borders
from railjoule.core.scenario import Line
from railjoule.core.scenario.disturbance import Disturbance
from railjoule.core.scenario.line import Section
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
OF_LINE = ("limits_hold_for", "limit_margin_m", "head_wind_kmh", "rail_condition")
LISTS = ("speed_limits", "neutral_sections", "traction_limits", "rail_conditions", "stations", "passing_points")
EVENTS = ("stops", "speed_limits", "voltage_changes", "recuperation_changes")


class FieldRow(NamedTuple):
    """A quantity with its value, its unit and its meaning."""

    quantity: str
    value: str
    unit: str
    meaning: str = ""

    @property
    def says_more(self) -> bool:
        """Whether the meaning adds to the name."""
        return self.meaning.rstrip(".").lower() not in {"", self.quantity.lower()}


class ScenarioTable(NamedTuple):
    """Fields, or entries under a head; entries are shortened where they are many."""

    title: str
    rows: Sequence[Any]
    head: Sequence[str] = ()
    left_out: int = 0


def scenario_tables(scenario: Scenario) -> list[ScenarioTable]:
    """Return vehicle, line, timetable and disturbances as tables; none is empty."""
    vehicle, line, disturbance = scenario.vehicle, scenario.line.in_running_order(), scenario.disturbance
    masses = [
        FieldRow("Mass with passengers", words.number(vehicle.total_mass_kg, 0), "kg"),
        FieldRow("Effective mass, with rotating parts", words.number(vehicle.total_inertia_kg, 0), "kg"),
    ]
    timetable = [
        *_fields(scenario.timetable),
        FieldRow("Length of the track", words.distance(line.length_m), "km"),
        *_fields(line, OF_LINE),
        *_fields(scenario.solver),
    ]
    tables = [
        ScenarioTable(f"Vehicle: {vehicle.name}", [*_fields(vehicle), *masses]),
        *(ScenarioTable(title, _fields(getattr(vehicle, part))) for part, title in PARTS.items()),
        _entries("Assumed values of the vehicle", vehicle.assumptions),
        # of a drive that has an induction machine beside its own loss model
        ScenarioTable("Induction machine", _fields(getattr(vehicle.drive, "machine", None))),
        ScenarioTable("Timetable and mesh", timetable),
        _track(line),
        *(_entries(words_of(name), getattr(line, name)) for name in LISTS),
    ]
    if disturbance != Disturbance():
        tables.append(ScenarioTable("Disturbances", _fields(disturbance)))
        tables += [_entries(f"Disturbances: {words_of(name).lower()}", getattr(disturbance, name)) for name in EVENTS]
    return [table for table in tables if table.rows]


def _fields(part: BaseModel | None, keys: Sequence[str] = ()) -> list[FieldRow]:
    """Return the fields of a part that have a value, all or those of some keys."""
    if part is None:
        return []
    # a choice is no field of the editor
    chosen = {} if keys else part.model_dump(include={"preset", "model"}, exclude_none=True)
    rows = [FieldRow(words_of(key), words_of(value) if key == "model" else value, "") for key, value in chosen.items()]
    for field in describe(type(part)):
        value = getattr(part, field.key)
        # the name is in the title, events have tables of their own
        if (
            value is None
            or value == ()
            or field.key in {"name", "assumed", *EVENTS}
            or (keys and field.key not in keys)
        ):
            continue
        if isinstance(field, Table):
            rows.append(FieldRow(field.label, f"{len(value)} entries", "", field.help))
        else:
            rows.append(FieldRow(field.quantity, _shown(value, field), field.unit, field.meaning))
    return rows


def _track(line: Line) -> ScenarioTable:
    """Return the sections of a line in running order."""
    borders = section_borders(line)
    rows = [
        (
            words.number(start, 0),
            words.number(end, 0),
            words.signed(section.gradient_permille, 1),
            "" if section.speed_limit_kmh is None else words.number(section.speed_limit_kmh, 0),
            words.number(section.curve_radius_m, 0) if section.curve_radius_m else "",
            "" if section.tunnel_factor == 1 else _number(section.tunnel_factor),
        )
        for section, start, end in zip(line.sections, borders[:-1], borders[1:], strict=True)
    ]
    _, *labels = (field.label for field in describe(Section))
    # empty columns would not leave the others room enough on paper
    columns = [column for column in zip(("From, m", "To, m", *labels), *rows, strict=True) if any(column[1:])]
    head, *cells = zip(*columns, strict=True)
    return _shortened(f"Track{f': {line.name}' if line.name else ''}", head, cells)


def _entries(title: str, entries: Sequence[BaseModel]) -> ScenarioTable:
    """Return entries of one kind, without columns for fields that none of them has."""
    kind = describe(type(entries[0])) if entries else ()
    fields = [field for field in kind if any(getattr(entry, field.key) is not None for entry in entries)]
    rows = [[_shown(getattr(entry, field.key), field) for field in fields] for entry in entries]
    return _shortened(title, [field.label for field in fields], rows)


def _shortened(title: str, head: Sequence[str], rows: Sequence[Sequence[str]]) -> ScenarioTable:
    return ScenarioTable(title, rows[:MAX_ROWS], head, max(len(rows) - MAX_ROWS, 0))


def _shown(value: Any, field: Field | Table) -> str:
    if value is None or value == "":
        return words.UNKNOWN
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int | float):
        return _number(value)
    if isinstance(value, tuple):
        return "; ".join(map(_number, value))
    return words_of(value) if isinstance(field, Field) and field.kind == "choice" else str(value)


def _number(value: float) -> str:
    """Return a number with as many digits as it was given with."""
    text = f"{value:.10g}"
    if "e" in text:
        return text.replace("-", words.MINUS)
    return words.number(value, len(text.partition(".")[2]))
