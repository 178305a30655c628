from types import SimpleNamespace

import numpy as np
import pytest

from railjoule.dashboard.charts.quantities import EFFORT, MOTOR_CURRENT, SPEED, at_nodes, read


def test_each_node_has_the_value_of_the_cell_before_it() -> None:
    assert list(at_nodes(np.array([3.0, 5.0]))) == [3.0, 3.0, 5.0]
    run = SimpleNamespace(effort_n=np.array([2e3, -1e3]), time_s=np.zeros(3))
    assert list(EFFORT.values(run)) == [2.0, 2.0, -1.0]


def test_what_a_run_does_not_know_is_zero_in_each_node() -> None:
    assert list(MOTOR_CURRENT.values(SimpleNamespace(current_a=None, time_s=np.zeros(3)))) == [0.0] * 3


def test_values_are_in_the_unit_that_is_told() -> None:
    # 10 m/s are 36 km/h
    assert SPEED.values(SimpleNamespace(speed_ms=np.array([0.0, 10.0]))) == pytest.approx([0.0, 36.0])


def test_a_limit_that_never_changes_counts_at_all_times() -> None:
    run = SimpleNamespace(voltage_limit_v=400.0, time_s=np.zeros(3))
    assert list(read("voltage_limit_v")(run)) == [400.0] * 3
