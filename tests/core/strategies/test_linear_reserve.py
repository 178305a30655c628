"""The reserve distributed linearly: speeds, energy and times by an integration of their own."""

import numpy as np
import pytest

from railjoule.core import solve
from railjoule.core.reserve import reserved_time, times_between
from railjoule.core.task import prepare_task
from tests.builders import plain_scenario


def test_speeds_and_energy_of_a_level_line():
    scenario = plain_scenario({"timetable": {"reserve_percent": 8.0}})
    run, fastest = solve(scenario, "linear_reserve", check=True), solve(scenario, "fastest")
    assert run.check.ok
    assert run.travel_time_s == pytest.approx(1.08 * fastest.travel_time_s, abs=1e-6)
    assert run.speed_ms == pytest.approx(fastest.speed_ms / 1.08, rel=1e-6)
    # the plain train, from the speeds of its fastest run: F = m a + R, 85 % efficiency, half is recuperated
    speed2, length = (fastest.speed_ms / 1.08) ** 2, np.diff(run.position_m)
    resistance_n = 981.0 * (2.0 + 5e-4 * 3.6**2 * 0.5 * (speed2[1:] + speed2[:-1]))
    effort_n = 110e3 * np.diff(speed2) / (2 * length) + resistance_n
    work_j = effort_n * length
    net_j = np.where(work_j > 0, work_j / 0.85, 0.5 * 0.85 * work_j).sum()
    assert run.energy.net_j == pytest.approx(net_j, rel=1e-6)
    # an economic distribution of the same time needs less, and the bound covers both
    best = solve(scenario, "optimal")
    assert best.energy.net_j < run.energy.net_j
    assert run.bound.energy_j <= best.energy.net_j * (1 + 1e-6)


def test_each_part_takes_its_own_reserve():
    stations = [{"position_m": 1200.0, "dwell_s": 25.0}]
    part = {"from_m": 500.0, "to_m": 1200.0, "reserve_percent": 20.0}
    scenario = plain_scenario(
        {
            "line.stations": stations,
            "line.sections": [{"length_m": 900.0}, {"length_m": 1100.0, "gradient_permille": 20.0}],
            "timetable": {"reserve_percent": 5.0, "reserve_parts": [part]},
        }
    )
    run, task, due = solve(scenario, "linear_reserve", check=True), prepare_task(scenario), reserved_time(scenario)
    taken = times_between(task, run.node_speed_ms**2, due.borders_m)
    assert taken == pytest.approx(due.shortest_s + due.reserve_s, abs=1e-6)
    # at the station the train is as late as the reserves before it add up to
    assert run.arrival_s(1200.0) == pytest.approx((due.shortest_s + due.reserve_s)[:2].sum(), abs=1e-6)
    assert [place for _, place, _ in run.station_arrivals] == [1200.0, 2000.0]
