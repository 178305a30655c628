"""The formula for level track beside the solver, which knows nothing of it."""

import pytest

from railjoule.core import Scenario, StrategyRefusedError, load_scenario, solve
from railjoule.core.studies.steady import phase_plane, steady_speeds


def level(length_m: float, time_s: float, recuperation: float) -> Scenario:
    changes = {"timetable.travel_time_s": time_s, "drive.recuperation_factor": recuperation}
    return load_scenario("liashenko-0").replace(line={"sections": [{"length_m": length_m}]}, **changes)


@pytest.mark.parametrize("recuperation", [0.0, 0.5, 1.0])
def test_a_long_run_holds_and_brakes_where_the_formula_says(recuperation):
    scenario = level(9000, 600, recuperation)
    run = solve(scenario)
    steady = steady_speeds(scenario, run.price_of_time_w)
    phases = {phase.phase: phase for phase in run.phases}
    # the solver's cells are 5 m long: it ends coasting within one of them
    assert steady.hold_ms == pytest.approx(phases["hold"].end_ms, rel=2e-3)
    assert steady.brake_ms == pytest.approx(phases["coast"].end_ms, rel=4e-3)


def test_a_short_run_brakes_where_the_formula_says():
    scenario = level(2000, 150, 0.0)
    run = solve(scenario)
    steady = steady_speeds(scenario, run.price_of_time_w, float(run.speed_ms.max()))
    coast = next(phase for phase in run.phases if phase.phase == "coast")
    assert steady.highest_ms < steady.hold_ms
    assert steady.brake_ms == pytest.approx(coast.end_ms, rel=4e-3)


def test_the_held_speed_is_the_vehicle_s_limit_at_most():
    assert steady_speeds(level(3000, 160, 0.0), 1e9).hold_ms * 3.6 == pytest.approx(80)


def test_the_phase_plane_meets_its_lines_at_the_switches():
    scenario = level(9000, 600, 0.5)
    full, coast, brake = phase_plane(scenario, steady_speeds(scenario, 2.5e5))
    # 0.85 of efficiency in driving, half of 0.85 back in braking
    assert full.adjoint[-1] == coast.adjoint[0] == pytest.approx(1 / 0.85)
    assert coast.adjoint[-1] == pytest.approx(0.425)
    assert brake.adjoint[0] == pytest.approx(0.425)
    assert full.adjoint.min() >= 1 / 0.85 - 1e-9
    assert brake.adjoint.max() <= 0.425 + 1e-9


def test_other_drives_are_refused():
    with pytest.raises(StrategyRefusedError, match="constant efficiency"):
        steady_speeds(load_scenario("tram-950m"), 1e5)
