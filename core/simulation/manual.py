"""Manual driving: runs from a driver's commands, or from a drawn speed, with train protection.

A command to power, coast or brake holds for whole cells of the mesh, so that a bound that is proven over the mesh
covers the run. Protection holds the greatest feasible speed against a command that would exceed it, which keeps
limits and the last stop; it keeps walking pace against one that would leave the train slower.

A drawn speed is a limit: the run is the fastest one below it. The train stays below a drawing that rises faster than
its speed at full effort, and brakes before one that falls faster than its speed under full braking.
"""

import re

import numpy as np

from railjoule.core.arrays import FloatArray, IntArray
from railjoule.core.errors import ScenarioError
from railjoule.core.motion import MeshedLine
from railjoule.core.motion.cell_step import COAST, FULL_BRAKE, FULL_TRACTION
from railjoule.core.motion.driving import braking_envelope, drive
from railjoule.core.motion.passes import slowed_to_reach
from railjoule.core.physics.place_limits import NO_PLACE
from railjoule.core.scenario import Scenario
from railjoule.core.trajectory import BY_HAND, Trajectory, make_trajectory
from railjoule.core.units import MS_PER_KMH

COMMANDS = (FULL_TRACTION, COAST, FULL_BRAKE)
LETTERS = "pcb"
"""The commands in a text, in the order of COMMANDS."""
COMMANDS_TEXT = re.compile(r"p0(?:[pcb][1-9]\d{0,4}){0,1500}")
WALKING_PACE_MS = 5 * MS_PER_KMH
"""Lowest speed of a train on its way, which also keeps it from standing between two stops."""
# far above rounding, far below what anybody sees in a speed
PARTED_MS = 1.0 * MS_PER_KMH
"""Difference of speed at which two runs have parted."""


def drive_manually(scenario: Scenario, mesh: MeshedLine, commands: IntArray) -> Trajectory:
    """Return the run under commands.

    Parameters
    ----------
    scenario : Scenario
        The scenario of the run.
    mesh : MeshedLine
        Its meshed line, from rest or from a prescribed speed and without stops on the way.
    commands : array of shape (n,)
        One of COMMANDS for each cell.

    Raises
    ------
    ScenarioError
        If there is not one known command a cell, the mesh has neutral sections or stops, or full traction does not
        move the train.
    """
    require_drivable(mesh)
    given = np.asarray(commands)
    if given.shape != (mesh.cell_count,) or not np.isin(given, COMMANDS).all():
        raise ScenarioError(f"commands must have {mesh.cell_count:,} entries of 0, 1 or 2, one for each cell.")
    wanted2 = np.append(0.0, np.array([np.inf, 0.0, -np.inf])[given.astype(int)])
    speed2, stand = drive(
        mesh.data,
        wanted2,
        max(float(mesh.data.fixed_speed2[0]), 0.0),
        coasts=given == COAST,
        pace_speed2=WALKING_PACE_MS**2,
        highest_speed2=braking_envelope(mesh),
    )
    if stand >= 0:
        raise ScenarioError(f"The train comes to a stand at {mesh.position_m[stand - 1]:g} m under full traction.")
    return make_trajectory(scenario, mesh, BY_HAND, speed2)


def drive_drawn(scenario: Scenario, mesh: MeshedLine, drawn_ms: FloatArray) -> Trajectory:
    """Return the fastest run below a drawn speed.

    Parameters
    ----------
    scenario : Scenario
        The scenario of the run.
    mesh : MeshedLine
        Its meshed line, from rest or from a prescribed speed and without stops on the way.
    drawn_ms : array of shape (n + 1,)
        Speed at each node [m/s], raised to WALKING_PACE_MS where it is lower.

    Raises
    ------
    ScenarioError
        If there is not one finite speed of at least 0 for each node, or the train cannot keep moving so slowly.
    """
    drawn = np.asarray(drawn_ms, dtype=float)
    if drawn.shape != (mesh.cell_count + 1,) or not np.all(np.isfinite(drawn) & (drawn >= 0)):
        raise ScenarioError(f"drawn_ms must have {mesh.cell_count + 1:,} finite entries of at least 0 m/s.")
    wanted = np.minimum(np.maximum(drawn, WALKING_PACE_MS) ** 2, braking_envelope(mesh))
    entering = max(float(mesh.data.fixed_speed2[0]), 0.0)
    wanted[0] = min(entering, wanted[0])
    speed2 = slowed_to_reach(mesh.data, wanted)
    standing = np.flatnonzero(~(speed2[1:-1] > 0))
    if len(standing):
        raise ScenarioError(f"The train comes to a stand at {mesh.position_m[standing[0] + 1]:g} m.")
    if speed2[0] < entering * (1 - 1e-9):
        raise ScenarioError(f"drawn_ms falls too soon for the speed of {entering**0.5:g} m/s at the start.")
    return make_trajectory(scenario, mesh, BY_HAND, speed2)


def require_drivable(mesh: MeshedLine) -> None:
    """Raise ScenarioError if a meshed line has neutral sections, stops on the way, or limits of effort by place."""
    if np.any(mesh.data.supply_share < 1) or np.any(mesh.dwell_s > 0):
        raise ScenarioError("A line is driven by hand without neutral sections and without stops on the way.")
    if np.any(mesh.data.place != NO_PLACE):
        raise ScenarioError(
            "A line is driven by hand without limits of traction or rail conditions of a part of it "
            "(line.traction_limits, line.rail_conditions)."
        )


def read_commands(text: str, cells: int) -> IntArray:
    """Return a command for each cell from a text of letters, each with its first cell.

    Raises
    ------
    ScenarioError
        If the text does not begin with power at cell 0, or its cells do not rise up to the last one.
    """
    rows = re.findall(r"([pcb])(\d+)", text) if COMMANDS_TEXT.fullmatch(text) else []
    starts = [int(start) for _, start in rows]
    if not rows or starts != sorted(set(starts)) or starts[-1] >= cells:
        raise ScenarioError(
            f"driven must be letters p, c and b, each with a rising number of a cell below {cells:,}, from p0 on."
        )
    commands = np.zeros(cells, dtype=np.int64)
    for (letter, _), start in zip(rows, starts, strict=True):
        commands[start:] = LETTERS.index(letter)
    return commands


def parting_node(run: Trajectory, other: Trajectory) -> int | None:
    """Return the node from which on two runs over one mesh differ in speed, None where they never part.

    It is the last one before their speeds differ by PARTED_MS at which they were still alike, within a tenth of that.
    """
    gap = np.abs(run.node_speed_ms - other.node_speed_ms)
    parted = np.flatnonzero(gap >= PARTED_MS)
    if not len(parted):
        return None
    alike = np.flatnonzero(gap[: parted[0]] <= 0.1 * PARTED_MS)
    return int(alike[-1]) if len(alike) else 0
