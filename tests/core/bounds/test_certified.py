"""Which runs a bound covers, and what becomes of a run that none covers."""

from dataclasses import replace

import numpy as np
import pytest
from builders import COPPER_LOSS, HILLS, plain_scenario

from railjoule.core import SolverError
from railjoule.core.bounds import bound_of, bounded, certified, certify, minimise
from railjoule.core.strategies import prepare_task, run_strategy
from railjoule.core.trajectory import make_trajectory

CHANGES = {
    "line.sections": HILLS,
    "vehicle.drive": COPPER_LOSS,
    "timetable.travel_time_s": 220.0,
    "vehicle.auxiliary_power_kw": 40.0,
    "line.stations": [{"position_m": 900.0, "dwell_s": 25.0}],
}


@pytest.fixture(scope="module")
def task():
    return prepare_task(plain_scenario(CHANGES))


def test_the_optimum_and_its_bound_are_in_si_with_dwells(task):
    solution = minimise(task)
    run = make_trajectory(task.scenario, task.course, "any", solution.optimum.speed2)
    # to the gap that was asked for: a barrier leaves a little of both efforts everywhere
    assert solution.energy_j == pytest.approx(run.energy.net_j, rel=1e-7)
    assert solution.optimum.energy_j == pytest.approx(run.energy.net_j - 25 * 40e3, rel=1e-7)
    assert solution.optimum.traction_n.max() == pytest.approx(run.tractive_effort_n.max(), rel=1e-6)
    bound = certify(task, solution.optimum)
    assert bound.energy_j == pytest.approx(solution.energy_j, rel=1e-6)
    assert bound.travel_time_s == task.travel_time_s
    assert bound.position_m is task.course.position_m


def test_the_price_of_time_is_what_a_second_saves(task):
    later = replace(task, running_time_s=task.running_time_s + 0.1)
    saved = minimise(task, 1e-9).energy_j - minimise(later, 1e-9).energy_j
    assert minimise(task).optimum.price_of_time_w == pytest.approx(10 * saved, rel=2e-3)


def test_a_known_bound_is_taken_where_it_covers(task):
    known = bound_of(task)
    assert bounded(task, run_strategy(task, "fastest"), known).bound is known
    other = replace(known, position_m=known.position_m[1:])
    assert bounded(task, run_strategy(task, "fastest"), other).bound.energy_j == pytest.approx(known.energy_j)


def test_a_run_keeps_its_own_bound(task):
    run = run_strategy(task, "optimal")
    assert bounded(task, run, bound_of(task)) is run


def test_a_late_run_gets_the_bound_of_its_own_time(task):
    slower = 0.9**2 * task.greatest_speed2
    late = replace(task, running_time_s=0.95 * task.shortest_time_s / 0.9)
    run = make_trajectory(task.scenario, task.course, "any", slower)
    bound = bounded(late, run, None).bound
    assert bound.travel_time_s == pytest.approx(run.travel_time_s)
    assert bound.energy_j <= run.energy.net_j


def test_there_is_no_bound_without_slack_or_without_an_optimum(task, monkeypatch):
    assert bound_of(replace(task, running_time_s=task.shortest_time_s)) is None

    def fails(*_):
        raise SolverError("the optimum was not found within 100 iterations.")

    monkeypatch.setattr(certified, "minimise", fails)
    assert bound_of(task) is None
    assert bounded(task, run_strategy(task, "fastest")).bound is None


def test_over_finer_nodes_the_bound_is_its_own(task):
    """Halved cells: another mesh, a bound of its own, which a run over the coarse mesh may not have."""
    coarse = task.course.position_m
    nodes = np.union1d(coarse, 0.5 * (coarse[1:] + coarse[:-1]))
    fine = prepare_task(task.scenario, position_m=nodes)
    run = bounded(task, make_trajectory(fine.scenario, fine.course, "any", fine.greatest_speed2), bound_of(task))
    assert np.array_equal(run.bound.position_m, nodes)
    assert run.bound.energy_j == pytest.approx(bound_of(fine).energy_j, rel=1e-12)


def test_over_very_many_more_nodes_a_run_stays_without_a_bound(task):
    """As the printed regulator's, which makes a cell of each step of time."""
    coarse = task.course.position_m
    shares = np.arange(certified.MOST_REFINED + 1) / (certified.MOST_REFINED + 1)
    nodes = np.append((coarse[:-1, None] + np.diff(coarse)[:, None] * shares).ravel(), coarse[-1])
    fine = prepare_task(task.scenario, position_m=nodes)
    run = make_trajectory(fine.scenario, fine.course, "any", fine.greatest_speed2)
    assert bounded(task, run, bound_of(task)).bound is None
    assert bounded(fine, run).bound is not None
