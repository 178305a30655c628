"""A run that plays: the same as the one that is simulated with the events of its end."""

import numpy as np
import pytest
from builders import plain_scenario

from railjoule.core import ScenarioError, load_scenario
from railjoule.core.check import check_run
from railjoule.core.scenario.disturbance import UnplannedLimit, UnplannedStop, VoltageChange
from railjoule.core.simulation.disturbances import simulate_disturbances
from railjoule.core.simulation.live import (
    LiveRun,
    advance,
    clear_signal,
    events_to_keep,
    finished_run,
    known_run,
    set_event,
    start_run,
    wait_longer,
    with_events,
)

STOP = UnplannedStop(position_m=900.0, duration_s=20.0)


def played_to(run: LiveRun, place_m: float) -> LiveRun:
    """Play a run in tenths of seconds up to a place."""
    while run.position_m < place_m:
        run = advance(run, 0.1)
    return run


def to_the_end(run: LiveRun) -> LiveRun:
    """Play a run to its end; no signal may hold it."""
    run = advance(run, 1e5)
    assert run.has_arrived
    return run


@pytest.mark.parametrize("name", ["tram-950m-recuperating", "metro-with-limit"])
def test_a_played_run_is_the_one_of_its_file(name: str) -> None:
    """A red signal, and later a lower voltage: played, and simulated with what is kept of it."""
    # cells so long that the quick plan of a tram has no longer ones
    scenario = load_scenario(name, {"solver.mesh_m": 20.0})
    run = played_to(start_run(scenario), 0.2 * scenario.line.length_m)
    run = set_event(run, UnplannedStop(position_m=0.5 * scenario.line.length_m, duration_s=8.0))
    run = set_event(played_to(run, 0.3 * scenario.line.length_m), VoltageChange(line_voltage_factor=0.9))
    played = finished_run(to_the_end(run))
    filed = simulate_disturbances(with_events(scenario, events_to_keep(run)), "computer")
    assert played.actual.energy_kwh == pytest.approx(filed.actual.energy_kwh, rel=1e-6)
    assert played.delay_s == pytest.approx(filed.delay_s, abs=1e-4)
    # with advance notice a train needs no more at the same arrival
    known = known_run(run)
    assert known.delay_s < played.delay_s + 1e-3
    if played.delay_s < 1e-3:
        assert known.actual.energy_kwh <= played.actual.energy_kwh * (1 + 1e-3)


def test_the_account_goes_on_through_all_plans_and_the_check_passes() -> None:
    scenario = plain_scenario({"timetable.travel_time_s": 260.0})
    run = set_event(played_to(start_run(scenario), 400.0), STOP)
    run = set_event(played_to(run, 700.0), UnplannedLimit(from_m=1200.0, to_m=1500.0, limit_kmh=40.0))
    assert run.energy_j + run.remaining_j == pytest.approx(run.spent_j + run.ahead.energy.net_j)
    run = to_the_end(run)
    played = finished_run(run).actual
    assert run.energy_j == pytest.approx(played.energy.net_j, rel=1e-6)
    assert run.remaining_j == pytest.approx(0.0, abs=1.0)
    assert played.travel_time_s == pytest.approx(260.0, abs=1e-3)
    # by formulas that share no code: effort, limits, stops and timetable of the line with both events
    known = scenario.replace(
        **{
            "line.stations": [{"position_m": 0}, {"position_m": 900, "dwell_s": 20}, {"position_m": 2000}],
            "line.speed_limits": [{"from_m": 1200, "to_m": 1500, "limit_kmh": 40}],
        }
    )
    result = check_run(known, played)
    assert result.ok, result


def test_an_open_signal_holds_the_train_until_it_clears() -> None:
    held = advance(set_event(played_to(start_run(plain_scenario()), 400.0), STOP, is_open=True), 1e4)
    assert held.position_m == pytest.approx(900.0)
    assert held.held_at is not None
    longer = advance(wait_longer(held), 7.0)
    assert (longer.position_m, longer.dwell_left_s) == (pytest.approx(900.0), pytest.approx(13.0))
    (signal,) = longer.events
    cleared = clear_signal(longer, signal)
    assert cleared.dwell_left_s == 0.0
    assert cleared.arrival_s < longer.arrival_s
    (kept,) = events_to_keep(to_the_end(cleared))
    assert kept.duration_s == pytest.approx(27.0)


def test_a_signal_that_clears_before_the_train_stands_gives_its_plan_back() -> None:
    run = played_to(start_run(plain_scenario({"timetable.travel_time_s": 240.0})), 400.0)
    stopping = advance(set_event(run, STOP), 3.0)
    (signal,) = stopping.events
    cleared = clear_signal(stopping, signal)
    assert events_to_keep(cleared) == ()
    assert "no event is kept of it" in cleared.notes[0]
    played = finished_run(cleared).actual
    assert np.all(played.speed_ms[1:-1] > 0)
    assert played.travel_time_s == pytest.approx(240.0, abs=1e-3)


def test_a_signal_too_close_is_passed_by_metres_that_are_named_and_one_behind_is_refused() -> None:
    run = played_to(start_run(plain_scenario()), 800.0)
    late = set_event(run, UnplannedStop(position_m=run.position_m + 5, duration_s=10.0))
    assert "becomes known too late: the train stands at" in late.notes[0]
    assert late.notes[0].endswith("m too far.")
    # what is set while it brakes does not let it forget the signal
    later = set_event(advance(late, 1.0), UnplannedLimit(from_m=1500.0, to_m=1600.0, limit_kmh=30.0))
    ended = finished_run(to_the_end(later)).actual
    filed = simulate_disturbances(with_events(plain_scenario(), events_to_keep(later)), "computer")
    for actual in (ended, filed.actual):
        standing = np.diff(actual.position_m) == 0
        assert np.diff(actual.time_s)[standing].sum() == pytest.approx(10.0)
    with pytest.raises(ScenarioError, match=r"is not ahead of the train at \d+ m\. The nearest place"):
        set_event(run, UnplannedStop(position_m=300.0, duration_s=5.0))


def test_a_voltage_counts_from_the_nominal_one() -> None:
    run = played_to(start_run(plain_scenario()), 300.0)
    weak = set_event(run, VoltageChange(line_voltage_factor=0.5))
    assert set_event(weak, VoltageChange(line_voltage_factor=1.0)).since.scenario.vehicle == run.scenario.vehicle
    changes = [{"line_voltage_factor": 0.5, "noticed_at_m": 300}, {"line_voltage_factor": 1.0, "noticed_at_m": 301}]
    filed = simulate_disturbances(plain_scenario({"disturbance.voltage_changes": changes}), "computer")
    assert filed.delay_s == pytest.approx(0.0, abs=1e-3)
