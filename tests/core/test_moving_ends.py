"""Runs that enter or leave their line in motion or pass places at given speeds, for every strategy and simulation."""

from pathlib import Path

import numpy as np
import pytest
from builders import COPPER_LOSS, INDUCTION, LOSS_POLYNOMIAL, plain_scenario

from railjoule.core import load_scenario, solve
from railjoule.core.check import check_run
from railjoule.core.errors import ScenarioError, StrategyRefusedError
from railjoule.core.motion import build_meshed_line
from railjoule.core.simulation.actual_run import actual_run
from railjoule.core.simulation.advised import drive_advice
from railjoule.core.simulation.field_oriented import simulate_field_oriented
from railjoule.core.strategies import compare
from railjoule.core.studies.whole_line import whole_line

MOVING = {"timetable.entry_speed_kmh": 36.0, "timetable.exit_speed_kmh": 54.0, "timetable.travel_time_s": 130.0}
PASSING = {"line.passing_points": [{"name": "junction", "position_m": 1205.0, "speed_kmh": 45.0}]}

G1 = Path(__file__).parents[1] / "benchmarks" / "g1.toml"
STATION = [{"position_m": 900.0, "dwell_s": 10.0}]


def speed_kmh_at(run, place_m):
    return float(np.sqrt(np.interp(place_m, run.position_m, run.speed_ms**2))) * 3.6


@pytest.mark.parametrize(
    ("ends_kmh", "printed_kwh", "share"),
    [
        # G1 of the two published solvers, which agree to 2e-6; and an IPOPT model of our own at rest, extrapolated
        (3.6, 440.1406, 2e-4),
        (0.0, 442.286, 5e-4),
    ],
)
def test_a_published_benchmark_begins_in_motion(ends_kmh, printed_kwh, share):
    scenario = load_scenario(G1)
    ends = {"timetable.entry_speed_kmh": ends_kmh, "timetable.exit_speed_kmh": ends_kmh}
    run = solve(scenario.replace(**ends), check=True)
    assert run.energy_kwh == pytest.approx(printed_kwh, rel=share)
    assert run.is_proven


@pytest.mark.parametrize("drive", [None, COPPER_LOSS, INDUCTION, LOSS_POLYNOMIAL])
@pytest.mark.parametrize("strategy", ["optimal", "bellman", "fastest"])
def test_runs_have_the_speeds_of_the_timetable(strategy, drive):
    changes = MOVING if drive is None else {**MOVING, "vehicle.drive": drive}
    run = solve(plain_scenario(changes), strategy, check=True)
    assert run.speed_ms[[0, -1]] * 3.6 == pytest.approx([36.0, 54.0])


def test_kinetic_energy_is_part_of_the_account():
    """One that enters at 36 km/h and leaves at 54 takes its inertia times (15^2 - 10^2) / 2 with it, and no loss."""
    scenario = plain_scenario(MOVING)
    run = solve(scenario)
    kinetic = 0.5 * scenario.vehicle.total_inertia_kg * (15.0**2 - 10.0**2)
    work = float(np.sum(run.effort_n * np.diff(run.position_m)))
    assert work - run.energy.running_resistance_j == pytest.approx(kinetic, rel=1e-6)


def test_every_strategy_takes_them_or_says_why_not():
    found = compare(plain_scenario({**MOVING, "vehicle.drive": COPPER_LOSS}))
    runs, refused = found.runs, found.refused
    assert {run.strategy for run in runs} == {"optimal", "bellman", "eoc", "enoc", "phases", "fastest"}
    assert refused["speed_limits"] == "needs a run that ends at rest."
    for run in runs:
        assert run.speed_ms[[0, -1]] * 3.6 == pytest.approx([36.0, 54.0])


@pytest.mark.parametrize("strategy", ["optimal", "bellman", "fastest"])
def test_passing_points_are_passed_at_their_speeds(strategy):
    run = solve(plain_scenario(PASSING), strategy, check=True)
    assert speed_kmh_at(run, 1205.0) == pytest.approx(45.0)
    # without them the train is faster there, so that they cost time or energy
    assert speed_kmh_at(solve(plain_scenario(), strategy), 1205.0) > 46.0
    assert run.check.ok
    assert "passing speeds" in {check.name for check in run.check.checks}


def test_the_check_sees_a_run_that_passes_too_fast():
    result = check_run(plain_scenario(PASSING), solve(plain_scenario()))
    assert {check.name for check in result.checks if not check.ok} == {"passing speeds"}


@pytest.mark.parametrize("strategy", ["eoc", "enoc", "phases", "speed_limits"])
def test_who_cannot_pass_at_a_speed_says_so(strategy):
    with pytest.raises(StrategyRefusedError, match="needs a line without passing points"):
        solve(plain_scenario({**PASSING, "vehicle.drive": COPPER_LOSS}), strategy)


def test_a_passing_point_costs_energy():
    assert solve(plain_scenario(PASSING)).energy_kwh > solve(plain_scenario()).energy_kwh


def test_a_follower_begins_and_ends_in_motion():
    run = actual_run(plain_scenario({**MOVING, "disturbance.actual_load_factor": 0.6}))
    assert run.planned.speed_ms[[0, -1]] * 3.6 == pytest.approx([36.0, 54.0])
    assert run.actual.speed_ms[0] * 3.6 == pytest.approx(36.0)
    assert run.actual.speed_ms[-1] * 3.6 == pytest.approx(54.0, rel=1e-3)
    assert run.actual.distance_m == pytest.approx(2000.0)


