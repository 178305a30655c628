"""The lesson that is driven: the meshed line that the browser drives on, and how a try compares with the optimum."""

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
from railjoule.dashboard.pages.learn.verdict import FASTER, MORE, Verdict, compare

PRESET = "metro-with-limit"
"""A metro train with a constant efficiency; "Open on Drive" opens it."""
LESSON_CHANGES = {"solver.mesh_m": 2.0}
"""A command holds for whole cells: of two metres, a tenth of a second at 72 km/h."""
TRIES = 3
DID = ("kept power", "coasted", "braked")
"""What a driver did, by the number of the command."""
DOES = {
    "full_power": "it uses full power",
    "part_power": "it uses part power",
    "hold": "it holds its speed",
    "coast": "it coasts",
    "brake": "it brakes",
    "stand": "it stands",
}
"""What the best run does, by the name of the phase."""
HERE = "From {place} m on you differ from the best run: {does}."
THERE = "You {did} to {place} m: there you are {speed} km/h {faster} and have used {energy} kWh {more}."


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


def begin(text: str) -> dict[str, Any]:
    """Return what the browser begins with: the line, and the run of a link to race; errors as `read_commands`."""
    scenario, mesh = lesson()
    run = driven_run(text) if text else None
    ghost = run and {"times": run.time_s.tolist(), "speeds": run.speed_ms.tolist()}
    return {"mesh": mesh_arrays(mesh), "timetable_s": scenario.travel_time_s, "tries": TRIES, "ghost": ghost}


def judge(text: str) -> Verdict:
    """Return how a try compares with the optimum; errors as `read_commands`."""
    scenario, mesh = lesson()
    commands, run, best = read_commands(text, mesh.cell_count), driven_run(text), best_run()
    node = parting_node(run, best)
    parting = None if node is None else {"position": float(run.nodes_m[node]), "node": node}
    sentences = () if node is None else _parting_words(run, best, commands, node)
    return compare(("driven", text), run, best, scenario.travel_time_s, sentences, parting=parting)


def _parting_words(run: Trajectory, best: Trajectory, commands: IntArray, node: int) -> tuple[str, str]:
    """Return where two runs part first, and what each does there."""
    # at the end of the cell, as a border between phases may lie within it
    phase = next(phase for phase in best.phases if phase.end_m >= run.nodes_m[node + 1])
    others = np.flatnonzero(commands[node:] != commands[node])
    end = node + int(others[0]) if len(others) else len(commands)
    faster = float(run.node_speed_ms[end] - best.node_speed_ms[end])
    cost = float(run.supply_energy_j[end] - best.supply_energy_j[end]) / J_PER_KWH
    there = THERE.format(
        did=DID[commands[node]],
        place=words.number(run.nodes_m[end], 0),
        speed=words.speed(abs(faster), 0),
        faster=FASTER[faster < 0],
        energy=words.energy(abs(cost)),
        more=MORE[cost < 0],
    )
    return HERE.format(place=words.number(run.nodes_m[node], 0), does=DOES[phase.phase]), there


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
    if data.starting_n > 0:
        raise ScenarioError("The lesson needs a train without starting resistance.")
    return {
        "position": mesh.position_m.tolist(),
        "length": data.cell_length_m.tolist(),
        "constant": (data.resistance_constant_n + data.line_force_n).tolist(),
        "running_constant": data.resistance_constant_n,
        "linear": data.resistance_linear,
        "quadratic": np.asarray(data.resistance_quadratic).tolist(),
        "gradient": mesh.gradient_force_n.tolist(),
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


def _limit(limit: EffortLimit) -> dict[str, Any]:
    return {"constant": limit.constant_n, "power": _finite(limit.power_w), "table": limit.table.tolist()}


def _finite(value: float) -> float | None:
    """Return a number that JSON can hold: None for one that is infinite."""
    return float(value) if np.isfinite(value) else None
