"""Limits for a regulator: those of line and stops with the braking curves before them, and set speeds of sections.

Set speeds hold for the front of the train. Limits of the line are kept in any case, by braking ahead at a constant
deceleration, no more than a braking curve of the vehicle has anywhere; a regulator that brakes keeps the set speeds in
the same way, a coasting one does not brake for them.
"""

from typing import NamedTuple

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.motion.meshed_line import MeshedLine
from railjoule.core.motion.passes import entering_speed2_under_brakes
from railjoule.core.physics.mesh_data import MeshData


class Regulation(NamedTuple):
    """A meshed line as a regulator sees it; n cells.

    Parameters
    ----------
    position_m : array of shape (n + 1,)
        Nodes [m].
    top_speed2 : array of shape (n,)
        Squares of the limit of line and vehicle within each cell [m2/s2].
    bound_speed2 : array of shape (n + 1,)
        The same at the nodes, where both neighbours count, and 0 at stops [m2/s2].
    deceleration_ms2 : float
        Of braking ahead [m/s2].
    brakes : bool
        Whether limits of sections are braked for.
    whole_cells : bool
        Whether the regulator takes one effort for each cell, as a run over this mesh has it, or changes its effort
        within cells, so that time and energy do not jump with the limits of a search.
    """

    position_m: FloatArray
    top_speed2: FloatArray
    bound_speed2: FloatArray
    deceleration_ms2: float
    brakes: bool
    whole_cells: bool = False


def make_regulation(mesh: MeshedLine, stop_deceleration_ms2: float, brakes: bool) -> Regulation:
    """Return the limits of a meshed line for a regulator that `brakes` for sections or coasts."""
    data = mesh.data
    bound = data.limit_speed2.copy()
    fixed = data.fixed_speed2 >= 0
    bound[fixed] = np.minimum(bound[fixed], data.fixed_speed2[fixed])
    # the start's speed is given: the train does not brake for it
    bound[0] = data.limit_speed2[0]
    return Regulation(
        position_m=mesh.position_m,
        top_speed2=mesh.cell_limit_ms**2,
        bound_speed2=bound,
        deceleration_ms2=min(stop_deceleration_ms2, data.max_deceleration_ms2, mesh.permitted_deceleration_ms2),
        brakes=brakes,
    )


@njit(cache=True, error_model="numpy")
def braking_curves(
    mesh: MeshData, regulation: Regulation, borders_m: FloatArray, limits_ms: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the squares of speed from which braking ahead still keeps all limits, and how they fall in each cell.

    Parameters
    ----------
    mesh : MeshData
        Train and line.
    regulation : Regulation
        Their limits for a regulator.
    borders_m : array of shape (k - 1,)
        Between sections, rising [m].
    limits_ms : array of shape (k,)
        Of the sections [m/s].

    Returns
    -------
    curve_speed2 : array of shape (n + 1,)
        At the nodes [m2/s2].
    fall_ms2 : array of shape (n,)
        By how much it falls over a metre within a cell while the train brakes [m/s2].
    """
    n = regulation.top_speed2.shape[0]
    curve, fall = np.empty(n + 1), np.empty(n)
    curve[n] = regulation.bound_speed2[n]
    section = limits_ms.shape[0] - 1
    # backwards, as the speed at a place depends only on the limits ahead
    if regulation.brakes:
        curve[n] = min(curve[n], limits_ms[section] * limits_ms[section])
    for i in range(n - 1, -1, -1):
        h = mesh.cell_length_m[i]
        # v^2 changes by 2 a h over a cell
        steepest = curve[i + 1] + 2.0 * regulation.deceleration_ms2 * h
        reached = entering_speed2_under_brakes(mesh, i, curve[i + 1], steepest)
        # down a hill too steep for its brakes the train must enter a cell slower than it leaves it
        fall[i] = (reached - curve[i + 1]) / h if reached >= 0.0 else 0.0
        end, value = regulation.position_m[i + 1], curve[i + 1]
        while regulation.brakes and section > 0 and borders_m[section - 1] >= regulation.position_m[i]:
            border = borders_m[section - 1]
            value = value + fall[i] * (end - border)
            # at the border itself both sections hold
            lower = min(limits_ms[section - 1], limits_ms[section])
            value = min(value, lower * lower)
            end = border
            section -= 1
        value = min(value + fall[i] * (end - regulation.position_m[i]), regulation.bound_speed2[i])
        if regulation.brakes:
            value = min(value, limits_ms[section] * limits_ms[section])
        curve[i] = value
    return curve, fall
