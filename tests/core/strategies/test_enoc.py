"""Ftorek's near-optimal control; the printed tables are in ../validation/test_ftorek.py."""

import numpy as np
import pytest
from builders import COPPER_LOSS, plain_scenario
from hypothesis import given
from hypothesis import strategies as st

from railjoule.core import StrategyRefusedError, load_scenario, solve
from railjoule.core.strategies import prepare_task
from railjoule.core.strategies.enoc import (
    acceleration_time_for_peak,
    best_acceleration_time,
    enoc_coefficients,
    enoc_energy,
    enoc_surface,
)
from railjoule.core.strategies.plain_line import PlainLine, plain_line

lines = st.builds(
    PlainLine,
    distance_m=st.floats(300, 2e4),
    inertia_kg=st.floats(1e4, 1e6),
    constant_n=st.one_of(st.just(0.0), st.floats(-3e3, -1.0), st.floats(1.0, 2e4)),
    linear=st.one_of(st.just(0.0), st.floats(0.1, 500)),
    quadratic=st.one_of(st.just(0.0), st.floats(0.1, 50)),
    loss_coefficient=st.floats(1e-6, 1e-4),
    notes=st.just(()),
    initial_speed_ms=st.one_of(st.just(0.0), st.floats(0.0, 30.0)),
    final_speed_ms=st.one_of(st.just(0.0), st.floats(0.0, 30.0)),
)
mean_speeds = st.floats(3, 40)


@pytest.fixture(scope="module")
def suburban():
    return enoc_coefficients(plain_line(prepare_task(load_scenario("ftorek-300s"))))


@given(lines, mean_speeds)
def test_best_acceleration_time_is_the_minimum_of_12(line, mean_speed):
    """Against brute force, which knows nothing of the quintic (13)."""
    coefficients, time = enoc_coefficients(line), line.distance_m / mean_speed
    longest = coefficients.longest_acceleration_s(time)
    energies = enoc_energy(coefficients, time, np.geomspace(1e-4 * time, longest, 20_001))
    best = best_acceleration_time(coefficients, time)
    assert 0 < best <= longest <= time / 2
    # downhill, the work against the resistance may take nearly all away, and kinetic energy too
    kinetic = 0.5 * line.inertia_kg * (line.initial_speed_ms**2 + line.final_speed_ms**2)
    size = abs(energies.min()) + abs(line.constant_n) * line.distance_m + kinetic
    assert float(enoc_energy(coefficients, time, best)) == pytest.approx(energies.min(), abs=1e-6 * size)
    assert float(enoc_energy(coefficients, time, best)) <= energies.min() + 1e-12 * size


@given(lines, mean_speeds, st.floats(0.05, 0.99))
def test_12_is_the_integral_of_power_between_any_end_speeds(line, mean_speed, share):
    """Gauss' rule with five points is exact for the fourth power of time in (11), part by part."""
    time = line.distance_m / mean_speed
    coefficients = enoc_coefficients(line)
    ramp = share * coefficients.longest_acceleration_s(time)
    cruise = float(coefficients.cruise_speed_ms(time, ramp))
    at, weights = np.polynomial.legendre.leggauss(5)
    energy, distance, size = 0.0, 0.0, 0.0
    parts = [
        (ramp, line.initial_speed_ms, cruise),
        (time - 2 * ramp, cruise, cruise),
        (ramp, cruise, line.final_speed_ms),
    ]
    for duration, before, after in parts:
        acceleration = (after - before) / duration
        speed = before + acceleration * duration * (at + 1) / 2
        effort = line.resistance_n(speed) + line.inertia_kg * acceleration
        power = line.loss_coefficient * effort**2 + effort * speed
        energy += duration / 2 * float(weights @ power)
        size += duration / 2 * float(weights @ np.abs(power))
        distance += duration * (before + after) / 2
    assert distance == pytest.approx(line.distance_m, rel=1e-9)
    assert float(enoc_energy(coefficients, time, ramp)) == pytest.approx(energy, abs=1e-9 * size)


