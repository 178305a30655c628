"""A bound of a longer time holds for every shorter one."""

from dataclasses import replace

import numpy as np
import pytest

from railjoule.core.bounds import find_bound, strongest_bounds
from railjoule.core.lower_bound import Bound
from railjoule.core.strategies import prepare_task
from tests.every_drive import train

NODES = np.array([0.0, 10.0, 20.0])


def bound(energy_j, time_s, position_m=NODES, slowest_ms=0.1):
    return Bound(energy_j, f"{energy_j} in {time_s}", time_s, 10.0, position_m, slowest_ms)


def test_the_greatest_of_longer_times_holds():
    bounds = [bound(50.0, 100.0), bound(44.0, 110.0), bound(47.0, 120.0), bound(30.0, 130.0), bound(31.0, 140.0)]
    assert [strongest.energy_j for strongest in strongest_bounds(bounds)] == [50.0, 47.0, 47.0, 31.0, 31.0]
    # in any order, and each says what it is of
    turned = strongest_bounds(bounds[::-1])
    assert [strongest.statement for strongest in turned[::-1]] == [b.statement for b in strongest_bounds(bounds)]
    assert turned[3].travel_time_s == 120.0


def test_bounds_of_other_runs_stay_apart():
    other_mesh = bound(90.0, 200.0, position_m=np.array([0.0, 5.0, 20.0]))
    not_so_slow = bound(80.0, 200.0, slowest_ms=np.array([0.0, 0.2, 0.0]))
    own = bound(50.0, 100.0, slowest_ms=np.array([0.0, 0.1, 0.0]))
    assert strongest_bounds([own, other_mesh, not_so_slow]) == [own, other_mesh, not_so_slow]
    assert strongest_bounds([]) == []


def test_a_bound_of_every_driving_holds_over_each_mesh_but_not_the_reverse():
    every, less = bound(60.0, 110.0, position_m=None), bound(40.0, 120.0, position_m=None)
    of_mesh = bound(50.0, 100.0)
    assert strongest_bounds([of_mesh, every, less]) == [every, every, less]
    of_mesh = bound(70.0, 110.0)
    assert strongest_bounds([of_mesh, every]) == [of_mesh, every]


@pytest.mark.parametrize("drive", ["copper loss", "loss polynomial"])
def test_bounds_of_real_timetables_do_not_rise_with_the_time(drive):
    task = prepare_task(train(drive, 15.0, **{"solver.mesh_m": 20.0}))
    proven = [
        find_bound(replace(task, running_time_s=share * task.shortest_time_s)) for share in (1.1, 1.3, 1.31, 1.6, 1.9)
    ]
    strongest = strongest_bounds(proven)
    assert np.all(np.diff([bound.energy_j for bound in strongest]) <= 0)
    assert all(new.energy_j >= old.energy_j for new, old in zip(strongest, proven, strict=True))
