"""The energy-optimal run of a drive whose power jumps at zero effort, its relaxation and its bound."""

import math

import pytest
from builders import COPPER_LOSS, INDUCTION, plain_scenario
from every_drive import train

from railjoule.core import load_scenario
from railjoule.core.bounds import certify, minimise
from railjoule.core.strategies import prepare_task, run_strategy
from railjoule.core.strategies.optimal import optimal
from railjoule.core.strategies.switching import best_switched, is_measured
from railjoule.core.units import J_PER_KWH

TRAM = {
    "vehicle": {
        "name": "tram of the findings",
        "tare_kg": 22e3,
        "rotating_mass_factor": 0.1529,
        "resistance": {"constant_n": 1427.6, "quadratic_n_per_kmh2": 7.189 / 3.6**2},
        "traction": {"max_speed_kmh": 72.0},
        "braking": {},
        "drive": INDUCTION,
    },
    "solver.mesh_m": 5.0,
}
RUNS = [((950, 95), 0.0), ((950, 95), 1.0), ((650, 56.108), 0.0), ((650, 56.108), 1.0)]


def tram(way=(950, 95), recuperation=0.0, **changes):
    """Return the tram of the findings over a flat line, unless `changes` say otherwise."""
    plain = {
        **TRAM,
        "drive.recuperation_factor": recuperation,
        "line.sections": [{"length_m": float(way[0])}],
        "timetable.travel_time_s": float(way[1]),
    }
    return plain_scenario(plain | {key.replace("__", "."): value for key, value in changes.items()})


@pytest.fixture(scope="module", params=RUNS, ids=str)
def run(request):
    """A task, its best run and the optimum with free switching [kWh]."""
    task = prepare_task(tram(*request.param))
    return request.param, task, optimal(task), relaxed_kwh(task)


def relaxed_kwh(task):
    return minimise(task).energy_j / J_PER_KWH


def test_free_switching_is_that_of_the_findings(run):
    """Findings on Rawicki, relaxed: two other solvers agree."""
    given, _, _, relaxed = run
    found = dict(zip(RUNS, (0.9943, 0.8264, 1.3243, 0.8572), strict=True))[given]
    assert relaxed == pytest.approx(found, rel=3e-4)


def test_without_switching_it_is_no_worse_than_the_findings(run):
    """Their runs without switching are local optima of a smoothed power; one start, then coasting, needs less."""
    given, _, best, relaxed = run
    found = dict(zip(RUNS, (0.9963, 0.8309, 1.3250, 0.8587), strict=True))[given]
    assert relaxed * (1 - 1e-4) < best.energy_kwh < found
    assert best.energy_kwh == pytest.approx(relaxed, rel=1e-3)
    assert abs(best.energy.imbalance) < 1e-7
    assert best.travel_time_s <= given[0][1] * (1 + 1e-8)


def test_statement_and_note_say_what_is_bounded():
    task = prepare_task(tram())
    best = optimal(task)
    assert best.bound.statement == (
        "No way of driving this train over this line within 95.0 s uses less than "
        f"{math.floor(best.lower_bound_kwh * 1e4) / 1e4:.4f} kWh; this assumes that between the points of a table of "
        "its power, the machines' power curves at most 1.5 times as much as at these points."
    )
    # rounded up, so that it is not less than what the relaxed optimum leaves
    saved_percent = math.ceil(1e4 * (1 - relaxed_kwh(task) / best.energy_kwh)) / 100
    assert best.notes == (
        "The drive stays on or off for at least 2 s, to the nearest cell, but between driving and braking; this is the "
        "best such run found, not proven; "
        f"switching freely within the cells of this mesh would save at most about {saved_percent:.2f} %; the "
        "vehicle has no friction brakes to support the electric ones.",
    )


HILLS = [
    {"length_m": 300.0},
    {"length_m": 250.0, "gradient_permille": 25.0},
    {"length_m": 300.0, "gradient_permille": -20.0, "speed_limit_kmh": 45.0},
    {"length_m": 250.0, "gradient_permille": 5.0},
]


