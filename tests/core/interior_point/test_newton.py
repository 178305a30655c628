"""The elimination of efforts and nodes against dense systems."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from railjoule.core.interior_point.newton import back_substitute, cell_block, factor, positive_part


def solved(lagrangian, right):
    """Return the solution of the factored system for a right-hand side of the free nodes."""
    vector = np.zeros(len(lagrangian.work.nodes.speed2))
    vector[lagrangian.free] = right
    back_substitute(lagrangian.work.nodes, vector)
    return vector[lagrangian.free]


def test_elimination_solves_the_dense_system(lagrangian):
    """Of all variables at once: the positive parts of each cell's curvature, and z/s times squares of gradients."""
    jacobian = lagrangian.differences(lagrangian.limits)
    weight = lagrangian.of_limits("multiplier") / lagrangian.of_limits("slack")
    dense = lagrangian.curvature(convex=True) + jacobian.T @ (weight[:, None] * jacobian)
    right = np.random.default_rng(2).normal(size=len(lagrangian.free))
    expected = np.linalg.solve(dense, np.append(right, np.zeros(len(dense) - len(right))))[: len(right)]
    assert factor(lagrangian.work, False, False)
    # differences lose about five digits, the elimination none
    assert solved(lagrangian, right) == pytest.approx(expected, rel=1e-8, abs=1e-9 * np.abs(expected).max())


def test_the_exact_elimination_solves_the_exact_system_where_that_is_convex(lagrangian):
    """Where it is not, it says so; the rows of the timetable stand apart."""
    jacobian = lagrangian.differences(lagrangian.limits)
    weight = lagrangian.of_limits("multiplier") / lagrangian.of_limits("slack")
    dense = lagrangian.curvature(convex=False) + jacobian.T @ (weight[:, None] * jacobian)
    nodes = len(lagrangian.free)
    efforts = dense[nodes:, nodes:]
    reduced = dense[:nodes, :nodes] - dense[:nodes, nodes:] @ np.linalg.solve(efforts, dense[nodes:, :nodes])
    convex = np.linalg.eigvalsh(reduced).min() > 0 and np.linalg.eigvalsh(efforts).min() > 0
    assert factor(lagrangian.work, False, True) == convex
    if convex:
        right = np.random.default_rng(2).normal(size=nodes)
        expected = np.linalg.solve(reduced, right)
        assert solved(lagrangian, right) == pytest.approx(expected, rel=1e-6, abs=1e-7 * np.abs(expected).max())


def test_the_convex_system_goes_downhill_where_limits_weigh_little(lagrangian):
    for rows in (lagrangian.work.rows, lagrangian.work.bounds):
        rows.slack[rows.weight > 0] *= 1e4
    assert factor(lagrangian.work, False, False)
    for right in np.eye(len(lagrangian.free)):
        assert right @ solved(lagrangian, right) > 0


entries = st.one_of(st.just(0.0), st.floats(1e-6, 1e6), st.floats(-1e6, -1e-6))


@given(entries, entries, entries)
def test_positive_part_against_eigenvalues(a, b, c):
    values, vectors = np.linalg.eigh(np.array([[a, b], [b, c]]))
    expected = vectors @ np.diag(np.maximum(values, 0)) @ vectors.T
    part = np.array(positive_part(a, b, c))
    assert part == pytest.approx(expected[[0, 0, 1], [0, 1, 1]], abs=1e-12 * abs(values).max())


weights = st.one_of(st.just(0.0), st.floats(1e-12, 1e12))
slopes = st.floats(0.01, 10)


@given(slopes, slopes, weights, slopes, slopes, weights, weights, weights)
def test_the_determinant_of_a_block_keeps_its_digits(lean0, lean1, both, u0, u1, speed, start, end):
    """Against fractions, which round nothing: weights of active limits are 1e12 times those of others."""
    block = cell_block(-lean0, lean1, both, u0, u1, speed, 0.0, start, end)
    l0, l1, b, d0, d1, v, s, e = (Fraction(x) for x in (-lean0, lean1, both, u0, u1, speed, start, end))
    m00, m01, m11 = b * l0 * l0 + v * d0 * d0 + s, b * l0 * l1 + v * d0 * d1, b * l1 * l1 + v * d1 * d1 + e
    exact = [float(x) for x in (m00, m01, m11, m00 * m11 - m01 * m01)]
    assert [block[0], block[2], block[3]] == pytest.approx([exact[0], exact[2], exact[3]], rel=1e-14)
    assert block[1] == pytest.approx(exact[1], abs=1e-14 * float(b * lean0 * lean1 + v * d0 * d1))
