"""What holds for an energy-optimal run whatever the numbers are; golden energies are in ../interior_point."""

from importlib import import_module

import numpy as np
import pytest
from builders import COPPER_LOSS, HILLS, plain_scenario
from hard_scenarios import WEAK_BRAKES
from hypothesis import given
from hypothesis import strategies as st
from random_scenarios import random_run

from railjoule.core import SolverError, check_run, load_scenario, solve
from railjoule.core.bounds import minimise, work_floor_j
from railjoule.core.bounds.minimum import TOLERANCE
from railjoule.core.scenario import scenario_from_document
from railjoule.core.strategies import prepare_task, run_strategy
from railjoule.core.strategies.optimal import optimal
from railjoule.core.units import J_PER_KWH
from tests.any_scenarios import any_time, any_wide_document
from tests.check_many import timed_task

SAME = 1e-6
"""Each of two optima is within 1e-7 of the best; the rest is for rounding and what limits may be violated by."""
shares = st.floats(0, 1)
drives = st.sampled_from([{}, {"vehicle.drive": COPPER_LOSS}])
EVERYTHING = {
    "vehicle.auxiliary_power_kw": 30.0,
    "vehicle.braking.friction_effort_kn": 30.0,
    "vehicle.braking.max_power_kw": 300.0,
    "vehicle.traction.curve": [[0, 100], [30, 95], [60, 55], [100, 30]],
    "vehicle.traction.max_acceleration_ms2": 0.6,
    "vehicle.braking.max_deceleration_ms2": 0.5,
    "line.sections": HILLS,
    "line.speed_limits": [{"from_m": 1500.0, "to_m": 1800.0, "limit_kmh": 40.0}],
    "line.stations": [{"position_m": 700.0, "dwell_s": 30.0}],
    "timetable.travel_time_s": 320.0,
}


def energy(task):
    """Return over a task's mesh the least energy [J], and what an equality of it may be off by."""
    data, least = task.mesh.data, minimise(task).energy_j
    return least, SAME * max(abs(least), data.half_inertia_kg * (task.mesh.length_m / task.running_time_s) ** 2)


def net(changes):
    return solve(plain_scenario(changes)).energy.net_j


def test_closed_form_without_resistance():
    """To 10 m/s at 1 m/s2, 850 m at that speed, down at 0.5 m/s2: no run of 115 s has a lower greatest speed."""
    run = solve(
        plain_scenario(
            {
                "vehicle.rotating_mass_factor": 0.0,
                "vehicle.resistance": {},
                "vehicle.traction": {"max_effort_kn": 100.0, "max_speed_kmh": 100.0},
                "vehicle.braking.max_effort_kn": 50.0,
                "drive.recuperation_factor": 0.0,
                "line.sections": [{"length_m": 50.0}, {"length_m": 850.0}, {"length_m": 100.0}],
                "timetable.travel_time_s": 115.0,
            }
        )
    )
    assert run.energy.net_j == pytest.approx(0.5 * 100e3 * 10**2 / 0.85, rel=SAME)
    assert run.max_speed_kmh == pytest.approx(36, rel=1e-4)


@given(shares, shares, drives, st.floats(140, 250))
def test_more_recuperation_never_costs_more(one, other, drive, time):
    changes = {**drive, "line.sections": HILLS, "timetable.travel_time_s": time}
    low, high = (plain_scenario({**changes, "drive.recuperation_factor": share}) for share in sorted((one, other)))
    (more, allowed), (less, _) = energy(prepare_task(low)), energy(prepare_task(high))
    assert less <= more + allowed


WEAK_BRAKE = {"vehicle.braking.max_effort_kn": 20.0}


@pytest.mark.parametrize(
    ("without", "limit"),
    [
        ({}, {"vehicle.traction.max_effort_kn": 60.0}),
        ({}, {"vehicle.traction.max_power_kw": 500.0}),
        ({}, {"vehicle.traction.curve": [[0, 100], [30, 50], [100, 30]]}),
        ({}, {"vehicle.traction.max_acceleration_ms2": 0.5}),
        ({}, {"vehicle.braking.max_power_kw": 300.0}),
        ({}, {"vehicle.braking.max_deceleration_ms2": 0.3}),
        ({"vehicle.braking.friction_effort_kn": 60.0, **WEAK_BRAKE}, WEAK_BRAKE),
        ({}, {"line.speed_limits": [{"from_m": 900.0, "to_m": 1200.0, "limit_kmh": 45.0}]}),
        ({}, {"line.stations": [{"position_m": 1000.0}]}),
    ],
    ids=["effort", "power", "curve", "acceleration", "braking power", "deceleration", "no friction", "speed", "stop"],
)
def test_a_limit_that_binds_costs_energy(without, limit):
    hills = {"line.sections": HILLS, "timetable.travel_time_s": 200.0}
    assert net({**hills, **limit}) > net({**hills, **without}) * (1 + 10 * SAME)


@given(st.floats(20, 60))
def test_an_average_speed_is_a_travel_time(speed_kmh):
    by_speed = {"timetable.travel_time_s": None, "timetable.average_speed_kmh": speed_kmh}
    assert net(by_speed) == pytest.approx(net({"timetable.travel_time_s": 2000 / (speed_kmh / 3.6)}), rel=SAME)


