"""Every expected number is one that another function of the core gives for the same setting, or a sum."""

import numpy as np
import pytest
from builders import plain_scenario
from hypothesis import given, settings
from hypothesis import strategies as st

from railjoule.core import ScenarioError, load_scenario, solve
from railjoule.core.simulation.actual_run import CAUSES, FREE_REST, actual_run, solve_plan
from railjoule.core.simulation.disturbances import simulate_disturbances
from railjoule.core.simulation.following import simulate_following

STOP = {"position_m": 900.0, "duration_s": 20.0, "noticed_at_m": 670.0, "reaction": "driver"}
LIMIT = {"from_m": 300.0, "to_m": 400.0, "limit_kmh": 30.0, "noticed_at_m": 100.0}
METRO = ("metro-with-limit", "liashenko-ii")
"""One without the target braking curves, one with them."""


def disturbed(name="metro-with-limit", **disturbance):
    return load_scenario(name).replace(**{f"disturbance.{key}": value for key, value in disturbance.items()})


def energies(run):
    return {cause.name: cause.energy_kwh for cause in run.causes}


def test_what_differs_in_nothing_is_the_plan():
    scenario = disturbed(actual_load_factor=0.5)
    run = actual_run(scenario)
    assert run.actual is run.planned
    assert run.actual.energy_kwh == solve(scenario).energy_kwh
    assert (run.extra_kwh, run.delay_s, run.causes, run.max_cause) == (0.0, 0.0, (), None)


@pytest.mark.parametrize("name", METRO)
@pytest.mark.parametrize("single", [{"actual_load_factor": 0.8}, {"coordinate_error_m": 10.0}])
def test_load_alone_and_place_alone_are_those_of_the_followed_plan(name, single):
    scenario = disturbed(name, **single)
    run, following = actual_run(scenario), simulate_following(scenario)
    assert run.planned.energy_kwh == following.planned.energy_kwh
    assert run.actual.energy_kwh == following.actual.energy_kwh
    assert run.delay_s == following.delay_s
    assert run.stop_error_m == pytest.approx(following.stop_error_m)
    assert len(run.causes) == 1


@pytest.mark.parametrize("name", METRO)
@pytest.mark.parametrize("reaction", ["driver", "computer", "known"])
def test_stops_alone_are_those_of_the_disturbed_ride(name, reaction):
    scenario = disturbed(name, stops=[STOP])
    run, ride = actual_run(scenario, reaction), simulate_disturbances(scenario, reaction)
    assert run.planned.energy_kwh == ride.planned.energy_kwh
    assert run.actual.energy_kwh == ride.actual.energy_kwh
    assert run.delay_s == ride.delay_s
    assert [cause.name for cause in run.causes] == ["stops"]


def test_causes_come_in_order_and_each_is_the_step_to_the_run_that_has_it():
    parts = {"actual_load_factor": 0.8, "coordinate_error_m": 10.0}
    run = actual_run(disturbed(**parts, resistance_factor=1.1, stops=[STOP], speed_limits=[LIMIT]))
    assert tuple(energies(run)) == CAUSES
    heavier = simulate_following(disturbed(actual_load_factor=0.8))
    displaced = simulate_following(disturbed(**parts))
    assert energies(run)["load"] == pytest.approx(heavier.actual.energy_kwh - run.planned.energy_kwh)
    assert energies(run)["position"] == pytest.approx(displaced.actual.energy_kwh - heavier.actual.energy_kwh)


@settings(max_examples=15, deadline=None)
@given(
    load=st.floats(0, 1.2),
    error_m=st.floats(-20, 20),
    place_m=st.floats(300, 2200),
    reaction=st.sampled_from(["driver", "computer", "known"]),
)
def test_the_causes_sum_to_the_whole(load, error_m, place_m, reaction):
    stop = {"position_m": place_m, "duration_s": 5.0, "noticed_at_m": place_m - 250}
    run = actual_run(disturbed(actual_load_factor=load, coordinate_error_m=error_m, stops=[stop]), reaction)
    assert sum(cause.energy_j for cause in run.causes) == pytest.approx(3.6e6 * run.extra_kwh, abs=1e-3)
    assert run.max_cause in run.causes


def test_an_unplanned_stop_is_made_where_it_is_by_a_train_that_believes_to_be_elsewhere():
    run = actual_run(disturbed(actual_load_factor=0.8, coordinate_error_m=10.0, stops=[STOP])).actual
    dwell = np.diff(run.position_m) == 0
    assert run.position_m[:-1][dwell] == pytest.approx([900.0])
    assert np.diff(run.time_s)[dwell] == pytest.approx([20.0])
    assert run.position_m[-1] == pytest.approx(2300.0)


def test_a_train_that_stood_short_of_a_station_does_not_stop_there_again():
    stop = {"position_m": 3000.0, "duration_s": 10.0, "noticed_at_m": 2700.0}
    scenario = disturbed("metro-10-stations", coordinate_error_m=10.0, stops=[stop])
    run = actual_run(scenario).actual
    stands = len(scenario.line.inner_stations) + 1
    assert int(np.sum((np.diff(run.position_m) == 0) & (np.diff(run.time_s) > 0))) == stands


def test_a_later_departure_delays_a_run_with_events_too():
    on_time, late = (actual_run(disturbed(stops=[STOP], departure_delay_s=delay)) for delay in (0.0, 12.0))
    assert late.delay_s == pytest.approx(on_time.delay_s + 12.0)
    assert late.extra_kwh == pytest.approx(on_time.extra_kwh)


def test_lateness_is_a_number_and_no_note():
    run = actual_run(disturbed(stops=[STOP]))
    assert run.delay_s > 1.0
    assert run.notes == ()


def test_a_target_curve_that_ends_with_the_first_event_is_told():
    assert actual_run(disturbed("liashenko-ii", coordinate_error_m=5.0, stops=[STOP])).notes == (FREE_REST,)


def test_the_plan_can_be_given():
    scenario = disturbed(coordinate_error_m=5.0)
    plan = solve_plan(scenario)
    assert actual_run(scenario, planned=plan).planned is plan


def test_a_stop_beyond_the_line_is_refused_with_its_bound():
    with pytest.raises(ScenarioError, match=r"stops\[0\]\.position_m = 2310 must lie before the end of the line"):
        actual_run(disturbed(actual_load_factor=0.8, stops=[{"position_m": 2310.0, "duration_s": 5.0}]))


def test_measuring_the_speed_wrong_is_a_matter_of_place():
    scenario = plain_scenario({"simulation.speed_error": 0.01, "disturbance.actual_load_factor": 0.3})
    assert tuple(energies(actual_run(scenario))) == ("load", "position")
