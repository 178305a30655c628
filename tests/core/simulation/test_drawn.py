"""Runs that are drawn: the fastest one beneath the drawing, whatever is drawn."""

import numpy as np
import pytest

from railjoule.core import Scenario, ScenarioError, solve
from railjoule.core.motion import Course
from railjoule.core.simulation.by_hand import WALKING_PACE_MS
from railjoule.core.simulation.drawn import drive_drawn
from railjoule.core.units import MS_PER_KMH


def test_a_drawing_above_all_limits_is_the_fastest_run(scenario: Scenario, course: Course) -> None:
    run = drive_drawn(scenario, course, np.full(course.cell_count + 1, 100.0))
    fastest = solve(scenario, strategy="fastest")
    np.testing.assert_allclose(run.node_speed_ms, fastest.node_speed_ms, atol=1e-6)


def test_what_the_train_can_do_is_driven_as_drawn(scenario: Scenario, course: Course) -> None:
    best = solve(scenario)
    run = drive_drawn(scenario, course, best.node_speed_ms)
    # but for the walking pace at both ends
    inside = best.node_speed_ms > 2 * WALKING_PACE_MS
    np.testing.assert_allclose(run.node_speed_ms[inside], best.node_speed_ms[inside], atol=1e-3)
    assert run.energy_kwh == pytest.approx(best.energy_kwh, rel=1e-3)


def test_any_drawing_becomes_a_run_that_keeps_its_bound(scenario: Scenario, course: Course) -> None:
    random = np.random.default_rng(3)
    for _ in range(10):
        drawn = np.interp(course.position_m, np.linspace(0, 2300, 24), random.uniform(0, 90, 24)) * MS_PER_KMH
        run = drive_drawn(scenario, course, drawn)
        assert np.all(run.node_speed_ms <= np.maximum(drawn, WALKING_PACE_MS) + 1e-9)
        assert np.all(run.node_speed_ms**2 <= course.data.largest_speed2 * (1 + 1e-9))
        assert run.node_speed_ms[-1] == 0
        assert abs(run.energy.imbalance) < 1e-9
        best = solve(scenario.replace(**{"timetable.travel_time_s": run.travel_time_s}))
        assert best.bound is not None
        assert run.energy.net_j >= best.bound.energy_j


def test_a_drawing_is_checked(scenario: Scenario, course: Course) -> None:
    speeds = np.full(course.cell_count + 1, 10.0)
    for wrong in (speeds[1:], np.where(course.position_m > 50, np.nan, speeds), -speeds):
        with pytest.raises(ScenarioError, match="finite entries of at least 0"):
            drive_drawn(scenario, course, wrong)
