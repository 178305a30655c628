"""Masses of a vehicle."""

import pytest
from builders import plain_scenario
from hypothesis import given
from hypothesis import strategies as st

shares = st.floats(0, 1)


@given(shares)
def test_mass_by_rotating_share(load_factor):
    vehicle = plain_scenario({"vehicle.load_factor": load_factor}).vehicle
    assert vehicle.load_mass_kg == pytest.approx(load_factor * 400 * 75)
    assert vehicle.total_mass_kg == pytest.approx(100e3 + load_factor * 30e3)
    assert vehicle.total_inertia_kg == pytest.approx(1.1 * vehicle.total_mass_kg)


@given(shares)
def test_passengers_do_not_turn(load_factor):
    vehicle = plain_scenario({"vehicle.inertial_mass_kg": 120e3, "vehicle.load_factor": load_factor}).vehicle
    assert vehicle.total_inertia_kg == pytest.approx(120e3 + load_factor * 30e3)
