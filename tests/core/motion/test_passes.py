"""The fastest run against a plain reference in Python, and how fast its error falls with the mesh."""

import math

import numpy as np
import pytest
from builders import HILLS, plain_scenario
from hypothesis import given
from hypothesis import strategies as st
from random_scenarios import random_run
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from railjoule.core import InfeasibleLineError, solve
from railjoule.core.motion import build_meshed_line, max_speeds, running_time
from railjoule.core.motion.passes import MOVED
from railjoule.core.strategies import prepare_task

WEAK_AT_A_STAND = {
    "line.sections": [{"length_m": 500.0}, {"length_m": 500.0, "gradient_permille": -18.0}],
    "vehicle.braking.max_effort_kn": 200.0,
    "vehicle.braking.curve": [[0, 20], [12, 150], [80, 40]],
}
"""Downhill this brake hardly slows the train down before its stop, and with more speed well enough."""
LIMITED = {"vehicle.traction.max_acceleration_ms2": 0.5, "vehicle.braking.max_deceleration_ms2": 0.3}


def max_effort(limit, speed):
    return float(limit.effort_n(np.array([max(speed, 1e-9)]))[0])


def reference(mesh):
    """Pass forward and backward cell by cell, each unknown by bisection, until nothing moves."""
    data = mesh.data
    cells = range(mesh.cell_count)
    w = data.limit_speed2.copy()
    w[data.fixed_speed2 >= 0] = data.fixed_speed2[data.fixed_speed2 >= 0]

    def force(i, before, after):
        mean_speed = 0.5 * (math.sqrt(before) + math.sqrt(after))
        rolling = data.resistance_constant_n + data.resistance_linear * mean_speed
        rolling += data.resistance_quadratic[i] * 0.5 * (before + after)
        return data.half_inertia_kg * (after - before) / data.cell_length_m[i] + rolling + data.line_force_n[
            i
        ], mean_speed

    def too_much_traction(i, before, after):
        needed, speed = force(i, before, after)
        return needed - max_effort(data.traction, speed)

    def too_much_braking(i, before, after):
        needed, speed = force(i, before, after)
        return -needed - max_effort(data.braking, speed) - data.friction_effort_n

    def greatest(excess, bound):
        return bound if excess(bound) <= 0 else brentq(excess, 0.0, bound, xtol=1e-13, rtol=1e-14)

    for _ in range(200):
        before = w.copy()
        for i in cells:
            bound = min(w[i + 1], w[i] + 2 * data.max_acceleration_ms2 * data.cell_length_m[i])
            w[i + 1] = greatest(lambda x, i=i: too_much_traction(i, w[i], x), bound)
        for i in reversed(cells):
            bound = min(w[i], w[i + 1] + 2 * data.max_deceleration_ms2 * data.cell_length_m[i])
            w[i] = greatest(lambda x, i=i: too_much_braking(i, x, w[i + 1]), bound)
        if np.abs(before - w).max() < 1e-9:
            return w
    raise AssertionError("the reference does not settle")


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"line.sections": HILLS, "vehicle.traction.curve": [[0, 100], [40, 90], [100, 30]]},
        {"line.sections": HILLS, "vehicle.braking.max_power_kw": 500, "vehicle.braking.friction_effort_kn": 10},
        {"line.sections": HILLS, "line.stations": [{"position_m": 900}], **LIMITED},
        {"line.sections": HILLS, "line.reverse": True, "vehicle.resistance.linear_n_per_kmh": 60, **LIMITED},
        WEAK_AT_A_STAND,
    ],
    ids=["flat", "curve", "braking power", "stop and limits", "reverse", "weak at a stand"],
)
def test_against_the_reference(changes):
    mesh = build_meshed_line(plain_scenario({"solver.mesh_m": 40.0, **changes}))
    speed2, obstacle, _ = max_speeds(mesh.data)
    assert obstacle == MOVED
    assert speed2 == pytest.approx(reference(mesh), rel=1e-7, abs=1e-7)


@given(st.integers(0, 10**6))
def test_random_courses_against_the_reference(seed):
    run = random_run(seed, stops=seed % 2 == 1)
    mesh = build_meshed_line(run.scenario.replace(**{"solver.mesh_m": max(run.mesh.length_m / 25, 20.0)}))
    speed2, obstacle, _ = max_speeds(mesh.data)
    if obstacle == MOVED:
        assert speed2 == pytest.approx(reference(mesh), rel=1e-7, abs=1e-7)


