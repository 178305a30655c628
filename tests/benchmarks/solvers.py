"""Times of the solver, the frontier and ENOC's surface, the solver beside IPOPT in the same run."""

import statistics
import time
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

import numpy as np

from railjoule.core import load_scenario, solve
from railjoule.core.bounds.minimum import FIRST_ITERATIONS, FREE_CENTRING, TOLERANCE
from railjoule.core.interior_point.solver import minimise_energy
from railjoule.core.scenario import preset_names
from railjoule.core.strategies import prepare_task
from railjoule.core.strategies.enoc import enoc_coefficients, enoc_surface
from railjoule.core.strategies.plain_line import plain_line
from railjoule.core.studies import energy_time_frontier, frontier_times
from railjoule.core.validation.benchmark import INTERIOR_POINT, TEXTBOOK, TUNED, warm_median_s
from railjoule.core.validation.ipopt import IpoptProblem, is_installed
from tests.benchmarks.measurement import Measurement

G1 = Path(__file__).with_name("g1.toml")
SURFACE_POINTS, FRONTIER_POINTS = 400, 40
ROUNDS = 60


def interleaved_medians_s(calls: Mapping[str, Callable[[], object]]) -> dict[str, float]:
    """Return the warm median of each call [s], taken in turn so that a busy machine slows all of them alike."""
    times: dict[str, list[float]] = {name: [] for name in calls}
    for _ in range(ROUNDS):
        for name, call in calls.items():
            call()  # brings its data back into the processor's caches
            started = time.perf_counter()
            call()
            times[name].append(time.perf_counter() - started)
    return {name: statistics.median(taken) for name, taken in times.items()}


def profile_two() -> Iterator[Measurement]:
    """Liashenko's profile II at a 5 m mesh, beside IPOPT on the same problem."""
    scenario = load_scenario("liashenko-ii").replace(**{"solver.mesh_m": 5.0})
    task = prepare_task(scenario)
    given = (task.mesh.data, task.fastest_speed2, task.shortest_time_s, task.running_time_s)
    calls: dict[str, Callable[[], object]] = {
        INTERIOR_POINT: lambda: minimise_energy(*given, TOLERANCE, FIRST_ITERATIONS, FREE_CENTRING, False),
        "solve()": lambda: solve(scenario),
    }
    if is_installed():
        calls |= {TEXTBOOK: IpoptProblem(task, textbook=True).solve, TUNED: IpoptProblem(task).solve}
    medians = interleaved_medians_s(calls)
    cells = f"profile II, {task.mesh.cell_count} cells"
    for name, median in medians.items():
        yield Measurement(f"{cells}: {name}", 1e3 * median, "ms", at_most=1 if name == INTERIOR_POINT else None)
    for name in (TEXTBOOK, TUNED):
        if name in medians:
            bar = 40 if name == TEXTBOOK else None
            yield Measurement(f"{cells}: {name}, over ours", medians[name] / medians[INTERIOR_POINT], "x", at_least=bar)


def long_line() -> Iterator[Measurement]:
    """G1, a public benchmark of 48.5 km."""
    scenario = load_scenario(G1)

    def run():
        return solve(scenario)

    trajectory = run()
    yield Measurement("G1: cells", len(trajectory.effort_n), "", at_most=1000)
    yield Measurement(
        "G1: off the published 440.14 kWh", 100 * abs(trajectory.energy_kwh / 440.14 - 1), "%", at_most=0.02
    )
    yield Measurement("G1: solve()", 1e3 * warm_median_s(run, budget_s=1.0), "ms", at_most=3)


def surface() -> Iterator[Measurement]:
    """ENOC's energy over travel time and acceleration time."""
    coefficients = enoc_coefficients(plain_line(prepare_task(load_scenario("ftorek-300s"))))
    times, ramps = np.linspace(200, 500, SURFACE_POINTS), np.linspace(5, 100, SURFACE_POINTS)
    median = warm_median_s(lambda: enoc_surface(coefficients, times, ramps), budget_s=1.0)
    yield Measurement("ENOC surface, 400 x 400 points", 1e3 * median, "ms", at_most=10)


def frontiers() -> Iterator[Measurement]:
    """Forty optima on each shipped scenario."""
    for name in preset_names("scenarios"):
        task = prepare_task(load_scenario(name))
        times = frontier_times(task, FRONTIER_POINTS)
        median = warm_median_s(lambda task=task, times=times: energy_time_frontier(task, times), budget_s=1.0)
        yield Measurement(f"frontier of 40 points, {name}", 1e3 * median, "ms", at_most=50)
