"""The account of a cell: which efforts its force takes, what the drive takes or generates, what the line gives.

All that counts energy counts it here: dynamic programming, trips under limits, the account of a trajectory. The
interior-point method minimises the same with the efforts as variables, which no optimum leaves elsewhere.
"""

import math
from typing import NamedTuple

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import Numbers, njit
from railjoule.core.drive.kernels import driving_power, generated_power
from railjoule.core.drive.kinds import PowerTerms
from railjoule.core.drive.line_power import line_power
from railjoule.core.physics.braking import electric_effort
from railjoule.core.physics.cell import Cell, duration, mean_speed, needed_force
from railjoule.core.physics.effort_limit import EffortLimit, max_effort
from railjoule.core.physics.mesh_data import MeshData, Train, cell_at, limits_at, shared_by_cells

# downhill a run may need no energy at all: differences are then small beside the kinetic energy, not beside zero
SMALL_ENERGY_SHARE = 0.1
"""Energies near zero are compared with this share of the kinetic energy at the mean speed."""


class CellBalance(NamedTuple):
    """Efforts, powers and time: numbers of one cell, or arrays of all cells of a run.

    Parameters
    ----------
    duration_s, mean_speed_ms : float or array of shape (n,)
        Time [s] and mean speed over it [m/s].
    tractive_effort_n, electric_braking_n, friction_braking_n : float or array of shape (n,)
        Efforts at the wheels, all positive [N].
    power_w : float or array of shape (n,)
        At the terminals of the drive, negative where it generates [W].
    supply_power_w : float or array of shape (n,)
        From the supply without auxiliaries, negative where it goes back [W].
    excess_n : float or array of shape (n,)
        By how much the effort exceeds the largest one [N]; below zero where there is more.
    """

    duration_s: Numbers
    mean_speed_ms: Numbers
    tractive_effort_n: Numbers
    electric_braking_n: Numbers
    friction_braking_n: Numbers
    power_w: Numbers
    supply_power_w: Numbers
    excess_n: Numbers


@njit(cache=True, error_model="numpy", forceinline=True)
def cell_balance(
    cell: Cell,
    train: Train,
    traction: EffortLimit,
    braking: EffortLimit,
    drive: FloatArray,
    start_speed2: float,
    end_speed2: float,
) -> CellBalance:
    """Return the account of a cell from one square of speed [m2/s2] to another, not both zero.

    Parameters
    ----------
    cell, train : Cell and Train
        Of a meshed line.
    traction, braking, drive : EffortLimits and array
        The meshed line's `traction`, `braking` and `drive_parameters`.
    start_speed2, end_speed2 : float
        Squares of speed [m2/s2].
    """
    # At the mean speed: the force is constant, so its work F v t = F h is exact; losses miss their mean by half of
    # their second derivative times the variance of the speed, little in a short cell.
    v = mean_speed(math.sqrt(start_speed2), math.sqrt(end_speed2))
    force = needed_force(cell, start_speed2, end_speed2, v)
    # no force is coasting: traction of zero, so that a drive which idles when it is on is off
    kind = train.drive_kind
    if cell.supply_share < 1.0:
        # in a neutral section the drive is off: what a solver leaves of an effort takes no power
        driven, friction, power = max(force, 0.0), min(max(-force, 0.0), train.friction_effort_n), 0.0
        electric = max(-force, 0.0) - friction
        excess = max(force, -force - train.friction_effort_n)
    elif force >= 0.0:
        driven, electric, friction = force, 0.0, 0.0
        power = driving_power(kind, drive, force, v)[0]
        excess = force - max_effort(traction, v)
    else:
        strongest = max_effort(braking, v)
        driven, electric = 0.0, electric_effort(kind, drive, -force, v, strongest, train.friction_effort_n)
        friction = -force - electric
        power = -generated_power(kind, drive, electric, v)[0]
        # by both brakes together: how they share does not matter to the limit
        excess = -force - strongest - train.friction_effort_n
    taken = line_power(power, train.recuperation_factor)
    return CellBalance(duration(cell.length_m, v), v, driven, electric, friction, power, taken, excess)


@njit(cache=True, error_model="numpy", nogil=True)
def run_energy(mesh: MeshData, speed2: FloatArray) -> float:
    """Return the line energy of a run without auxiliaries [J], for squares of speed at the nodes of shape (n + 1,)."""
    shared = shared_by_cells(mesh)
    total = 0.0
    for i in range(mesh.cell_length_m.shape[0]):
        train, traction, braking, drive = limits_at(shared, i)
        account = cell_balance(cell_at(mesh, i), train, traction, braking, drive, speed2[i], speed2[i + 1])
        total += account.supply_power_w * account.duration_s
    return total


@njit(cache=True, error_model="numpy", nogil=True)
def run_balance(mesh: MeshData, speed2: FloatArray) -> CellBalance:
    """Return the account of a run from squares of speed at its nodes [m2/s2], of shape (n + 1,)."""
    n = mesh.cell_length_m.shape[0]
    rows, shared = np.empty((8, n)), shared_by_cells(mesh)
    for i in range(n):
        train, traction, braking, drive = limits_at(shared, i)
        account = cell_balance(cell_at(mesh, i), train, traction, braking, drive, speed2[i], speed2[i + 1])
        for row in range(8):
            rows[row, i] = account[row]
    return CellBalance(rows[0], rows[1], rows[2], rows[3], rows[4], rows[5], rows[6], rows[7])


@njit(cache=True, error_model="numpy")
def energy_per_metre(power: PowerTerms, speed: float) -> PowerTerms:
    """Return E [J/m] and E_f, E_v, E_ff, E_fv, E_vv for a power at a speed [m/s] and its derivatives.

    E_v = (P_v - E) / v, E_fv = (P_fv - E_f) / v, E_vv = (P_vv - 2 E_v) / v, from v E = P differentiated once and
    twice.
    """
    p, p_f, p_v, p_ff, p_fv, p_vv = power
    inverse = 1.0 / speed
    e, e_f = p * inverse, p_f * inverse
    e_v = (p_v - e) * inverse
    return e, e_f, e_v, p_ff * inverse, (p_fv - e_f) * inverse, (p_vv - 2.0 * e_v) * inverse


@njit(cache=True)
def reference_energy(mesh: MeshData, energy: float, running_time: float) -> float:
    """Return the size of an energy [J], but no less than a share of the kinetic energy at a run's mean speed.

    Parameters
    ----------
    mesh : MeshData
    energy : float
        The energy to be compared [J].
    running_time : float
        Time of the run, dwells not included [s].
    """
    mean = mesh.cell_length_m.sum() / running_time
    smallest: float = SMALL_ENERGY_SHARE * mesh.half_inertia_kg * mean * mean
    return max(abs(energy), smallest)
