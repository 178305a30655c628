"""The lesson that is driven: the line for the browser, and the comparison of a try with the optimum."""

from functools import cache
from typing import Any

import numpy as np

from railjoule.core import Scenario, ScenarioError, Trajectory, load_scenario, solve
from railjoule.core.arrays import IntArray
from railjoule.core.drive.geared import BRAKING_EFFICIENCY, TRACTION_EFFICIENCY
from railjoule.core.drive.kinds import CONSTANT_EFFICIENCY
from railjoule.core.motion import MeshedLine, build_meshed_line
from railjoule.core.motion.driving import braking_envelope
from railjoule.core.motion.line_profile import height_profile, section_borders
from railjoule.core.simulation.manual import (
    WALKING_PACE_MS,
    drive_manually,
    parting_node,
    read_commands,
    require_drivable,
)
from railjoule.core.units import J_PER_KWH
from railjoule.dashboard.look import words
from railjoule.dashboard.pages.learn.verdict import (
    FASTER,
    MORE,
    Verdict,
    compare,
)

PRESET = "metro-with-limit"
"""A metro train with a constant efficiency; "Open on Drive" opens it."""
LESSON_CHANGES = {"solver.mesh_m": 2.0}
"""A command holds for whole cells: of two metres, a tenth of a second at 72 km/h."""
TRIES = 3
DID = ("kept power", "coasted", "braked")
"""Words for the action of a driver, by the number of the command."""
DOES = {
    "full_power": "it uses full power",
    "part_power": "it uses part power",
    "hold": "it holds its speed",
    "coast": "it coasts",
    "brake": "it brakes",
    "stand": "it stands",
}
"""Words for the action of the best run, by the name of the phase."""
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
    """Return the initial data of the browser: the line, and the run of a link to race; errors as `read_commands`."""
    scenario, mesh = lesson()
    run = driven_run(text) if text else None
    ghost = run and {"times": run.time_s.tolist(), "speeds": run.speed_ms.tolist()}
    heights = np.interp(mesh.position_m, section_borders(scenario.line), height_profile(scenario.line))
    return {
        "mesh": mesh_arrays(mesh),
        "heights": heights.tolist(),
        "timetable_s": scenario.travel_time_s,
        "tries": TRIES,
        "ghost": ghost,
    }


def judge(text: str) -> Verdict:
    """Return the comparison of a try with the optimum; errors as `read_commands`."""
    scenario, mesh = lesson()
    commands, run, best = read_commands(text, mesh.cell_count), driven_run(text), best_run()
    node = parting_node(run, best)
    parting = None if node is None else {"position": float(run.nodes_m[node]), "node": node}
    sentences = () if node is None else _parting_words(run, best, commands, node)
    return compare(("driven", text), run, best, scenario.travel_time_s, sentences, parting=parting)


def _parting_words(run: Trajectory, best: Trajectory, commands: IntArray, node: int) -> tuple[str, str]:
    """Return sentences on the first difference of two runs: its position, and the action of each run there."""
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
        If the train is not as simple as the script: a constant efficiency, no limit but force and power, no friction
        brakes, no auxiliaries, and a resistance without a linear part; or as `require_drivable`.
    """
    data = mesh.data
    require_drivable(mesh)
    quadratic = np.unique(data.resistance_quadratic)
    missing = (data.starting_n, data.resistance_linear, data.friction_effort_n, data.auxiliary_power_w)
    unlimited = (data.braking.power_w, data.max_acceleration_ms2, data.max_deceleration_ms2)
    tables = len(data.traction.table) + len(data.braking.table) + len(quadratic) - 1
    if data.drive_kind != CONSTANT_EFFICIENCY or any(missing) or np.any(np.isfinite(unlimited)) or tables:
        raise ScenarioError("The lesson needs a train of constant efficiency that only force and power limit.")
    return {
        "position": mesh.position_m.tolist(),
        "length": data.cell_length_m.tolist(),
        "constant": (data.resistance_constant_n + data.line_force_n).tolist(),
        "running_constant": data.resistance_constant_n,
        "quadratic": float(quadratic[0]),
        "gradient": mesh.gradient_force_n.tolist(),
        "highest2": braking_envelope(mesh).tolist(),
        "entering2": max(float(data.fixed_speed2[0]), 0.0),
        "pace2": WALKING_PACE_MS**2,
        "half_inertia": data.half_inertia_kg,
        "traction": data.traction.constant_n,
        "power": data.traction.power_w,
        "braking": data.braking.constant_n,
        "driving_efficiency": float(data.drive_parameters[TRACTION_EFFICIENCY]),
        "braking_efficiency": float(data.drive_parameters[BRAKING_EFFICIENCY]),
        "recuperated": data.recuperation_factor,
    }
