"""What the editor begins with where something new is added: rows of tables, drives of another kind."""

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

from railjoule.core import Scenario
from railjoule.core.scenario import preset_document, preset_names
from railjoule.core.scenario.drive import DriveParameters

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
"""What a new row between two others does not take from the one above it: it belongs to that place alone."""
SPEED_STEP_KMH = 10.0
FIRST_GEARED = {"motors": 4, "gear_ratio": 6.0, "wheel_diameter_m": 0.86}
"""Assumed, where neither the drive before nor a shipped vehicle tells; to be typed over."""
# without torque no power comes out: there the efficiency is zero
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
    # it has a slider beside every page, which must not jump
    return {**made, "recuperation_factor": before.recuperation_factor}


def first_rows(table: str, scenario: Scenario) -> list[Row]:
    """Return the rows that an empty table begins with; its key is a dotted path."""
    length, traction, braking = scenario.line.length_m, scenario.vehicle.traction, scenario.vehicle.braking
    stretch = {"from_m": float(round(length / 3)), "to_m": float(round(2 * length / 3)), "limit_kmh": FIRST_LIMIT_KMH}
    middle = length / 2
    neutral = {"from_m": round(middle, 1), "to_m": round(min(middle + FIRST_NEUTRAL_M, length), 1)}
    effort = traction.max_effort_kn or FIRST_EFFORT_KN
    electric = braking.max_effort_kn or effort
    rows: Mapping[str, list[Row]] = {
        "line.speed_limits": [stretch],
        "line.neutral_sections": [neutral],
        "line.passing_points": [_first_passing_point(scenario)],
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
        "vehicle.braking.curve": [
            {"speed_kmh": 0.0, "effort_kn": electric},
            {"speed_kmh": traction.max_speed_kmh, "effort_kn": electric},
        ],
        "vehicle.braking.permitted_deceleration": [
            {"speed_kmh": 0.0, "deceleration_ms2": braking.max_deceleration_ms2 or FIRST_DECELERATION_MS2}
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
    elif table in {"line.stations", "line.passing_points"}:
        beyond = scenario.line.length_m
    else:
        beyond = row[key] + 2 * SPEED_STEP_KMH
    alike = {name: value for name, value in row.items() if name not in OF_ITS_PLACE}
    return [row, {**alike, key: (row[key] + beyond) / 2}]


def _first_passing_point(scenario: Scenario) -> Row:
    """Return a passing point that no station is near: in the middle between the two stops furthest apart."""
    line = scenario.line
    stops = sorted({0.0, *(station.position_m for station in line.stations), line.length_m})
    start, end = max(pairwise(stops), key=lambda ends: ends[1] - ends[0])
    limits = [section.speed_limit_kmh or FIRST_PASS_KMH for section in line.sections]
    limits += [limit.limit_kmh for limit in line.speed_limits]
    return {
        "name": "Passing point",
        "position_m": round((start + end) / 2, 1),
        "speed_kmh": min(FIRST_PASS_KMH, *limits),
    }