def test_iterations_price_and_bound_come_with_the_run():
    """Over 5 m the least energy is 2.2239 kWh; over a mesh that is cut where the regime changes, 2.2230."""
    task = prepare_task(load_scenario("liashenko-ii"))
    run = optimal(task)
    assert run.iterations > 0
    assert run.price_of_time_w > 0
    assert run.energy_kwh == pytest.approx(2.22303, rel=1e-5)
    assert minimise(task).energy_j / J_PER_KWH == pytest.approx(2.22390, rel=1e-5)
    assert run.gap >= 0
    assert run.is_proven
    proven = np.floor(run.lower_bound_kwh * 1e4) / 1e4
    assert run.bound.statement == (
        f"No way of driving this train over this line within 133.7 s uses less than {proven:.4f} kWh."
    )
    costate = run.bound.costate
    assert costate.position_m.shape == costate.force_price.shape
    assert np.all(np.diff(costate.position_m) >= 0)
    assert costate.position_m[[0, -1]].tolist() == run.position_m[[0, -1]].tolist()


def test_a_coarser_tolerance_takes_fewer_iterations():
    task = prepare_task(load_scenario("liashenko-iii"))
    assert minimise(task, 1e-4).iterations < minimise(task, TOLERANCE).iterations


def test_an_accuracy_that_rounding_does_not_allow_is_an_error():
    with pytest.raises(SolverError, match=r"^the optimum was not found within \d+ iterations\.$"):
        minimise(prepare_task(load_scenario("liashenko-iii")), 1e-30)


@pytest.mark.parametrize("seed", range(6))
def test_no_run_needs_less_than_the_work_at_its_wheels(seed):
    task = random_run(seed, stops=bool(seed % 2)).task
    best = optimal(task)
    assert work_floor_j(task) <= best.bound.energy_j <= best.energy.net_j


def test_the_work_at_the_wheels_by_hand():
    """1000 m at 2 N/kN of 40 t, 5 per mille uphill, from rest to rest, without auxiliaries."""
    task = prepare_task(
        plain_scenario(
            {
                "vehicle.tare_kg": 40e3,
                "vehicle.resistance": {"constant_n_per_kn": 2.0},
                "line.sections": [{"length_m": 1000.0, "gradient_permille": 5.0}],
            }
        )
    )
    assert work_floor_j(task) == pytest.approx(40e3 * 9.81 * (0.002 + 0.005) * 1000.0)


def test_a_barrier_that_falls_slowly_still_ends():
    """Nothing needs energy: the first two attempts end after 40 and 60 iterations, before the gap does."""
    run = solve(scenario_from_document(WEAK_BRAKES), check=True)
    assert run.energy_kwh == pytest.approx(0.0, abs=1e-6)
    assert run.iterations > 100


@pytest.fixture
def failing(monkeypatch):
    """Let the interior point fail."""

    def fails(*_):
        raise SolverError("the optimum was not found within 250 iterations.")

    monkeypatch.setattr(import_module("railjoule.core.continuous_bound.refinement"), "minimise", fails)


@pytest.mark.usefixtures("failing")
def test_where_the_interior_point_fails_dynamic_programming_drives():
    task = prepare_task(plain_scenario({"line.sections": HILLS}))
    run, other = optimal(task), run_strategy(task, "bellman")
    assert (run.strategy, run.bound, run.energy_kwh) == ("optimal", None, other.energy_kwh)
    assert run.notes[0] == (
        "The interior-point method failed: the optimum was not found within 250 iterations. This is the best run of "
        "dynamic programming, without a bound."
    )
    assert not run.reference.proven


@pytest.mark.usefixtures("failing")
def test_where_both_fail_the_first_failure_is_told(monkeypatch):
    def fails(_):
        raise SolverError("no run")

    monkeypatch.setattr(import_module("railjoule.core.strategies.optimal"), "bellman", fails)
    with pytest.raises(SolverError, match="the optimum was not found within 250 iterations"):
        optimal(prepare_task(plain_scenario()))


@pytest.mark.parametrize("steps", [[[0, 0.35]], [[0, 0.4], [30, 0.25]], [[0, 0.25], [30, 0.4]]])
def test_a_braking_curve_is_kept_and_the_optimum_proven(steps):
    curve = {"vehicle.braking.permitted_deceleration": steps, "timetable.travel_time_s": 270.0}
    task = prepare_task(plain_scenario(EVERYTHING | curve))
    run = run_strategy(task, "optimal")
    assert run.gap >= 0
    assert run.is_proven
    assert check_run(run.scenario, run).ok
    assert (run.speed_ms <= run.permitted_speed_ms * (1 + 1e-7)).all()
    # it binds: without it the same time takes less
    free = minimise(prepare_task(plain_scenario(EVERYTHING | {"timetable.travel_time_s": 270.0})))
    assert free.energy_j < minimise(task).energy_j


@pytest.mark.parametrize(("seed", "strategy"), [(878, "phases"), (1158, "bellman")])
def test_on_a_coarse_mesh_no_other_strategy_needs_less(seed, strategy):
    """Of `tests.check_many`: 14 cells, too coarse to switch a drive on, cost 7.4 %, and a local optimum 6.6 %."""
    task = timed_task(any_wide_document(seed), any_time(seed), seed)
    found, other = run_strategy(task, "optimal"), run_strategy(task, strategy)
    assert found.energy.net_j <= other.energy.net_j * (1 + 1e-3)
    assert found.notes[0].startswith("This is the run of ")
    assert found.bound.covers(found)
    assert check_run(task.scenario, found).ok
