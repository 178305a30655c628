"""A course: the numbers of a vehicle on a line in SI."""

import math
from dataclasses import replace

import numpy as np
import pytest
from builders import HILLS, plain_scenario
from hypothesis import given
from hypothesis import strategies as st

from railjoule.core import ScenarioError, solve
from railjoule.core.motion import build_course
from railjoule.core.motion.course import FREE
from railjoule.core.physics.resistance import resistance_coefficients

coefficients = st.fixed_dictionaries(
    {
        "constant_n_per_kn": st.floats(0, 10),
        "linear_n_per_kn_per_kmh": st.floats(0, 0.1),
        "quadratic_n_per_kn_per_kmh2": st.floats(0, 0.01),
        "constant_n": st.floats(0, 1e4),
        "linear_n_per_kmh": st.floats(0, 1e3),
        "quadratic_n_per_kmh2": st.floats(0, 10),
    }
)


@given(coefficients, st.floats(0, 200))
def test_resistance_in_si_is_that_of_the_file(resistance, speed_kmh):
    vehicle = plain_scenario({"vehicle.resistance": resistance, "vehicle.load_factor": 0.5}).vehicle
    weight_kn = 115 * 9.81  # 100 t and half of 400 passengers of 75 kg
    r, v = resistance, speed_kmh
    specific = r["constant_n_per_kn"] + r["linear_n_per_kn_per_kmh"] * v + r["quadratic_n_per_kn_per_kmh2"] * v**2
    absolute = r["constant_n"] + r["linear_n_per_kmh"] * v + r["quadratic_n_per_kmh2"] * v**2
    a, b, c = resistance_coefficients(vehicle)
    metric = speed_kmh / 3.6
    assert a + b * metric + c * metric**2 == pytest.approx(weight_kn * specific + absolute, rel=1e-12, abs=1e-9)


@given(st.floats(0.5, 2), st.integers(0, 2**32 - 1))
def test_units_do_not_matter(factor, seed):
    """Masses, efforts and powers times `factor` give the same speeds and times, and energy times `factor`."""
    rng = np.random.default_rng(seed)
    sections = [{"length_m": 500.0, "gradient_permille": float(rng.uniform(-15, 15))} for _ in range(3)]
    scenario = plain_scenario({"line.sections": sections, "timetable.travel_time_s": 200.0})
    scaled = scenario.with_(
        **{
            "vehicle.tare_kg": 100e3 * factor,
            "vehicle.traction.max_effort_kn": 100 * factor,
            "vehicle.traction.max_power_kw": 1000 * factor,
            "vehicle.braking.max_effort_kn": 80 * factor,
        }
    )
    one, other = solve(scenario), solve(scaled)
    assert other.energy.net_j == pytest.approx(factor * one.energy.net_j, rel=1e-6)
    assert other.speed_ms == pytest.approx(one.speed_ms, abs=1e-2)
    assert solve(scaled, "fastest").travel_time_s == pytest.approx(solve(scenario, "fastest").travel_time_s, rel=1e-12)


def test_data_are_si():
    data = build_course(
        plain_scenario(
            {
                "vehicle.auxiliary_power_kw": 40,
                "vehicle.braking.friction_effort_kn": 30,
                "vehicle.braking.max_deceleration_ms2": 0.9,
                "vehicle.traction.max_acceleration_ms2": 0.8,
                "line.sections": HILLS,
            }
        )
    ).data
    assert data.half_inertia_kg == pytest.approx(0.5 * 1.1 * 100e3)
    assert (data.traction.constant_n, data.traction.power_w, data.braking.constant_n) == (100e3, 1e6, 80e3)
    assert (data.friction_effort_n, data.auxiliary_power_w) == (30e3, 40e3)
    assert (data.max_acceleration_ms2, data.max_deceleration_ms2) == (0.8, 0.9)
    assert math.isclose(data.largest_speed2.max(), (100 / 3.6) ** 2)
    assert math.isclose(data.largest_speed2[len(data.largest_speed2) // 2], (70 / 3.6) ** 2)
    assert data.cell_length_m.sum() == pytest.approx(2000)


def test_ends_and_stops_are_fixed():
    course = build_course(plain_scenario({"line.stations": [{"position_m": 700, "dwell_s": 30}]}), 2.0, 3.0)
    fixed = np.flatnonzero(course.data.fixed_speed2 != FREE)
    assert course.position_m[fixed] == pytest.approx([0, 700, 2000])
    assert course.data.fixed_speed2[fixed] == pytest.approx([4, 0, 9])
    assert course.dwell_s.sum() == 30


def test_net_force_by_hand():
    """From 10 to 12 m/s over 100 m, uphill 5 per mille: 55 t * 44 / 100 m + 4905 N + resistance at the means."""
    scenario = plain_scenario({"line.sections": [{"length_m": 100.0, "gradient_permille": 5.0}]})
    course = build_course(scenario, 10.0, 12.0, np.array([0.0, 100.0]))
    quadratic = 100 * 9.81 * 5e-4 * 3.6**2
    expected = 55e3 * 44 / 100 + 4905 + 100 * 9.81 * 2 + quadratic * 122
    assert course.net_force_n(np.array([100.0, 144.0])) == pytest.approx([expected])


def test_own_nodes():
    nodes = np.array([0.0, 500.0, 1300.0, 2000.0])
    course = build_course(plain_scenario(), position_m=nodes)
    assert course.cell_count == 3
    assert course.length_m == 2000
    assert (course.position_m == nodes).all()


@pytest.mark.parametrize("speed", [-1.0, math.nan, math.inf])
@pytest.mark.parametrize("name", ["initial_speed_ms", "final_speed_ms"])
def test_a_speed_at_an_end_that_is_none(name, speed):
    with pytest.raises(ScenarioError) as error:
        solve(plain_scenario(), **{name: speed})
    assert str(error.value) == f"{name} = {speed:g} must be a finite number of at least 0."


def test_a_part_of_a_course_is_the_course_of_that_part():
    """Every array, those of the data too: one that is added and not cut would keep its length."""
    stations = [{"position_m": 700.0, "dwell_s": 30.0}]
    neutral = [{"from_m": 300.0, "to_m": 400.0}]
    scenario = plain_scenario({"line.sections": HILLS, "line.stations": stations, "line.neutral_sections": neutral})
    course = build_course(scenario)
    first, last = 17, int(np.flatnonzero(course.dwell_s)[0])
    part = course.between(first, last)
    assert part.cell_count == last - first
    for whole, cut in ((vars(course), vars(part)), (course.data._asdict(), part.data._asdict())):
        for name, value in whole.items():
            if not isinstance(value, np.ndarray) or name in ("drive_parameters", "machines_on"):
                continue
            nodes = len(value) - course.cell_count
            assert nodes in (0, 1), name
            if name != "dwell_s":
                assert cut[name].tolist() == value[first : last + nodes].tolist(), name
    assert part.dwell_s.tolist() == [0.0] * (last - first + 1)
    decided = course.data._replace(machines_on=np.arange(course.cell_count) % 2.0)
    assert replace(course, data=decided).between(3, 6).data.machines_on.tolist() == [1, 0, 1]
