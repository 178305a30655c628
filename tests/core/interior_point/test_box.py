"""The minimum of a priced cell over a box against brute force."""

import os
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from railjoule.core.interior_point.box import box_minimum

weights = st.floats(-10, 10)
terms = st.tuples(weights, weights, st.floats(-1e3, 1e4), st.floats(-300, 300), weights)
valleys = st.tuples(st.floats(0.1, 10), st.floats(0.1, 10), st.floats(1e2, 1e4), st.floats(-100, 100), weights)
"""Cells whose minimum often lies inside of the box."""
slow = st.floats(0.5, 10.0)
widths = st.one_of(st.just(0.0), st.floats(0.1, 15.0))


def brute_force(cell, box):
    """Return the least value on a grid that is laid anew, ever finer, around the best point of the one before."""
    (a0, a1, kappa, beta, gamma), (low0, high0, low1, high1) = cell, box
    centre, reach, best = (0.5 * (low0 + high0), 0.5 * (low1 + high1)), 0.5, np.inf
    for _ in range(14):
        v0, v1 = (
            np.clip(c + reach * (high - low) * np.linspace(-1, 1, 41), low, high)
            for c, low, high in ((centre[0], low0, high0), (centre[1], low1, high1))
        )
        v = 0.5 * (v0[:, None] + v1)
        values = a0 * v0[:, None] ** 2 + a1 * v1**2 + kappa / v + beta * v + gamma * v**2
        row, column = np.unravel_index(values.argmin(), values.shape)
        centre, reach, best = (v0[row], v1[column]), 0.3 * reach, min(best, values.min())
    return best


@settings(max_examples=200)
@given(st.one_of(terms, valleys), slow, widths, slow, widths)
def test_minimum_over_a_box(cell, low0, width0, low1, width1):
    box = low0, low0 + width0, low1, low1 + width1
    expected = brute_force(cell, box)
    assert box_minimum(*cell, *box) == pytest.approx(expected, rel=1e-8, abs=1e-5)


@pytest.mark.parametrize(
    ("cell", "box", "expected"),
    [
        # 2 v^2 + 108 / v with v0 = v1 = v is least where 4 v = 108 / v^2
        ((1.0, 1.0, 108.0, 0.0, 0.0), (1.0, 10.0, 1.0, 10.0), 54.0),
        # the same where the box ends below it
        ((1.0, 1.0, 108.0, 0.0, 0.0), (1.0, 2.0, 1.0, 2.0), 62.0),
        # standing still costs nothing where time has no price
        ((1.0, 1.0, 0.0, 1.0, 0.0), (0.0, 10.0, 0.0, 10.0), 0.0),
    ],
)
def test_by_hand(cell, box, expected):
    assert box_minimum(*cell, *box) == pytest.approx(expected, abs=1e-12)


FRESH = """
from railjoule.core.interior_point.box import box_minimum
print(round(box_minimum(1.0, 1.0, 108.0, 0.0, 0.0, 0.0, 10.0, 0.0, 10.0), 9))
"""


def test_a_corner_at_rest_in_a_fresh_cache(tmp_path):
    """As the first case by hand, but with 108 / v infinite in one corner."""
    environment = {**os.environ, "XDG_CACHE_HOME": str(tmp_path), "NUMBA_CACHE_DIR": ""}
    answer = subprocess.run([sys.executable, "-c", FRESH], env=environment, capture_output=True, text=True, check=False)
    assert answer.stdout.strip() == "54.0"
