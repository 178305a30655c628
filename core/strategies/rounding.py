"""Rounding of shares of cells to decisions that keep a minimum on/off time.

Sum-up rounding in time keeps the time for which the drive is on close to its share: within half of the most that one
stretch on and one off make up at that share. With no minimum on/off time, that is half a cell.

References: Sager, Bock, Diehl 2012, "The integer approximation error in mixed-integer optimal control", Math. Program.
133, 1-23. Zeile, Robuschi, Sager 2021, "Mixed-integer optimal control under minimum dwell time constraints", Math.
Program. 188, 653-694.
"""

import numpy as np

from railjoule.core.arrays import FloatArray, IntArray
from railjoule.core.compiled import njit
from railjoule.core.interior_point.duty import COASTED, DRIVEN
from railjoule.core.physics.mesh_data import BRAKE, DRIVE, OFF
from railjoule.core.physics.stretches import NOTHING


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
