"""The memory of a state of backward induction beside its speed: one of a few labels, and where each action leads."""

from typing import NamedTuple

import numpy as np

from railjoule.core.arrays import IntArray
from railjoule.core.compiled import njit
from railjoule.core.physics.stretches import ACTIONS, NOTHING

FORBIDDEN = -1


class Memory(NamedTuple):
    """The labels of states and the actions of steps; a run begins with the label 0.

    Parameters
    ----------
    moves : array of shape (n, labels, actions)
        The label after a cell, by the label before it and the action in it; FORBIDDEN where that is not allowed.
    first, end : array of shape (n, actions)
        The labels to which an action in a cell may lead: from `first` to below `end`.
    """

    moves: IntArray
    first: IntArray
    end: IntArray


@njit(cache=True, error_model="numpy", nogil=True)
def on_off_memory(lasting: IntArray, interrupted_by: IntArray) -> Memory:
    """Return the memory of a drive that must stay off, driving or braking for some cells.

    A label is an action and the number of cells for which the drive still has to go on with it. A drive that is free to
    switch goes on or begins another stretch; one that is interrupted begins a stretch in any case.

    Parameters
    ----------
    lasting : array of shape (n,)
        How many cells a stretch lasts at least that begins with a cell.
    interrupted_by : array of shape (n,)
        Interruption of the drive before each cell.
    """
    n = lasting.shape[0]
    # no label is held for longer than the longest stretch that began before still lasts
    most, bound = 0, np.empty(n, dtype=np.int64)
    for i in range(n):
        most = max(most - 1, lasting[i] - 1)
        bound[i] = most
    size = bound.max() + 1
    moves = np.full((n, ACTIONS * size, ACTIONS), FORBIDDEN)
    first, end = np.empty((n, ACTIONS), dtype=np.int64), np.empty((n, ACTIONS), dtype=np.int64)
    for i in range(n):
        for action in range(ACTIONS):
            first[i, action], end[i, action] = action * size, action * size + bound[i] + 1
            begun = action * size + lasting[i] - 1
            for before in range(ACTIONS):
                for left in range(size):
                    if interrupted_by[i] != NOTHING or (left == 0 and action != before):
                        moves[i, before * size + left, action] = begun
                    elif action == before:
                        moves[i, before * size + left, action] = action * size + max(left - 1, 0)
    return Memory(moves, first, end)
