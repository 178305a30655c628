"""Quantities of Liashenko, Yatsko 2025 that `assets/papers/liashenko-2025.toml` compares with the paper.

Tables 4 to 7 are judged by two measures: overconsumption by (12), over the plan for half load, and above a plan for the
actual load. Effort, resistance and controller are not printed, so that single numbers of these tables decide nothing;
orders and signs do.
"""

from collections.abc import Iterable, Mapping
from functools import cache
from typing import Any

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.energy import share_above
from railjoule.core.scenario import Scenario, load_scenario
from railjoule.core.simulation.following import follow, plan_for
from railjoule.core.strategies import solve
from railjoule.core.studies.table import StudyTable
from railjoule.core.trajectory import Trajectory
from railjoule.core.units import MS_PER_KMH, N_PER_KN, STANDARD_GRAVITY_MS2
from railjoule.core.validation.liashenko_runs import (
    MIN_SHOWN,
    PAPER,
    above_own_time,
    both_directions,
    compared_table,
    compared_tables,
    example,
    plan_knowing,
    rms,
)

Quantities = dict[str, Any]

MEASURES = ("by_plan", "by_load", "printed")
SMALL_PERCENT = 1e-6
"""A plan and its own run differ by less than this [%]."""
SPEED_ERRORS = (-0.05, -0.02, 0.02, 0.05)
SENSOR_ERRORS_M = (-5.0, -2.0, 2.0, 5.0)
DECELERATIONS_MS2 = (0.3, 0.4, 0.5, 0.6, 0.8)
MESHES_M = (10.0, 5.0, 1.0)
PASSENGER_KG = 75.0
"""Mass of a passenger below (4)."""


def cells(place: str) -> list[Quantities]:
    """Compute the cells of one of Tables 4 to 7 by both measures, with the reasons of their differences."""
    table = compared_table(place)
    loads = [_load(table, k) for k in range(len(table.load_factor))]
    records = []
    # in the order of the paper, whose rows are errors
    for m, error in enumerate(table.coordinate_error_m):
        for k, load in enumerate(loads):
            printed, by_plan, by_load = (table[key][k, m] for key in ("printed", "by_plan", "by_load"))
            records.append(
                {
                    **load,
                    "error": error,
                    "printed": float(printed),
                    "by_plan": by_plan,
                    "by_load": by_load,
                    "load_note": "assumed" if by_load >= 0 else load["load_note"],
                    "is_plan_off": abs(by_plan - printed) > MIN_SHOWN,
                    "is_load_off": abs(by_load - printed) > MIN_SHOWN,
                }
            )
    return records


def _load(table: StudyTable, k: int) -> Quantities:
    """Compute the quantities of a load of a table that explain its numbers: mass, plan, and the arrival below zero."""
    load, planned = table.load_factor[k], table.scenario.vehicle
    loaded = table.scenario.replace(**{"vehicle.load_factor": load}).vehicle
    mass = 100 * share_above(loaded.total_mass_kg, planned.total_mass_kg)
    change = 100 * share_above(table.replanned_kwh[k], table.planned_energy_kwh)
    below, late = table.by_plan[k] < 0, table.by_load[k] < -SMALL_PERCENT
    delay = float(np.max(table.delay_s[k, below], initial=0.0))
    plan_note = "heavier" if mass > 0 else "lighter_below_zero" if below.any() else "lighter"
    changes = {"disturbance.actual_load_factor": load}
    above = [
        above_own_time(both_directions(table.scenario, **changes, **{"disturbance.coordinate_error_m": error}))
        for error in np.compress(late, table.coordinate_error_m).tolist()
    ]
    return {
        "load": load,
        "mass": abs(mass),
        "change": change if mass > 0 else -change,
        "arrival": f"at most {delay:.1f} s late" if delay >= MIN_SHOWN else "not late",
        "stop_error_m": float(np.max(np.abs(table.stop_error_m[k, below]), initial=0.0)),
        "plan_note": "assumed" if load == planned.load_factor else plan_note,
        "load_note": "late" if late.any() else "assumed",
        "late_s": float(np.max(table.delay_s[k, late], initial=0.0)),
        "above": _range(above),
    }


def _range(shares: list[float]) -> str:
    """Return the smallest and the largest share in percent, or one of them if they read the same."""
    return " to ".join(dict.fromkeys(f"{100 * share:.1f}" for share in (min(shares), max(shares)))) if shares else ""


def summary(place: str) -> Quantities:
    """Compute the root mean square of the differences of a table by each measure, and its cells without an error."""
    table = compared_table(place)
    by_plan, by_load = (rms(table[key] - table.printed) for key in ("by_plan", "by_load"))
    corners = []
    for k in (0, -1):
        numbers = {key: float(_without_error(table, key)[k]) for key in MEASURES}
        words = {"by_plan": "(12)", "by_load": "the plan for the actual load"}
        same = [word for key, word in words.items() if numbers[key] * numbers["printed"] > 0]
        corners.append({"load": table.load_factor[k], **numbers, "same": " and ".join(same) or "neither"})
    nearer = "(12)" if by_plan < by_load else "the plan for the actual load"
    return {"by_plan": by_plan, "by_load": by_load, "nearer": nearer, "corners": corners}


