import numpy as np
import pytest
from set_speeds import drive_under_limits

from railjoule.core import Scenario, ScenarioError, StrategyRefusedError, load_scenario
from railjoule.dashboard.pages.set_speeds.compute import (
    LimitRun,
    compute_limit_run,
    compute_limit_trip,
    compute_storage,
)

SCENARIO = load_scenario("kharkiv-like-40kmh")
GIVEN = {"strategy": "speed_limits", "search.limits_kmh": [50.0, 30.0]}


@pytest.fixture(scope="module")
def run() -> LimitRun:
    return compute_limit_run(SCENARIO, GIVEN)


def test_given_limits_are_driven_and_compared_over_the_same_time(run: LimitRun) -> None:
    assert run.run.energy_kwh == pytest.approx(drive_under_limits(SCENARIO, [50.0, 30.0]).energy_kwh, rel=1e-9)
    assert run.optimum.travel_time_s == pytest.approx(run.run.travel_time_s, abs=0.01)
    assert run.run.above_share == pytest.approx(run.run.energy_kwh / run.optimum.energy_kwh - 1)
    assert run.run.above_share > 0
    assert run.limits_kmh == pytest.approx([50.0, 30.0])


@pytest.mark.parametrize("changes", [{"search.regulator": "literal"}, {"search.limits_kmh": None}])
def test_no_quick_trip_for_a_relay_or_a_search(changes: dict[str, object]) -> None:
    assert compute_limit_trip(SCENARIO, {**GIVEN, **changes}) is None


def test_a_time_without_optimum_says_why() -> None:
    flat_out = {"strategy": "speed_limits", "search.limits_kmh": [80.0, 80.0], "search.stop_deceleration_ms2": 20.0}
    found = compute_limit_run(level(), flat_out)
    assert (found.optimum is None) == bool(found.no_optimum)
    assert found.run.above_share is None
    assert "shortest possible" in found.no_optimum


def level() -> Scenario:
    """A line so short that no limit is met."""
    return SCENARIO.replace(
        **{
            "line": {"sections": [{"length_m": 50.0}, {"length_m": 50.0}]},
            "search.boundaries_m": [50.0],
            "timetable": {"travel_time_s": 40.0},
        }
    )


def test_refusals_name_the_strategy() -> None:
    tight = SCENARIO.replace(**{"timetable.travel_time_s": 131.0})
    with pytest.raises(StrategyRefusedError, match="Set speeds: needs at least"):
        compute_limit_run(tight, {"strategy": "speed_limits"})
    with pytest.raises(ScenarioError, match="at most the vehicle's 80"):
        compute_limit_run(SCENARIO, {**GIVEN, "search.limits_kmh": [50.0, 500.0]})


def test_storages_save_up_to_what_they_need(run: LimitRun) -> None:
    curve = compute_storage(run, None, None, 0.95, 0.95)
    assert curve.chosen.storage.size_kwh == run.need.max_drop_kwh
    assert np.all(np.diff(curve.saved_kwh) > -1e-9)
    assert curve.saved_kwh[0] == pytest.approx(0, abs=1e-9)
    # nothing is burnt, so only both losses are missing
    most = curve.chosen.with_resistors_kwh - curve.chosen.with_receptive_line_kwh
    assert curve.saved_kwh[-1] == pytest.approx(0.95**2 * most, rel=1e-6)
    with pytest.raises(ScenarioError, match=r"storage\.size_kwh = -1 must be"):
        compute_storage(run, -1.0, None, 0.95, 0.95)
