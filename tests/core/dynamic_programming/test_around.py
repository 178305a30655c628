"""Runs that bracket a timetable in a band of speeds, and their hybrids."""

import numpy as np
import pytest
from every_drive import train

from railjoule.core import SolverError
from railjoule.core.bounds import minimise
from railjoule.core.dynamic_programming.around import runs_around
from railjoule.core.motion import running_time
from railjoule.core.physics.account import run_energy
from railjoule.core.strategies import prepare_task


@pytest.fixture(scope="module")
def task():
    return prepare_task(train("loss polynomial", 15.0, **{"timetable.travel_time_s": 100.0}))


def given(task):
    return task.course.data, task.greatest_speed2, task.running_time_s


def total_j(task, speed2):
    data = task.course.data
    return run_energy(data, speed2) + data.auxiliary_power_w * running_time(data.cell_length_m, speed2)


def test_the_runs_bracket_the_timetable_and_their_mean_meets_it(task):
    data, optimum = task.course.data, minimise(task).optimum
    price = optimum.price_of_time_w + data.auxiliary_power_w
    found = runs_around(*given(task), optimum.speed2, price, 2.0, 41)
    times = [running_time(data.cell_length_m, run) for run in found.others]
    assert min(times) <= task.running_time_s * (1 + 1e-4)
    assert max(times) >= task.running_time_s * (1 - 1e-4)
    assert running_time(data.cell_length_m, found.meeting) == pytest.approx(task.running_time_s, abs=2e-6)
    assert found.price_w == pytest.approx(price, rel=0.25)
    assert total_j(task, found.meeting) == pytest.approx(optimum.energy_j, rel=0.02)


def test_a_band_without_a_run_says_so(task):
    """No train goes from the greatest speed to a crawl and back from node to node."""
    by_turns = np.where(np.arange(len(task.greatest_speed2)) % 2 == 0, task.greatest_speed2, 0.5)
    with pytest.raises(SolverError, match="no run"):
        runs_around(*given(task), by_turns, 1e4, 0.01, 5)


def test_what_promises_most_comes_first(task):
    """What a run lacks of the time, or has too much of it, counts at the price of time."""
    data, optimum = task.course.data, minimise(task).optimum
    price = optimum.price_of_time_w + data.auxiliary_power_w
    found = runs_around(*given(task), optimum.speed2, price, 2.0, 25)
    late_s = [running_time(data.cell_length_m, run) - task.running_time_s for run in found.others]
    saved_w = found.price_w - data.auxiliary_power_w
    promised = [total_j(task, run) + saved_w * late for run, late in zip(found.others, late_s, strict=True)]
    assert len(promised) >= 2
    assert promised == sorted(promised)
