"""Masses of a vehicle."""

import pytest
from builders import plain_scenario
from hypothesis import given
from hypothesis import strategies as st

from railjoule.core import ScenarioError

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


def test_kinds_of_cars_weigh_in_by_their_number():
    """By hand: 1.0 for all, 2.0 more for three of five, 0.5 more for two of five."""
    kinds = [
        {"cars": 3, "constant_n_per_kn": 2.0},
        {"cars": 2, "constant_n_per_kn": 0.5, "linear_n_per_kn_per_kmh": 0.1},
    ]
    vehicle = plain_scenario(
        {
            "vehicle.length_m": 100.0,
            "vehicle.car_count": 5,
            "vehicle.resistance": {"constant_n_per_kn": 1.0, "car_kinds": kinds},
        }
    ).vehicle
    assert vehicle.specific_resistance.constant_n_per_kn == pytest.approx(2.4)
    assert vehicle.specific_resistance.linear_n_per_kn_per_kmh == pytest.approx(0.04)


@pytest.mark.parametrize(("count", "words"), [(4, "car_count is 4"), (None, "car_count is not given")])
def test_kinds_of_cars_must_make_the_train(count, words):
    with pytest.raises(ScenarioError, match=f"car_kinds have 5 cars, but {words}"):
        plain_scenario(
            {
                "vehicle.length_m": 100.0,
                "vehicle.car_count": count,
                "vehicle.resistance": {"car_kinds": [{"cars": 5, "constant_n_per_kn": 2.0}]},
            }
        )


def test_a_crush_load_is_possible_up_to_what_the_vehicle_names():
    crowded = {"vehicle.crush_load_factor": 1.25, "vehicle.load_factor": 1.2}
    assert plain_scenario(crowded).vehicle.load_mass_kg == pytest.approx(1.2 * 400 * 75)
    with pytest.raises(
        ScenarioError, match=r"vehicle.load_factor = 1.3 must be at most 1.25, the crush_load_factor\.$"
    ):
        plain_scenario({**crowded, "vehicle.load_factor": 1.3})
    with pytest.raises(ScenarioError, match=r"vehicle.crush_load_factor = 0.9 must be at least 1\.$"):
        plain_scenario({"vehicle.crush_load_factor": 0.9})


def test_the_real_load_may_be_a_crush_load_too():
    real = {"disturbance.actual_load_factor": 1.2}
    assert plain_scenario({"vehicle.crush_load_factor": 1.2, **real}).disturbance.actual_load_factor == 1.2
    sentence = r"disturbance.actual_load_factor = 1.2 must be at most 1, the vehicle.crush_load_factor\.$"
    with pytest.raises(ScenarioError, match=sentence):
        plain_scenario(real)
