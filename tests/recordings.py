"""Recordings of simulated trains: what a recorder would have written, at its rate, in its steps, with its noise."""

import numpy as np

from railjoule.core import Scenario, Trajectory, load_scenario, solve
from railjoule.core.arrays import FloatArray
from railjoule.core.units import J_PER_KWH, N_PER_KN, W_PER_KW

# beside liashenko-ii: another resistance, less inertia, a worse drive, some auxiliaries
TRUE_TRAIN = {
    "vehicle.resistance.linear_n_per_kmh": 25.0,
    "vehicle.resistance.quadratic_n_per_kmh2": 1.4,
    "vehicle.rotating_mass_factor": 0.10,
    "vehicle.auxiliary_power_kw": 40.0,
    "drive.traction_efficiency": 0.82,
}
"""The train that is measured, where the one of the scenario is not it."""
COLUMNS = ("time_s", "speed_ms", "effort_kn", "power_kw", "energy_kwh")


def true_runs(times_s: tuple[float, ...], name: str = "liashenko-ii") -> list[Trajectory]:
    """Return runs of the true train in these times."""
    truth = load_scenario(name).replace(**TRUE_TRAIN)
    return [solve(with_time(truth, time)) for time in times_s]


def with_time(scenario: Scenario, time_s: float) -> Scenario:
    return scenario.replace(**{"timetable.average_speed_kmh": None, "timetable.travel_time_s": time_s})


def samples(
    run: Trajectory,
    seed: int = 0,
    step_s: float = 1.0,
    speed_step_ms: float = 0.1,
    effort_noise: float = 0.01,
    standing_s: float = 3.0,
) -> dict[str, FloatArray]:
    """Return what a recorder writes of a run: readings at its moments, before the start and after the end at rest."""
    random = np.random.default_rng(seed)
    # the clock of a recorder does not begin with the train
    time = np.arange(-standing_s + random.random() * step_s, run.time_s[-1] + standing_s, step_s)
    inside = (time >= 0) & (time < run.time_s[-1])
    cell = np.clip(np.searchsorted(run.time_s, time, side="right") - 1, 0, len(run.effort_n) - 1)
    speed = np.interp(time, run.time_s, run.speed_ms)
    effort = np.where(inside, run.effort_n[cell], 0.0)
    mean_speed = 0.5 * (run.speed_ms[1:] + run.speed_ms[:-1])[cell]
    # the power of a cell is that of its mean speed, and a recorder reads it at a moment
    power = np.where(inside, run.supply_power_w[cell] + np.maximum(effort, 0.0) * (speed - mean_speed) / 0.82, 0.0)
    if speed_step_ms > 0:
        speed = np.round(speed / speed_step_ms) * speed_step_ms
    return {
        "time_s": time - time[0],
        "speed_ms": speed,
        "effort_kn": effort * (1 + effort_noise * random.standard_normal(len(time))) / N_PER_KN,
        "power_kw": power / W_PER_KW,
        "energy_kwh": np.interp(time, run.time_s, run.supply_energy_j) / J_PER_KWH,
    }


def as_csv(columns: dict[str, FloatArray], names: tuple[str, ...] = COLUMNS) -> str:
    """Return a table in CSV, numbers with as many digits as recorders write."""
    rows = zip(*(columns[name] for name in names), strict=True)
    return "\n".join([",".join(names), *(",".join(f"{value:.5f}" for value in row) for row in rows)]) + "\n"
