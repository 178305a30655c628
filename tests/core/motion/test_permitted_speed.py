"""Braking curves of stepwise deceleration, against distances by hand and against the curve itself between nodes."""

from itertools import pairwise

import numpy as np
import pytest
from builders import plain_scenario
from hypothesis import given
from hypothesis import strategies as st

from railjoule.core import InfeasibleLineError
from railjoule.core.motion import build_meshed_line
from railjoule.core.strategies import prepare_task

KEY = "vehicle.braking.permitted_deceleration"
POINT_MASS = {
    "vehicle.rotating_mass_factor": 0.0,
    "vehicle.resistance": {},
    "vehicle.traction": {"max_effort_kn": 100.0, "max_speed_kmh": 72.0},
    "vehicle.braking.max_effort_kn": 200.0,
}
"""100 t without resistance: 1 m/s2 at full effort, 2 m/s2 with all its brakes, up to 20 m/s."""


def assemble_meshed_line(steps, **changes):
    return build_meshed_line(
        plain_scenario({KEY: steps, **{key.replace("__", "."): it for key, it in changes.items()}})
    )


def speed_ms(mesh, place_m):
    (node,) = np.flatnonzero(np.abs(mesh.position_m - place_m) < 1e-6)
    return float(np.sqrt(mesh.data.limit_speed2[node]))


def distance_m(slow2, fast2, steps):
    """Return how long the curve takes from one square of speed to another: the sum of dv^2 / (2 a) over the steps."""
    parts = zip(pairwise([*[(kmh / 3.6) ** 2 for kmh, _ in steps], np.inf]), steps, strict=True)
    return sum(max(min(fast2, end) - max(slow2, begin), 0.0) / (2 * a) for (begin, end), (_, a) in parts)


def curve_speed2(slow2, back_m, steps):
    """Return the square of speed of the curve a distance before its end, by bisection of `distance_m`."""
    low, high = slow2, slow2 + 2 * 20 * back_m
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if distance_m(slow2, middle, steps) < back_m else (low, middle)
    return low


def test_one_deceleration_before_a_stop():
    """20 m/s at 1 m/s2: 20^2 / 2 = 200 m."""
    mesh = assemble_meshed_line([[0, 1.0]])
    assert speed_ms(mesh, 1800) == pytest.approx(20, rel=1e-12)
    assert speed_ms(mesh, 1990) == pytest.approx(np.sqrt(20), rel=1e-12)
    # the limit of the vehicle, from 27.8^2 / 2 = 386 m before the stop
    assert speed_ms(mesh, 1610) == pytest.approx(100 / 3.6)
    assert mesh.permitted_deceleration_ms2 == 1.0


def test_no_curve_leaves_the_limit():
    mesh = build_meshed_line(plain_scenario({}))
    assert (mesh.data.limit_speed2 == (100 / 3.6) ** 2).all()
    assert mesh.permitted_deceleration_ms2 == np.inf


@pytest.mark.parametrize(
    ("steps", "speed2"),
    [
        # 10 m/s are 100 m at 0.5 m/s2, and 100 m more at 1 m/s2 add 200 m2/s2
        ([[0, 0.5], [36, 1.0]], 300.0),
        # 10 m/s are 50 m at 1 m/s2, and 150 m more at 0.5 m/s2 add 150 m2/s2
        ([[0, 1.0], [36, 0.5]], 250.0),
    ],
)
def test_two_steps(steps, speed2):
    assert speed_ms(assemble_meshed_line(steps), 1800) == pytest.approx(np.sqrt(speed2), rel=1e-12)


def test_a_step_within_a_cell_is_passed_exactly_where_the_deceleration_falls():
    """9 m/s are 40.5 m at 1 m/s2, in the midst of a cell."""
    assert speed_ms(assemble_meshed_line([[0, 1.0], [32.4, 0.4]]), 1900) ** 2 == pytest.approx(
        81 + 0.8 * 59.5, rel=1e-12
    )


@pytest.mark.parametrize("mesh_m", [10.0, 5.0, 2.5, 1.25, 0.625])
def test_a_step_up_costs_less_than_a_cell(mesh_m):
    """37 km/h lie 105.6 m before the stop: from there to the next node the lower deceleration holds, on the safe side.

    That is the whole error, 2 (1 - 0.5) times that length, so that it is gone as the mesh gets finer.
    """
    steps = [[0, 0.5], [37, 1.0]]
    corner = (37 / 3.6) ** 2
    too_long = -corner % mesh_m
    found = speed_ms(assemble_meshed_line(steps, solver__mesh_m=mesh_m), 1800) ** 2
    assert found == pytest.approx(curve_speed2(0.0, 200.0, steps) - 2 * 0.5 * too_long, rel=1e-12)


decelerations = st.floats(0.1, 3.0)