def _without_error(table: StudyTable, key: str) -> FloatArray:
    """Return a column of a table over the loads, where the position has no error."""
    return table[key][:, table.coordinate_error_m.index(0)]


def followed_plan(entry: Quantities) -> Quantities:
    """Compute the plan of one of Figures 3 to 6 and the run that follows it."""
    run, own_plan = example(entry["place"])
    by_load = share_above(run.actual.energy_kwh, own_plan.energy_kwh)
    above = [above_own_time((load_scenario(entry["scenario"]),))] if by_load < 0 else []
    return {
        "planned_kwh": run.planned.energy_kwh,
        "by_plan": 100 * run.overconsumption,
        "by_load": 100 * by_load,
        "is_below_plan": run.overconsumption < 0,
        "is_below_load": by_load < 0,
        "less": -100 * (own_plan.energy_kwh / run.planned.energy_kwh - 1),
        "delay_s": run.delay_s,
        "stop_error_m": run.stop_error_m,
        "arrival": f"{abs(run.delay_s):.1f} s {'late' if run.delay_s > 0 else 'early'}",
        "late_s": run.delay_s,
        "above": _range(above),
    }


def passenger_share() -> Quantities:
    """Compute the share of passengers in the mass of the train at full and at crush load [%]."""
    vehicle = _profiles()[0].vehicle
    masses = [
        vehicle.tare_kg + load * vehicle.capacity_passengers * vehicle.passenger_mass_kg
        for load in (1.0, vehicle.crush_load_factor)
    ]
    shares = [100 * (1 - vehicle.tare_kg / mass) for mass in masses]
    return {"full": shares[0], "crush": shares[1]}


def changes_by_mass() -> Quantities:
    """Compare plans for other loads with those for half load."""
    changes, speeds = [], []
    for plan in _plans():
        for load in (0.0, 1.0):
            own = plan_knowing(plan.scenario, load)
            changes.append(100 * share_above(own.energy_kwh, plan.energy_kwh))
            other = np.interp(plan.position_m, own.position_m, own.speed_ms)
            speeds.append(np.max(np.abs(other - plan.speed_ms)) / MS_PER_KMH)
    return {
        "low": min(changes),
        "high": max(changes),
        "least": min(map(abs, changes)),
        "speed_kmh": max(speeds),
        "wrong": max(abs(_without_error(table, "by_load")).max() for table in compared_tables()),
    }


@cache
def recursion() -> Quantities:
    """Compute the gap of the recursion, and the change of the optimum's energy with the mesh [%]."""
    gaps = [solve(scenario, "bellman").gap for scenario in _base_scenarios()]
    energies = np.array(
        [[solve(one.replace(**{"solver.mesh_m": mesh})).energy_kwh for mesh in MESHES_M] for one in _base_scenarios()]
    )
    return {
        "gap": 100 * max(gap if gap is not None else np.inf for gap in gaps),
        "mesh": 100 * np.max(np.abs(energies[:, :-1] / energies[:, -1:] - 1), axis=0),
        "count": len(gaps),
    }


def scheduled_times() -> Quantities:
    """Compute the times of the plans [s]."""
    figures = [example(entry["place"])[0].planned for entry in PAPER["figure"]]
    return {
        "figures": [plan.travel_time_s for plan in figures],
        "base": [plan.travel_time_s for plan in _plans()[::2]],
        "late_s": max(plan.travel_time_s - plan.scenario.travel_time_s for plan in (*figures, *_plans())),
    }


def passenger_weight() -> Quantities:
    """Compute the weight of a passenger, and its difference from the print."""
    weight = PASSENGER_KG * STANDARD_GRAVITY_MS2 / N_PER_KN
    return {"weight_kn": weight, "off": 100 * (weight / PAPER["passenger_weight_kn"] - 1)}


def gradient() -> Quantities:
    """Compute the energies of profile 0 there and back."""
    up, down = (plan.energy_kwh for plan in _plans()[:2])
    return {"up": up, "down": down, "more": 100 * share_above(up, down)}


def stops() -> Quantities:
    """Compute the largest stopping error of Tables 4 to 7."""
    worst = max(float(np.max(np.abs(table.stop_error_m))) for table in compared_tables())
    errors = max(float(np.max(np.abs(table.coordinate_error_m))) for table in compared_tables())
    return {"worst_m": worst, "errors_m": errors, "share": worst / errors}


def speed_sensor() -> Quantities:
    """Compute the stops with errors of the measured speed, with and without precision braking."""
    changes = [{"simulation.speed_error": error} for error in SPEED_ERRORS]
    worst, without = (_worst_stop_m(changes, is_braking) for is_braking in (True, False))
    late = max(follow(plan, plan.scenario.replace(**changes[-1])).delay_s for plan in _plans())
    return {"worst_m": worst, "without_m": without, "share": worst / without, "late_s": late}


