"""Labels of the states of backward induction: what a state remembers beside its speed, and where each action leads.

A label is an action and a count, numbered `action * counts + count`; a run begins with the label 0.
"""

from typing import NamedTuple

import numpy as np

from railjoule.core.arrays import FloatArray, IntArray
from railjoule.core.dynamic_programming.steps import REGIMES
from railjoule.core.physics.mesh_data import MODES
from railjoule.core.physics.stretches import NOTHING

FORBIDDEN = -1


class Labels(NamedTuple):
    """The labels of states and the actions of steps.

    Parameters
    ----------
    moves : array of shape (n, labels, actions)
        The label after a cell, by the label before it and the action in it; FORBIDDEN where that is not allowed.
    used : array of shape (n,)
        Number of counts that an action in a cell may lead to, from 0 on.
    """

    moves: IntArray
    used: IntArray


def no_labels(n: int) -> Labels:
    """Return the labels of states that remember nothing, for steps without actions over n cells."""
    return Labels(np.zeros((n, 1, 1), dtype=np.int64), np.ones(n, dtype=np.int64))


def on_off_labels(lasting: IntArray, interrupted_by: IntArray) -> Labels:
    """Return the labels of a drive that must stay off, driving or braking for some cells.

    The count is the number of cells for which the drive still has to go on with its action. A drive that is free to
    switch goes on or begins another stretch; one that is interrupted begins a stretch in any case.

    Parameters
    ----------
    lasting : array of shape (n,)
        Minimum number of cells of a stretch that begins with a cell.
    interrupted_by : array of shape (n,)
        Interruption of the drive before each cell.
    """
    number, action = np.arange(len(lasting)), np.arange(MODES)
    # no label is held for longer than the longest stretch that began before still lasts
    used = np.maximum.accumulate(lasting + number) - number
    size = int(used.max())
    before, left = np.divmod(np.arange(MODES * size)[:, None], size)
    begun = action * size + (lasting - 1)[:, None, None]
    goes_on = np.where(action == before, action * size + np.maximum(left - 1, 0), FORBIDDEN)
    begins = (interrupted_by != NOTHING)[:, None, None] | ((left == 0) & (action != before))
    return Labels(np.where(begins, begun, goes_on), used)


def regime_labels(fixed_speed2: FloatArray, changes: int) -> Labels:
    """Return the labels of a driver who changes the regime a limited number of times between two stops.

    The count is the number of changes left. A train that leaves a stop has all its changes again, and its first regime
    is none of them.

    Parameters
    ----------
    fixed_speed2 : array of shape (n + 1,)
        Prescribed squares of speed at the nodes [m2/s2].
    changes : int
        Number of changes allowed.
    """
    n, size, action = len(fixed_speed2) - 1, changes + 1, np.arange(REGIMES)
    before, left = np.divmod(np.arange(REGIMES * size)[:, None], size)
    changed = np.where(left > 0, action * size + left - 1, FORBIDDEN)
    moves = np.where(action == before, action * size + left, changed)
    leaves_stop = (fixed_speed2[:-1] == 0.0) | (np.arange(n) == 0)
    return Labels(np.where(leaves_stop[:, None, None], action * size + changes, moves), np.full(n, size))
