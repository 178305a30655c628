"""Trips under limits of sections: what they obey, that they cost what their trajectory says, and no mesh shows."""

import numpy as np
import pytest
from builders import plain_scenario
from hypothesis import given
from hypothesis import strategies as st
from set_speeds import drive_under_limits

from railjoule.core import load_scenario
from railjoule.core.limit_search.problem import scale_to_time
from railjoule.core.limit_search.regulation import make_regulation
from railjoule.core.limit_search.trip import regulated_trip, trip_over_cells
from railjoule.core.task import prepare_task

METRO = load_scenario("kharkiv-like-40kmh")
TASK = prepare_task(METRO)
BORDERS = np.array([1200.0])
limits = st.tuples(st.floats(10, 80), st.floats(10, 80))


@given(speed=st.floats(15, 60))
def test_one_limit_on_a_flat_line_by_hand(speed):
    """Constant efforts and no drag: time and energy from v^2 = 2 a s; braking at 0.8 m/s2."""
    scenario = plain_scenario(
        {
            "vehicle.resistance": {},
            "vehicle.traction.max_power_kw": None,
            "drive.recuperation_factor": 0.0,
            "search.limits_kmh": [speed],
        }
    )
    run = drive_under_limits(scenario, [speed], "brake")
    v, mass, acceleration = speed / 3.6, 110e3, 80e3 / 110e3
    start, stop = v**2 / (2 * 100e3 / mass), v**2 / (2 * min(0.8, acceleration))
    seconds = v / (100e3 / mass) + v / min(0.8, acceleration) + (2000 - start - stop) / v
    assert run.travel_time_s == pytest.approx(seconds, rel=1e-5)
    assert run.energy_kwh == pytest.approx(0.5 * mass * v**2 / 0.85 / 3.6e6, rel=1e-5)


@given(pair=st.tuples(st.floats(0.3, 22), st.floats(0.3, 22)), brakes=st.booleans(), share=st.floats(1.2, 4))
def test_scaled_limits_meet_the_time(pair, brakes, share):
    target = share * TASK.shortest_time_s
    regulation = make_regulation(TASK.mesh, 0.8, brakes)
    found, seconds, energy = scale_to_time(
        TASK.mesh.data, regulation, BORDERS, np.array(pair), 1 / 3.6, 80 / 3.6, target
    )
    assert (found >= 1 / 3.6 - 1e-12).all()
    assert (found <= 80 / 3.6 + 1e-12).all()
    if not (np.isclose(found, 1 / 3.6).any() or np.isclose(found, 80 / 3.6).any()):
        assert found[0] / found[1] == pytest.approx(pair[0] / pair[1])
    assert seconds == pytest.approx(target, rel=1e-6)
    assert (seconds, energy) == regulated_trip(TASK.mesh.data, regulation, BORDERS, found)[2:]


def test_uphill_at_a_crawl_the_train_stands():
    """600 kN of grade against 100 kN of effort, after a coasting run-up that is too short."""
    mesh = prepare_task(plain_scenario()).mesh
    data = mesh.data._replace(line_force_n=np.where(mesh.position_m[1:] > 500, 200e3, 0.0))
    _, _, *cost = regulated_trip(data, make_regulation(mesh, 0.8, False), np.empty(0), np.array([3.0]))
    assert cost == [np.inf, np.inf]


@pytest.mark.parametrize("border", [1000.0000001, 1000.0004, 999.9995])
def test_borders_beside_a_node_are_merged_with_it(border):
    """The mesh has a node at 1000 m: cells of less than a millimetre would hold rounding."""
    run = drive_under_limits(plain_scenario({"search.boundaries_m": [border]}), [60, 40], "coast")
    assert np.diff(run.nodes_m).min() > 1e-3
    there = drive_under_limits(plain_scenario({"search.boundaries_m": [1000.0]}), [60, 40], "coast")
    assert run.energy_kwh == pytest.approx(there.energy_kwh, rel=1e-5)


def test_a_train_too_fast_to_brake_fails_where_it_passes_the_limit():
    """From 20 m/s a stop at 0.5 m/s2 takes 400 m; the line has 300."""
    scenario = plain_scenario({"line.sections": [{"length_m": 300.0}], "vehicle.braking.max_deceleration_ms2": 0.5})
    mesh = prepare_task(scenario).mesh
    data = mesh.data._replace(fixed_speed2=np.where(np.arange(mesh.cell_count + 1) == 0, 400.0, mesh.data.fixed_speed2))
    regulation = make_regulation(mesh, 0.8, False)
    position, speed2, seconds, _ = trip_over_cells(data, regulation, np.empty(0), np.array([25.0]))
    assert seconds == np.inf
    assert position[-1] == 300
    assert speed2[-1] == pytest.approx(400 - 2 * 0.5 * 300)