def sensors(places: list[int]) -> Quantities:
    """Compute the stops with deviations of some of the sensors D1 to D3."""
    errors = [[error if k == place else 0.0 for k in range(3)] for place in places for error in SENSOR_ERRORS_M]
    options = _base_scenarios()[0].simulation
    return {
        "share": _worst_stop_m([{"simulation.sensor_errors_m": one} for one in errors]) / max(SENSOR_ERRORS_M),
        "calibration_m": options.calibration_length_m,
        "stop_sensor_m": options.stop_sensor_m,
    }


def decelerations() -> Quantities:
    """Compute the energy of plans over the deceleration of the target curve [kWh]."""
    totals = [
        sum(
            plan_for(one.replace(**{"simulation.target_deceleration_ms2": deceleration})).energy_kwh
            for one in _base_scenarios()
        )
        for deceleration in DECELERATIONS_MS2
    ]
    return {
        "totals": ", ".join(f"{total:.1f}" for total in totals),
        "steps": ", ".join(f"{deceleration:g}" for deceleration in DECELERATIONS_MS2),
        "largest_rise": max(np.diff(totals)),
    }


def braking_zone() -> Quantities:
    """Compute the speeds at which optimal runs would enter the zone of precision braking [km/h]."""
    free = _plans(is_braking=False)
    options: Any = free[0].scenario.simulation
    top: Any = free[0].scenario.vehicle.traction.max_speed_kmh
    zone, deceleration = options.reset_sensor_m, options.target_deceleration_ms2
    permitted = np.sqrt(2 * deceleration * zone) / MS_PER_KMH
    entering = [np.interp(run.position_m[-1] - zone, run.position_m, run.speed_ms) / MS_PER_KMH for run in free]
    return {
        "permitted": permitted,
        "slow": sum(speed <= permitted for speed in entering),
        "count": len(entering),
        "fastest": max(entering),
        "excess": max(entering) - permitted,
        "top": top,
        "distance_m": (top * MS_PER_KMH) ** 2 / (2 * deceleration),
    }


def cells_below_zero() -> Quantities:
    """Count the cells below zero by each measure."""
    tables = compared_tables()
    counts = {key: sum(int(np.sum(table[key] < -MIN_SHOWN)) for table in tables) for key in MEASURES}
    fourth = 100 * example("Fig. 4")[0].overconsumption
    return {**counts, "cells": sum(table.printed.size for table in tables), "fourth": fourth}


def largest(place: str) -> Quantities:
    """Compute the largest cell of a table by each measure."""
    table = compared_table(place)
    places = {key: np.unravel_index(np.argmax(table[key]), table.printed.shape) for key in MEASURES}
    found = {
        key: {"most": table[key][k, m], "error": table.coordinate_error_m[m], "load": table.load_factor[k]}
        for key, (k, m) in places.items()
    }
    return {**found, "is_same": places["by_plan"] == places["printed"]}


def max_values() -> Quantities:
    """Compute the largest values of Tables 4 to 7 by each measure, and whether they grow by one of them."""
    values = {key: [float(table[key].max()) for table in compared_tables()] for key in MEASURES}
    return {**values, "grows": any(np.all(np.diff(values[key]) > 0) for key in ("by_plan", "by_load"))}


def effects(claim: Quantities) -> Quantities:
    """Compute the largest effect of the position error and of the load, each without the other [points]."""
    tables = [compared_table(place) for place in claim["places"]]
    found = {key: [_effects(table, key) for table in tables] for key in MEASURES}
    held = {key: sum((a > b) == claim["is_position"] for a, b in found[key]) for key in MEASURES}
    return {**found, "held": held}


def _effects(table: StudyTable, key: str) -> tuple[float, float]:
    position = table[key][table.load_factor.index(table.scenario.vehicle.load_factor)]
    return float(np.max(np.abs(position))), float(np.max(np.abs(_without_error(table, key))))


def _profiles() -> list[Scenario]:
    return [load_scenario(entry["scenario"]) for entry in PAPER["table"]]


@cache
def _plans(is_braking: bool = True) -> tuple[Trajectory, ...]:
    """Return the plans for 35 km/h of the four profiles, there and back, with or without precision braking."""
    changes = {} if is_braking else {"simulation.target_braking": False}
    return tuple(plan_for(one) for profile in _profiles() for one in both_directions(profile, **changes))


def _base_scenarios() -> list[Scenario]:
    return [plan.scenario for plan in _plans()]


def _worst_stop_m(changes: Iterable[Mapping[str, Any]], is_braking: bool = True) -> float:
    """Return the largest stopping error of runs that follow the plans under changes [m]."""
    return max(
        abs(follow(plan, plan.scenario.replace(**change)).stop_error_m)
        for change in changes
        for plan in _plans(is_braking)
    )
