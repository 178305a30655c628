"""Curves of effort with a vertical step, or with no effort at an end: the curve itself, and runs by own integration."""

import warnings
from typing import Any

import numpy as np
import pytest
from builders import plain_scenario

from railjoule.core import ScenarioError, check_run, solve
from railjoule.core.physics.vehicle_limit import RAMP_MS, curve_effort_n

STEPS = ((0.0, 100.0), (36.0, 100.0), (36.0, 60.0), (72.0, 50.0), (72.0, 70.0), (100.0, 30.0))
ONLY_CURVE: dict[str, Any] = {"vehicle.traction.max_power_kw": None, "vehicle.traction.max_effort_kn": None}


def test_at_a_step_the_lower_effort_holds() -> None:
    at_steps = curve_effort_n(STEPS, np.array([10.0, 20.0]))
    assert at_steps == pytest.approx([60e3, 50e3])
    beside = curve_effort_n(STEPS, np.array([10.0 - 2 * RAMP_MS, 20.0 + 2 * RAMP_MS]))
    assert beside == pytest.approx([100e3, 70e3], rel=2e-3)


def test_nowhere_more_than_the_curve() -> None:
    speed = np.concatenate(
        [np.linspace(0.1, 27, 2000), 10 + np.linspace(-0.02, 0.02, 81), 20 + np.linspace(-1, 1, 81) / 50]
    )
    sides = [np.interp(3.6 * (speed + way), *np.array(STEPS).T) for way in (-1e-9, 1e-9)]
    assert (curve_effort_n(STEPS, speed) <= 1e3 * np.minimum(*sides) * (1 + 1e-6)).all()


def own_time_s(curve: tuple[tuple[float, float], ...]) -> float:
    """Return the fastest time of the plain train over 2 km, by passes in v^2 with steps of 0.1 m."""
    kmh, kn = np.array(curve).T
    places = np.arange(0, 2000.05, 0.1)

    def resistance(v: float) -> float:
        return 981 * (2 + 5e-4 * (3.6 * v) ** 2)

    forward, backward = np.zeros(len(places)), np.zeros(len(places))
    for squares, brakes in ((forward, False), (backward, True)):
        for i in range(len(places) - 1):
            w = squares[i]
            for _ in range(2):
                v = max(0.5 * (w + squares[i]), 1e-9) ** 0.5
                effort = 80e3 if brakes else 1e3 * np.interp(3.6 * v, kmh, kn)
                force = effort + resistance(v) if brakes else effort - resistance(v)
                w = min(squares[i] + 0.2 * force / 110e3, (100 / 3.6) ** 2)
            squares[i + 1] = w
    speed = np.sqrt(np.minimum(forward, backward[::-1]))
    return float(np.sum(0.2 / (speed[1:] + speed[:-1])))


def test_the_fastest_run_over_steps() -> None:
    scenario = plain_scenario({"vehicle.traction.curve": STEPS, **ONLY_CURVE, "solver.mesh_m": 2.0})
    run = solve(scenario, "fastest")
    assert check_run(scenario, run).ok
    assert run.travel_time_s == pytest.approx(own_time_s(STEPS), abs=0.1)


def test_the_optimum_over_a_step_is_a_run_and_its_bound_holds() -> None:
    scenario = plain_scenario({"vehicle.traction.curve": STEPS, **ONLY_CURVE, "solver.mesh_m": 50.0})
    run, other = (solve(scenario, name, prove_seconds=0) for name in ("optimal", "bellman"))
    assert check_run(scenario, run).ok
    assert run.bound is not None
    assert run.bound.energy_j / 3.6e6 <= min(run.energy_kwh, other.energy_kwh)
    assert run.energy_kwh == pytest.approx(other.energy_kwh, rel=0.01)


@pytest.mark.parametrize(
    "changes",
    [
        {"vehicle.traction.curve": [[0, 100], [40, 60], [80, 0]], **ONLY_CURVE},
        {
            "vehicle.braking.curve": [[0, 0], [10, 0], [10, 80], [100, 40]],
            "vehicle.braking.max_effort_kn": None,
            "vehicle.braking.friction_effort_kn": 40.0,
        },
    ],
    ids=["ends at 0 kN", "begins at 0 kN"],
)
def test_no_effort_at_an_end_gives_no_warning(changes: dict[str, Any]) -> None:
    scenario = plain_scenario({**changes, "timetable.travel_time_s": 200.0, "solver.mesh_m": 25.0})
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        run = solve(scenario)
    assert check_run(scenario, run).ok


NONE_ABOVE_50 = {"curve": [[0, 80], [50, 80], [50, 0], [100, 0]], "friction_effort_kn": 100.0}
NONE_ABOVE_60 = {"curve": [[0, 80], [40, 80], [60, 0], [100, 0]], "friction_effort_kn": 100.0}


def test_a_brake_without_effort_above_a_speed_recuperates_only_below_it() -> None:
    """The fastest run of 110 t brakes with 80 + 100 kN from 50 km/h: M v dv = F ds, and half of 0.85 comes back."""
    run = solve(plain_scenario({"vehicle.braking": NONE_ABOVE_50, "solver.mesh_m": 2.0}), "fastest")
    speed = (np.arange(5000) + 0.5) * 50 / 3.6 / 5000
    braked = 180e3 + 981 * (2 + 5e-4 * (3.6 * speed) ** 2)
    distance_m = float(np.sum(110e3 * speed / braked) * 50 / 3.6 / 5000)
    assert run.energy.recuperated_j == pytest.approx(0.5 * 0.85 * 80e3 * distance_m, rel=0.02)
    above = run.speed_ms[1:] > 50.1 / 3.6
    assert run.electric_braking_n[above].max() < 1.0


@pytest.mark.parametrize("brakes", [NONE_ABOVE_50, NONE_ABOVE_60], ids=["step", "falling"])
@pytest.mark.parametrize("friction_kn", [0.0, 100.0])
def test_the_optimum_of_a_brake_without_effort_above_a_speed_agrees_with_backward_induction(
    brakes: dict[str, Any], friction_kn: float
) -> None:
    scenario = plain_scenario({"vehicle.braking": {**brakes, "friction_effort_kn": friction_kn}})
    run, other = solve(scenario, check=True), solve(scenario, "bellman", check=True)
    assert run.notes == ()
    assert run.bound is not None
    assert run.bound.energy_j <= other.energy.net_j
    assert run.energy_kwh == pytest.approx(other.energy_kwh, rel=1e-3)


@pytest.mark.parametrize(
    ("curve", "sentence"),
    [
        ([[0, 100], [40, 60], [30, 50]], "curve must have rising speeds; two points at the same speed are a step"),
        ([[0, 100], [40, 60], [40, 50], [40, 40]], "curve has more than two points at the same speed"),
        ([[0, 100], [0, 60], [40, 50]], "curve begins with a step"),
    ],
)
def test_what_is_no_step_is_refused(curve: list[list[float]], sentence: str) -> None:
    with pytest.raises(ScenarioError, match=sentence):
        plain_scenario({"vehicle.traction.curve": curve})
