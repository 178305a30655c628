"""The run of the printed regulator: one that the train can drive, or a sentence that tells why there is none."""

import numpy as np
import pytest
from builders import HILLS, plain_scenario
from hard_scenarios import COMES_TO_REST_FOR_EVER
from set_speeds import drive_under_limits

from railjoule.core import StrategyRefusedError, check_run, load_scenario, solve
from railjoule.core.scenario import scenario_from_document
from railjoule.core.strategies.literal_regulator import literal_run
from railjoule.core.strategies.speed_limits import speed_limits, speed_limits_with_search
from railjoule.core.task import prepare_task
from railjoule.core.units import MS_PER_KMH

STEEP = [{"length_m": 1000.0}, {"length_m": 1000.0, "gradient_permille": -40.0, "speed_limit_kmh": 30.0}]
SLOW = [{"length_m": 2000.0, "speed_limit_kmh": 8.0}]
STEP = r"with the literal regulator and search\.time_step_s = "
HILLY = {
    "line.sections": HILLS,
    "vehicle.length_m": 80.0,
    "vehicle.car_count": 4,
    "vehicle.braking": {"max_effort_kn": 60.0, "max_power_kw": 600.0, "friction_effort_kn": 40.0},
}


def literal(changes, limit_kmh=50.0, **search):
    options = {f"search.{key}": value for key, value in search.items()}
    return drive_under_limits(
        plain_scenario({"search.regulator": "literal", "search.boundaries_m": [1000.0], **changes, **options}),
        [limit_kmh, 40.0],
        "literal",
    )


@pytest.mark.parametrize("step", [0.02, 0.1, 0.5])
@pytest.mark.parametrize(
    "changes",
    [{}, HILLY, {"vehicle.traction.max_acceleration_ms2": 0.5, "vehicle.braking.max_deceleration_ms2": 0.4}],
    ids=["plain", "hilly", "gentle"],
)
def test_its_run_keeps_every_rule(changes, step):
    """Weak brakes under a limit of power, gradients all along the train, limits of acceleration."""
    run = literal(changes, time_step_s=step)
    assert [check.name for check in check_run(run.scenario, run).checks if not check.ok] == []
    assert run.speed_ms[-1] == 0


def test_it_coasts_where_it_asks_for_nothing():
    """Gradients change along the train within each of its steps: the drive shall be off all the same."""
    run = literal_run(prepare_task(plain_scenario(HILLY)), np.array([50.0]) * MS_PER_KMH, np.empty(0))
    assert (np.abs(run.mesh.net_force_n(run.speed2)) < 1e-3).sum() > 100


def test_it_waits_for_its_effort_uphill():
    """20 per mille of 100 t are 20 kN, a fifth of the effort that grows in 2 s: 0.4 s."""
    run = literal({"line.sections": [{"length_m": 2000.0, "gradient_permille": 20.0}]})
    assert run.time_s[1] == pytest.approx((20 + 2 * 100 * 9.81e-3) / 100 * 2, abs=0.1)
    assert run.position_m[1] == 0


@pytest.mark.parametrize(
    ("changes", "search", "expected"),
    [
        (
            {"vehicle.traction.max_effort_kn": 300.0, "line.sections": SLOW, "timetable.travel_time_s": 1000.0},
            {"full_effort_time_s": 20.0, "effort_rate_share": 1.0, "time_step_s": 0.05},
            rf"passes the end of the line by 0\.\d+ m {STEP}0\.05, even with all its brakes",
        ),
        (
            {"line.sections": STEEP, "timetable.travel_time_s": 250.0},
            {"time_step_s": 1.0},
            rf"passes the speed limit of 30 km/h by 2\.\d km/h at 100\d m {STEP}1\.$",
        ),
        ({}, {"time_step_s": 0.0005}, r"takes at most 200,000 steps of the literal regulator"),
    ],
)
def test_what_it_refuses(changes, search, expected):
    with pytest.raises(StrategyRefusedError, match=expected):
        literal(changes, **search)


def test_given_limits_are_driven_from_stop_to_stop():
    """It stands at the station for its dwell and until its effort moves the train, on the level within a step."""
    stations = [{"name": "Middle", "position_m": 900.0, "dwell_s": 20.0}]
    run = literal({"line.stations": stations, "timetable.travel_time_s": 250.0})
    assert check_run(run.scenario, run).ok
    at_station = np.abs(run.position_m - 900.0) < 1e-6
    assert 20.0 <= np.ptp(run.time_s[at_station]) <= 20.1
    assert run.speed_ms[at_station] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.nightly
def test_a_search_with_it_keeps_the_window():
    """(14) holds for its own run, of the time (2400 - 96) m / 40 km/h by (15), and no cheaper pair is near."""
    scenario = load_scenario("kharkiv-like-40kmh", {"search.regulator": "literal"})
    run, search = speed_limits_with_search(prepare_task(scenario))
    window = scenario.search.time_window
    assert abs(run.travel_time_s / 207.36 - 1) < window
    assert run.travel_time_s > 207.36 * (1 + window) * (1 - 2e-3)
    assert run.energy.net_j == pytest.approx(search.best.energy_j, rel=1e-9)
    assert check_run(scenario, run).ok
    for share in (0.98, 1.02):
        limits_kmh = search.best.limits_ms / MS_PER_KMH * [share, 1.0]
        other = drive_under_limits(scenario, limits_kmh.tolist())
        assert other.energy_kwh > run.energy_kwh or other.travel_time_s > 207.36 * (1 + window)


def test_a_search_of_the_whole_line_needs_one_for_each_run():
    stations = [{"name": "Middle", "position_m": 900.0, "dwell_s": 20.0}]
    changes = {"line.stations": stations, "timetable.travel_time_s": 250.0, "search.regulator": "literal"}
    scenario = plain_scenario(changes)
    with pytest.raises(
        StrategyRefusedError, match=r"needs a line without stops .* \(search.inter_station_runs = 'sepa"
    ):
        solve(scenario, "speed_limits")


def test_a_crawl_is_told_from_a_stand():
    """2 km at 1 km/h take two hours; it gives up after three times the timetable's 150 s."""
    with pytest.raises(StrategyRefusedError, match=r"does not arrive within 450 s with the literal regulator"):
        literal({"search.limits_kmh": [2.0, 2.0]}, limit_kmh=2.0)


def test_a_train_that_comes_to_rest_for_ever_is_given_up():
    """After three times its timetable's 220 s."""
    with pytest.raises(StrategyRefusedError, match=r"does not arrive within 660 s with the literal regulator"):
        speed_limits(prepare_task(scenario_from_document(COMES_TO_REST_FOR_EVER)))


def test_it_knows_no_braking_curve():
    sentence = r"^needs a train without a permitted deceleration \(vehicle\.braking\.permitted_deceleration\) for the"
    with pytest.raises(StrategyRefusedError, match=sentence):
        literal({"vehicle.braking.permitted_deceleration": [[0, 0.5]]})
