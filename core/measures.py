"""Measures of a run, by which runs of different trains, lines and timetables can be compared."""

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

import numpy as np

from railjoule.core.units import J_PER_KWH, J_PER_WH, KG_PER_T, M_PER_KM, MS_PER_KMH, W_PER_KW

if TYPE_CHECKING:
    from railjoule.core.trajectory import Trajectory


def energy_per_km_kwh(run: "Trajectory") -> float:
    """Return the net energy from the supply over the length of the run [kWh/km]."""
    return run.energy_kwh / (run.distance_m / M_PER_KM)


def energy_per_tonne_km_wh(run: "Trajectory") -> float:
    """Return the net energy from the supply over length and mass, the load included [Wh/(t km)]."""
    tonne_km = run.scenario.vehicle.total_mass_kg / KG_PER_T * run.distance_m / M_PER_KM
    return run.energy.net_j / J_PER_WH / tonne_km


def mean_speed_kmh(run: "Trajectory") -> float:
    """Return the length of the run over its travel time, dwells included [km/h]."""
    return run.distance_m / run.travel_time_s / MS_PER_KMH


def max_supply_power_kw(run: "Trajectory") -> float:
    """Return the largest power from the supply, auxiliaries included [kW]."""
    return float(np.max(run.supply_power_w)) / W_PER_KW


def max_supply_current_a(run: "Trajectory") -> float | None:
    """Return the largest current from the supply [A]; None without a line voltage."""
    return None if run.supply_current_a is None else float(np.max(run.supply_current_a))


MEASURES: Mapping[str, Callable[["Trajectory"], float | None]] = {
    "energy_kwh": lambda run: run.energy_kwh,
    "energy_per_km_kwh": energy_per_km_kwh,
    "energy_per_tonne_km_wh": energy_per_tonne_km_wh,
    "recuperated_kwh": lambda run: run.energy.recuperated_j / J_PER_KWH,
    "travel_time_s": lambda run: run.travel_time_s,
    "mean_speed_kmh": mean_speed_kmh,
    "max_speed_kmh": lambda run: run.max_speed_kmh,
    "max_supply_power_kw": max_supply_power_kw,
    "max_supply_current_a": max_supply_current_a,
    "distance_m": lambda run: run.distance_m,
    "total_mass_kg": lambda run: run.scenario.vehicle.total_mass_kg,
    "lower_bound_kwh": lambda run: run.lower_bound_kwh,
    "gap": lambda run: run.gap,
}
"""Each measure by its name, which ends with its unit."""


def measure(run: "Trajectory") -> dict[str, float | None]:
    """Return all measures of a run by their names; None for one that it does not have."""
    return {name: value(run) for name, value in MEASURES.items()}
