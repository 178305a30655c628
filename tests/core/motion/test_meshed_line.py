"""A meshed line: the numbers of a vehicle on a line in SI."""

import math
from dataclasses import replace

import numpy as np
import pytest
from builders import HILLS, plain_scenario
from hypothesis import given
from hypothesis import strategies as st

from railjoule.core import ScenarioError, solve
from railjoule.core.motion import build_meshed_line


@given(st.floats(0.5, 2), st.integers(0, 2**32 - 1))
def test_units_do_not_matter(factor, seed):
    """Masses, efforts and powers times `factor` give the same speeds and times, and energy times `factor`."""
    rng = np.random.default_rng(seed)
    sections = [{"length_m": 500.0, "gradient_permille": float(rng.uniform(-15, 15))} for _ in range(3)]
    scenario = plain_scenario({"line.sections": sections, "timetable.travel_time_s": 200.0})
    scaled = scenario.replace(
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


def test_ends_and_stops_are_fixed():
    mesh = build_meshed_line(plain_scenario({"line.stations": [{"position_m": 700, "dwell_s": 30}]}), 2.0, 3.0)
    fixed = np.flatnonzero(~np.isnan(mesh.data.fixed_speed2))
    assert mesh.position_m[fixed] == pytest.approx([0, 700, 2000])
    assert mesh.data.fixed_speed2[fixed] == pytest.approx([4, 0, 9])
    assert mesh.dwell_s.sum() == 30


def test_own_nodes():
    nodes = np.array([0.0, 500.0, 1300.0, 2000.0])
    mesh = build_meshed_line(plain_scenario(), position_m=nodes)
    assert (mesh.cell_count, mesh.length_m) == (3, 2000)
    assert (mesh.position_m == nodes).all()


@pytest.mark.parametrize("speed", [-1.0, math.nan, math.inf])
@pytest.mark.parametrize("name", ["initial_speed_ms", "final_speed_ms"])
def test_a_speed_at_an_end_that_is_none(name, speed):
    with pytest.raises(ScenarioError) as error:
        solve(plain_scenario(), **{name: speed})
    assert str(error.value) == f"{name} = {speed:g} must be a finite number of at least 0."


def test_a_part_of_a_course_is_the_course_of_that_part():
    """Every array over the line, those of the data too: one that is added and not cut would keep its length."""
    stations = [{"position_m": 700.0, "dwell_s": 30.0}]
    neutral = [{"from_m": 300.0, "to_m": 400.0}]
    scenario = plain_scenario({"line.sections": HILLS, "line.stations": stations, "line.neutral_sections": neutral})
    mesh = build_meshed_line(scenario)
    first, last = 17, int(np.flatnonzero(mesh.dwell_s)[0])
    part = mesh.between(first, last)
    assert part.cell_count == last - first
    for whole, cut in ((vars(mesh), vars(part)), (mesh.data._asdict(), part.data._asdict())):
        for name, value in whole.items():
            if not isinstance(value, np.ndarray) or name in ("drive_parameters", "mode", "curve_steps"):
                continue
            nodes = len(value) - mesh.cell_count
            assert nodes in (0, 1), name
            if name != "dwell_s":
                np.testing.assert_array_equal(cut[name], value[first : last + nodes], name)
    assert part.dwell_s.tolist() == [0.0] * (last - first + 1)
    decided = mesh.data._replace(mode=np.arange(mesh.cell_count) % 2)
    assert replace(mesh, data=decided).between(3, 6).data.mode.tolist() == [1, 0, 1]