def test_best_acceleration_time_of_the_suburban_unit(suburban):
    """Findings on Ftorek 2025: 30.9 s and 4250 Wh for 300 s, 1.6 % above the optimum of 4180.53 Wh."""
    best = best_acceleration_time(suburban, 300.0)
    assert best == pytest.approx(30.9, abs=0.1)
    assert float(enoc_energy(suburban, 300.0, best)) / 3600 == pytest.approx(4250, abs=1)
    step = 1e-3
    slope = (enoc_energy(suburban, 300.0, best + step) - enoc_energy(suburban, 300.0, best - step)) / (2 * step)
    assert abs(slope) < 1e-6 * float(enoc_energy(suburban, 300.0, best))


@pytest.mark.parametrize(("time", "ramp", "peak_kmh"), [(270, 60.932, 86.094), (300, 62.713, 75.858)])
def test_acceleration_time_for_a_peak_is_printed_below_15(suburban, time, ramp, peak_kmh):
    assert acceleration_time_for_peak(suburban, time, peak_kmh / 3.6) == pytest.approx(ramp, rel=2e-4)


def test_surface_has_a_row_a_ramp_and_no_number_where_ramps_do_not_fit(suburban):
    times, ramps = np.array([100.0, 200.0, 300.0]), np.array([10.0, 50.0, 75.0, 120.0])
    surface = enoc_surface(suburban, times, ramps)
    assert surface.shape == (4, 3)
    assert np.array_equal(np.isnan(surface), 2 * ramps[:, None] > times)
    assert surface[1, 0] == enoc_energy(suburban, 100.0, 50.0)
    assert surface[2, 2] == enoc_energy(suburban, 300.0, 75.0)


@pytest.mark.parametrize("ramp", [None, 62.713, 100.0])
def test_a_run_is_the_trapezoid_with_the_energy_of_12(suburban, ramp):
    run = solve(load_scenario("ftorek-300s", {} if ramp is None else {"enoc.acceleration_time_s": ramp}), "enoc")
    ramp = ramp or best_acceleration_time(suburban, 300.0)
    peak = 5000 / (300 - ramp)
    assert (run.travel_time_s, run.max_speed_kmh) == (pytest.approx(300, rel=1e-9), pytest.approx(3.6 * peak))
    up = run.time_s < ramp
    assert run.speed_ms[up] == pytest.approx(peak * run.time_s[up] / ramp)
    # (12) integrates over time, the account over the cells of a mesh
    assert run.energy.net_j == pytest.approx(float(enoc_energy(suburban, 300.0, ramp)), rel=1e-4)
    assert (
        run.notes[0] == f"ENOC accelerates and brakes for {ramp:.1f} s each, cruising at {3.6 * peak:.1f} km/h between."
    )


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        (
            {"enoc.acceleration_time_s": 101.0},
            "needs an acceleration time of at most 100.0 s, half of the travel time.",
        ),
        # 110 t to 10.15 m/s within 3 s, and 2 kN of resistance
        ({"enoc.acceleration_time_s": 3.0}, "pulls with 374 kN at 0 m, where at most 100 kN are available."),
        (
            {"enoc.acceleration_time_s": 90.0, "timetable.entry_speed_kmh": 72.0, "timetable.exit_speed_kmh": 90.0},
            "needs less time: within 200.0 s its ramps between these speeds of the ends cover the whole line.",
        ),
        ({"vehicle.traction.max_speed_kmh": 40.0}, "needs 40.38 km/h, but the limit is 40 km/h."),
        ({"line.stations": [{"position_m": 900.0}]}, "needs a line without stops between its ends."),
    ],
)
def test_refusals(changes, sentence):
    scenario = plain_scenario({"vehicle.drive": COPPER_LOSS, "timetable.travel_time_s": 200.0, **changes})
    with pytest.raises(StrategyRefusedError) as refusal:
        solve(scenario, "enoc")
    assert str(refusal.value) == sentence


def test_a_corner_beside_a_node():
    """Expected: mass times acceleration and the resistance at the end of the ramp, by hand."""
    ramp, changes = 57.518543046357614, {"vehicle.drive": COPPER_LOSS, "timetable.travel_time_s": 170.3}
    scenario = plain_scenario({**changes, "enoc.acceleration_time_s": ramp})
    line, run = plain_line(prepare_task(scenario)), solve(scenario, "enoc")
    peak = line.distance_m / (170.3 - ramp)
    resistance = line.constant_n + (line.linear + line.quadratic * peak) * peak
    assert run.tractive_effort_n.max() == pytest.approx(line.inertia_kg * peak / ramp + resistance, rel=1e-3)
