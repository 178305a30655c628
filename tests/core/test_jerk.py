"""The run within a limit of jerk: times in closed form, the rule of the check, the lower bound."""

from dataclasses import replace

import numpy as np
import pytest

from railjoule.core import TimetableError, solve
from railjoule.core.check import check_run
from railjoule.core.errors import StrategyRefusedError
from tests.builders import plain_scenario

# 100 t and a tenth for turning parts, without resistance: 0.9 and 0.6 m/s2 at constant effort up to 20 m/s
LEVEL = {
    "vehicle.resistance": {"constant_n_per_kn": 0.0},
    "vehicle.traction": {"max_effort_kn": 99.0, "max_power_kw": 4000.0, "max_speed_kmh": 72.0},
    "vehicle.braking": {"max_effort_kn": 66.0},
    "timetable.travel_time_s": 200.0,
}
STARTS, STOPS, TOP = 0.9, 0.6, 20.0


@pytest.mark.parametrize("jerk", [0.3, 0.7])
def test_a_start_and_a_stop_take_half_a_ramp_longer(jerk):
    run = solve(plain_scenario({**LEVEL, "vehicle.max_jerk_ms3": jerk}), "fastest", check=True)
    plain_s = 2000.0 / TOP + TOP / (2 * STARTS) + TOP / (2 * STOPS)
    assert run.travel_time_s == pytest.approx(plain_s + (STARTS + STOPS) / (2 * jerk), abs=0.02)
    # a start at the rate j reaches a speed a / (2 j) later: v / a + a / (2 j)
    reached_s = np.interp(10.0, run.speed_ms[: run.speed_ms.argmax()], run.time_s[: run.speed_ms.argmax()])
    assert reached_s == pytest.approx(10.0 / STARTS + STARTS / (2 * jerk), abs=2e-3)
    # within the first ramp v = j t^2 / 2
    early = run.time_s < 0.9 * STARTS / jerk
    assert run.speed_ms[early] == pytest.approx(0.5 * jerk * run.time_s[early] ** 2, abs=2e-3)
    assert run.position_m[-1] == 2000.0
    assert run.speed_ms[-1] == 0.0


def test_the_optimum_keeps_the_time_and_its_bound():
    stations = [{"position_m": 900.0, "dwell_s": 20.0}]
    free = plain_scenario({"line.stations": stations, "timetable.travel_time_s": 230.0})
    scenario = free.replace(**{"vehicle.max_jerk_ms3": 0.5})
    best, run = solve(free), solve(scenario, check=True)
    assert run.check.ok
    assert best.travel_time_s - 2e-3 <= run.travel_time_s <= best.travel_time_s + 1e-6
    assert run.energy.net_j > best.energy.net_j
    assert run.bound.energy_j == best.bound.energy_j
    assert "Efforts change at 0.5 m/s3 at most" in run.notes[-1]
    # the run without the limit breaks the rule, and only this one
    broken = check_run(scenario, replace(best, scenario=scenario))
    assert [check.name for check in broken.checks if not check.ok] == ["jerk"]


def test_a_time_that_only_a_train_without_the_limit_keeps():
    scenario = plain_scenario({"vehicle.max_jerk_ms3": 0.2, "timetable": {"reserve_percent": 0.5}})
    shortest = solve(scenario, "fastest").travel_time_s
    with pytest.raises(TimetableError, match=f"shorter than the shortest possible {np.ceil(10 * shortest) / 10:.1f} s"):
        solve(scenario)


def test_a_neutral_section_is_refused():
    neutral = [{"from_m": 900.0, "to_m": 1000.0}]
    with pytest.raises(StrategyRefusedError, match="max_jerk_ms3 on a line with neutral_sections"):
        solve(plain_scenario({"vehicle.max_jerk_ms3": 0.5, "line.neutral_sections": neutral}))
