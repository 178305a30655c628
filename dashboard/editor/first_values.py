"""What the editor begins with where something new is added: rows of tables, drives of another kind."""

from collections.abc import Mapping, Sequence
from typing import Any

from railjoule.core import Scenario
from railjoule.core.scenario import preset_document, preset_names
from railjoule.core.scenario.drive import DriveParameters

Row = dict[str, Any]

FIRST_LIMIT_KMH, FIRST_STOP_S, FIRST_EFFORT_KN = 50.0, 30.0, 100.0
RISING = {"line.stations": "position_m", "vehicle.traction.curve": "speed_kmh"}
"""Tables whose rows must rise, and in what."""
SPEED_STEP_KMH = 10.0
FIRST_GEARED = {"motors": 4, "gear_ratio": 6.0, "wheel_diameter_m": 0.86}
"""Assumed, where neither the drive before nor a shipped vehicle tells; to be typed over."""
FIRST_MAP = [
    [torque, speed, efficiency]
    for torque, efficiency in ((0.0, 0.0), (500.0, 0.9), (1000.0, 0.9))
    for speed in (0.0, 200.0, 400.0)
]
"""An assumed map of one efficiency; to be pasted over."""


def drive_of_kind(model: str, before: DriveParameters) -> Row:
    """Return a drive of a kind: a shipped vehicle's where one has it, else assumed beside what `before` shares.

    Parameters
    ----------
    model : str
        The kind.
    before : DriveParameters
        The drive that it replaces.
    """
    made: Row = {"model": model}
    shipped = [preset_document("vehicles", name)["drive"] for name in preset_names("vehicles")]
    alike = [drive for drive in shipped if drive["model"] == model]
    if alike:
        made |= alike[0]
    else:
        made |= {name: getattr(before, name, value) for name, value in FIRST_GEARED.items()}
    if model == "efficiency_map":
        made["points"] = FIRST_MAP
    return {**made, "recuperation_factor": before.recuperation_factor}


def first_rows(table: str, scenario: Scenario) -> list[Row]:
    """Return the rows that an empty table begins with; its key is a dotted path."""
    length, traction = scenario.line.length_m, scenario.vehicle.traction
    stretch = {"from_m": float(round(length / 3)), "to_m": float(round(2 * length / 3)), "limit_kmh": FIRST_LIMIT_KMH}
    effort = traction.max_effort_kn or FIRST_EFFORT_KN
    rows: Mapping[str, list[Row]] = {
        "line.speed_limits": [stretch],
        "line.stations": [{"name": "Station", "position_m": float(round(length / 2)), "dwell_s": FIRST_STOP_S}],
        "disturbance.stops": [{"position_m": float(round(length / 2)), "duration_s": FIRST_STOP_S}],
        "disturbance.speed_limits": [stretch],
        "disturbance.voltage_changes": [{"line_voltage_factor": 0.8}],
        "disturbance.recuperation_changes": [{"recuperation_factor": 0.5}],
        "vehicle.resistance.car_kinds": [{"cars": scenario.vehicle.car_count or 1}],
        "vehicle.traction.curve": [
            {"speed_kmh": 0.0, "effort_kn": effort},
            {"speed_kmh": traction.max_speed_kmh, "effort_kn": effort},
        ],
    }
    return rows.get(table, [])


def row_after(table: str, rows: Sequence[Row], index: int, scenario: Scenario) -> list[Row]:
    """Return a row and the new one below it: a section is halved, a rising one lies between, others are alike."""
    row = rows[index]
    if table == "line.sections":
        half = {**row, "length_m": row["length_m"] / 2}
        return [half, half]
    key = RISING.get(table)
    if key is None:
        return [row, dict(row)]
    if index + 1 < len(rows):
        beyond = rows[index + 1][key]
    elif table == "line.stations":
        beyond = scenario.line.length_m
    else:
        beyond = row[key] + 2 * SPEED_STEP_KMH
    return [row, {**row, key: (row[key] + beyond) / 2}]
