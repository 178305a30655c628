"""Fits to many recordings of one train whose parameters are known, beside two usual ways to do without.

    python -m tests.benchmarks.fit [REPEATS]

Each repeat records four runs of one train anew: at 1 Hz, at another moment, in steps of 0.1 m/s, with 1 % of noise on
the effort. Three are fitted, the fourth is held out: its energy by the fitted train at its measured speeds is compared
with the true one. The two other ways find A, B, C and the inertia as well:

- accelerations: SciPy's `curve_fit` of effort less inertia over the differences of the speed
- grid: the least mean square of the simulated speed over a grid, narrowed four times; it has no intervals
"""

import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import scipy

from railjoule.core import Scenario, load_scenario
from railjoule.core.fit import fit_runs
from railjoule.core.fit.parameters import MASS, MASS_FACTOR, RESISTANCE, Model
from railjoule.core.fit.speed import simulated_speed
from railjoule.core.fit.steps import Steps, usable_steps
from railjoule.core.measured import MeasuredRun, measured_run, read_recording
from railjoule.core.units import MS_PER_KMH
from tests.recordings import as_csv, samples, true_runs

TIMES_S = (83.0, 89.0, 108.0, 96.0)
"""Of the runs; the last one is held out. The shortest possible is 77 s."""
NAMES = (*RESISTANCE, MASS_FACTOR)
Interval = tuple[float, float]
Found = tuple[dict[str, float], dict[str, Interval]]


@dataclass
class Score:
    """What one way made of all repeats."""

    values: list[dict[str, float]] = field(default_factory=list)
    covered: list[dict[str, bool]] = field(default_factory=list)
    energy_errors: list[float] = field(default_factory=list)
    seconds: float = 0.0


def recorded(seed: int, scenario: Scenario) -> list[MeasuredRun]:
    """Return the recordings of a repeat on their line."""
    texts = [as_csv(samples(run, 100 * seed + number)) for number, run in enumerate(true_runs_once())]
    return [measured_run(read_recording(text, f"run {number}"), scenario) for number, text in enumerate(texts)]


_RUNS: list = []


def true_runs_once() -> list:
    if not _RUNS:
        _RUNS.extend(true_runs(TIMES_S))
    return _RUNS


def by_velocity(runs: list[MeasuredRun], scenario: Scenario) -> Found:
    fit = fit_runs(runs, scenario)
    return fit.values, {parameter.name: (parameter.low, parameter.high) for parameter in fit.parameters}


def by_accelerations(runs: list[MeasuredRun], scenario: Scenario) -> Found:
    steps, model = usable_steps(runs, scenario), Model(scenario.vehicle, NAMES, 20.0)
    speed = steps.mean_speed_ms / MS_PER_KMH
    acceleration = (steps.end_speed_ms - steps.start_speed_ms) / steps.step_s

    def effort(rows, constant, linear, quadratic, factor):
        speed, acceleration = rows
        return constant + linear * speed + quadratic * speed**2 + (1 + factor) * model.first[MASS] * acceleration

    first = [model.first[name] for name in NAMES]
    rows = np.array([speed, acceleration])
    best, covariance = scipy.optimize.curve_fit(effort, rows, steps.effort_n - steps.line_force_n, first)
    reach = 1.96 * np.sqrt(np.diag(covariance))
    values = dict(zip(NAMES, best.tolist(), strict=True))
    intervals = {name: (values[name] - far, values[name] + far) for name, far in zip(NAMES, reach, strict=True)}
    return {**model.first, **values}, intervals


def by_grid(runs: list[MeasuredRun], scenario: Scenario) -> Found:
    steps, model = usable_steps(runs, scenario), Model(scenario.vehicle, NAMES, 20.0)
    centre = np.array([model.first[name] for name in NAMES])
    width = np.array([model.sizes[name] for name in NAMES]) * 0.5
    for _ in range(4):
        axes = [np.linspace(max(c - w, 0.0), c + w, 7) for c, w in zip(centre, width, strict=True)]
        grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(NAMES))
        centre = grid[np.argmin([_misfit(steps, values, model.first[MASS]) for values in grid])]
        width = width / 3
    return {**model.first, **dict(zip(NAMES, centre.tolist(), strict=True))}, {}


def _misfit(steps: Steps, values: np.ndarray, mass_kg: float) -> float:
    constant, linear, quadratic, factor = values
    simulated = simulated_speed(
        steps.step_s, steps.start_speed_ms, steps.begins, steps.effort_n - steps.line_force_n, steps.tunnel_factor,
        constant, linear / MS_PER_KMH, quadratic / MS_PER_KMH**2, (1 + factor) * mass_kg,
    )  # fmt: skip
    return float(np.mean((simulated - steps.end_speed_ms) ** 2))


WAYS: dict[str, Callable[[list[MeasuredRun], Scenario], Found]] = {
    "velocity fitting": by_velocity,
    "accelerations": by_accelerations,
    "grid": by_grid,
}


def score(repeats: int, ways: dict = WAYS) -> tuple[dict[str, float], dict[str, Score]]:
    """Return the true values, and what each way made of the repeats."""
    scenario = load_scenario("liashenko-ii")
    truth = Model(true_runs_once()[0].scenario.vehicle, NAMES, 20.0).first
    scores = {name: Score() for name in ways}
    for seed in range(repeats):
        *fitted, held = recorded(seed, scenario)
        for name, way in ways.items():
            begin = time.perf_counter()
            values, intervals = way(fitted, scenario)
            scores[name].seconds += time.perf_counter() - begin
            scores[name].values.append(values)
            scores[name].covered.append({key: low <= truth[key] <= high for key, (low, high) in intervals.items()})
            scores[name].energy_errors.append(energy_error(values, held, scenario))
    return truth, scores


def energy_error(values: dict[str, float], held: MeasuredRun, scenario: Scenario) -> float:
    """Return the energy of the held-out run by the fitted train over the true one, less 1."""
    model = Model(scenario.vehicle, tuple(values), 20.0)
    truth = true_runs_once()[-1]
    # the efficiency is that of the true train for all, so that motion alone is compared
    known = {**values, "drive.traction_efficiency": 0.82, "auxiliary_power_kw": 40.0}
    positive = {name: max(value, 0.0) for name, value in known.items()}
    fitted = scenario.model_copy(update={"vehicle": model.fitted(positive)})
    return measured_run(held.recording, fitted).modelled.energy_kwh / truth.energy_kwh - 1


def main() -> None:
    repeats = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    truth, scores = score(repeats)
    print(f"{repeats} repeats; mean error and deviation over the truth, share of intervals that hold the truth\n")
    head = f"{'way':18}" + "".join(f"{name.rpartition('.')[2]:>34}" for name in NAMES)
    print(head + f"{'held-out energy, largest':>32}{'ms a fit':>10}")
    for name, result in scores.items():
        cells = ""
        for key in NAMES:
            errors = np.array([values[key] for values in result.values]) / truth[key] - 1
            inside = [one[key] for one in result.covered if key in one]
            cover = f"{100 * np.mean(inside):5.1f} %" if inside else "      -"
            cells += f"{100 * errors.mean():+12.1f} % {100 * errors.std():7.1f} %  {cover:>8}"
        energy = 100 * np.abs(result.energy_errors)
        print(f"{name:18}{cells}{energy.mean():18.2f} %{energy.max():9.2f} %{1e3 * result.seconds / repeats:10.1f}")


if __name__ == "__main__":
    main()
