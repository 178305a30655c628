"""The resistance of a start, against numerical integrals and an own run in v^2 over the distance."""

from typing import Any

import numpy as np
import pytest
from builders import COPPER_LOSS, INDUCTION, plain_scenario

from railjoule.core import InfeasibleLineError, StrategyRefusedError, check_run, solve
from railjoule.core.physics.resistance import (
    mean_starting_curvatures,
    mean_starting_resistance,
    mean_starting_slopes,
)
from railjoule.core.simulation.following import simulate_following

START: dict[str, Any] = {
    "vehicle.resistance.starting_n_per_kn": 10.0,
    "vehicle.resistance.starting_n": 1e3,
    "vehicle.resistance.starting_ends_at_kmh": 9.0,
}
"""10.81 kN of a train of 981 kN, which end at 2.5 m/s."""
AT_REST_N, ENDS_MS = 10_810.0, 2.5
SPEEDS = [(0.0, 1.0), (0.0, 2.5), (0.0, 6.0), (1.0, 2.0), (2.0, 1.0), (1.5, 1.5), (2.0, 7.0), (7.0, 2.0), (3.0, 9.0)]


def at_speed(speed: np.ndarray) -> np.ndarray:
    """Return the starting resistance at speeds."""
    return AT_REST_N * np.maximum(1 - speed / ENDS_MS, 0)


@pytest.mark.parametrize(("start", "end"), SPEEDS)
def test_the_mean_over_the_distance(start: float, end: float) -> None:
    """The square of speed is linear over the distance: 200,000 midpoints of it."""
    share = (np.arange(200_000) + 0.5) / 200_000
    by_points = at_speed(np.sqrt(start**2 + share * (end**2 - start**2))).mean()
    assert mean_starting_resistance(AT_REST_N, ENDS_MS, start**2, end**2) == pytest.approx(
        by_points, rel=1e-6, abs=1e-6
    )


@pytest.mark.parametrize(("start", "end"), [pair for pair in SPEEDS if pair[0] > 0])
def test_slopes_and_curvatures_against_differences(start: float, end: float) -> None:
    w, y, d = start**2, end**2, 1e-4

    def mean(a: float, b: float) -> float:
        return float(mean_starting_resistance(AT_REST_N, ENDS_MS, a, b))

    slopes = (mean(w + d, y) - mean(w - d, y)) / (2 * d), (mean(w, y + d) - mean(w, y - d)) / (2 * d)
    assert mean_starting_slopes(AT_REST_N, ENDS_MS, w, y) == pytest.approx(slopes, rel=1e-5, abs=1e-5)
    curvatures = tuple(
        (mean(w + one, y + other) - 2 * mean(w, y) + mean(w - one, y - other)) / d**2 for one, other in ((d, 0), (0, d))
    )
    assert mean_starting_curvatures(AT_REST_N, ENDS_MS, w, y) == pytest.approx(curvatures, rel=0.02, abs=1.0)


def own_time_s(start_n: float, effort_n: float) -> float:
    """Return the fastest time over 2 km, by passes in v^2 with steps of 2 mm at the start and 0.25 m elsewhere.

    100 t with a tenth rotating, 1000 kW, 80 kN of brakes, 100 km/h; 2 N/kN and 5e-4 N/kN/(km/h)^2.
    """
    places = np.concatenate([np.arange(0, 20, 0.002), np.arange(20, 1980, 0.25), np.arange(1980, 2000.0001, 0.002)])

    def resistance(speed: float) -> float:
        return 981 * (2 + 5e-4 * (3.6 * speed) ** 2) + start_n * max(1 - speed / ENDS_MS, 0)

    def passed(way: np.ndarray, brakes: bool) -> np.ndarray:
        squares = np.zeros(len(way))
        for i, h in enumerate(np.diff(way)):

            def slope(w: float) -> float:
                v = max(w, 1e-12) ** 0.5
                force = 80e3 + resistance(v) if brakes else min(effort_n, 1e6 / v) - resistance(v)
                return 2 * force / 110e3

            half = squares[i] + 0.5 * h * slope(squares[i])
            squares[i + 1] = min(squares[i] + h * slope(half), (100 / 3.6) ** 2)
        return squares

    speed = np.sqrt(np.minimum(passed(places, False), passed(2000 - places[::-1], True)[::-1]))
    return float(np.sum(2 * np.diff(places) / (speed[1:] + speed[:-1])))


