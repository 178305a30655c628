"""The scenario as tables, from the descriptions of its fields; every text of a user is escaped."""

import re
from collections.abc import Iterator, Sequence
from typing import Any

from pydantic import BaseModel

from railjoule.core import Scenario
from railjoule.core.motion.line_profile import section_borders
from railjoule.core.scenario import Line, Vehicle
from railjoule.core.scenario.disturbance import Disturbance
from railjoule.dashboard.look import words
from railjoule.dashboard.views.parts import table

DESCRIPTION = re.compile(r"^(?P<words>.*?)(?: \[(?P<unit>[^\]]+)\])?\.?$")
MOST_ROWS = 40
"""A table with more rows ends with how many are left out; all of them stand in the embedded scenario."""
PARTS = {"resistance": "Running resistance", "traction": "Traction", "braking": "Braking", "drive": "Powertrain"}
UNITS = {
    "_n_per_kn_per_kmh2": "N/kN/(km/h)\u00b2",
    "_n_per_kn_per_kmh": "N/kN/(km/h)",
    "_n_per_kmh2": "N/(km/h)\u00b2",
    "_n_per_kmh": "N/(km/h)",
}
EVENTS = ("stops", "speed_limits", "voltage_changes", "recuperation_changes")


def scenario_tables(scenario: Scenario) -> str:
    """Return vehicle, line, timetable and what goes otherwise as tables."""
    vehicle = scenario.vehicle
    blocks = [
        _fields_table(f"Vehicle: {vehicle.name}", [*_fields(vehicle), *_masses(scenario)]),
        *(_fields_table(title, _fields(getattr(vehicle, part))) for part, title in PARTS.items()),
        _machine_table(vehicle),
        _fields_table("Timetable and mesh", _timetable(scenario)),
        *_line_tables(scenario.line),
        *_disturbance_tables(scenario.disturbance),
    ]
    return "".join(block for block in blocks if block)


Row = tuple[str, str, str]


def _machine_table(vehicle: Vehicle) -> str:
    """Return the induction machine of a drive that has one beside its own loss model."""
    machine = getattr(vehicle.drive, "machine", None)
    return "" if machine is None else _fields_table("Induction machine", _fields(machine))


def _fields(part: BaseModel) -> Iterator[Row]:
    """Yield what the fields of a part are called, their values and their units."""
    for name, field in type(part).model_fields.items():
        value = getattr(part, name)
        if value is None or isinstance(value, BaseModel) or name in {"name", *EVENTS} or value == ():
            continue
        match = DESCRIPTION.match(field.description or name.replace("_", " "))
        assert match is not None
        label = match["words"].rstrip(".")
        yield label[0].upper() + label[1:], _shown(value), match["unit"] or _unit_of(name)


def _unit_of(name: str) -> str:
    """Return the unit that the name of a field tells where its description does not."""
    return next((unit for ending, unit in UNITS.items() if name.endswith(ending)), "")


def _shown(value: Any) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int | float):
        return _number(value)
    if isinstance(value, tuple):
        return f"{len(value)} entries"
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
    yield from _fields(scenario.solver)


def _line_tables(line: Line) -> Iterator[str]:
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
        )
        for section, start, end in zip(running.sections, borders[:-1], borders[1:], strict=True)
    ]
    name = f": {line.name}" if line.name else ""
    head = ("From, m", "to, m", words.PER_MILLE, "limit, km/h", "curve radius, m")
    yield _rows_table(f"Track{name}", head, sections)
    limits = [
        (words.number(limit.from_m, 0), words.number(limit.to_m, 0), words.number(limit.limit_kmh, 0))
        for limit in running.speed_limits
    ]
    yield _rows_table("Speed limits", ("From, m", "to, m", "km/h"), limits)
    stations = [
        (station.name or "\u2013", words.number(station.position_m, 0), words.number(station.dwell_s, 0))
        for station in running.stations
    ]
    yield _rows_table("Stations", ("Station", "at, m", "dwell, s"), stations)


def _disturbance_tables(disturbance: Disturbance) -> Iterator[str]:
    """Yield what goes otherwise than planned; nothing where all goes as planned."""
    if disturbance == Disturbance():
        return
    yield _fields_table("Disturbances", _fields(disturbance))
    events = [(number, kind, event) for kind in EVENTS for number, event in enumerate(getattr(disturbance, kind), 1)]
    for number, kind, event in events[:MOST_ROWS]:
        yield _fields_table(f"Event: {kind.replace('_', ' ').removesuffix('s')} {number}", _fields(event))


def _fields_table(title: str, rows: Iterator[Row] | Sequence[Row]) -> str:
    """Return a table of names, values and units; nothing without rows."""
    cells = list(rows)
    return table(title, ("Quantity", "Value", "Unit"), ((row, False) for row in cells)) if cells else ""


def _rows_table(title: str, head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return a table, shortened where it is long; nothing without rows."""
    if not rows:
        return ""
    left_out = len(rows) - MOST_ROWS
    more = f'<p class="note">{left_out} more rows in the scenario below.</p>' if left_out > 0 else ""
    return f"{table(title, head, ((row, False) for row in rows[:MOST_ROWS]))}{more}"
