"""Driving, braking and coasting in the optimum of a drive with idle losses, and decisions that follow it.

Sum-up rounding in time keeps the time for which the drive is on close to its share: within half of the most that one
stretch on and one off make up at that share. With no minimum on/off time, that is half a cell.

References: Sager, Bock, Diehl 2012, "The integer approximation error in mixed-integer optimal control", Math. Program.
133, 1-23. Zeile, Robuschi, Sager 2021, "Mixed-integer optimal control under minimum dwell time constraints", Math.
Program. 188, 653-694.
"""

import math
from typing import NamedTuple

import numpy as np

from railjoule.core.arrays import FloatArray, IntArray
from railjoule.core.compiled import njit
from railjoule.core.drive.kernels import has_standstill_brake, smooth_power_when_on
from railjoule.core.interior_point.solver import Optimum
from railjoule.core.interior_point.switching import FORBIDDING_PRICE, hull_power
from railjoule.core.motion.cell_step import COAST, exit_speed2
from railjoule.core.physics.cell import mean_speed, needed_force
from railjoule.core.physics.mesh_data import BRAKE, DRIVE, OFF, MeshData, cell_at, limits_at, shared_by_cells
from railjoule.core.physics.stretches import NEXT_TO_NOTHING, NOTHING

DRIVEN, COASTED = 0.98, 0.02
"""Shares of driving from which a cell counts as driven, and up to which as coasted."""


class Duty(NamedTuple):
    """On which share of each cell a drive that is switched at will is on, from 0 to 1; arrays of shape (n,)."""

    driving: FloatArray
    braking: FloatArray


@njit(cache=True, error_model="numpy", nogil=True)
def duty(mesh: MeshData, optimum: Optimum) -> Duty:
    """Return on which share of each cell the drive is on to drive, and on which to brake.

    Parameters
    ----------
    mesh : MeshData
    optimum : Optimum
        Of any decision where the drive is on.
    """
    h, w = mesh.cell_length_m, optimum.speed2
    kind, parameters, shared = mesh.drive_kind, mesh.drive_parameters, shared_by_cells(mesh)
    driving, braking = np.empty(h.shape[0]), np.empty(h.shape[0])
    another = has_standstill_brake(kind, parameters)
    for i in range(h.shape[0]):
        v = mean_speed(math.sqrt(w[i]), math.sqrt(w[i + 1]))
        train, traction, electric, _ = limits_at(shared, i)
        _, touch = hull_power(kind, parameters, False, traction, 0.0, v, 0.0)
        driving[i] = min(optimum.traction_n[i] / touch, 1.0)
        power, touch = hull_power(kind, parameters, True, electric, 0.0, v, 0.0)
        braking[i] = min(optimum.braking_n[i] / touch, 1.0)
        # Braking that gains nothing is left to the other brakes. How the optimum shares it between brakes that cost
        # the same is an accident of the barrier
        gains = power[1] < 0.0 and train.recuperation_factor > 0.0
        if another and optimum.braking_n[i] > touch:
            # next to a stop the effort that is needed may draw, though a smaller one would generate
            gains = gains and smooth_power_when_on(kind, parameters, True, optimum.braking_n[i], v)[0] < 0.0
        if not gains and (another or -needed_force(cell_at(mesh, i), w[i], w[i + 1], v) <= train.friction_effort_n):
            braking[i] = 0.0
    return Duty(driving, braking)


def forbidden_energy_j(mesh: MeshData, modes: IntArray, optimum: Optimum) -> float:
    """Return the price of efforts that a decision leaves out, in the energy of its optimum [J]."""
    driven, braked = _forbidden_efforts_n(mesh, modes, optimum)
    return FORBIDDING_PRICE * float((mesh.cell_length_m * (driven + braked)).sum())


def repaired_modes(mesh: MeshData, modes: IntArray, optimum: Optimum) -> IntArray:
    """Return a decision that allows what the optimum of another one could not do without."""
    driven, braked = _forbidden_efforts_n(mesh, modes, optimum)
    least = NEXT_TO_NOTHING * mesh.traction.constant_n
    repaired: IntArray = np.where(driven > least, DRIVE, np.where(braked > least, BRAKE, modes))
    return repaired


