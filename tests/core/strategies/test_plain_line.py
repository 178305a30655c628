"""What Ftorek's strategies know of a line, and what they refuse."""

import re

import numpy as np
import pytest
from builders import COPPER_LOSS, plain_scenario
from hypothesis import given
from hypothesis import strategies as st
from random_scenarios import random_run, random_speeds

from railjoule.core import StrategyRefusedError
from railjoule.core.strategies import prepare_task
from railjoule.core.strategies.plain_line import broken_accelerations, check_feasible, plain_line

COPPER = {"vehicle.drive": {**COPPER_LOSS, "recuperation_factor": 1.0}}
SLOPES = [{"length_m": 500.0, "gradient_permille": 6.0}, {"length_m": 1500.0, "gradient_permille": -4.0}]


def line_of(changes):
    return plain_line(prepare_task(plain_scenario({**COPPER, **changes})))


def test_numbers_of_a_flat_line_by_hand():
    """100 t, of which 2 N/kN and 5e-4 N/kN per (km/h)^2 resist; h = n R (r / (n k u))^2 with r = 0.4 m."""
    line = line_of({"vehicle.resistance.linear_n_per_kmh": 36.0})
    assert (line.distance_m, line.notes, line.inertia_kg) == (2000, (), pytest.approx(110e3))
    assert (line.constant_n, line.linear) == (pytest.approx(981 * 2), pytest.approx(36 * 3.6))
    assert line.quadratic == pytest.approx(981 * 5e-4 * 3.6**2)
    assert line.loss_coefficient == pytest.approx(4 * 0.1 * (0.4 / (4 * 5.0 * 5.0)) ** 2)


def test_gradients_and_curves_become_a_mean_force():
    """-1.5 per mille in the mean; 300 m of 600 N m/kN over 400 m in 2000 m: 0.225 N/kN."""
    line = line_of({"line.sections": SLOPES})
    assert line.constant_n == pytest.approx(981 * (2 - 1.5))
    assert line.notes == ("Gradients are replaced by their mean, -1.50 per mille.",)
    curve = [{"length_m": 1700.0}, {"length_m": 300.0, "curve_radius_m": 400.0}]
    curved = line_of({"line.sections": curve, "vehicle.resistance.curve_constant_m_n_per_kn": 600.0})
    assert curved.constant_n == pytest.approx(981 * (2 + 0.225))


def test_curves_are_not_called_gradients():
    curve = [{"length_m": 1700.0}, {"length_m": 300.0, "curve_radius_m": 400.0}]
    line = line_of({"line.sections": curve, "vehicle.resistance.curve_constant_m_n_per_kn": 600.0})
    assert not any("gradient" in note for note in line.notes)


def test_one_gradient_all_the_way_needs_no_note():
    assert line_of({"line.sections": [{"length_m": 2000.0, "gradient_permille": 3.0}]}).notes == ()


def test_a_part_of_recuperation_is_noted():
    assert line_of({"drive.recuperation_factor": 0.99}).notes == (
        "The plan assumes that all the energy generated in braking is recuperated.",
    )


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"line.stations": [{"position_m": 900.0}]}, "needs a line without stops between its ends."),
        ({"line.sections": [{"length_m": 2000.0, "speed_limit_kmh": 99.0}]}, "needs a line without limits."),
        ({"line.speed_limits": [{"from_m": 0.0, "to_m": 50.0, "limit_kmh": 99.0}]}, "needs a line without limits."),
        ({"vehicle.drive": plain_scenario().vehicle.drive.model_dump()}, "needs a drive with copper loss."),
        ({"vehicle.drive.resistance_ohm": 0.0}, "needs a drive with copper loss."),
    ],
)
def test_refusals(changes, sentence):
    with pytest.raises(StrategyRefusedError, match="^" + re.escape(sentence) + "$"):
        line_of(changes)


def test_a_line_has_the_speeds_of_the_run_at_its_ends():
    line = plain_line(prepare_task(plain_scenario(COPPER), 3.0, 4.0))
    assert (line.initial_speed_ms, line.final_speed_ms) == pytest.approx((3.0, 4.0))


def test_a_limit_above_the_vehicles_own_is_none():
    assert line_of({"line.sections": [{"length_m": 2000.0, "speed_limit_kmh": 100.0}]}).distance_m == 2000


