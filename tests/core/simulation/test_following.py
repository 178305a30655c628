import re

import numpy as np
import pytest
from builders import plain_scenario

from railjoule.core import InfeasibleLineError, ScenarioError, load_scenario, solve
from railjoule.core.simulation.following import plan_for, simulate_following

LINES = ("liashenko-0", "liashenko-i", "liashenko-ii", "liashenko-iii")


@pytest.mark.parametrize("reverse", [False, True])
@pytest.mark.parametrize("name", LINES)
def test_a_plan_that_comes_true_is_driven_as_planned(name, reverse):
    result = simulate_following(load_scenario(name).replace(**{"line.reverse": reverse}))
    assert result.overconsumption == pytest.approx(0, abs=1e-6)
    assert (result.delay_s, result.stop_error_m) == (pytest.approx(0, abs=1e-6), pytest.approx(0, abs=1e-9))


@pytest.mark.parametrize("load", [0.0, 1.0])
@pytest.mark.parametrize("error", [-25.0, 10.0])
@pytest.mark.parametrize("name", LINES)
def test_exact_sensors_stop_the_train_at_its_place(name, error, load):
    changes = {"disturbance.coordinate_error_m": error, "disturbance.actual_load_factor": load}
    result = simulate_following(load_scenario(name).replace(**changes))
    assert abs(result.stop_error_m) < 0.5
    assert abs(result.actual.energy.imbalance) < 1e-9
    assert result.actual.scenario.vehicle.load_factor == load


def test_a_greater_error_of_the_place_costs_more():
    """The trend of Tables 4 to 7 of Liashenko 2025 at the planned load, both directions together as in (12)."""

    def overconsumption(error):
        energy = planned = 0.0
        for reverse in (False, True):
            changes = {"line.reverse": reverse, "disturbance.coordinate_error_m": error}
            result = simulate_following(load_scenario("liashenko-i").replace(**changes))
            energy += result.actual.energy.net_j
            planned += result.planned.energy.net_j
        return energy / planned - 1

    for sign in (-1, 1):
        assert np.all(np.diff([overconsumption(sign * error) for error in (0.0, 10.0, 20.0, 25.0)]) > 0)


def test_one_percent_of_speed_error_moves_the_stop_by_less_than_a_hand():
    result = simulate_following(load_scenario("liashenko-ii").replace(**{"simulation.speed_error": 0.01}))
    assert abs(result.stop_error_m) < 0.1


def test_the_plan_obeys_the_target_curve_unless_it_is_off():
    scenario = load_scenario("liashenko-0")
    run = plan_for(scenario)
    before = 1000.0 - run.position_m
    near = (before > 0) & (before < 300)
    assert np.all(run.speed_ms[near] ** 2 <= 2 * 0.6 * before[near] * (1 + 1e-9))
    without = scenario.replace(**{"simulation.target_braking": False})
    free = plan_for(without)
    assert free.energy_kwh < run.energy_kwh
    # only the plan without curves is the run of `solve`
    assert free.energy_kwh == pytest.approx(solve(scenario).energy_kwh, rel=1e-9)
    assert simulate_following(without).notes == ()
    assert simulate_following(scenario).notes == (
        "The plan brakes along target curves of 0.6 m/s2; simulation.target_braking = false plans without them.",
    )


def test_a_train_that_is_too_heavy_for_its_plan_is_late():
    changes = {"timetable.travel_time_s": 125.0, "simulation.target_deceleration_ms2": 0.4}
    result = simulate_following(plain_scenario({**changes, "disturbance.actual_load_factor": 1.0}))
    assert result.delay_s > 0.5
    assert abs(result.stop_error_m) < 0.5


def test_brakes_that_do_not_hold_the_heavier_train_overrun_the_stop():
    changes = {
        "vehicle.braking.max_effort_kn": 60.0,
        "simulation.target_deceleration_ms2": 0.5,
        "disturbance.actual_load_factor": 1.0,
        "line.sections": [{"length_m": 2000.0, "gradient_permille": -3.0}],
    }
    result = simulate_following(plain_scenario(changes))
    assert result.stop_error_m > 0.5
    assert result.actual.speed_ms[-1] == 0


def test_stops_are_kept_with_their_dwells():
    changes = {
        "line.stations": [{"position_m": 900.0, "dwell_s": 20.0}],
        "timetable.travel_time_s": 240.0,
        "disturbance.coordinate_error_m": 8.0,
    }
    result = simulate_following(plain_scenario(changes))
    assert len(result.stop_errors_m) == 2
    assert np.abs(result.stop_errors_m).max() < 0.5
    assert result.actual.travel_time_s == pytest.approx(240.0, abs=3.0)
    assert any(phase.phase == "stand" for phase in result.actual.phases)


def test_a_hill_that_the_real_load_cannot_climb():
    changes = {
        "vehicle.capacity_passengers": 2000,
        "line.sections": [{"length_m": 600.0}, {"length_m": 1400.0, "gradient_permille": 45.0}],
        "timetable.travel_time_s": 300.0,
        "disturbance.actual_load_factor": 1.0,
    }
    with pytest.raises(InfeasibleLineError, match="with its actual load comes to a stand") as refused:
        simulate_following(plain_scenario(changes))
    # 45 N and 2 N of resistance for each kN of weight
    full = plain_scenario(changes | {"vehicle.load_factor": 1.0}).vehicle
    [needed, effort] = map(float, re.findall(r"([\d.]+) kN", str(refused.value)))
    assert needed == pytest.approx(full.total_mass_kg * 9.81e-3 * (0.045 + 0.002), abs=0.06)
    assert effort == full.traction.max_effort_kn < needed


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"disturbance.coordinate_error_m": 3000.0}, "less than the shortest distance between two stops, 2000 m"),
        ({"simulation.reset_sensor_m": 2500.0}, "simulation.reset_sensor_m = 2500 must be less than"),
        ({"simulation.stop_sensor_m": 250.0}, "the sensors must be in the order D1, D2, D3"),
        (
            {"disturbance.actual_load_factor": 1.5},
            "disturbance.actual_load_factor = 1.5 must be at most 1, the vehicle.crush",
        ),
    ],
)
def test_bad_input_is_one_sentence(changes, words):
    with pytest.raises(ScenarioError, match=words):
        simulate_following(plain_scenario(changes))


def test_the_actual_train_has_the_braking_curve_of_its_plan():
    """Without a disturbance it drives the plan, and so keeps the curve."""
    curve = {"vehicle.braking.permitted_deceleration": [[0, 0.6]]}
    followed = simulate_following(load_scenario("liashenko-ii", curve))
    for run in (followed.planned, followed.actual):
        assert (run.speed_ms <= run.permitted_speed_ms * (1 + 1e-6)).all()
