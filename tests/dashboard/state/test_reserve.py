"""The travel time beside every page, where a running time reserve gives it."""

from railjoule.core import load_scenario
from railjoule.dashboard.state.scenario import FIRST_SCENARIO, ScenarioModel

RESERVE = {"timetable.reserve_percent": 10.0}


def test_the_travel_time_follows_the_load_until_it_is_set_by_hand() -> None:
    model, first = ScenarioModel(), load_scenario(FIRST_SCENARIO)
    model.edit(RESERVE)
    assert model.travel_time_s == round(first.replace(**RESERVE).travel_time_s, 1)
    model.load_percent = 90.0
    heavy = first.replace(**RESERVE, **{"vehicle.load_factor": 0.9})
    assert model.travel_time_s == round(heavy.travel_time_s, 1)
    assert model.scenario().timetable.reserve_percent == 10.0
    assert model.scenario().travel_time_s == heavy.travel_time_s
    model.travel_time_s = 175.0
    assert model.scenario().timetable.travel_time_s == 175.0
    model.load_percent = 20.0
    assert model.scenario().travel_time_s == 175.0
