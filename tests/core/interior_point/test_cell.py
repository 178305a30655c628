"""The cells' derivatives against central differences."""

import numpy as np
import pytest


def test_gradient_of_the_lagrangian(lagrangian):
    by_differences = lagrangian.differences(lagrangian.value)
    assert lagrangian.gradient(lagrangian.point) == pytest.approx(by_differences, rel=1e-7, abs=1e-6)


def test_gradient_of_the_time(lagrangian):
    by_differences = lagrangian.differences(lagrangian.time)
    filled = lagrangian.work.nodes.time_gradient[lagrangian.free]
    assert filled == pytest.approx(by_differences[: len(filled)], rel=1e-8)


def test_curvature_of_the_lagrangian(lagrangian):
    """What the cells fill in, put together, against differences of the gradient."""
    by_differences = lagrangian.differences(lagrangian.gradient)
    size = np.abs(by_differences).max()
    assert lagrangian.curvature(convex=False) == pytest.approx(by_differences, rel=1e-6, abs=1e-8 * size)
