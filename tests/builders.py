"""Small scenarios for tests, described by what differs from one plain run."""

from collections.abc import Mapping
from typing import Any

from railjoule.core.scenario import Scenario, scenario_from_document
from railjoule.core.scenario.document import change_document

PLAIN: dict[str, Any] = {
    "title": "plain",
    "vehicle": {
        "name": "plain",
        "tare_kg": 100e3,
        "capacity_passengers": 400,
        "passenger_mass_kg": 75.0,
        "rotating_mass_factor": 0.1,
        "resistance": {"constant_n_per_kn": 2.0, "quadratic_n_per_kn_per_kmh2": 5e-4},
        "traction": {"max_effort_kn": 100.0, "max_power_kw": 1000.0, "max_speed_kmh": 100.0},
        "braking": {"max_effort_kn": 80.0},
        "drive": {"model": "constant_efficiency", "traction_efficiency": 0.85, "recuperation_factor": 0.5},
    },
    "line": {"sections": [{"length_m": 2000.0}]},
    "timetable": {"travel_time_s": 150.0},
    "solver": {"mesh_m": 10.0},
}
"""A flat line, one train: the shortest possible time is 110 s."""

COPPER_LOSS: dict[str, Any] = {
    "model": "copper_loss",
    "motors": 4,
    "gear_ratio": 5.0,
    "wheel_diameter_m": 0.8,
    "torque_per_amp_nm": 5.0,
    "resistance_ohm": 0.1,
    "recuperation_factor": 0.5,
}

HILLS: list[dict[str, Any]] = [
    {"length_m": 400.0},
    {"length_m": 300.0, "gradient_permille": 25.0},
    {"length_m": 500.0, "gradient_permille": -20.0, "speed_limit_kmh": 70.0},
    {"length_m": 500.0, "gradient_permille": 5.0, "curve_radius_m": 300.0},
    {"length_m": 300.0, "gradient_permille": -8.0},
]


def plain_scenario(changes: Mapping[str, Any] | None = None) -> Scenario:
    """Return the plain scenario with changed keys, named by their path in a file."""
    return scenario_from_document(change_document(PLAIN, changes or {}))