@pytest.mark.parametrize("multiplier", [0.5, 1.5])
def test_a_bound_from_bad_multipliers_holds(multiplier):
    task = prepare_task(tram(recuperation=1.0))
    optimum = minimise(task).optimum
    bad = optimum._replace(price_of_time_w=multiplier * optimum.price_of_time_w)
    assert certify(task, bad).energy_j < certify(task, optimum).energy_j


def test_a_decision_that_no_run_can_follow_is_mended():
    """At 1.5 s more than its timetable one decision leaves out a cell that a limit needs, and 1 % is lost there."""
    asked = load_scenario("kharkiv-like-40kmh").travel_time_s + 1.5
    changes = {"timetable.travel_time_s": asked, "drive.least_switching_s": 0.0}
    task = prepare_task(load_scenario("kharkiv-like-40kmh", changes))
    assert optimal(task).energy.net_j < minimise(task).energy_j * (1 + 1e-3)


def test_driving_by_turns_comes_near_free_switching():
    """On random trams the median is 0.03 % above it; driving each stretch in one go cost 1 %."""
    task = prepare_task(tram(recuperation=1.0, line__sections=HILLS, timetable__travel_time_s=130.0))
    assert optimal(task).energy.net_j / J_PER_KWH == pytest.approx(relaxed_kwh(task), rel=1e-3)


def test_only_drives_that_idle_are_switched():
    assert prepare_task(tram()).mesh.drive.has_idle_losses
    assert not prepare_task(plain_scenario({"vehicle.drive": COPPER_LOSS})).mesh.drive.has_idle_losses


def test_the_shipped_tram_is_near_the_findings():
    """Another tram, identified with other weights: findings; their 0.8309 without switching is no optimum."""
    for name, switched in (("tram-950m", 0.9943), ("tram-950m-recuperating", 0.8264)):
        task = prepare_task(load_scenario(name))
        assert relaxed_kwh(task) == pytest.approx(switched, rel=3e-3)
        energy = best_switched(task, minimise(task).optimum).energy_j
        assert energy / J_PER_KWH == pytest.approx(switched, rel=3e-3)


@pytest.mark.parametrize("time_s", [90.0, 120.0])
@pytest.mark.parametrize("friction_kn", [0.0, 15.0])
@pytest.mark.parametrize("drive", ["loss polynomial", "efficiency map", "induction", "synchronous"])
def test_no_run_of_dynamic_programming_is_cheaper(drive, friction_kn, time_s):
    """Up and down hill: braking that generates nothing, and limits that no rounding knows, cost up to 1 % before."""
    task = prepare_task(train(drive, friction_kn, **{"timetable.travel_time_s": time_s}))
    best = optimal(task)
    # over the same nodes: the account of a coarser mesh may be too low
    other = run_strategy(prepare_task(task.scenario, position_m=best.nodes_m), "bellman")
    assert best.energy.net_j <= other.energy.net_j * (1 + 1e-4)


def test_a_relaxed_optimum_above_a_run_is_no_measure():
    """Of a local optimum of the relaxation, 0.3 % too high, a run was called good enough that was as expensive."""
    task = prepare_task(tram())
    optimum = minimise(task).optimum
    found = best_switched(task, optimum).energy_j
    assert is_measured(task, optimum, found)
    assert not is_measured(task, optimum._replace(energy_j=1.003 * optimum.energy_j), found)


def test_dynamic_programming_helps_where_the_relaxation_is_of_no_use():
    """One that has not converged, of another timetable, ends in a run as good as Bellman's."""
    task = prepare_task(train("loss polynomial", 15.0, **{"timetable.travel_time_s": 90.0}))
    other = prepare_task(train("loss polynomial", 15.0, **{"timetable.travel_time_s": 140.0}))
    found = best_switched(task, minimise(other).optimum._replace(status=1))
    assert found.energy_j <= run_strategy(task, "bellman").energy.net_j * (1 + 1e-4)
