"""The best run with few changes of regime, beside the optimum and beside other ways to find the same."""

import numpy as np
import pytest
from builders import INDUCTION, plain_scenario

from railjoule.core import StrategyRefusedError, TimetableError, load_scenario, solve
from railjoule.core.bounds import minimise
from railjoule.core.check import check_run
from railjoule.core.simulation.advised import drive_advice
from railjoule.core.studies.simple_advice import FREE_SHARE, simple_advice
from railjoule.core.task import prepare_task

HILLY = {
    "line.sections": [
        {"length_m": 500.0, "gradient_permille": 12.0},
        {"length_m": 700.0, "gradient_permille": -15.0},
        {"length_m": 800.0, "gradient_permille": 8.0, "speed_limit_kmh": 60.0},
    ],
    "timetable.travel_time_s": 170.0,
}


@pytest.fixture(scope="module")
def hilly():
    return simple_advice(prepare_task(plain_scenario(HILLY)))


def test_fewer_orders_cost_more(hilly):
    energies = [run.run.energy_kwh for run in hilly.runs]
    assert energies == sorted(energies, reverse=True)
    assert [run.changes for run in hilly.runs] == sorted({run.changes for run in hilly.runs})
    # the optimum is over a finer mesh: only what is proven lies below every run
    assert min(energies) > hilly.optimum.lower_bound_kwh
    assert hilly.price_kwh(hilly.runs[0]) == pytest.approx(energies[0] - hilly.optimum.energy_kwh)


def test_runs_keep_every_rule_and_the_timetable(hilly):
    for simple in hilly.runs:
        result = check_run(simple.run.scenario, simple.run)
        assert result.ok, result.verdict
        # one stretch of power is as long as the time asks: never late, and early by what that can be told to
        assert 0 <= 170.0 - simple.run.travel_time_s < 1e-3


def test_no_run_has_more_orders_than_it_may(hilly):
    for simple in hilly.runs:
        assert simple.changes <= simple.changes_allowed
        # an order for each regime
        assert len(simple.run.phases) == simple.changes + 1


def test_a_driver_who_follows_the_orders_needs_that_energy(hilly):
    simple = hilly.runs[-1].run
    driven = drive_advice(simple.scenario, simple.advice)
    # orders are rounded to tenths of a km/h and whole metres
    assert driven.energy_kwh == pytest.approx(simple.energy_kwh, rel=0.02)
    assert driven.travel_time_s == pytest.approx(simple.travel_time_s, rel=0.01)


def test_power_coast_brake_is_the_optimum_where_that_has_nothing_else():
    """Liashenko's profile II: the optimum has three regimes, and the search finds it within 1e-5 over one mesh."""
    task = prepare_task(load_scenario("liashenko-ii"))
    advice = simple_advice(task)
    assert len(advice.runs) == 1
    assert advice.runs[0].changes == 2
    assert advice.runs[0].run.energy.net_j == pytest.approx(minimise(task).energy_j, rel=1e-5)
    assert advice.runs[0].run.energy_kwh > advice.optimum.lower_bound_kwh


def test_four_phases_on_a_plain_line_are_those_of_their_own_planner():
    """Start, hold, coast, brake: `phases` finds them by searches over two speeds, without any grid."""
    scenario = plain_scenario({"timetable.travel_time_s": 130.0})
    advice = simple_advice(prepare_task(scenario), max_changes=3)
    assert advice.runs[-1].run.energy_kwh <= solve(scenario, "phases").energy_kwh * (1 + 1e-3)


def test_more_orders_end_where_they_are_free(hilly):
    last = hilly.runs[-1]
    assert last.run.energy_kwh <= hilly.optimum.energy_kwh * (1 + FREE_SHARE) or last.changes < last.changes_allowed


def test_each_leg_has_its_own_orders():
    stations = [{"position_m": 900.0, "dwell_s": 20.0}]
    advice = simple_advice(
        prepare_task(plain_scenario({"line.stations": stations, "timetable.travel_time_s": 190.0})), 2
    )
    (simple,) = advice.runs
    assert simple.changes == 2
    assert check_run(simple.run.scenario, simple.run).ok
    assert np.count_nonzero(simple.run.speed_ms == 0.0) >= 3


def test_drives_that_jump_are_taken():
    advice = simple_advice(prepare_task(plain_scenario({"vehicle.drive": INDUCTION, "timetable.travel_time_s": 240.0})))
    assert advice.runs
    assert check_run(advice.runs[-1].run.scenario, advice.runs[-1].run).ok


def test_a_timetable_that_cannot_be_kept():
    with pytest.raises(TimetableError):
        simple_advice(prepare_task(plain_scenario({"timetable.travel_time_s": 60.0})))


def test_a_mesh_of_too_many_cells_is_refused():
    with pytest.raises(StrategyRefusedError, match="takes at most 4,000 cells"):
        simple_advice(prepare_task(plain_scenario({"solver.mesh_m": 0.4})))
