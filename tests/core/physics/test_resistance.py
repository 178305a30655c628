"""Running resistance, gradients, curves and tunnels against numbers by hand."""

import numpy as np
import pytest
from builders import plain_scenario
from hypothesis import given
from hypothesis import strategies as st

from railjoule.core.compiled import njit
from railjoule.core.physics.resistance import (
    curve_force_n,
    gradient_force_n,
    resistance_coefficients,
    resistance_slope,
    running_resistance,
    total_weight_kn,
)

numbers = st.floats(0, 1e4)


def test_a_sum_by_hand():
    """1000 + 20 * 10 + 3 * 100 N, and its slope 20 + 2 * 3 * 10 N s/m."""
    assert running_resistance(1000.0, 20.0, 3.0, 10.0, 100.0) == 1500
    assert resistance_slope(20.0, 3.0, 10.0) == 80


@given(numbers, numbers, numbers, st.floats(0.1, 60))
def test_the_slope_against_differences(constant, linear, quadratic, speed):
    def resistance(v):
        return running_resistance(constant, linear, quadratic, v, v * v)

    step = 1e-3
    difference = (resistance(speed + step) - resistance(speed - step)) / (2 * step)
    assert resistance_slope(linear, quadratic, speed) == pytest.approx(difference, rel=1e-6, abs=1e-6)


def test_arrays_kernels_and_numbers_get_the_same_digits():
    @njit(error_model="numpy")
    def compiled(speed):
        return running_resistance(1234.5, 67.8, 9.1, speed, speed * speed)

    speeds = np.linspace(0.1, 40, 50)
    array = running_resistance(1234.5, 67.8, 9.1, speeds, speeds * speeds)
    assert array.tolist() == [compiled(v) for v in speeds.tolist()]


def test_forces_of_the_line_by_hand():
    """100 t weigh 981 kN: 20 per mille pull with 19.62 kN; a curve of 300 m with 700 m N/kN brakes with 2289 N."""
    vehicle = plain_scenario({"vehicle.resistance.curve_constant_m_n_per_kn": 700.0}).vehicle
    assert total_weight_kn(vehicle) == pytest.approx(981)
    assert gradient_force_n(vehicle, np.array([20.0, -20.0])) == pytest.approx([19620, -19620])
    assert curve_force_n(vehicle, np.array([1 / 300, 0.0])) == pytest.approx([2289, 0])


def test_coefficients_by_hand():
    """981 kN: 2 N/kN and 500 N; 0.1 N/kN/(km/h) and 10 N/(km/h); 0.001 N/kN/(km/h)2 and 0.2 N/(km/h)2."""
    resistance = {
        "constant_n_per_kn": 2.0,
        "constant_n": 500.0,
        "linear_n_per_kn_per_kmh": 0.1,
        "linear_n_per_kmh": 10.0,
        "quadratic_n_per_kn_per_kmh2": 0.001,
        "quadratic_n_per_kmh2": 0.2,
    }
    found = resistance_coefficients(plain_scenario({"vehicle.resistance": resistance}).vehicle)
    assert found == pytest.approx((2462.0, 108.1 * 3.6, 1.181 * 3.6**2))
