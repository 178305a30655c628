"""For how long a drive stays as it is: off, driving or braking.

A drive with idle losses saves energy by being on for a part of the time. How often it may be switched is
`drive.least_switching_s`; a mesh, on which it is switched only at nodes, holds that to the nearest cell. Between
driving and braking a drive may be off for less, as it passes through no effort on the way from the one to the other.
A neutral section switches the drive off and lets it go on, wherever it lies: how long a stretch lasts of which it cuts
off an end is nobody's choice.
"""

from typing import NamedTuple

import numpy as np

from railjoule.core.arrays import FloatArray, IntArray
from railjoule.core.compiled import njit
from railjoule.core.drive.kernels import has_standstill_brake
from railjoule.core.physics.effort_limit import EffortLimit
from railjoule.core.physics.energy_balance import CellBalance, cell_balance
from railjoule.core.physics.mesh_data import BRAKE, DRIVE, OFF, MeshData, cell_at, limits_at, shared_by_cells

NONE_BEFORE = -1
NOTHING, STOP, NEUTRAL_SECTION = range(3)
"""Interruptions of a drive before a cell; a neutral section interrupts it at either of its ends."""
NEXT_TO_NOTHING = 1e-5
"""Efforts below this share of the largest are what a barrier leaves of none."""


@njit(cache=True, error_model="numpy")
def action_of_cell(account: CellBalance, traction: EffortLimit, has_standstill_brake: bool) -> tuple[int, int]:
    """Return the action of a train in a cell, and the mode of its drive there.

    A standstill brake, whose effort the account holds as electric, brakes with a drive that is off.
    """
    least = NEXT_TO_NOTHING * traction.constant_n
    if account.tractive_effort_n > least:
        return DRIVE, DRIVE
    if account.electric_braking_n > least:
        return BRAKE, OFF if has_standstill_brake and account.power_w >= 0.0 else BRAKE
    return OFF, OFF


class RunActions(NamedTuple):
    """Actions of a run in each cell; arrays of shape (n,).

    Parameters
    ----------
    action, mode : array of int
        As `action_of_cell` returns them: OFF, DRIVE or BRAKE of `mesh_data`.
    duration_s : array
        For how long [s].
    interrupted_by : array of int
        The interruption before the cell: NOTHING, a STOP or the end of a NEUTRAL_SECTION.
    """

    action: IntArray
    mode: IntArray
    duration_s: FloatArray
    interrupted_by: IntArray


@njit(cache=True, error_model="numpy", nogil=True)
def actions_of_run(mesh: MeshData, speed2: FloatArray) -> RunActions:
    """Return the actions of the drive in each cell of a run, given by its squares of speed [m2/s2] at n + 1 nodes."""
    n = mesh.cell_length_m.shape[0]
    done = RunActions(
        np.empty(n, np.int64),
        np.empty(n, np.int64),
        np.empty(n),
        np.where(mesh.fixed_speed2[:-1] == 0.0, STOP, NOTHING),
    )
    shared = shared_by_cells(mesh)
    another = has_standstill_brake(mesh.drive_kind, mesh.drive_parameters)
    for i in range(n):
        train, traction, braking, drive = limits_at(shared, i)
        account = cell_balance(cell_at(mesh, i), train, traction, braking, drive, speed2[i], speed2[i + 1])
        done.action[i], done.mode[i] = action_of_cell(account, traction, another)
        done.duration_s[i] = account.duration_s
        if i > 0 and done.interrupted_by[i] == NOTHING and mesh.supply_share[i] != mesh.supply_share[i - 1]:
            done.interrupted_by[i] = NEUTRAL_SECTION
    return done


def shortest_stretch_s(mesh: MeshData, speed2: FloatArray) -> float:
    """Return how long a run's drive stays as it is at least [s], to the nearest cell; infinite if it never switches.

    A stretch that ends with a stop does not count, as nobody switches there, nor one that a neutral section cuts, nor
    one that is off between driving and braking.

    Parameters
    ----------
    mesh : MeshData
        The line and the train.
    speed2 : array of shape (n + 1,)
        Squares of speed at the nodes [m2/s2].
    """
    done = actions_of_run(mesh, speed2)
    return float(stretch_durations_s(done.action, done.duration_s, done.interrupted_by).min(initial=np.inf))


@njit(cache=True, error_model="numpy", nogil=True)
def stretch_durations_s(actions: IntArray, durations_s: FloatArray, interrupted_by: IntArray) -> FloatArray:
    """Return the durations of the stretches that cells are in, half a cell added; infinite where they do not count.

    Parameters
    ----------
    actions, durations_s : arrays of shape (n,)
        Actions of the drive in each cell, and their durations [s].
    interrupted_by : array of shape (n,)
        Interruption of the drive before each cell.
    """
    n = actions.shape[0]
    lasting, first, before = np.full(n, np.inf), 0, NONE_BEFORE
    for i in range(1, n):
        if interrupted_by[i] != NOTHING:
            first, before = i, NONE_BEFORE
        elif actions[i] != actions[i - 1]:
            passes = actions[first] == OFF and before != actions[i]
            # a train that is moving at the beginning may have been switched long before
            begins = interrupted_by[first] == STOP or (first > 0 and interrupted_by[first] == NOTHING)
            if begins and not passes:
                lasting[first:i] = durations_s[first:i].sum() + 0.5 * durations_s[first:i].max()
            first, before = i, actions[first]
    return lasting


@njit(cache=True, error_model="numpy", nogil=True)
def min_stretch_cells(durations_s: FloatArray, min_s: float) -> IntArray:
    """Return how many cells a stretch lasts at least that begins with a cell, to the nearest; shape (n,).

    Parameters
    ----------
    durations_s : array of shape (n,)
        Times of the cells [s].
    min_s : float
        For how long a stretch lasts at least [s].
    """
    n = durations_s.shape[0]
    counts = np.empty(n, dtype=np.int64)
    for i in range(n):
        lasts, end = durations_s[i], i + 1
        while end < n and lasts + 0.5 * durations_s[end - 1] < min_s:
            lasts += durations_s[end]
            end += 1
        counts[i] = end - i
    return counts