@given(st.integers(0, 10**6))
def test_feasible_runs_pass(seed):
    task = random_run(seed, stops=seed % 2 == 1).task
    check_feasible(task.mesh, random_speeds(task, seed))


@pytest.mark.parametrize(
    ("changes", "peak_ms", "sentence"),
    [
        # 28^2 m2/s2 times 0.99 at the last node before the middle
        ({}, 28.0, "needs 100.3 km/h, but the limit is 100 km/h."),
        # 22 kN of inertia and 2 of resistance at the start, less 2 and 2.5 of drag where braking begins
        ({"vehicle.traction.max_effort_kn": 20.0}, 20.0, "pulls with 24 kN at 0 m, where at most 20 kN are available."),
        (
            {"vehicle.braking.max_effort_kn": 15.0},
            20.0,
            "brakes with 17.5 kN at 1000 m, where at most 15 kN are available.",
        ),
        (
            {"vehicle.traction.max_acceleration_ms2": 0.15},
            20.0,
            "accelerates by 0.2 m/s2 at 0 m, but the limit is 0.15 m/s2.",
        ),
        (
            {"vehicle.braking.max_deceleration_ms2": 0.15},
            20.0,
            "slows down by 0.2 m/s2 at 1000 m, but the limit is 0.15 m/s2.",
        ),
    ],
    ids=["speed", "effort", "braking", "acceleration", "deceleration"],
)
def test_a_run_beyond_a_limit_is_refused_with_the_first_place(changes, peak_ms, sentence):
    """At constant acceleration to the middle of the line and down again; 20 m/s there take 0.2 m/s2."""
    mesh = prepare_task(plain_scenario({**COPPER, **changes})).mesh
    with pytest.raises(StrategyRefusedError, match="^" + re.escape(sentence) + "$"):
        check_feasible(mesh, triangle(mesh, peak_ms))


def test_friction_brakes_help_to_brake():
    weak = {**COPPER, "vehicle.braking.max_effort_kn": 15.0, "vehicle.braking.friction_effort_kn": 3.0}
    mesh = prepare_task(plain_scenario(weak)).mesh
    check_feasible(mesh, triangle(mesh, 19.0))


def triangle(mesh, peak_ms):
    return peak_ms**2 * np.minimum(mesh.position_m, 2000 - mesh.position_m) / 1000


def test_a_missing_brake_is_none_in_words():
    mesh = prepare_task(plain_scenario({**COPPER, "vehicle.braking.max_effort_kn": 0.0})).mesh
    with pytest.raises(StrategyRefusedError, match=r"^brakes with 17.5 kN at 1000 m, where at most 0 kN are available"):
        check_feasible(mesh, triangle(mesh, 20.0))


def test_the_first_cell_that_accelerates_too_much_is_named_with_its_acceleration():
    """By hand: v dv/dx = (16 - 9) / (2 h) in the cell after the node that is faster than all others."""
    mesh = prepare_task(plain_scenario({**COPPER, "vehicle.braking.max_deceleration_ms2": 0.1})).mesh
    speed2 = np.full(mesh.cell_count + 1, 9.0)
    speed2[4] = 16.0
    length = mesh.data.cell_length_m
    (slowing,) = broken_accelerations(mesh, speed2)
    assert (slowing.does, slowing.cell, slowing.limit) == ("slows down", 4, 0.1)
    assert slowing.reached == pytest.approx(3.5 / length[4])
    assert broken_accelerations(mesh, np.full(mesh.cell_count + 1, 9.0)) == []


def test_a_run_above_the_braking_curve_is_refused_with_the_key():
    """v^2 of 0.4 x meets 0.2 (2000 - x) at 667 m: at the next node the roots of 268 and 266 m2/s2."""
    curve = {"vehicle.braking.permitted_deceleration": [[0, 0.1]]}
    task = prepare_task(plain_scenario({**COPPER, **curve, "timetable.travel_time_s": 400.0}))
    # the curve is no limit of the line
    assert plain_line(task).distance_m == 2000.0
    with pytest.raises(StrategyRefusedError) as refusal:
        check_feasible(task.mesh, triangle(task.mesh, 20.0))
    assert str(refusal.value) == (
        "needs 58.93 km/h at 670 m, but the permitted deceleration "
        "(vehicle.braking.permitted_deceleration) permits only 58.71 km/h there."
    )