@given(
    st.lists(decelerations, min_size=1, max_size=4),
    st.lists(st.floats(5, 80), min_size=3, max_size=3, unique=True),
    st.sampled_from([3.0, 17.0, 80.0]),
)
def test_a_run_along_the_nodes_is_never_above_the_curve(rates, borders, mesh_m):
    """Between nodes v^2 is linear: compared at places between them, before a limit, a stop and the end."""
    steps = [[kmh, rate] for kmh, rate in zip([0, *sorted(borders)], rates, strict=False)]
    mesh = assemble_meshed_line(
        steps,
        solver__mesh_m=mesh_m,
        line__speed_limits=[{"from_m": 612.3, "to_m": 700.0, "limit_kmh": 33.0}],
        line__stations=[{"position_m": 1234.5, "dwell_s": 10.0}],
    )
    places = np.linspace(0, 2000, 126)
    top2 = np.full(len(places), (100 / 3.6) ** 2)
    for end, slow2 in ((612.3, (33 / 3.6) ** 2), (1234.5, 0.0), (2000.0, 0.0)):
        before = places <= end
        top2[before] = np.minimum(top2[before], [curve_speed2(slow2, end - x, steps) for x in places[before]])
    data = mesh.data
    # arriving at the stop: what its node permits but for it holds for leaving it
    arriving = np.where(data.fixed_speed2 >= 0, np.minimum(data.fixed_speed2, data.limit_speed2), data.limit_speed2)
    arriving[0] = data.limit_speed2[0]
    assert (np.interp(places, mesh.position_m, arriving) <= top2 * (1 + 1e-9) + 1e-9).all()


def test_the_curve_ends_where_a_limit_falls_and_not_where_one_ends():
    """With 80 m of train the limit lasts longer, and begins where it did: 15 m/s, 50 m before it at 1 m/s2."""
    changes = {
        "line__speed_limits": [{"from_m": 1000.0, "to_m": 1100.0, "limit_kmh": 54.0}],
        "line__limits_hold_for": "whole_train",
        "vehicle__length_m": 80.0,
    }
    mesh = assemble_meshed_line([[0, 1.0]], **changes)
    assert speed_ms(mesh, 950) == pytest.approx(np.sqrt(15**2 + 100))
    assert [speed_ms(mesh, place) for place in (1000, 1180)] == pytest.approx([15, 15])
    assert speed_ms(mesh, 1190) == pytest.approx(100 / 3.6)


def test_the_curve_ends_at_a_passing_point_and_with_the_speed_of_the_end():
    mesh = assemble_meshed_line(
        [[0, 1.0]],
        line__passing_points=[{"position_m": 800.0, "speed_kmh": 36.0}],
        timetable__exit_speed_kmh=72.0,
    )
    assert speed_ms(mesh, 700) == pytest.approx(np.sqrt(10**2 + 200))
    # the point itself keeps what is permitted but for it
    assert speed_ms(mesh, 800) == pytest.approx(100 / 3.6)
    assert speed_ms(mesh, 1900) == pytest.approx(np.sqrt(20**2 + 200))


def test_the_curve_knows_what_lies_beyond_a_part_of_the_line():
    part = assemble_meshed_line([[0, 1.0]]).between(10, 186)
    assert part.data.limit_speed2[-1] == pytest.approx(2 * (2000 - part.position_m[-1]))


def test_a_speed_above_the_curve_is_refused():
    """From 20 m before a limit of 30 km/h, 1 m/s2 permits the root of 8.33^2 + 40: 37.66 km/h."""
    changes = {
        KEY: [[0, 1.0]],
        "line.passing_points": [{"position_m": 900.0, "speed_kmh": 90.0}],
        "line.speed_limits": [{"from_m": 920.0, "to_m": 1500.0, "limit_kmh": 30.0}],
    }
    with pytest.raises(InfeasibleLineError) as refusal:
        prepare_task(plain_scenario(changes))
    assert str(refusal.value) == "The train is to run at 90 km/h at 900 m, where the limit is 37.662 km/h."


@pytest.mark.parametrize(
    ("curve", "shortest_s"),
    [
        # 20 s and 200 m to 20 m/s, 10 s and 100 m down at 2 m/s2, the rest at 20 m/s
        (None, 20 + 1700 / 20 + 10),
        # 40 s and 400 m down at 0.5 m/s2
        ([[0, 0.5]], 20 + 1400 / 20 + 40),
        # 10 m/s in 20 s and 100 m at 0.5 m/s2, the other 10 m/s in 10 s and 150 m at 1 m/s2
        ([[0, 0.5], [36, 1.0]], 20 + 1550 / 20 + 30),
        # the brakes are weaker than this curve and govern
        ([[0, 3.0]], 20 + 1700 / 20 + 10),
    ],
)
def test_the_shortest_time_by_hand(curve, shortest_s):
    task = prepare_task(plain_scenario({**POINT_MASS, **({KEY: curve} if curve else {})}))
    assert task.shortest_time_s == pytest.approx(shortest_s, rel=1e-9)
