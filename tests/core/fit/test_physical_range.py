"""Values and intervals within bounds, against formulas and a search over a grid."""

import numpy as np
import pytest

from railjoule.core.fit.physical_range import Range


def two(estimate, correlation=0.0):
    covariance = np.array([[1.0, correlation], [correlation, 1.0]])
    return Range(np.array(estimate), covariance, np.zeros(2), np.full(2, np.inf))


def test_an_estimate_well_within_the_bounds_is_the_value_with_the_usual_interval():
    found = two([5.0, 7.0], 0.5)
    best, distance = found.nearest()
    assert (best.tolist(), distance) == ([5.0, 7.0], 0.0)
    assert found.interval(0, 1.96) == pytest.approx((5 - 1.96, 5 + 1.96))


def test_without_correlation_an_interval_ends_where_the_distance_exceeds_the_least_by_the_quantile():
    # (x + 1)^2 + (y - 3)^2 over x >= 0 is least at (0, 3), by 1; so x ends where (x + 1)^2 = 1 + q^2
    found = two([-1.0, 3.0])
    best, distance = found.nearest()
    assert best == pytest.approx([0.0, 3.0])
    assert distance == pytest.approx(1.0)
    assert found.interval(0, 2.0) == pytest.approx((0.0, -1 + np.sqrt(5)), abs=1e-5)
    assert found.interval(1, 2.0) == pytest.approx((1.0, 5.0), abs=1e-5)


@pytest.mark.parametrize("estimate", [(-1.5, 2.0), (-2.0, -3.0), (0.5, 0.2), (-4.0, 6.0), (0.1, 5.0)])
@pytest.mark.parametrize("correlation", [-0.9, 0.3, 0.95])
def test_value_and_interval_are_those_of_a_search_over_a_grid(estimate, correlation):
    found = two(estimate, correlation)
    axis = np.linspace(0, 12, 2401)
    grid = np.stack(np.meshgrid(axis, axis, indexing="ij"), axis=-1) - np.array(estimate)
    distance = np.einsum("xyi,ij,xyj->xy", grid, np.linalg.inv(found.covariance), grid)
    best, least = found.nearest()
    assert least == pytest.approx(distance.min(), abs=0.01)
    for index in (0, 1):
        held = axis[distance.min(axis=1 - index) <= distance.min() + 1.96**2]
        low, high = found.interval(index, 1.96)
        assert low <= best[index] <= high
        assert (low, high) == pytest.approx((held[0], held[-1]), abs=0.02)
