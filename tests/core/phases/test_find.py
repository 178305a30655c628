"""A run in the words of a driver, by hand and over whole runs."""

import numpy as np
import pytest
from builders import plain_scenario
from hypothesis import given
from hypothesis import strategies as st
from pieces import LARGEST_N, in_short, run_of
from random_scenarios import random_run

from railjoule.core import load_scenario, solve
from railjoule.core.phases import find_phases
from railjoule.core.phases.labels import NEGLIGIBLE_MS
from railjoule.core.strategies import run_strategy
from railjoule.core.units import J_PER_KWH


def test_the_classical_run():
    phases = find_phases(run_of((100, 15, 1.0), (400, 15, 0.1), (300, 12, 0.0), (100, 0.0, -0.8), start_ms=0.0))
    assert in_short(phases) == [("full_power", 0, 100), ("hold", 100, 500), ("coast", 500, 800), ("brake", 800, 900)]
    first, second = phases[:2]
    assert (first.start_s, first.start_ms, first.end_ms) == (0, 0, pytest.approx(15))
    assert first.end_s == second.start_s == pytest.approx(100 / 7.5)
    assert second.mean_speed_ms == pytest.approx(15)
    assert [phase.energy_j for phase in phases] == pytest.approx([100e3 * 100, 10e3 * 400, 0, 0])
    assert [phase.effort_share for phase in phases] == [None, None, None, pytest.approx(0.8)]


def test_a_stand_parts_phases_however_short_they_are():
    run = run_of((2000, 0.0, -0.5), (0, 0.0, 0.0), (5, 2.0, 1.0), (5, 0.0, -1.0), (0, 0.0, 0.0), (2000, 10, 1.0))
    phases = find_phases(run)
    assert [phase.phase for phase in phases] == ["brake", "stand", "full_power", "brake", "stand", "full_power"]
    assert phases[1].end_s - phases[1].start_s == 30


def test_what_a_negligible_effort_takes_counts_where_power_is():
    """2 kN over 20 m change the speed of 100 t at 10 m/s by 0.04 m/s: more than negligible; over 5 m by 0.01: less."""
    shown = find_phases(run_of((100, 14, 1.0), (500, 13, 0.0), (20, 12.8, 0.02), (500, 12, 0.0), cell_m=5.0))
    assert [phase.phase for phase in shown] == ["full_power", "coast", "part_power", "coast"]
    negligible = find_phases(run_of((100, 14, 1.0), (500, 13, 0.0), (5, 13, 0.02), (500, 12, 0.0), cell_m=5.0))
    assert in_short(negligible) == [("full_power", 0, 100), ("coast", 100, 1105)]
    assert [phase.energy_j for phase in negligible] == [pytest.approx(100 * LARGEST_N + 5 * 0.02 * LARGEST_N), 0]


def test_the_first_scenario_brakes_for_its_limit_and_holds_it():
    """Metro with a limit of 50 from 600 m to 900 m: the brake of 5 m before it was lost in the coasting once."""
    run = solve(load_scenario("metro-with-limit"))
    kinds = [phase.phase for phase in run.phases]
    assert kinds == ["full_power", "coast", "brake", "hold", "full_power", "coast", "brake"]
    brake, hold = run.phases[2:4]
    assert (brake.start_m, brake.end_m, brake.end_ms * 3.6) == (595, 600, pytest.approx(50, abs=1e-6))
    assert (hold.start_m, hold.end_m) == (600, 900)
    assert brake.energy_j < -0.4e6


@given(st.integers(0, 10**6), st.sampled_from(["optimal", "fastest"]))
def test_phases_cover_the_run(seed, strategy):
    run = run_strategy(random_run(seed, stops=seed % 2 == 1).task, strategy)
    first, last = run.phases[0], run.phases[-1]
    assert (first.start_m, first.start_s, first.start_ms) == (0, 0, run.speed_ms[0])
    assert (last.end_m, last.end_s, last.end_ms) == (run.position_m[-1], run.time_s[-1], run.speed_ms[-1])
    for one, other in zip(run.phases, run.phases[1:], strict=False):
        assert (one.end_m, one.end_s, one.end_ms) == (other.start_m, other.start_s, other.start_ms)
        assert one.end_s > one.start_s
    own = run.energy.traction_j - run.energy.recuperated_j
    assert sum(phase.energy_j for phase in run.phases) == pytest.approx(own, rel=1e-9, abs=1.0)


@given(st.integers(0, 10**6), st.sampled_from(["optimal", "fastest"]))
def test_coasting_hides_neither_power_nor_brakes(seed, strategy):
    """An effort beside coasting that is not shown changes the speed by less than the advice shows."""
    run = run_strategy(random_run(seed, stops=seed % 2 == 1).task, strategy)
    middle = 0.5 * (run.position_m[1:] + run.position_m[:-1])
    work = run.effort_n * np.diff(run.position_m)
    mean_speed = 0.5 * (run.speed_ms[1:] + run.speed_ms[:-1])
    for phase in run.phases:
        if phase.phase != "coast":
            continue
        # a cell within which the phase begins or ends has the effort of the other one
        inside = (run.position_m[:-1] >= phase.start_m) & (run.position_m[1:] <= phase.end_m)
        assert np.all((middle[inside] > phase.start_m) & (middle[inside] < phase.end_m))
        change = np.abs(work[inside]) / (run.run_data.inertia_kg * mean_speed[inside])
        assert np.all(change < NEGLIGIBLE_MS)


@given(st.integers(0, 10**6))
def test_no_brake_is_lost(seed):
    """Every cell that slows the train down by a change that the advice shows belongs to a brake or holds a speed."""
    run = run_strategy(random_run(seed, stops=False).task, "fastest")
    work = -run.effort_n * np.diff(run.position_m)
    slowed = work / (run.run_data.inertia_kg * 0.5 * (run.speed_ms[1:] + run.speed_ms[:-1]))
    for place in run.position_m[1:][slowed > NEGLIGIBLE_MS]:
        phase = next(phase for phase in run.phases if phase.start_m < place <= phase.end_m)
        assert phase.phase in {"brake", "hold"}


@pytest.mark.parametrize(
    ("length_m", "names"),
    [(8000.0, ["full_power", "hold", "coast", "brake"]), (2000.0, ["full_power", "coast", "brake"])],
)
def test_the_optimum_without_recuperation_has_the_classical_phases(length_m, names):
    """Pontryagin's principle: on a level line with constant efficiency there are no others; short runs need no hold."""
    changes = {"line.sections": [{"length_m": length_m}], "timetable.travel_time_s": length_m / 15}
    run = solve(plain_scenario({"drive.recuperation_factor": 0.0, **changes}))
    assert [phase.phase for phase in run.phases] == names
    # the solver leaves some newtons; a table has two decimals of a kWh
    assert abs(run.phases[-2].energy_j) < 1e-3 * J_PER_KWH


def test_auxiliaries_are_not_in_phases():
    run = solve(plain_scenario({"vehicle.auxiliary_power_kw": 50.0}))
    assert run.energy.auxiliary_j == pytest.approx(50e3 * 150)
    net = sum(phase.energy_j for phase in run.phases) + run.energy.auxiliary_j
    assert net == pytest.approx(run.energy.net_j, rel=1e-9)
    assert abs(next(phase for phase in run.phases if phase.phase == "coast").energy_j) < 1e-3 * J_PER_KWH
