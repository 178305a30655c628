import numpy as np
import pytest

from railjoule.core import TimetableError, load_scenario, solve
from railjoule.core.studies.tradeoff import one_speed_run


def test_it_holds_one_speed_takes_the_time_and_costs_more():
    scenario = load_scenario("liashenko-0").replace(line={"sections": [{"length_m": 1500.0}]})
    run, optimum = one_speed_run(scenario), solve(scenario)
    assert run.travel_time_s == pytest.approx(scenario.travel_time_s, abs=1e-6)
    held = np.isclose(run.speed_ms, run.speed_ms.max(), rtol=1e-6)
    assert np.diff(run.position_m)[held[1:] & held[:-1]].sum() > 1000
    assert run.energy_kwh > 1.05 * optimum.energy_kwh


def test_too_short_a_time_is_refused():
    with pytest.raises(TimetableError):
        one_speed_run(load_scenario("liashenko-0").replace(timetable={"travel_time_s": 30.0}))
