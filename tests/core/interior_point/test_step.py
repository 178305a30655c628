"""A step against the linearised conditions of optimality, and how far it goes."""

import numpy as np
import pytest

from railjoule.core.interior_point.newton import factor_with_fallback
from railjoule.core.interior_point.step import longest_steps, move, set_direction

BARRIER, TIME_AIM = 0.01, 0.8


@pytest.fixture
def stepped(lagrangian):
    """Fill the steps of a Newton iteration."""
    slack, multiplier = lagrangian.time_slack, lagrangian.time_multiplier
    residual = lagrangian.task.running_time_s - lagrangian.time(lagrangian.point) - slack
    response = factor_with_fallback(lagrangian.work, False)
    course = lagrangian.task.course.data
    set_direction(course, lagrangian.work, response, BARRIER, False, slack, multiplier, residual, TIME_AIM)
    return lagrangian


def test_a_step_solves_the_linearised_conditions(stepped):
    point, step = stepped.point, stepped.step
    jacobian, by_time = stepped.differences(stepped.limits), stepped.differences(stepped.time)
    z, dz, s, ds = (stepped.of_limits(name) for name in ("multiplier", "multiplier_step", "slack", "slack_step"))
    time_slack_step, price_step = stepped.work.time_step
    gradient = stepped.gradient(point)
    stationary = stepped.curvature(convex=True) @ step - jacobian.T @ dz + by_time * price_step
    assert stationary == pytest.approx(-gradient, rel=1e-8, abs=1e-9 * np.abs(gradient).max())
    assert ds == pytest.approx(jacobian @ step + stepped.limits(point) - s, abs=1e-9)
    assert s * dz + z * ds == pytest.approx(BARRIER * stepped.of_limits("weight") - s * z, abs=1e-9)
    residual = stepped.task.running_time_s - stepped.time(point) - stepped.time_slack
    assert time_slack_step == pytest.approx(residual - by_time @ step, abs=1e-8)
    product = stepped.time_slack * price_step + stepped.time_multiplier * time_slack_step
    assert product == pytest.approx(TIME_AIM - stepped.time_slack * stepped.time_multiplier, rel=1e-9)


def test_longest_steps_end_at_a_bound(stepped):
    """Slacks and multipliers keep a hundredth of themselves; the one that loses most keeps just that."""
    lengths = longest_steps(stepped.work, stepped.time_slack, stepped.time_multiplier, 0.99)
    time = ("time_slack", "time_multiplier")
    for length, name, own, own_step in zip(lengths, ("slack", "multiplier"), time, stepped.work.time_step, strict=True):
        values = np.append(stepped.of_limits(name), getattr(stepped, own))
        steps = np.append(stepped.of_limits(f"{name}_step"), own_step)
        kept = (values + length * steps) / values
        assert kept.min() >= 0.01 * (1 - 1e-9)
        assert length == 1 or kept.min() == pytest.approx(0.01)


def test_pairs_stay_near_the_centre(stepped):
    rows = stepped.work.rows
    used = rows.weight > 0
    rows.multiplier[used] *= np.random.default_rng(3).choice([1e-9, 1e9], used.sum())
    move(rows, stepped.work.used, 0.0, 0.0, BARRIER, 10.0)
    share = (rows.slack * rows.multiplier)[used] / (BARRIER * rows.weight[used])
    assert np.all((share > 0.0999) & (share < 10.001))
