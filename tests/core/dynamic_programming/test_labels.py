"""Labels of the states of backward induction against the rules that they stand for."""

from itertools import pairwise, product

import numpy as np
import pytest

from railjoule.core.dynamic_programming.labels import FORBIDDEN, on_off_labels, regime_labels
from railjoule.core.dynamic_programming.steps import BRAKE as REGIME_BRAKE
from railjoule.core.dynamic_programming.steps import HOLD, POWER, ROLL
from railjoule.core.physics.mesh_data import BRAKE, DRIVE, OFF
from railjoule.core.physics.stretches import NOTHING, STOP


def is_allowed(labels, actions):
    """Return whether the labels allow actions, from the label 0 on, and lead only to counts that are in use."""
    label, size = 0, labels.moves.shape[1] // labels.moves.shape[2]
    for i, action in enumerate(actions):
        label = labels.moves[i, label, action]
        if label == FORBIDDEN:
            return False
        assert divmod(label, size)[0] == action
        assert label % size < labels.used[i]
    return True


def stretches(actions, interrupted):
    """Return first cell and length of each stretch."""
    first = [i for i, a in enumerate(actions) if i == 0 or interrupted[i] or a != actions[i - 1]]
    return list(zip(first, np.diff([*first, len(actions)]), strict=True))


@pytest.mark.parametrize("lasting", [[1, 1, 1, 1, 1], [3, 2, 2, 1, 1], [2, 4, 1, 3, 2]])
@pytest.mark.parametrize("stop", [None, 3])
def test_a_stretch_lasts_unless_it_is_interrupted(lasting, stop):
    n = len(lasting)
    interrupted_by = np.full(n, NOTHING)
    interrupted_by[[0] if stop is None else [0, stop]] = STOP
    labels = on_off_labels(np.array(lasting), interrupted_by)
    for actions in product((OFF, DRIVE, BRAKE), repeat=n):
        # the end of the line and a stop cut a stretch off
        cut = {n, stop}
        lasts = all(
            length >= lasting[first] or first + length in cut
            for first, length in stretches(actions, interrupted_by > 0)
        )
        assert is_allowed(labels, actions) == lasts


@pytest.mark.parametrize("changes", [0, 1, 2])
def test_regimes_change_so_often_between_two_stops(changes):
    labels = regime_labels(np.array([0.0, np.nan, np.nan, 0.0, np.nan, 0.0]), changes)
    for actions in product((POWER, HOLD, ROLL, REGIME_BRAKE), repeat=5):
        legs = (actions[:3], actions[3:])
        few = all(sum(a != b for a, b in pairwise(leg)) <= changes for leg in legs)
        assert is_allowed(labels, actions) == few
