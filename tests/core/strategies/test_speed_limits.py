"""The strategy: sections from anywhere, stops, bounds, and what it refuses."""

import numpy as np
import pytest
from builders import HILLS, plain_scenario

from railjoule.core import ScenarioError, StrategyRefusedError, check_run, load_scenario, solve
from railjoule.core.strategies import compare, prepare_task
from railjoule.core.strategies.speed_limits import section_boundaries, speed_limits_with_search

SHORT = {"line.sections": HILLS, "timetable.travel_time_s": 180.0, "strategy": "speed_limits"}
METRO = load_scenario("kharkiv-like-40kmh")


def test_sections_of_the_line_where_none_are_given():
    scenario = plain_scenario(SHORT)
    assert section_boundaries(scenario) == pytest.approx([400, 700, 1200, 1700])
    run = solve(scenario)
    assert run.travel_time_s == pytest.approx(1.01 * 180, rel=1e-6)
    assert run.notes[0].startswith("Set speeds: ")
    assert "not a proof" in run.notes[1]


def test_its_bound_is_that_of_its_own_time_and_nodes():
    """A run that may be late could otherwise undercut the bound of the timetable."""
    scenario = plain_scenario(SHORT)
    run = solve(scenario)
    late = solve(scenario.replace(**{"timetable.travel_time_s": 1.01 * 180}), "optimal")
    # over nodes of its own, too, which are finer
    assert run.lower_bound_kwh == pytest.approx(late.lower_bound_kwh, rel=1e-4)
    assert run.gap > 0
    bounds = {one.strategy: one.lower_bound_kwh for one in compare(scenario).runs}
    assert bounds["speed_limits"] < bounds["optimal"] == bounds["bellman"]


def test_stops_on_the_way():
    stations = [{"name": "Middle", "position_m": 900.0, "dwell_s": 20.0}]
    scenario = plain_scenario({"line.stations": stations, "timetable.travel_time_s": 220.0, "strategy": "speed_limits"})
    run = solve(scenario)
    assert run.travel_time_s == pytest.approx(1.01 * 200 + 20, rel=1e-6)
    assert run.speed_ms[np.isclose(run.position_m, 900)] == pytest.approx(0, abs=1e-9)
    assert [phase.phase for phase in run.phases].count("stand") == 1


def test_one_section_needs_no_search():
    run, search = speed_limits_with_search(prepare_task(plain_scenario({"strategy": "speed_limits"})))
    assert len(search.evaluations) == 1
    assert run.notes[0].startswith("Set speed: ")


def test_given_limits_are_one_trip():
    run, search = speed_limits_with_search(prepare_task(METRO.replace(**{"search.limits_kmh": [40.0, 35.0]})))
    assert [one.stage for one in search.evaluations] == ["given"]
    assert run.notes == ("Set speeds: 40.0, 35.0 km/h, changing at 1200 m.",)


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({"search.boundaries_m": [1200.0, 2400.0]}, r"search.boundaries_m\[1\] = 2400 must lie before the end of the"),
        ({"search.boundaries_m": [1200.0, 900.0]}, r"search.boundaries_m must rise"),
        ({"search.limits_kmh": [40.0]}, r"search.limits_kmh has 1 entries for the 2 sections between boundaries_m"),
        ({"search.time_window": 0.0}, r"search.time_window = 0 must be above 0"),
    ],
)
def test_bad_sections_and_windows(changes, expected):
    with pytest.raises(ScenarioError, match=expected):
        METRO.replace(**changes)


@pytest.mark.parametrize(
    ("limits", "expected"),
    [
        ([0.5, 40.0], r"^search.limits_kmh\[0\] = 0.5 must be at least 1.$"),
        ([40.0, 95.0], r"^search.limits_kmh\[1\] = 95 must be at most the vehicle's 80.$"),
    ],
)
def test_limits_out_of_bounds(limits, expected):
    with pytest.raises(ScenarioError, match=expected):
        solve(METRO.replace(**{"search.limits_kmh": limits}))


def test_too_tight_for_the_regulator():
    """132 s are possible with full brakes, not at 0.3 m/s2."""
    tight = METRO.replace(**{"timetable.travel_time_s": 140.0, "search.stop_deceleration_ms2": 0.3})
    with pytest.raises(StrategyRefusedError, match=r"needs at least \d+\.\d s with its regulator, which brakes at 0.3"):
        solve(tight)