def test_running_time_by_hand():
    """10 m from rest to 4 m/s take 5 s, 30 m from 4 to 6 m/s another 6 s."""
    assert running_time(np.array([10.0, 30.0]), np.array([0.0, 16.0, 36.0])) == pytest.approx(11.0)


def test_ideal_train_by_hand():
    """Without resistance, 1 m/s2 up and 0.5 m/s2 down over 300 m: peak 14.14 m/s in 42.43 s."""
    scenario = plain_scenario(
        {
            "vehicle.tare_kg": 100e3,
            "vehicle.rotating_mass_factor": 0.0,
            "vehicle.resistance": {},
            "vehicle.traction": {"max_effort_kn": 100, "max_speed_kmh": 200},
            "vehicle.braking.max_effort_kn": 50,
            "line.sections": [{"length_m": 100}, {"length_m": 200}],  # a node at the peak
        }
    )
    run = solve(scenario, "fastest")
    assert run.travel_time_s == pytest.approx(3 * math.sqrt(200), rel=1e-12)
    assert run.max_speed_kmh == pytest.approx(math.sqrt(200) * 3.6, rel=1e-12)


@pytest.mark.parametrize(("initial_speed_ms", "order"), [(0.0, 1.5), (8.0, 2.0)])
def test_order_of_convergence(initial_speed_ms, order):
    """From a stand, where speed is no smooth function of place, the order is 1.5: hence the cells halved at stops.

    The way up at full effort against strong drag, to 1000 m: against the equation of motion over time.
    """
    changes = {
        "line.sections": [{"length_m": 2000}],
        "vehicle.traction.max_speed_kmh": 300,
        "vehicle.traction.max_power_kw": None,
        "vehicle.resistance.quadratic_n_per_kn_per_kmh2": 5e-3,
        "vehicle.resistance.linear_n_per_kn_per_kmh": 0.05,
    }
    scenario = plain_scenario(changes)
    data = build_meshed_line(scenario).data

    def motion(_, y):
        drag = data.resistance_constant_n + data.resistance_linear * y[1] + data.resistance_quadratic[0] * y[1] ** 2
        return [y[1], (100e3 - drag) / (2 * data.half_inertia_kg)]

    def arrived(_, y):
        return y[0] - 1000

    arrived.terminal = True
    exact = solve_ivp(motion, (0, 200), [0, initial_speed_ms], events=arrived, rtol=1e-11, atol=1e-11).t_events[0][0]
    errors = []
    for mesh_m in (40.0, 20.0, 10.0, 5.0):
        mesh = build_meshed_line(scenario, initial_speed_ms, position_m=np.arange(0, 2001, mesh_m))
        speed2, _, _ = max_speeds(mesh.data)
        half = mesh.cell_count // 2
        errors.append(abs(running_time(mesh.data.cell_length_m[:half], speed2[: half + 1]) - exact))
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert errors[-1] < 1e-4 * exact, errors
    assert orders == pytest.approx(order, abs=0.1)


def test_limits_bind_and_are_kept():
    """Acceleration and deceleration limits of HILLS are reached, and never passed, to 1e-6."""
    mesh = build_meshed_line(plain_scenario({"line.sections": HILLS, **LIMITED}))
    speed2, obstacle, _ = max_speeds(mesh.data)
    assert obstacle == MOVED
    rise = 0.5 * np.diff(speed2) / mesh.data.cell_length_m
    assert rise.max() == pytest.approx(0.5, abs=1e-6)
    assert rise.min() == pytest.approx(-0.3, abs=1e-6)


