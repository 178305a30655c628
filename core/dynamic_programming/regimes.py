"""The run of given regimes, for advice with few changes of regime.

A driver who is advised wants few instructions. So a cell is driven in one of four regimes: full power, a speed that is
held, coasting, braking; and between two stops the regime changes at most a given number of times. `recursion` finds
such runs with the labels of `labels.regime_labels`; here they are driven with a regime that ends within a cell.
"""

import numpy as np

from railjoule.core.arrays import FloatArray, IntArray
from railjoule.core.compiled import njit
from railjoule.core.dynamic_programming.grid import exit_under
from railjoule.core.dynamic_programming.steps import BRAKE, HOLD, POWER, ROUNDING
from railjoule.core.motion.cell_step import COAST, FULL_BRAKE, FULL_TRACTION
from railjoule.core.physics.cell import Cell
from railjoule.core.physics.mesh_data import MeshData, TrainLimits, cell_at, limits_at, shared_by_cells


@njit(cache=True, error_model="numpy", nogil=True)
def drive_regimes(
    mesh: MeshData,
    fastest_speed2: FloatArray,
    planned2: FloatArray,
    regimes: IntArray,
    cell_number: int,
    share: float,
) -> FloatArray:
    """Return the run of given regimes, one cell of which is driven in two.

    It keeps below the greatest speeds, which end in full braking, and brakes for the planned speeds where it is to
    brake. The one cell mixes its regime, up to a share of its length, with that of the next cell.

    Parameters
    ----------
    mesh : MeshData
        The line and the train.
    fastest_speed2, planned2 : array of shape (nodes,)
        Greatest feasible squares of speed, and those of the run whose brakes are taken over [m2/s2].
    regimes : array of shape (nodes - 1,)
        The regime of each cell.
    cell_number, share : int and float
        The cell that is driven in two regimes, and the share of its own one.

    Returns
    -------
    array of shape (nodes,)
        Squares of speed [m2/s2]; -1 from where the train comes to a stand or cannot keep below the greatest.
    """
    nodes = planned2.shape[0]
    shared = shared_by_cells(mesh)
    speed2 = np.full(nodes, -1.0)
    speed2[0] = planned2[0]
    for i in range(nodes - 1):
        cell, entering, limits = cell_at(mesh, i), speed2[i], limits_at(shared, i)
        leaving = _exit_of_regime(limits, cell, entering, regimes[i], planned2[i + 1])
        if i == cell_number and i + 1 < nodes - 1:
            other = _exit_of_regime(limits, cell, entering, regimes[i + 1], planned2[i + 1])
            leaving = share * leaving + (1.0 - share) * other
        least = exit_under(limits, cell, entering, FULL_BRAKE)
        if regimes[i] == BRAKE:
            # a train that is faster than planned brakes fully until the plan is met
            leaving = max(leaving, least)
        leaving = min(leaving, fastest_speed2[i + 1])
        fixed = mesh.fixed_speed2[i + 1]
        if fixed >= 0.0 and leaving >= fixed * (1.0 - ROUNDING):
            leaving = fixed
        stands = leaving <= 0.0 and fixed != 0.0
        if stands or leaving < least - ROUNDING * fastest_speed2.max() or (fixed >= 0.0 and leaving != fixed):
            break
        speed2[i + 1] = leaving
    return speed2


@njit(cache=True, error_model="numpy")
def _exit_of_regime(limits: TrainLimits, cell: Cell, entering_speed2: float, regime: int, planned2: float) -> float:
    """Return the square of speed to which a regime leads, braking no further than to a planned one [m2/s2]."""
    if regime in (POWER, HOLD):
        top = exit_under(limits, cell, entering_speed2, FULL_TRACTION)
        # a speed that full power does not hold is no speed that is held
        return top if regime == POWER else min(entering_speed2, top)
    coasted = exit_under(limits, cell, entering_speed2, COAST)
    return min(coasted, planned2) if regime == BRAKE else coasted
