import numpy as np
import pytest
from builders import plain_scenario

from railjoule.core import solve
from railjoule.core.simulate.leg import joined, leg_of

DWELL = {"line.stations": [{"position_m": 900.0, "dwell_s": 30.0}], "timetable.travel_time_s": 250.0}


@pytest.fixture(scope="module")
def run():
    return solve(plain_scenario(DWELL))


def test_a_leg_keeps_the_clock_of_its_run(run):
    leg = leg_of(run)
    assert leg.duration_s == pytest.approx(run.travel_time_s, abs=1e-9)
    assert leg.dwell_s.max() == pytest.approx(30.0)
    assert leg.place_at(0.0) == 0.0
    time = float(np.interp(400.0, run.position_m, run.time_s))
    assert leg.place_at(time) == pytest.approx(400.0, abs=0.01)
    stands = leg.arrival_s[np.argmax(leg.dwell_s)]
    assert leg.place_at(stands + 10.0) == 900.0


def test_cut_and_joined_it_is_the_same_run(run):
    leg = leg_of(run)
    first = leg.until(433.3)
    assert first.position_m[-1] == 433.3
    rest = leg.beyond(433.3)
    again = joined([first, rest], run.scenario, run.strategy)
    assert again.travel_time_s == pytest.approx(run.travel_time_s, abs=1e-6)
    assert again.energy_kwh == pytest.approx(run.energy_kwh, rel=1e-4)
    assert abs(again.energy.imbalance) < 1e-9
    assert first.then(rest).duration_s == pytest.approx(leg.duration_s, abs=1e-9)


def test_the_effort_of_a_leg_is_that_of_its_run(run):
    leg = leg_of(run)
    assert leg.effort_at(30.0) == pytest.approx(
        float(run.effort_n[np.searchsorted(run.position_m, 30.0) - 1]), rel=1e-6
    )
