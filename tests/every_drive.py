"""Every kind of drive with and without friction brakes, for one line and one train."""

from dataclasses import dataclass
from itertools import product

import numpy as np

from railjoule.core import load_scenario
from railjoule.core.motion import MeshedLine, build_meshed_line
from railjoule.core.scenario import Scenario
from tests.builders import COPPER_LOSS, INDUCTION, LOSS_POLYNOMIAL, plain_scenario

MAP_TORQUES, MAP_SPEEDS = np.linspace(0, 2400, 13), np.linspace(0, 400, 11)


def efficiency_points() -> list[tuple[float, float, float]]:
    """Return a map with the losses 800 W + 0.02 w^2 + 0.006 M^2 of a motor; ours."""
    points = []
    for torque, speed in product(MAP_TORQUES, MAP_SPEEDS):
        shaft, loss = torque * speed, 800 + 0.02 * speed**2 + 0.006 * torque**2
        points.append((float(torque), float(speed), float(shaft / (shaft + loss)) if shaft > 0 else 0.0))
    return points


GEAR = {"motors": 4, "gear_ratio": 5.0, "wheel_diameter_m": 0.8, "gear_loss_share": 0.02}
SYNCHRONOUS = load_scenario("kharkiv-like-40kmh").vehicle.drive.model_dump(exclude_none=True)
DRIVES = {
    "constant efficiency": {
        "model": "constant_efficiency",
        "traction_efficiency": 0.85,
        "braking_efficiency": 0.7,
        "recuperation_factor": 0.5,
    },
    "copper loss": {**COPPER_LOSS, "resistance_ohm": 0.3},
    "loss polynomial": {**LOSS_POLYNOMIAL, "motors": 4},
    "efficiency map": {"model": "efficiency_map", "points": efficiency_points(), **GEAR},
    "induction": {**INDUCTION, "motors": 8, "standstill_brake": False},
    "induction with a standstill brake": {**INDUCTION, "motors": 8},
    "synchronous": {**SYNCHRONOUS, "motors": 4},
}
FRICTIONS_KN = (0.0, 15.0, 120.0)
"""None; less than what is braked with; enough for all of it."""
FACTORS = (0.0, 0.37, 1.0)
"""Shares of the generated energy that the line takes back."""
HILLY = [
    {"length_m": 300.0, "gradient_permille": 4.0},
    {"length_m": 300.0, "gradient_permille": 18.0, "curve_radius_m": 400.0},
    {"length_m": 400.0, "gradient_permille": -25.0, "tunnel_factor": 1.6},
    {"length_m": 200.0},
]


def train(drive: str, friction_kn: float = 0.0, factor: float = 0.37, **changes: object) -> Scenario:
    """Return a metro car on a hilly line, with each kind of resistance."""
    return plain_scenario(
        {
            "vehicle.drive": {**DRIVES[drive], "recuperation_factor": factor},
            "vehicle.tare_kg": 60e3,
            "vehicle.braking.max_effort_kn": 60.0,
            "vehicle.braking.max_power_kw": 700.0,
            "vehicle.braking.friction_effort_kn": friction_kn,
            "vehicle.traction.max_effort_kn": 70.0,
            "vehicle.traction.max_power_kw": 800.0,
            "vehicle.traction.max_speed_kmh": 70.0,
            "vehicle.resistance.linear_n_per_kmh": 30.0,
            "vehicle.resistance.curve_constant_m_n_per_kn": 700.0,
            "vehicle.auxiliary_power_kw": 25.0,
            "line.sections": HILLY,
            **changes,
        }
    )


@dataclass(frozen=True)
class OneCell:
    """A meshed line of one cell with speeds at its ends [m/s]."""

    scenario: Scenario
    mesh: MeshedLine
    speeds: tuple[float, float]

    @property
    def speed2(self) -> np.ndarray:
        return np.square(self.speeds)


def one_cell(scenario: Scenario, length_m: float, start_ms: float, end_ms: float) -> OneCell:
    """Return the first cell of a line that is as long as is asked for."""
    section = {"length_m": length_m, "gradient_permille": 3.0}
    short = scenario.model_copy(update={"line": plain_scenario({"line.sections": [section]}).line})
    mesh = build_meshed_line(short, start_ms, end_ms, np.array([0.0, length_m]))
    return OneCell(short, mesh, (start_ms, end_ms))