def test_too_many_sections():
    many = plain_scenario({"line.sections": [{"length_m": 100.0}] * 20, "strategy": "speed_limits"})
    with pytest.raises(StrategyRefusedError, match=r"\(search.boundaries_m\): the line has 20 sections"):
        solve(many)


STATIONS = [{"name": "One", "position_m": 600.0, "dwell_s": 20.0}, {"name": "Two", "position_m": 1300.0}]
LINE = {"line.sections": HILLS, "line.stations": STATIONS, "timetable.travel_time_s": 290.0, "strategy": "speed_limits"}


def test_inter_station_runs_by_themselves_and_together():
    """(15) for each: one average speed, so that times are as lengths; together, time moves to where it saves most."""
    scenario = plain_scenario(LINE)
    separate = scenario.replace(**{"search.inter_station_runs": "separate"})
    together, (run, search) = solve(scenario), speed_limits_with_search(prepare_task(separate))
    arrives = np.array([run.arrival_s(place) for place in (600.0, 1300.0, 2000.0)])
    # each is as late as its window allows
    assert arrives - [0.0, 20.0, 20.0] == pytest.approx(1.01 * 270.0 * np.array([0.3, 0.65, 1.0]), rel=1e-5)
    assert together.travel_time_s == pytest.approx(run.travel_time_s, rel=1e-5)
    # over the same sections, together is never worse but for the mesh
    assert together.energy_kwh < run.energy_kwh * 1.001
    assert together.lower_bound_kwh < together.energy_kwh
    assert [len(one.best.limits_ms) for one in search.runs] == [2, 3, 2]
    assert all(check_run(scenario, one).ok for one in (together, run))


def test_a_given_arrival_is_the_time_of_its_own_runs():
    stations = [STATIONS[0], {**STATIONS[1], "arrival_s": 200.0}]
    run = solve(plain_scenario({**LINE, "line.stations": stations, "search.inter_station_runs": "separate"}))
    assert run.arrival_s(1300.0) == pytest.approx(1.01 * 180.0 + 20.0, rel=1e-5)
    assert run.arrival_s(600.0) == pytest.approx(1.01 * 180.0 * 6 / 13, rel=1e-5)


def test_a_run_without_enough_time_is_named():
    stations = [{"name": "One", "position_m": 50.0}]
    changes = {**LINE, "line.stations": stations, "timetable.travel_time_s": 180.0, "search.boundaries_m": [50.0]}
    separate = plain_scenario({**changes, "search.inter_station_runs": "separate"})
    with pytest.raises(StrategyRefusedError, match=r"^from the start to One needs more than the shortest \d+\.\d s"):
        solve(separate)
    assert solve(plain_scenario(changes)).energy_kwh > 0


def test_ten_stations_need_no_borders():
    """37 sections of the line, at most seven between two stations; before, they were refused."""
    scenario = load_scenario("metro-10-stations", {"search.inter_station_runs": "separate"})
    assert len(section_boundaries(scenario)) == 36
    assert solve(scenario, "speed_limits", check=True).travel_time_s == pytest.approx(1.01 * 860 + 220, rel=1e-5)


def test_the_bound_lies_below_every_run():
    tight = load_scenario("kharkiv-like-40kmh")
    assert solve(tight, "optimal").lower_bound_kwh < solve(tight, "bellman").energy_kwh < solve(tight).energy_kwh


@pytest.mark.parametrize("regulator", ["brake", "coast"])
def test_set_speeds_under_a_braking_curve(regulator):
    """Its regulator brakes ahead with one deceleration, the least of the curve."""
    scenario = plain_scenario(
        {
            "vehicle.braking.permitted_deceleration": [[0, 0.5], [40, 0.35]],
            "line.speed_limits": [{"from_m": 900.0, "to_m": 1100.0, "limit_kmh": 45.0}],
            "search.boundaries_m": [700.0, 1300.0],
            "search.regulator": regulator,
            "search.limits_kmh": [60.0, 50.0, 65.0],
            "timetable.travel_time_s": 220.0,
        }
    )
    run = solve(scenario, "speed_limits")
    assert check_run(scenario, run).ok
    assert (run.speed_ms <= run.permitted_speed_ms * (1 + 1e-7)).all()
