"""The line and the vehicle of a scenario as files of TTOBench 1.5, for other programs that read them."""

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np

from railjoule.core.errors import ScenarioError
from railjoule.core.motion.line_profile import limit_steps
from railjoule.core.scenario import Scenario, Vehicle
from railjoule.core.scenario.drive import ConstantEfficiency
from railjoule.core.units import MS_PER_KMH, N_PER_KN, STANDARD_GRAVITY_MS2

LIBRARY_VERSION = "TTOBench v1.5"
# what a change of value is; lengths in files have fewer digits
DIGITS_M = 6


@dataclass(frozen=True)
class ExportedFile:
    """A file of another program's format.

    Parameters
    ----------
    document : mapping
        What it holds.
    lost : tuple of str
        What the scenario tells and the format cannot, each in words.
    """

    document: Mapping[str, Any]
    lost: tuple[str, ...] = field(default=())

    def to_json(self) -> str:
        """Return the file's text."""
        return json.dumps(self.document, indent=4, allow_nan=False) + "\n"


def export_track(scenario: Scenario) -> ExportedFile:
    """Return the line of a scenario, in running order.

    Where the line has no limit, the vehicle's largest speed is written: the format needs one.
    """
    line = scenario.line.in_running_order()
    lost = []
    if any(section.tunnel_factor != 1 for section in line.sections):
        lost.append("tunnel_factor of sections: a track has tunnels by their cross sections.")
    if line.neutral_sections:
        lost.append("neutral_sections: a track has traction power everywhere.")
    if any(station.dwell_s for station in line.stations):
        lost.append("dwell times of stations: a journey has them.")
    begins = np.append(0.0, np.cumsum([section.length_m for section in line.sections])[:-1])
    borders, limits = limit_steps(line, scenario.vehicle.traction.max_speed_kmh)
    stops = [0.0, *(station.position_m for station in line.inner_stations), line.length_m]
    gradients = _steps(begins, [section.gradient_permille for section in line.sections])
    radii = _steps(begins, [section.curve_radius_m for section in line.sections])
    document: dict[str, Any] = {
        "metadata": _metadata(line.name or scenario.title or "railjoule_line"),
        "stops": {"unit": "m", "values": [_short(position) for position in stops]},
        "speed limits": {
            "units": {"position": "m", "velocity": "km/h"},
            "values": [[_short(place), float(limit)] for place, limit in zip(borders[:-1], limits, strict=True)],
        },
        "gradients": {"units": {"position": "m", "slope": "permil"}, "values": gradients},
    }
    if any(radius for _, radius in radii):
        document["curvatures"] = {
            "units": {"position": "m", "radius at start": "m", "radius at end": "m"},
            "values": [[place, *([radius or "infinity"] * 2)] for place, radius in radii],
        }
    return ExportedFile(document, tuple(lost))


def export_train(scenario: Scenario) -> ExportedFile:
    """Return the vehicle of a scenario with its load.

    Raises
    ------
    ScenarioError
        If the vehicle's file tells no largest effort or power of its motors, which a train of the format must have.
    """
    vehicle = scenario.vehicle
    effort, power, lost = _traction(vehicle)
    braking = vehicle.braking
    weight_kn = vehicle.total_mass_kg * STANDARD_GRAVITY_MS2 / N_PER_KN
    over_weight, terms = vehicle.specific_resistance, vehicle.resistance
    # without an electric brake there is no power either
    strongest = [braking.max_effort_kn, max((force for _, force in braking.curve or ()), default=None)]
    electric_kn = min((one for one in strongest if one is not None), default=effort)
    electric_kw = 0.0 if electric_kn == 0 else power if braking.max_power_kw is None else braking.max_power_kw
    quantities: dict[str, tuple[float | None, str]] = {
        "num coaches": (vehicle.car_count, "-"),
        "length": (vehicle.length_m, "m"),
        "mass": (vehicle.total_mass_kg, "kg"),
        "rho": (100 * (vehicle.total_inertia_kg / vehicle.total_mass_kg - 1), "%"),
        "max traction power": (power, "kW"),
        "max reg braking power": (electric_kw, "kW"),
        "max traction force": (effort, "kN"),
        "max reg braking force": (electric_kn, "kN"),
        "max pn braking force": (braking.friction_effort_kn, "kN"),
        "max acceleration": (vehicle.traction.max_acceleration_ms2, "m/s^2"),
        "max deceleration": (braking.max_deceleration_ms2, "m/s^2"),
        "max speed": (vehicle.traction.max_speed_kmh, "km/h"),
        "rolling resistance r0": ((terms.constant_n + weight_kn * over_weight.constant_n_per_kn) / N_PER_KN, "kN"),
        "rolling resistance r1": (
            (terms.linear_n_per_kmh + weight_kn * over_weight.linear_n_per_kn_per_kmh) / N_PER_KN,
            "kN/(km/h)",
        ),
        "rolling resistance r2": (
            (terms.quadratic_n_per_kmh2 + weight_kn * over_weight.quadratic_n_per_kn_per_kmh2) / N_PER_KN,
            "kN/(km/h)^2",
        ),
    }
    efficiencies, told = _efficiencies(vehicle)
    document: dict[str, Any] = {"metadata": _metadata(vehicle.name)}
    document |= {
        key: {"unit": unit, "value": float(f"{value:.12g}")}
        for key, (value, unit) in {**quantities, **efficiencies}.items()
        if value is not None
    }
    return ExportedFile(document, (*lost, *told, *_without_place(vehicle)))


