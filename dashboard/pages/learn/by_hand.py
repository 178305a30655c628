"""The lesson that is driven: the meshed line that the browser drives on, and how a try compares with the optimum."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from railjoule.core import Scenario, ScenarioError, Trajectory, load_scenario, solve
from railjoule.core.arrays import IntArray
from railjoule.core.drive.geared import BRAKING_EFFICIENCY, TRACTION_EFFICIENCY
from railjoule.core.drive.kinds import CONSTANT_EFFICIENCY
from railjoule.core.motion import MeshedLine, build_meshed_line
from railjoule.core.motion.driving import braking_envelope
from railjoule.core.physics.effort_limit import EffortLimit
from railjoule.core.simulation.manual import (
    WALKING_PACE_MS,
    drive_manually,
    parting_node,
    read_commands,
    require_drivable,
)
from railjoule.core.units import J_PER_KWH
from railjoule.dashboard.look import words

PRESET = "metro-with-limit"
"""A metro train with a constant efficiency; "Open in the workbench" opens it."""
LESSON_CHANGES = {"solver.mesh_m": 2.0}
"""A command holds for whole cells: of two metres, a tenth of a second at 72 km/h."""
DID = ("kept power", "coasted", "braked")
"""What a driver did, by the number of the command."""
HERE = "Here you part, at {place} m. The best run: {phase}."
THERE = "You {did} to {place} m: there you are {speed} km/h {faster} and have used {energy} kWh {more}."
FASTER, MORE = ("faster", "slower"), ("more", "less")
"""Words of a difference of speed and of energy that is not negative, and of one that is."""
BEYOND = {"losses": "Lost in motors and brakes", "resistance": "Lost to resistance", "auxiliary": "Auxiliaries"}
"""Where energy goes, by the name that the browser's account has for it."""
# a second behind the decimal point is rounding of the last cells
IN_TIME_S = 0.05


@dataclass(frozen=True)
class TryRequest:
    """A try: its commands as a text, such as p0c300b2200; empty where only the meshed line is asked for."""

    commands: str = ""


@dataclass(frozen=True, eq=False)
class TryResult:
    """What the browser is told.

    Parameters
    ----------
    request : TryRequest
    mesh : mapping
        What it drives on.
    verdict : mapping or None
        How the try compares with the optimum; None where there was none.
    """

    request: TryRequest
    mesh: Mapping[str, Any]
    verdict: Mapping[str, Any] | None = None


def judge(request: TryRequest) -> TryResult:
    """Return the meshed line and how a try compares with the optimum.

    Raises
    ------
    ScenarioError
        If the text is not one of commands for this meshed line.
    """
    _, mesh = lesson()
    arrays = mesh_arrays(mesh)
    if not request.commands:
        return TryResult(request, arrays)
    return TryResult(request, arrays, verdict_on(request.commands))


@cache
def lesson() -> tuple[Scenario, MeshedLine]:
    """Return the scenario of the lesson over its mesh, and its meshed line."""
    scenario = load_scenario(PRESET).replace(**LESSON_CHANGES)
    return scenario, build_meshed_line(scenario)


@cache
def best_run() -> Trajectory:
    """Return the optimum of the lesson, with its proven bound."""
    return solve(lesson()[0])


def driven_run(text: str) -> Trajectory:
    """Return the run of a try; errors as `read_commands`."""
    scenario, mesh = lesson()
    return drive_manually(scenario, mesh, read_commands(text, mesh.cell_count))


