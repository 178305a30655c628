"""The driving loop: a train that is driven cell by cell, as closely to given speeds as its efforts allow.

Each rule of driving is a set of orders that `drive` obeys: a speed to hold, a plan to follow, a driver's commands, full
braking. An infinite square of speed stands for full traction, a negative infinite one for full braking.
"""

import math

import numpy as np

from railjoule.core.arrays import BoolArray, FloatArray
from railjoule.core.compiled import njit
from railjoule.core.motion.cell_step import COAST, FULL_BRAKE, FULL_TRACTION, exit_speed2
from railjoule.core.motion.meshed_line import FREE, MeshedLine
from railjoule.core.motion.passes import max_speeds
from railjoule.core.physics.cell import Cell
from railjoule.core.physics.effort_limit import EffortLimit
from railjoule.core.physics.mesh_data import MeshData, Train, cell_at, limits_at, shared_by_cells

STANDING_SPEED2 = 1e-9
"""Square of a speed that counts as standing, 0.03 mm/s: rounding of the last braking cell [m2/s2]."""
ROUNDING = 1e-10
"""Brakes reach a square of speed that they miss by less than this share: it is found by iteration."""


def drive(
    mesh: MeshData,
    wanted_speed2: FloatArray,
    entering_speed2: float,
    *,
    coasts: BoolArray | None = None,
    response_m: float = 0.0,
    pace_speed2: float = 0.0,
    highest_speed2: FloatArray | None = None,
) -> tuple[FloatArray, int]:
    """Drive a train over a meshed line of n cells.

    Parameters
    ----------
    mesh : MeshData
        Train and line.
    wanted_speed2 : array of shape (n + 1,)
        Squares of speed to reach at the nodes [m2/s2].
    entering_speed2 : float
        Square of speed at the first node [m2/s2].
    coasts : array of shape (n,), optional
        Cells without effort, unless the train would come to a stand there.
    response_m : float
        Length over which a deviation from the wanted squares of speed falls to 1/e; 0 for immediately [m].
    pace_speed2 : float
        Square of speed that the train keeps at least, as far as its traction suffices [m2/s2].
    highest_speed2 : array of shape (n + 1,), optional
        Squares of speed that train protection does not let it exceed [m2/s2].

    Returns
    -------
    speed2 : array of shape (n + 1,)
        Squares of speed [m2/s2]; at most 0 where the train comes to a stand, and 0 beyond.
    stand : int
        The node before the last at which the train stands; -1 if there is none.
    """
    return _drive(
        mesh,
        wanted_speed2,
        entering_speed2,
        np.zeros(len(wanted_speed2) - 1, dtype=np.bool_) if coasts is None else coasts,
        response_m,
        pace_speed2,
        np.full(len(wanted_speed2), np.inf) if highest_speed2 is None else highest_speed2,
    )


def brake_fully(mesh: MeshData, entering_speed2: float) -> tuple[FloatArray, float]:
    """Return squares of speed under full braking, 0 from the stand on, and the way to it [m]; NaN without a stand."""
    speed2, stand = drive(mesh, np.full(len(mesh.cell_length_m) + 1, -np.inf), entering_speed2)
    if speed2[-1] > 0.0:
        return speed2, math.nan
    # constant force within a cell: v^2 falls linearly, so its zero is found by proportion
    last = (stand if stand > 0 else len(speed2) - 1) - 1
    share = speed2[last] / (speed2[last] - speed2[last + 1])
    return np.maximum(speed2, 0.0), float(mesh.cell_length_m[:last].sum() + mesh.cell_length_m[last] * share)


def braking_envelope(mesh: MeshedLine) -> FloatArray:
    """Return the greatest squares of speed from which full braking keeps all limits and stops ahead; shape (n + 1,)."""
    # the start is left free: whether the train is slow enough there is the question
    fixed = mesh.data.fixed_speed2.copy()
    fixed[0] = FREE
    speed2, _, _ = max_speeds(mesh.data._replace(fixed_speed2=fixed))
    return speed2


@njit(cache=True, error_model="numpy")
def reachable_speed2(
    cell: Cell, train: Train, traction: EffortLimit, braking: EffortLimit, speed2: float, wanted2: float
) -> float:
    """Return the square of speed [m2/s2] nearest to a wanted one to which efforts within their limits lead.

    Negative where full effort does not bring the train through the cell.
    """
    most = exit_speed2(cell, train, traction, braking, speed2, FULL_TRACTION)
    if wanted2 >= most:
        return most
    least = exit_speed2(cell, train, traction, braking, speed2, FULL_BRAKE)
    return min(least, most) if least > wanted2 + ROUNDING * speed2 else wanted2


@njit(cache=True, error_model="numpy", nogil=True)
def _drive(
    mesh: MeshData,
    wanted_speed2: FloatArray,
    entering_speed2: float,
    coasts: BoolArray,
    response_m: float,
    pace_speed2: float,
    highest_speed2: FloatArray,
) -> tuple[FloatArray, int]:
    """Return squares of speed and the node of a stand; arguments as in `drive`."""
    n = mesh.cell_length_m.shape[0]
    shared = shared_by_cells(mesh)
    speed2 = np.zeros(n + 1)
    speed2[0] = entering_speed2
    for i in range(n):
        cell, before, wanted2 = cell_at(mesh, i), speed2[i], wanted_speed2[i + 1]
        train, traction, braking, _ = limits_at(shared, i)
        if response_m > 0.0 and i < n - 1:
            answered2 = wanted2 + (before - wanted_speed2[i]) * math.exp(-cell.length_m / response_m)
            # a deviation can exceed the last metres per second of a plan
            wanted2 = answered2 if answered2 > 0.0 else wanted2
        after = exit_speed2(cell, train, traction, braking, before, COAST) if coasts[i] else 0.0
        if not after > 0.0:
            after = reachable_speed2(cell, train, traction, braking, before, wanted2)
        if after < pace_speed2 and pace_speed2 > 0.0:
            most = exit_speed2(cell, train, traction, braking, before, FULL_TRACTION)
            after = max(after, min(most, pace_speed2))
        after = min(after, highest_speed2[i + 1])
        speed2[i + 1] = after
        if not after > 0.0:
            return speed2, i + 1 if i < n - 1 else -1
    return speed2, -1