def test_the_fastest_run_with_it() -> None:
    """A weak train takes longer, by as much as in an own integration; a strong one gains as much when it stops."""
    for effort_n, least_s in ((25e3, 1.0), (100e3, -0.1)):
        fine = {
            "solver.mesh_m": 1.0,
            "vehicle.traction.max_effort_kn": effort_n / 1e3,
            "timetable.travel_time_s": 400.0,
        }
        without, with_it = (solve(plain_scenario({**changes, **fine}), "fastest") for changes in ({}, START))
        longer = own_time_s(AT_REST_N, effort_n) - own_time_s(0.0, effort_n)
        assert with_it.travel_time_s - without.travel_time_s == pytest.approx(longer, rel=0.01, abs=0.002)
        assert longer > least_s


@pytest.mark.parametrize("drive", [{}, {"drive": COPPER_LOSS, "solver.mesh_m": 2.0}], ids=["efficiency", "copper loss"])
def test_the_optimum_keeps_all_rules_and_its_bound_is_close(drive: dict[str, Any]) -> None:
    scenario = plain_scenario({**START, **drive})
    run, without = solve(scenario), solve(plain_scenario(drive))
    assert check_run(scenario, run).ok
    assert run.gap is not None
    assert 0 <= run.gap < 5e-4
    # once from rest to 2.5 m/s and once back: the work of the start itself is a third of S v_e^2 over 2 a
    assert run.energy.running_resistance_j > without.energy.running_resistance_j - 1e4
    assert run.energy_kwh > without.energy_kwh
    assert solve(scenario, "bellman").energy_kwh >= run.bound.energy_j / 3.6e6


def test_the_bound_holds_with_idle_losses() -> None:
    """Chains of boxes have their own account of it: dynamic programming never falls below their bound."""
    changes = {"drive": INDUCTION, "vehicle.tare_kg": 30e3, "timetable.travel_time_s": 260.0, "solver.mesh_m": 25.0}
    run = solve(plain_scenario({**START, **changes}))
    other = solve(plain_scenario({**START, **changes}), "bellman")
    assert run.bound.energy_j / 3.6e6 <= min(run.energy_kwh, other.energy_kwh) * (1 + 1e-9)


@pytest.mark.parametrize(("gradient", "goes"), [(85.0, True), (90.0, False)])
def test_a_train_that_cannot_start_is_refused(gradient: float, goes: bool) -> None:
    """981 kN at 2 + 85 or 90 per mille and 10.81 kN are 96.2 and 101.1 kN; the train pulls with 100 kN."""
    hill = {"line.sections": [{"length_m": 300.0, "gradient_permille": gradient}, {"length_m": 700.0}]}
    scenario = plain_scenario({**START, **hill, "timetable.travel_time_s": 400.0})
    if goes:
        assert solve(scenario, "fastest").travel_time_s < 400
        return
    sentence = (
        r"^At 0 m, on a gradient of 90 per mille, the train stands and cannot start: that takes more than 101.1 kN, of "
        r"which 10\.81 kN are its starting resistance, and its effort is at most 100 kN\.$"
    )
    with pytest.raises(InfeasibleLineError, match=sentence):
        solve(scenario, "fastest")


@pytest.mark.parametrize("strategy", ["phases", "eoc", "enoc"])
def test_strategies_without_it_refuse_it_by_name(strategy: str) -> None:
    with pytest.raises(StrategyRefusedError, match="starting_n_per_kn"):
        solve(plain_scenario({**START, "drive": COPPER_LOSS}), strategy)


def test_the_run_that_follows_has_it_too() -> None:
    done = simulate_following(plain_scenario({**START, "disturbance.resistance_factor": 1.2}))
    assert done.actual.energy.running_resistance_j > done.planned.energy.running_resistance_j