def _forbidden_efforts_n(mesh: MeshData, modes: IntArray, optimum: Optimum) -> tuple[FloatArray, FloatArray]:
    """Return the tractive and the braking efforts that a decision leaves out and its optimum uses even so [N]."""
    driven = np.where(modes == DRIVE, 0.0, optimum.traction_n)
    # the effort of a standstill brake costs nothing, and stands for the machines' own
    free = (modes == BRAKE) | has_standstill_brake(mesh.drive_kind, mesh.drive_parameters)
    return driven, np.where(free, 0.0, optimum.braking_n)


def safest_modes(duty: Duty) -> IntArray:
    """Return the decision that leaves a solver each cell that the optimum drives or brakes in, however little."""
    modes: IntArray = np.where(duty.driving > COASTED, DRIVE, np.where(duty.braking > COASTED, BRAKE, OFF))
    return modes


@njit(cache=True, error_model="numpy", nogil=True)
def coasting_exactly(mesh: MeshData, optimum: Optimum) -> FloatArray:
    """Return squares of speed [m2/s2] of a run that coasts where it all but coasts; shape (n + 1,).

    The method leaves tiny efforts everywhere, and with any effort the drive would count as on.
    """
    speed2, residue = optimum.speed2.copy(), NEXT_TO_NOTHING * mesh.traction.constant_n
    train, traction, braking, _ = shared_by_cells(mesh).own
    for i in range(mesh.cell_length_m.shape[0]):
        small = optimum.traction_n[i] < residue and optimum.braking_n[i] < residue
        if small and math.isnan(mesh.fixed_speed2[i + 1]) and speed2[i] > 0.0:
            leaving = exit_speed2(cell_at(mesh, i), train, traction, braking, speed2[i], COAST)
            # never so far that the next cell would notice, nor beyond a limit
            if abs(leaving - speed2[i + 1]) < NEXT_TO_NOTHING * speed2[i + 1]:
                speed2[i + 1] = min(leaving, mesh.limit_speed2[i + 1])
    return speed2


@njit(cache=True, error_model="numpy", nogil=True)
def round_shares(
    driving: FloatArray, braking: FloatArray, durations_s: FloatArray, interrupted_by: IntArray, min_s: float
) -> IntArray:
    """Return a decision, an array of shape (n,), whose stretches last and which keeps close to given shares.

    Parameters
    ----------
    driving, braking, durations_s : arrays of shape (n,)
        Shares of the cells on which the drive is on, and times of the cells [s].
    interrupted_by : array of shape (n,)
        Interruption of the drive before each cell.
    min_s : float
        For how long a stretch lasts at least [s].
    """
    n = durations_s.shape[0]
    decision, does, lasts = np.full(n, OFF), OFF, np.inf
    owed_driving, owed_braking = 0.0, 0.0
    for i in range(n):
        t = durations_s[i]
        if interrupted_by[i] != NOTHING:
            does, lasts = OFF, np.inf
        owed_driving, drive = _owes(owed_driving, driving, i, t, min_s, does == DRIVE)
        owed_braking, brake = _owes(owed_braking, braking, i, t, min_s, does == BRAKE)
        wanted = DRIVE if drive else BRAKE if brake else OFF
        # to the nearest cell, as `shortest_stretch_s` counts
        if wanted != does and lasts + 0.5 * t >= min_s:
            does, lasts = wanted, 0.0
        owed_driving -= t if does == DRIVE else 0.0
        owed_braking -= t if does == BRAKE else 0.0
        decision[i] = does
        lasts += t
    return decision


@njit(cache=True, error_model="numpy")
def _owes(
    owed_s: float, share: FloatArray, cell: int, duration_s: float, min_s: float, is_on: bool
) -> tuple[float, bool]:
    """Return for how long the drive is owed to be on at the end of a cell [s], and whether it is to be on there.

    At a share d the shortest stretches that last and keep to it are of d / (1 - d) to one: what is owed swings by
    max(d, 1 - d) of the shortest stretch.
    """
    part = share[cell]
    if part >= DRIVEN or part <= COASTED:
        return 0.0, bool(part >= DRIVEN)
    half_swing = 0.5 * min_s * max(part, 1.0 - part)
    if cell == 0 or not COASTED < share[cell - 1] < DRIVEN:
        owed_s = 0.0
    owed_s += part * duration_s
    # in the middle of the cell: the borders of a stretch are then off by half a cell to either side
    middle = owed_s - 0.5 * duration_s
    return owed_s, bool(middle > -half_swing if is_on else middle >= half_swing)
