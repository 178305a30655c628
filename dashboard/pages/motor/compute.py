"""A plan through the control loop of its motors, and the runs to compare with."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from railjoule.core import Scenario, SolverError, StrategyRefusedError, TimetableError, Trajectory, load_scenario
from railjoule.core.arrays import frozen_array
from railjoule.core.scenario.drive import CopperLoss, Induction
from railjoule.core.simulation.actual_vehicle import actual_vehicle
from railjoule.core.simulation.field_oriented import (
    FieldOrientedRun,
    Ripple,
    current_ripple,
    simulate_field_oriented,
)
from railjoule.core.strategies import prepare_task, run_strategy
from railjoule.core.studies.flux_sweep import FluxSweep, sweep_flux
from railjoule.core.studies.motor_map import MotorMap, OperatingPoints, induction_map, machine_points
from railjoule.core.units import MS_PER_KMH
from railjoule.dashboard.look.key_names import without_keys
from railjoule.dashboard.work.runs import named_refusals

MACHINE_SCENARIO = "ftorek-300s"
"""A shipped scenario whose drive has a machine."""
RIVALS: tuple[str, ...] = ("eoc", "enoc")
"""The strategies that the paper compares."""
DRAWN_POINTS = 120
"""Of a run in its machine's map, at most."""
Limits = Mapping[str, float]
"""Maximum amplitudes per phase of the inverter of one motor: `max_phase_voltage_v` and `max_current_a` [V, A]."""


@cache
def _example() -> Scenario:
    return load_scenario(MACHINE_SCENARIO)


def scenario_with_motor(scenario: Scenario) -> Scenario:
    """Return a scenario, or the example where its drive has no induction motor."""
    return _example() if limits_of(scenario) is None else scenario


def limits_of(scenario: Scenario) -> Limits | None:
    """Return the limits of a scenario's inverter; None where its drive has no induction machine."""
    drive = scenario.vehicle.drive
    if isinstance(drive, Induction):
        current_a = max(drive.starting_current_a, drive.braking_current_a)
        return {"max_phase_voltage_v": drive.max_phase_voltage_v, "max_current_a": current_a}
    if isinstance(drive, CopperLoss) and drive.machine is not None:
        machine = drive.machine
        return {"max_phase_voltage_v": machine.max_phase_voltage_v, "max_current_a": machine.max_current_a}
    return None


def limit_changes(scenario: Scenario, limits: Limits) -> Mapping[str, float]:
    """Return limits of a scenario's inverter by the keys of its file.

    If driving and braking have separate currents, the larger one is the limit, and bounds the other.
    """
    drive = scenario.vehicle.drive
    if not isinstance(drive, Induction):
        return {f"drive.machine.{name}": value for name, value in limits.items()}
    currents = {
        "drive.starting_current_a": drive.starting_current_a,
        "drive.braking_current_a": drive.braking_current_a,
    }
    largest, limit = max(currents.values()), limits["max_current_a"]
    return {
        "drive.max_phase_voltage_v": limits["max_phase_voltage_v"],
        **{key: limit if own == largest else min(own, limit) for key, own in currents.items()},
    }


def compute_loop_run(scenario: Scenario, strategy: str, changes: Mapping[str, Any]) -> FieldOrientedRun:
    """Return the run of a strategy's plan through the loop.

    Parameters
    ----------
    scenario : Scenario
    strategy : str
        It plans without the limits under test in the loop.
    changes : mapping
        Controller and limits by the keys of the scenario's file.

    Raises
    ------
    RailjouleError
        If a value is out of its bounds, there is no such plan, or the drive has no machine.
    """
    in_loop = scenario.replace(strategy=strategy, **changes)
    return simulate_field_oriented(in_loop, _plan(scenario, strategy))


def _plan(scenario: Scenario, strategy: str) -> Trajectory:
    planned = scenario.replace(strategy=strategy)
    with named_refusals(planned):
        task = prepare_task(planned)
        task.require_timetable()
        return run_strategy(task, strategy)


@dataclass(frozen=True, eq=False)
class LoopRivals:
    """The runs with which a run is compared.

    Parameters
    ----------
    runs : mapping
        By the names that charts give them: the `run` itself; the run `with` and `without` the pre-compensator, one of
        which it is; the run with the `other flux`; the paper's strategies that take the scenario.
    refused : mapping
        Why a strategy does not take it.
    """

    runs: Mapping[str, FieldOrientedRun]
    refused: Mapping[str, str]


def compute_rivals(run: FieldOrientedRun) -> LoopRivals:
    """Return the runs with which a run is compared; errors as `compute_loop_run`."""
    scenario, options = run.scenario, run.scenario.simulation
    ahead = options.precompensator
    other = simulate_field_oriented(scenario.replace(**{"simulation.precompensator": not ahead}), run.planned)
    runs = {"run": run, **({"with": run, "without": other} if ahead else {"with": other, "without": run})}
    flux = "constant" if options.flux == "min_loss" else "min_loss"
    runs["other flux"] = simulate_field_oriented(scenario.replace(**{"simulation.flux": flux}), run.planned)
    refused: dict[str, str] = {}
    for name in RIVALS:
        if name == run.planned.strategy:
            # driven already: it is the run itself
            runs[name] = run
            continue
        try:
            runs[name] = simulate_field_oriented(scenario, _plan(run.planned.scenario, name))
        except (StrategyRefusedError, SolverError, TimetableError) as refusal:
            refused[name] = without_keys(str(refusal))
    return LoopRivals(runs, refused)


def compute_machine_map(run: FieldOrientedRun) -> tuple[MotorMap, OperatingPoints]:
    """Return the map of a run's machine, and the run in it."""
    found = induction_map(run.scenario)
    return found, spread_points(machine_points(run), found)


def spread_points(points: OperatingPoints, over: MotorMap) -> OperatingPoints:
    """Return fewer points that lie evenly along the way of a run through a map."""
    # as shares of the map, as N m and rad/s have no length in common
    sizes = np.ptp(over.torque_nm), np.ptp(over.speed_rads)
    steps = np.hypot(np.diff(points.torque_nm) / sizes[0], np.diff(points.speed_rads) / sizes[1])
    way = np.append(0.0, np.cumsum(steps))
    # by rounding, the end may be looked for beyond the last point
    chosen = np.unique(np.searchsorted(way, np.linspace(0.0, way[-1], DRAWN_POINTS)).clip(max=len(way) - 1))
    return OperatingPoints(frozen_array(points.torque_nm[chosen]), frozen_array(points.speed_rads[chosen]))


def compute_ripple(run: FieldOrientedRun, at_s: float) -> Ripple:
    """Return currents under switched voltage around a time, which is kept within the run."""
    return current_ripple(run, min(max(at_s, float(run.time_s[0])), float(run.time_s[-1])))


def compute_flux_sweep(scenario: Scenario, speed_kmh: float) -> FluxSweep:
    """Return losses, voltage, efficiency and power factor over the flux of a cruise; errors as `sweep_flux`."""
    return sweep_flux(actual_vehicle(scenario).vehicle, speed_kmh * MS_PER_KMH)