def _traction(vehicle: Vehicle) -> tuple[float, float, list[str]]:
    """Return the largest tractive effort [kN] and power at the wheel [kW], and what they do not tell."""
    traction, lost = vehicle.traction, []
    curve = traction.curve or ()
    efforts = [traction.max_effort_kn, max((force for _, force in curve), default=None)]
    powers = [traction.max_power_kw, max((force * speed * MS_PER_KMH for speed, force in curve), default=None)]
    effort, power = (min((one for one in given if one is not None), default=None) for given in (efforts, powers))
    for name, limits in (("traction", traction), ("braking", vehicle.braking)):
        if limits.curve:
            lost.append(f"{name}.curve: a train has its largest effort and power alone.")
        if limits.breakdown_speed_kmh is not None:
            lost.append(f"{name}.breakdown_speed_kmh = {limits.breakdown_speed_kmh:g}: its power stays beyond it.")
    if effort is None or power is None:
        name = "max_effort_kn" if effort is None else "max_power_kw"
        raise ScenarioError(f"vehicle.traction.{name} is missing, and a train of TTOBench needs it.")
    return effort, power, lost


def _efficiencies(vehicle: Vehicle) -> tuple[dict[str, tuple[float | None, str]], list[str]]:
    drive = vehicle.drive
    if not isinstance(drive, ConstantEfficiency):
        return {}, [f"drive, whose model is {drive.model}: a train has constant efficiencies."]
    braking = drive.traction_efficiency if drive.braking_efficiency is None else drive.braking_efficiency
    lost = (
        []
        if drive.recuperation_factor == 1
        else [f"drive.recuperation_factor = {drive.recuperation_factor:g}: all that braking generates goes back."]
    )
    return {
        "efficiency traction": (100 * drive.traction_efficiency, "%"),
        "efficiency reg brake": (100 * braking, "%"),
    }, lost


def _without_place(vehicle: Vehicle) -> list[str]:
    lost = []
    if vehicle.braking.permitted_deceleration:
        lost.append("braking.permitted_deceleration: a train has no braking curve.")
    if vehicle.auxiliary_power_kw:
        lost.append(f"auxiliary_power_kw = {vehicle.auxiliary_power_kw:g}.")
    if vehicle.resistance.curve_constant_m_n_per_kn:
        lost.append(f"resistance.curve_constant_m_n_per_kn = {vehicle.resistance.curve_constant_m_n_per_kn:g}.")
    return lost


def _metadata(name: str) -> dict[str, str]:
    """Return what a file is; ids have letters, digits and underscores alone."""
    identifier = re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_") or "railjoule"
    return {"id": identifier, "created by": "railjoule", "library version": LIBRARY_VERSION}


def _steps(begins: np.ndarray, values: list[float]) -> list[list[float]]:
    """Return where a value begins that differs from the one before."""
    changed = [True, *(later != earlier for earlier, later in pairwise(values))]
    return [[_short(begin), value] for begin, value, new in zip(begins, values, changed, strict=True) if new]


def _short(position_m: float) -> float:
    return round(float(position_m), DIGITS_M)
