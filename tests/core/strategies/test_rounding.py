"""Minimum on/off times: rounding in time by hand, and `drive.least_switching_s` in whole runs."""

import numpy as np
import pytest
from builders import LOSS_POLYNOMIAL, plain_scenario
from every_drive import train
from hypothesis import given
from hypothesis import strategies as st

from railjoule.core import load_scenario
from railjoule.core.bounds import minimise
from railjoule.core.check import check_run
from railjoule.core.errors import ScenarioError
from railjoule.core.interior_point.duty import round_shares
from railjoule.core.motion import build_meshed_line
from railjoule.core.physics.mesh_data import BRAKE, DRIVE, OFF
from railjoule.core.physics.stretches import NOTHING, STOP, shortest_stretch_s
from railjoule.core.strategies import prepare_task, run_strategy
from railjoule.core.strategies.switching import best_switched

CELLS = 400


def shares(value):
    return np.full(CELLS, value)


def round_by_hand(driving, braking=None, least=2.0, duration=0.5, stands=()):
    n = len(driving)
    given = driving, np.zeros(n) if braking is None else braking, np.full(n, duration)
    return round_shares(*given, np.where(np.isin(np.arange(n), list(stands)), STOP, NOTHING), least)


def lengths(decision):
    return np.diff(np.concatenate([[0], np.flatnonzero(np.diff(decision)) + 1, [len(decision)]]))


@pytest.mark.parametrize(("share", "on", "off"), [(0.5, 4, 4), (0.25, 4, 12), (0.75, 12, 4)])
def test_a_share_is_kept_by_the_shortest_stretches_that_last(share, on, off):
    """2 s are four cells of half a second; d of on and 1 - d of off makes the longer one d / (1 - d) times as long."""
    # the first ones settle
    assert set(lengths(round_by_hand(shares(share)))[2:-1]) == {on, off}
    assert np.mean(round_by_hand(shares(share)) == DRIVE) == pytest.approx(share, abs=0.03)


def test_what_is_on_or_off_throughout_stays_so():
    driving = np.repeat([1.0, 0.0, 1.0], [40, 60, 50])
    assert np.array_equal(round_by_hand(driving) == DRIVE, driving == 1)


def test_without_a_minimum_time_the_way_driven_stays_within_half_a_cell_of_the_shares():
    """Sager, Bock, Diehl 2012: the bound of sum-up rounding."""
    driving = np.random.default_rng(3).uniform(0.03, 0.97, CELLS)
    assert np.abs(np.cumsum(driving) - np.cumsum(round_by_hand(driving, least=0.0) == DRIVE)).max() <= 0.5 + 1e-9


def test_driving_goes_over_to_braking_immediately():
    driving, braking = np.repeat([1.0, 0.0], [20, 20]), np.repeat([0.0, 1.0], [20, 20])
    assert np.array_equal(round_by_hand(driving, braking), np.repeat([DRIVE, BRAKE], [20, 20]))


def test_a_stop_frees_the_drive():
    """One cell before the stop the drive went off; behind it the drive is on immediately."""
    driving = np.repeat([1.0, 0.0, 1.0], [20, 1, 19])
    assert round_by_hand(driving)[21] == OFF
    assert round_by_hand(driving, stands=[21])[21] == DRIVE


@given(st.lists(st.floats(0, 1), min_size=2, max_size=60), st.floats(0.4, 5.0))
def test_every_stretch_lasts_to_the_nearest_cell(driving, least):
    decision = round_by_hand(np.array(driving), least=least)
    # what the run begins with was there before it, and what it ends with goes on
    assert all(0.5 * length + 0.25 >= least - 1e-9 for length in lengths(decision)[1:-1])


@pytest.mark.parametrize("strategy", ["optimal", "bellman"])
@pytest.mark.parametrize("drive", ["loss polynomial", "efficiency map", "induction", "synchronous"])
def test_runs_stay_on_or_off_long_enough(drive, strategy):
    """Over hills, where switching in any cell pays: the more often the less energy, and the checker agrees."""
    energies = []
    for least in (0.0, 2.0, 6.0):
        scenario = train(drive, 0.0, **{"timetable.travel_time_s": 120.0, "drive.least_switching_s": least})
        task = prepare_task(scenario)
        run = run_strategy(task, strategy)
        # the mesh may have been refined since
        mesh = build_meshed_line(scenario, *task.end_speeds_ms, run.nodes_m)
        assert shortest_stretch_s(mesh.data, run.node_speed_ms**2) >= least
        assert check_run(scenario, run).ok, check_run(scenario, run).verdict
        energies.append(run.energy.net_j)
    assert energies[0] <= min(energies) * (1 + 1e-4)
    assert energies[2] == pytest.approx(energies[0], rel=1e-2)


@pytest.mark.parametrize("mesh_m", [10.0, 5.0, 2.0])
def test_how_often_is_no_matter_of_the_mesh(mesh_m):
    """Switching in any cell follows the mesh; 2 s are 2 s on each."""
    changes = {"solver.mesh_m": mesh_m}
    task, at_will = (
        prepare_task(load_scenario("kharkiv-like-40kmh", changes | {"drive.least_switching_s": least}))
        for least in (2.0, 0.0)
    )
    relaxed = minimise(task).optimum
    run, free = best_switched(task, relaxed), best_switched(at_will, relaxed)
    assert shortest_stretch_s(task.mesh.data, run.speed2) >= 2.0
    assert shortest_stretch_s(task.mesh.data, free.speed2) < 2.0
    assert free.energy_j * (1 - 1e-4) <= run.energy_j < free.energy_j * (1 + 2e-3)


@pytest.mark.parametrize("auxiliary_kw", [0.0, 200.0])
def test_no_fastest_run_that_keeps_the_rule_is_cheaper(auxiliary_kw):
    """The fastest run drives for 22.6 s without a break: with coasting in between no stretch would last 20 s."""
    changes = {
        "vehicle.drive": {**LOSS_POLYNOMIAL, "least_switching_s": 20.0},
        "vehicle.traction.max_speed_kmh": 50.0,
        "vehicle.braking.max_effort_kn": 100.0,
        "vehicle.auxiliary_power_kw": auxiliary_kw,
        "line.sections": [{"length_m": 300.0}],
        "timetable.travel_time_s": 38.0,
    }
    task = prepare_task(plain_scenario(changes))
    fastest, best = run_strategy(task, "fastest"), run_strategy(task, "optimal")
    assert shortest_stretch_s(task.mesh.data, fastest.node_speed_ms**2) >= 20.0
    assert shortest_stretch_s(task.mesh.data, best.node_speed_ms**2) >= 20.0
    assert best.energy.net_j <= fastest.energy.net_j * (1 + 1e-9)
    assert check_run(best.scenario, best).ok


def test_a_run_that_no_switching_suits_has_a_note():
    """A minute on or off at least: no start over 300 m is that long."""
    changes = {"timetable.travel_time_s": 45.0, "line.sections": [{"length_m": 300.0}], "drive.least_switching_s": 60.0}
    for strategy in ("optimal", "bellman"):
        run = run_strategy(prepare_task(train("induction", 0.0, **changes)), strategy)
        assert "no run was found" in run.notes[-1].lower()
        assert "minimum on/off time of 60 s" in run.notes[-1]


def test_a_time_below_nothing_is_refused():
    with pytest.raises(ScenarioError, match=r"drive\.least_switching_s = -1 must be at least 0"):
        train("induction", 0.0, **{"drive.least_switching_s": -1.0})
