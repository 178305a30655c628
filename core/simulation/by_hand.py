"""A run that is driven by hand: power, coast or brake in each cell, with train protection over the driver.

Protection keeps what a driver on a screen cannot: where a command would pass the greatest feasible speed it holds that
speed, so that limits and the last stop are kept, and where it would leave the train slower than walking pace it keeps
that pace. All else is the driver's. A command holds for whole cells of the mesh, so that a bound that is proven over
the mesh covers the run.
"""

import math
import re

import numpy as np

from railjoule.core.arrays import FloatArray, IntArray
from railjoule.core.compiled import njit
from railjoule.core.errors import ScenarioError
from railjoule.core.motion import Course
from railjoule.core.motion.cell_step import COAST, FULL_BRAKE, FULL_TRACTION, exit_speed2
from railjoule.core.physics.course_data import CourseData, cell_of, shared_by_cells
from railjoule.core.scenario import Scenario
from railjoule.core.simulation.driver import braking_envelope
from railjoule.core.trajectory import BY_HAND, Trajectory, make_trajectory
from railjoule.core.units import MS_PER_KMH

COMMANDS = (FULL_TRACTION, COAST, FULL_BRAKE)
LETTERS = "pcb"
"""The commands in a text, in that order."""
COMMANDS_TEXT = re.compile(r"p0(?:[pcb][1-9]\d{0,4}){0,1500}")
WALKING_PACE_MS = 5 * MS_PER_KMH
"""A train on its way is not left slower than this, which also keeps it from standing between two stops."""
# far above rounding, far below what anybody sees in a speed
PARTED_MS = 1.0 * MS_PER_KMH
"""Two runs whose speeds differ by this have parted."""


def drive_by_hand(scenario: Scenario, course: Course, commands: IntArray) -> Trajectory:
    """Return the run to which commands lead.

    Parameters
    ----------
    scenario : Scenario
        What was asked for.
    course : Course
        Its course, from rest or from a prescribed speed and without stops on the way.
    commands : array of shape (n,)
        One of COMMANDS for each cell.

    Raises
    ------
    ScenarioError
        If there is not one known command a cell, the course has neutral sections or stops, or full traction does not
        move the train.
    """
    require_drivable(course)
    given = np.asarray(commands)
    if given.shape != (course.cell_count,) or not np.isin(given, COMMANDS).all():
        raise ScenarioError(f"commands must have {course.cell_count:,} entries of 0, 1 or 2, one for each cell.")
    speed2, standing = _commanded(course.data, braking_envelope(course), given.astype(np.int64), WALKING_PACE_MS**2)
    if standing >= 0:
        raise ScenarioError(f"The train comes to a stand at {course.position_m[standing]:g} m under full traction.")
    return make_trajectory(scenario, course, BY_HAND, speed2)


def require_drivable(course: Course) -> None:
    """Raise ScenarioError if a course has neutral sections or stops on the way."""
    if np.any(course.data.supply_share < 1) or np.any(course.dwell_s > 0):
        raise ScenarioError("A line is driven by hand without neutral sections and without stops on the way.")


def read_commands(text: str, cells: int) -> IntArray:
    """Return a command for each cell from a text of letters, each with the cell from which it holds.

    Raises
    ------
    ScenarioError
        If the text begins otherwise than with power at cell 0, or its cells do not rise up to the last one.
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
    apart = np.abs(run.node_speed_ms - other.node_speed_ms)
    parted = np.flatnonzero(apart >= PARTED_MS)
    if not len(parted):
        return None
    alike = np.flatnonzero(apart[: parted[0]] <= 0.1 * PARTED_MS)
    return int(alike[-1]) if len(alike) else 0


@njit(cache=True, error_model="numpy", nogil=True)
def _commanded(
    course: CourseData, highest_speed2: FloatArray, commands: IntArray, pace_speed2: float
) -> tuple[FloatArray, int]:
    """Return squares of speed under commands, and the node at which the train stands; -1 where it arrives."""
    n = course.cell_length_m.shape[0]
    train, traction, braking, _ = shared_by_cells(course)
    speed2 = np.zeros(n + 1)
    speed2[0] = max(course.fixed_speed2[0], 0.0)
    for i in range(n):
        cell = cell_of(course, i)
        after = exit_speed2(cell, train, traction, braking, speed2[i], commands[i])
        if after < pace_speed2:
            most = exit_speed2(cell, train, traction, braking, speed2[i], FULL_TRACTION)
            after = max(after, min(most, pace_speed2))
        after = min(after, highest_speed2[i + 1])
        if after <= 0.0 and (i < n - 1 or math.isnan(after)):
            return speed2, i
        speed2[i + 1] = after
    return speed2, -1
