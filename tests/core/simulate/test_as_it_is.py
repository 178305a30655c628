import numpy as np
import pytest

from railjoule.core import load_scenario
from railjoule.core.motion import build_course
from railjoule.core.simulate.as_it_is import as_it_is
from railjoule.core.simulate.following import simulate_following


def courses(**disturbance):
    scenario = load_scenario("liashenko-i").with_(**{f"disturbance.{key}": it for key, it in disturbance.items()})
    return build_course(scenario).data, build_course(as_it_is(scenario)).data


def test_nothing_disturbed_nothing_changed():
    scenario = load_scenario("liashenko-i")
    assert as_it_is(scenario) == scenario


def test_resistance_changes_by_its_factor_alone():
    plan, real = courses(resistance_factor=1.3)
    assert real.resistance_constant_n == pytest.approx(1.3 * plan.resistance_constant_n)
    assert real.resistance_quadratic == pytest.approx(1.3 * plan.resistance_quadratic)
    assert np.array_equal(real.line_force_n, plan.line_force_n)


def test_a_lower_voltage_takes_power_and_leaves_the_effort_at_low_speed():
    plan, real = courses(line_voltage_factor=0.8)
    assert real.traction.effort_n(1.0) == plan.traction.effort_n(1.0)
    assert real.traction.effort_n(20.0) == pytest.approx(0.8 * plan.traction.effort_n(20.0))


def test_a_curve_of_effort_is_pressed_together_along_the_speed():
    curve = [[0.0, 200.0], [30.0, 200.0], [60.0, 100.0], [80.0, 60.0]]
    scenario = load_scenario("liashenko-i").with_(
        **{"vehicle.traction.curve": curve, "disturbance.line_voltage_factor": 0.5}
    )
    assert as_it_is(scenario).vehicle.traction.curve == ((0.0, 200.0), (15.0, 200.0), (30.0, 100.0), (40.0, 60.0))


def test_head_wind_costs_energy_and_less_voltage_costs_time():
    scenario = load_scenario("liashenko-ii")
    windy = simulate_following(scenario.with_(**{"disturbance.resistance_factor": 1.2}))
    assert windy.overconsumption > 0.005
    tight = scenario.with_(**{"timetable.travel_time_s": 100.0, "disturbance.line_voltage_factor": 0.5})
    assert simulate_following(tight).delay_s > 0.5
    late = simulate_following(scenario.with_(**{"disturbance.departure_delay_s": 12.0}))
    assert late.delay_s == pytest.approx(12.0, abs=1e-6)
    assert late.overconsumption == pytest.approx(0, abs=1e-9)


def test_kinds_of_cars_and_a_synchronous_drive_are_disturbed_as_well():
    kinds = [{"cars": 3, "constant_n_per_kn": 1.2}, {"cars": 2, "constant_n_per_kn": 0.8}]
    scenario = load_scenario("kharkiv-like-40kmh").with_(
        **{
            "vehicle.resistance.car_kinds": kinds,
            "disturbance.resistance_factor": 1.5,
            "disturbance.line_voltage_factor": 0.9,
        }
    )
    real = as_it_is(scenario).vehicle
    assert real.drive.link_voltage_v == pytest.approx(0.9 * scenario.vehicle.drive.link_voltage_v)
    wanted = 1.5 * scenario.vehicle.specific_resistance.constant_n_per_kn
    assert real.specific_resistance.constant_n_per_kn == pytest.approx(wanted)
