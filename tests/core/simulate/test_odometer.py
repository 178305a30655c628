"""By hand: a way of 1000 m, D1 300 m, D2 180 m and D3 15 m before the stop."""

import numpy as np
import pytest

from railjoule.core.scenario.options import SimulationOptions
from railjoule.core.simulate.odometer import estimated_positions, stopping_position, stretches


def test_sensors_set_the_place_right():
    way = stretches(0.0, 1000.0, 20.0, SimulationOptions())
    places, scale = estimated_positions(way, np.array([0.0, 600.0, 700.0, 900.0, 1000.0]))
    assert places == pytest.approx([20.0, 620.0, 700.0, 900.0, 1000.0])
    assert scale == pytest.approx(1.0)
    assert stopping_position(way, 1000.0) == pytest.approx(1000.0)


def test_the_calibration_takes_away_an_error_of_speed():
    way = stretches(0.0, 1000.0, 0.0, SimulationOptions(speed_error=0.02))
    places, scale = estimated_positions(way, np.array([600.0, 800.0, 900.0]))
    # at D2, 820 m, its estimate is 700 + 120 * 1.02 m; from there on it measures rightly
    assert places == pytest.approx([612.0, 802.0, 822.4 + 80.0])
    assert scale == pytest.approx([1.02, 1.02, 1.0])


def test_a_stop_sensor_out_of_place_moves_the_stop():
    way = stretches(0.0, 1000.0, 0.0, SimulationOptions(sensor_errors_m=(0.0, 0.0, 0.4)))
    assert stopping_position(way, 1000.0) == pytest.approx(1000.4)


def test_without_target_braking_the_error_stays():
    way = stretches(0.0, 1000.0, 20.0, SimulationOptions(target_braking=False))
    assert stopping_position(way, 1000.0) == pytest.approx(980.0)