@pytest.mark.parametrize("reaction", ["driver", "computer", "known"])
def test_an_unplanned_stop_leaves_the_ends_in_motion(reaction):
    stop = {"position_m": 1000.0, "duration_s": 5.0, "noticed_at_m": 400.0, "reaction": reaction}
    run = actual_run(plain_scenario({**MOVING, "disturbance.stops": [stop]}))
    assert run.actual.speed_ms[[0, -1]] * 3.6 == pytest.approx([36.0, 54.0])


def test_advice_begins_in_motion():
    run = solve(plain_scenario(MOVING))
    driven = drive_advice(run.scenario, run.advice)
    assert driven.speed_ms[0] * 3.6 == pytest.approx(36.0)
    assert driven.speed_ms[-1] * 3.6 == pytest.approx(54.0, abs=0.2)


def test_a_whole_line_with_moving_ends():
    line = whole_line(plain_scenario({**MOVING, "timetable.travel_time_s": 160.0, "line.stations": STATION}))
    assert line.run.speed_ms[[0, -1]] * 3.6 == pytest.approx([36.0, 54.0])
    assert len({round(leg.price_of_time_w, 6) for leg in line.legs}) == 1


def test_the_closed_loop_refuses_moving_ends():
    scenario = plain_scenario({**MOVING, "vehicle.drive": INDUCTION, "simulation.kind": "field_oriented"})
    with pytest.raises(ScenarioError, match=r"does not simulate timetable\.entry_speed_kmh"):
        simulate_field_oriented(scenario)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"line.passing_points": [{"position_m": 1999.5, "speed_kmh": 40}]}, "at least 1 m before the end of the line"),
        (
            {"line.passing_points": [{"position_m": 500, "speed_kmh": 40}], "line.stations": [{"position_m": 500}]},
            "lies at a station, where the train stands",
        ),
        (
            {
                "line.passing_points": [
                    {"position_m": 500, "speed_kmh": 40},
                    {"position_m": 500.5, "speed_kmh": 40},
                ]
            },
            "passing_points must have rising positions",
        ),
        ({"timetable.entry_speed_kmh": -1}, "timetable.entry_speed_kmh = -1 must be at least 0"),
        ({"line.limits_hold_for": "whole_train"}, "needs vehicle.length_m"),
    ],
)
def test_what_cannot_be_is_told(changes, words):
    with pytest.raises(ScenarioError, match=words):
        plain_scenario(changes)


def test_head_wind_by_hand():
    """C (v + w)^2 = C w^2 + 2 C w v + C v^2, with w = 10 m/s."""
    still, windy = (
        build_meshed_line(plain_scenario()).data,
        build_meshed_line(plain_scenario({"line.head_wind_kmh": 36.0})).data,
    )
    c = still.resistance_quadratic[0]
    assert windy.resistance_constant_n - still.resistance_constant_n == pytest.approx(100 * c)
    assert windy.resistance_linear - still.resistance_linear == pytest.approx(20 * c)
    assert windy.resistance_quadratic[0] == c


@pytest.mark.parametrize("strategy", ["optimal", "bellman", "phases", "speed_limits", "fastest"])
def test_all_feel_the_wind_and_the_check_agrees(strategy):
    windy = plain_scenario({"line.head_wind_kmh": 30.0})
    assert solve(windy, strategy, check=True).energy_kwh > solve(plain_scenario(), strategy).energy_kwh


@pytest.mark.parametrize("strategy", ["optimal", "bellman", "speed_limits", "fastest"])
@pytest.mark.parametrize("gradient_at", ["front", "middle", "whole_train"])
def test_trains_with_a_length_pass_the_check(strategy, gradient_at):
    changes = {
        "vehicle.length_m": 120.0,
        "vehicle.car_count": 5,
        "vehicle.gradient_at": gradient_at,
        "line.limits_hold_for": "whole_train",
        "line.sections": [
            {"length_m": 700.0, "speed_limit_kmh": 60.0},
            {"length_m": 600.0, "gradient_permille": 12.0},
            {"length_m": 700.0, "gradient_permille": -8.0},
        ],
        "line.speed_limits": [{"from_m": 1400.0, "to_m": 1500.0, "limit_kmh": 55.0}],
        "timetable.travel_time_s": 190.0,
    }
    run = solve(plain_scenario(changes), strategy, check=True)
    assert speed_kmh_at(run, 819.0) <= 60.0 + 1e-6
    assert speed_kmh_at(run, 1619.0) <= 55.0 + 1e-6


def test_a_run_that_ignores_its_rear_fails_the_check():
    changes = {"vehicle.length_m": 120.0, "line.speed_limits": [{"from_m": 600.0, "to_m": 900.0, "limit_kmh": 40.0}]}
    front = solve(plain_scenario({**changes, "timetable.travel_time_s": 170.0}), "fastest")
    asked = front.scenario.replace(**{"line.limits_hold_for": "whole_train"})
    assert "speed limit" in {check.name for check in check_run(asked, front).checks if not check.ok}
