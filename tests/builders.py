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

INDUCTION: dict[str, Any] = {
    "model": "induction",
    "motors": 4,
    "gear_ratio": 7.16,
    "wheel_diameter_m": 0.654,
    "gear_efficiency": 0.98,
    "pole_pairs": 2,
    "stator_resistance_ohm": 0.1116,
    "rotor_resistance_ohm": 0.1266,
    "stator_inductance_mh": 33.81,
    "rotor_inductance_mh": 33.81,
    "mutual_inductance_mh": 33.15,
    "rated_magnetising_current_a": 23.03,
    "rated_frequency_hz": 60.0,
    "hysteresis_loss_w": 300.0,
    "eddy_loss_w": 300.0,
    "mechanical_loss_torque_nm": 4.05,
    "max_phase_voltage_v": 310.27,
    "starting_current_a": 201.05,
    "braking_current_a": 148.67,
    "standstill_brake": True,
    "recuperation_factor": 0.5,
}
"""The tram that the findings identify; not the shipped one, so that their numbers can be told from ours."""

LOSS_POLYNOMIAL: dict[str, Any] = {
    "model": "loss_polynomial",
    "motors": 12,
    "gear_ratio": 5.33,
    "wheel_diameter_m": 0.78,
    "gear_loss_share": 0.025,
    "no_load_loss_w": 350.0,
    "speed_loss_w_per_rads": 2.0,
    "speed_loss_w_per_rads2": 0.03,
    "torque_loss_w_per_nm": 0.55,
    "torque_loss_w_per_nm2": 0.0046,
    "recuperation_factor": 1.0,
}
"""The metro's drive that the findings assume; gear and number of motors are ours."""

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


ACCOUNT_CASES = {
    "constant efficiency": plain_scenario(),
    "copper loss over hills": plain_scenario({"drive": COPPER_LOSS, "line.sections": HILLS}),
    "friction brakes": plain_scenario(
        {"vehicle.braking.max_effort_kn": 20.0, "vehicle.braking.friction_effort_kn": 80}
    ),
    "auxiliaries": plain_scenario({"vehicle.auxiliary_power_kw": 50.0}),
    "induction": plain_scenario({"drive": INDUCTION, "vehicle.tare_kg": 30e3}),
}
"""Scenarios that have each part of the energy account between them."""