def mesh_arrays(mesh: MeshedLine) -> dict[str, Any]:
    """Return a meshed line as `driving.js` takes it, in SI units.

    Raises
    ------
    ScenarioError
        If its drive has no constant efficiency, or `railjoule.core.simulation.manual` does not take the meshed line.
    """
    data = mesh.data
    require_drivable(mesh)
    if data.drive_kind != CONSTANT_EFFICIENCY:
        raise ScenarioError("The lesson needs a drive with a constant efficiency.")
    return {
        "position": mesh.position_m.tolist(),
        "length": data.cell_length_m.tolist(),
        "constant": (data.resistance_constant_n + data.line_force_n).tolist(),
        "running_constant": data.resistance_constant_n,
        "linear": data.resistance_linear,
        "quadratic": np.asarray(data.resistance_quadratic).tolist(),
        "gradient": mesh.gradient_force_n.tolist(),
        "permille": mesh.gradient_permille.tolist(),
        "limit": mesh.cell_limit_ms.tolist(),
        "highest2": braking_envelope(mesh).tolist(),
        "entering2": max(float(data.fixed_speed2[0]), 0.0),
        "pace2": WALKING_PACE_MS**2,
        "half_inertia": data.half_inertia_kg,
        "traction": _limit(data.traction),
        "braking": _limit(data.braking),
        "friction": data.friction_effort_n,
        "most_acceleration": _finite(data.max_acceleration_ms2),
        "most_deceleration": _finite(data.max_deceleration_ms2),
        "auxiliary": data.auxiliary_power_w,
        "driving_efficiency": float(data.drive_parameters[TRACTION_EFFICIENCY]),
        "braking_efficiency": float(data.drive_parameters[BRAKING_EFFICIENCY]),
        "recuperated": data.recuperation_factor,
    }


def verdict_on(text: str) -> dict[str, Any]:
    """Return how a try compares with the optimum, in numbers and sentences; errors as `read_commands`."""
    scenario, mesh = lesson()
    commands, best = read_commands(text, mesh.cell_count), best_run()
    run = driven_run(text)
    late = run.travel_time_s - scenario.travel_time_s
    bound = best.bound
    assert bound is not None
    return {
        "commands": text,
        "kwh": run.energy_kwh,
        "time_s": run.travel_time_s,
        "late_s": late,
        "counts": late <= IN_TIME_S,
        "bound_kwh": bound.energy_j / J_PER_KWH,
        "proven": best.is_proven,
        "best_kwh": best.energy_kwh,
        "best_ms": best.speed_ms.tolist(),
        "above_kwh": ((run.supply_energy_j - best.supply_energy_j) / J_PER_KWH).tolist(),
        "parting": _parting(run, best, commands),
        "rows": beyond(run, best),
    }


def _parting(run: Trajectory, best: Trajectory, commands: IntArray) -> dict[str, Any] | None:
    """Return where two runs part first, and in words what each does there."""
    node = parting_node(run, best)
    if node is None:
        return None
    place = float(run.nodes_m[node])
    # at the end of the cell, as a border between phases may lie within it
    phase = next(phase for phase in best.phases if phase.end_m >= run.nodes_m[node + 1])
    others = np.flatnonzero(commands[node:] != commands[node])
    end = node + int(others[0]) if len(others) else len(commands)
    faster = float(run.node_speed_ms[end] - best.node_speed_ms[end])
    cost = float(run.supply_energy_j[end] - best.supply_energy_j[end]) / J_PER_KWH
    return {
        "position": place,
        "node": node,
        "here": HERE.format(place=words.number(place, 0), phase=words.PHASE_WORDS[phase.phase]),
        "there": THERE.format(
            did=DID[commands[node]],
            place=words.number(run.nodes_m[end], 0),
            speed=words.speed(abs(faster), 0),
            faster=FASTER[faster < 0],
            energy=words.energy(abs(cost)),
            more=MORE[cost < 0],
        ),
    }


def spent_kwh(run: Trajectory) -> dict[str, float]:
    """Return what a run has spent for good, by the names of BEYOND [kWh]."""
    account = run.energy
    spent = {
        "losses": sum(account.losses_j.values()),
        "resistance": account.running_resistance_j + account.curve_resistance_j,
        "auxiliary": account.auxiliary_j,
    }
    return {name: energy / J_PER_KWH for name, energy in spent.items()}


def beyond(run: Trajectory, best: Trajectory) -> list[tuple[str, float]]:
    """Return what a try took beyond the optimum, by where it went [kWh]; they sum to the whole."""
    mine, least = spent_kwh(run), spent_kwh(best)
    rows = [(word, mine[name] - least[name]) for name, word in BEYOND.items()]
    # a train without auxiliaries has no row of them
    return [row for row in rows if row[1] or row[0] != BEYOND["auxiliary"]]


def _limit(limit: EffortLimit) -> dict[str, Any]:
    return {"constant": limit.constant_n, "power": _finite(limit.power_w), "table": limit.table.tolist()}


def _finite(value: float) -> float | None:
    """Return a number that JSON can hold: None for one that is infinite."""
    return float(value) if np.isfinite(value) else None
