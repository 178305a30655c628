"""Ftorek's optimal control in both variants, and what it refuses."""

from dataclasses import replace

import numpy as np
import pytest
from builders import COPPER_LOSS, plain_scenario

from railjoule.core import StrategyRefusedError, load_scenario, solve
from railjoule.core.strategies import prepare_task
from railjoule.core.strategies.eoc import solve_eoc, speed2_at
from railjoule.core.strategies.optimal import unwindowed_optimum
from railjoule.core.strategies.plain_line import plain_line


def suburban(travel_time_s, **changes):
    return load_scenario("ftorek-300s", {"timetable.travel_time_s": travel_time_s, **changes})


def solution(scenario):
    task = prepare_task(scenario)
    line = plain_line(task)
    return line, solve_eoc(line, task.running_time_s, scenario.eoc.variant)


@pytest.mark.parametrize(
    ("travel_time_s", "energy_wh", "speed_kmh"), [(270, 4618.07, 76.62), (300, 4180.53, 68.35), (330, 3853.74, 61.65)]
)
def test_optimal_variant(travel_time_s, energy_wh, speed_kmh):
    """Findings on Ftorek 2025: three other methods agree to seven digits."""
    scenario = suburban(travel_time_s)
    run = solve(scenario, "eoc")
    assert 1000 * run.energy_kwh == pytest.approx(energy_wh, rel=1e-4)
    assert (run.max_speed_kmh, run.notes) == (pytest.approx(speed_kmh, rel=5e-4), ())
    assert solution(scenario)[1].total_energy_j / 3600 == pytest.approx(energy_wh, rel=2e-6)


@pytest.mark.parametrize("travel_time_s", [240, 300, 600])
def test_pontryagin_and_the_interior_point_find_the_same_run(travel_time_s):
    """Where no limit binds and all braking energy comes back, the two methods solve one problem."""
    theirs = solve(suburban(travel_time_s), "eoc")
    ours = unwindowed_optimum(replace(prepare_task(suburban(travel_time_s)), can_be_remeshed=False))
    assert theirs.energy.net_j == pytest.approx(ours.energy.net_j, rel=2e-6)
    assert theirs.speed_ms == pytest.approx(ours.speed_ms, abs=0.02)
    assert theirs.gap >= 0
    assert theirs.is_proven


@pytest.mark.parametrize(("entry_kmh", "exit_kmh"), [(10.0, 0.0), (0.0, 20.0), (36.0, 54.0), (80.0, 30.0)])
def test_moving_ends_of_10_against_the_interior_point(entry_kmh, exit_kmh):
    """ENOC, which has the same ends, is a little above both; kinetic energy makes some of these totals negative."""
    ends = {"timetable.entry_speed_kmh": entry_kmh, "timetable.exit_speed_kmh": exit_kmh}
    eoc, trapezoid = (solve(suburban(300, **ends), name, check=True) for name in ("eoc", "enoc"))
    optimal = unwindowed_optimum(replace(prepare_task(suburban(300, **ends)), can_be_remeshed=False))
    spent = optimal.energy.running_resistance_j
    assert eoc.energy.net_j == pytest.approx(optimal.energy.net_j, abs=2e-6 * spent)
    assert eoc.speed_ms == pytest.approx(optimal.speed_ms, abs=0.02)
    assert 1e-3 * spent < trapezoid.energy.net_j - optimal.energy.net_j < 0.03 * spent
    for run in (eoc, trapezoid):
        assert run.speed_ms[[0, -1]] * 3.6 == pytest.approx([entry_kmh, exit_kmh], abs=1e-9)
        assert run.travel_time_s == pytest.approx(300, rel=1e-9)


def test_speeds_between_samples():
    """Away from the ends straight lines between 4001 samples of place are right to 1 mm, hence of v^2 to 0.002."""
    line, over_time = solution(suburban(300))
    times = np.linspace(5, 295, 12_001)
    places, speeds = (np.interp(times, over_time.time_s, v) for v in (over_time.position_m, over_time.speed_ms))
    speed2 = speed2_at(over_time, line, np.concatenate([[0.0], places, [5000.0]]))
    assert speed2[1:-1] == pytest.approx(speeds**2, abs=2e-3)
    assert speed2[[0, -1]].tolist() == [0, 0]


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"line.stations": [{"position_m": 900.0}]}, "needs a line without stops between its ends."),
        ({"vehicle.drive": plain_scenario().vehicle.drive.model_dump()}, "needs a drive with copper loss."),
        ({"timetable.travel_time_s": 112.0}, "pulls with 161 kN at 0 m, where at most 100 kN are available."),
    ],
)
def test_refusals(changes, sentence):
    with pytest.raises(StrategyRefusedError) as refusal:
        solve(plain_scenario({"vehicle.drive": COPPER_LOSS, "timetable.travel_time_s": 200.0, **changes}), "eoc")
    assert str(refusal.value) == sentence


def test_a_run_that_would_roll_back_is_refused():
    """60 s for 200 m: slowing down evenly from 60 km/h and speeding up again takes all of the line and half of that."""
    ends = {"timetable.entry_speed_kmh": 60.0, "timetable.exit_speed_kmh": 60.0}
    with pytest.raises(StrategyRefusedError, match=r"^needs less time: within 60\.0 s its optimum .* rolls back\.$"):
        solve(suburban(60, **{"line.sections": [{"length_m": 200.0}], **ends}), "eoc")


def test_a_gradient_that_carries_the_train():
    """2 per mille down against 2 N/kN: hardly other than 1.999."""
    changes = {"vehicle.drive": COPPER_LOSS, "timetable.travel_time_s": 200.0}
    exact, near = (
        {**changes, "line.sections": [{"length_m": 2000.0, "gradient_permille": gradient}]}
        for gradient in (-2.0, -1.9999)
    )
    other = solve(plain_scenario(near), "eoc").energy_kwh
    assert solve(plain_scenario(exact), "eoc").energy_kwh == pytest.approx(other, rel=1e-3)
