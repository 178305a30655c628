import numpy as np
import pytest

from railjoule.core import ScenarioError, StrategyRefusedError, load_scenario, solve
from railjoule.core.simulation.field_oriented import FieldOrientedRun
from railjoule.dashboard.pages.motor.compute import (
    LoopRivals,
    compute_loop_run,
    compute_ripple,
    compute_rivals,
    scenario_with_motor,
)

# with the ramps of the paper
SUBURBAN = load_scenario("ftorek-300s").replace(**{"enoc.acceleration_time_s": 62.713})


@pytest.fixture(scope="module")
def loop() -> FieldOrientedRun:
    return compute_loop_run(SUBURBAN, "enoc", {})


@pytest.fixture(scope="module")
def rivals(loop: FieldOrientedRun) -> LoopRivals:
    return compute_rivals(loop)


def test_the_plan_is_that_of_the_strategy(loop: FieldOrientedRun) -> None:
    assert loop.planned.strategy == "enoc"
    assert loop.planned.energy_kwh == pytest.approx(solve(SUBURBAN, "enoc").energy_kwh, rel=1e-9)
    assert loop.saturated == ()
    # Table 2 of the paper, ENOC at 300 s; corners of the speed add a little
    assert loop.torque_current_a.max() == pytest.approx(196.2, rel=0.01)


def test_a_run_is_compared_with_its_like_and_with_the_paper_s_strategies(
    loop: FieldOrientedRun, rivals: LoopRivals
) -> None:
    assert rivals.runs["with"] is loop
    # a loop of third order with its poles at 10 rad/s lags by 3/10 s of its speed; with the pre-compensator by 5 cm
    lag = 0.3 * loop.planned.speed_ms.max()
    assert rivals.runs["without"].max_tracking_error_m == pytest.approx(lag, rel=0.01)
    assert loop.max_tracking_error_m < 0.05
    assert rivals.runs["enoc"] is loop
    assert rivals.runs["eoc"].planned.strategy == "eoc"
    assert rivals.refused == {}


def test_a_lower_limit_holds_the_drive_but_not_its_plan() -> None:
    weak = compute_loop_run(SUBURBAN, "enoc", {"drive.machine.max_phase_voltage_v": 400.0})
    assert weak.planned.energy_kwh == pytest.approx(solve(SUBURBAN, "enoc").energy_kwh, rel=1e-9)
    assert {span.what for span in weak.saturated} >= {"voltage"}
    assert weak.max_phase_voltage_v <= 400.0 * (1 + 1e-9)


def test_strategies_that_refuse_a_line_are_told() -> None:
    hilly = SUBURBAN.replace(line={"sections": [{"length_m": 5000.0, "gradient_permille": 2.0}]})
    hilly = hilly.replace(**{"line.speed_limits": [{"from_m": 1000.0, "to_m": 1500.0, "limit_kmh": 40.0}]})
    rivals = compute_rivals(compute_loop_run(hilly, "optimal", {}))
    assert set(rivals.refused) == {"eoc", "enoc"}
    with pytest.raises(StrategyRefusedError, match=r"^ENOC: "):
        compute_loop_run(hilly, "enoc", {})


def test_ripple_is_asked_for_within_the_run(loop: FieldOrientedRun) -> None:
    ripple = compute_ripple(loop, 1e6)
    assert np.all(np.isfinite(ripple.phase_current_a))
    assert ripple.time_s[0] <= loop.time_s[-1]


def test_scenarios_without_a_machine_say_so() -> None:
    tram = load_scenario("tram-950m")
    assert scenario_with_motor(SUBURBAN) is SUBURBAN
    assert scenario_with_motor(tram) is tram
    assert scenario_with_motor(load_scenario("liashenko-ii")).title == "Suburban, flat 5 km"
    with pytest.raises(ScenarioError, match="max_phase_voltage_v"):
        compute_loop_run(SUBURBAN, "enoc", {"drive.machine.max_phase_voltage_v": -1.0})