@pytest.mark.parametrize("deceleration_ms2", [0.5, 0.2, 0.1, 0.05])
@pytest.mark.parametrize("gradient_permille", [40.0, 80.0, 100.0])
def test_a_hill_that_slows_down_more_than_allowed_is_entered_slowly(deceleration_ms2, gradient_permille):
    """Full effort must do: the run keeps the limit of deceleration and that of effort at once."""
    changes = {
        "vehicle.traction.max_effort_kn": 130.0,
        "vehicle.braking.max_deceleration_ms2": deceleration_ms2,
        "line.sections": [
            {"length_m": 800},
            {"length_m": 300, "gradient_permille": gradient_permille},
            {"length_m": 800},
        ],
    }
    mesh = build_meshed_line(plain_scenario(changes))
    speed2, obstacle, _ = max_speeds(mesh.data)
    assert obstacle == MOVED
    rise = 0.5 * np.diff(speed2) / mesh.data.cell_length_m
    mean_speed = 0.5 * (np.sqrt(speed2[1:]) + np.sqrt(speed2[:-1]))
    assert rise.min() >= -deceleration_ms2 * (1 + 1e-6)
    assert (mesh.net_force_n(speed2) - mesh.data.traction.effort_n(mean_speed)).max() < 1e-3


def test_brakes_too_weak_to_keep_the_acceleration_downhill():
    changes = {
        "vehicle.braking.max_effort_kn": 40.0,
        "vehicle.traction.max_acceleration_ms2": 0.1,
        "line.sections": [{"length_m": 500}, {"length_m": 200, "gradient_permille": -60}, {"length_m": 900}],
    }
    with pytest.raises(
        InfeasibleLineError, match=r"on a gradient of -60 per mille, the brakes of at most 40 kN cannot"
    ):
        prepare_task(plain_scenario(changes))
    assert solve(plain_scenario({**changes, "vehicle.braking.max_effort_kn": 55.0}), "fastest").travel_time_s > 0


def test_a_gradient_that_no_train_climbs():
    sections = [{"length_m": 500}, {"length_m": 700, "gradient_permille": 150}]
    with pytest.raises(InfeasibleLineError) as error:
        solve(plain_scenario({"line.sections": sections}))
    words = str(error.value)
    assert words.startswith("At ")
    assert "on a gradient of 150 per mille, the train comes to a stand: its effort of at most 100 kN" in words


def test_a_short_steep_hill_is_climbed_by_run_up():
    sections = [{"length_m": 500}, {"length_m": 60, "gradient_permille": 150}, {"length_m": 500}]
    assert solve(plain_scenario({"line.sections": sections}), "fastest").travel_time_s > 0


def test_brakes_that_do_not_stop_the_train():
    changes = {"vehicle.braking.max_effort_kn": 5.0, "line.sections": [{"length_m": 900, "gradient_permille": -40}]}
    with pytest.raises(InfeasibleLineError, match=r"gradient of -40 per mille, the brakes of at most 5 kN cannot slow"):
        solve(plain_scenario(changes))


@pytest.mark.parametrize("ends", [{"initial_speed_ms": 40.0}, {"final_speed_ms": 40.0}, {"final_speed_ms": 27.7}])
def test_speeds_at_the_ends_that_cannot_be(ends):
    changes = {"vehicle.traction.max_power_kw": 300.0}
    with pytest.raises(InfeasibleLineError):
        solve(plain_scenario(changes), **ends)


def test_a_speed_at_an_end_above_the_limit_is_told():
    changes = {"timetable.exit_speed_kmh": 60.0, "line.speed_limits": [{"from_m": 1500, "to_m": 2000, "limit_kmh": 50}]}
    with pytest.raises(InfeasibleLineError, match=r"run at 60 km/h at 2000 m, where the limit is 50 km/h"):
        solve(plain_scenario(changes))


def test_a_curve_that_stops_the_train_is_named():
    """A curve of 3 m takes 600 / 3 = 200 N/kN, twice what 100 kN pull of 130 t: the gradient has no part in it."""
    sections = [{"length_m": 500.0}, {"length_m": 700.0, "curve_radius_m": 3.0}]
    changes = {"line.sections": sections, "vehicle.resistance.curve_constant_m_n_per_kn": 600.0}
    with pytest.raises(InfeasibleLineError, match="gradient of 0 per mille and in a curve that resists with") as error:
        solve(plain_scenario(changes))
    weight_kn = plain_scenario().vehicle.total_mass_kg * 9.81 / 1e3
    resisting = float(str(error.value).split("resists with ")[1].split(" kN")[0])
    assert resisting == pytest.approx(0.2 * weight_kn, rel=1e-3)
