"""The example runs of the page Files: `python -m tests.measured_example` writes them.

No recorder wrote them. A train that differs from that of the shipped scenario in what a fit looks for is driven over
its line by a driver who keeps to lower speeds than the limits, and what a recorder would write is read from that run,
with the steps and errors of recorders.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from railjoule.core import Trajectory, load_scenario, solve
from railjoule.core.arrays import FloatArray
from railjoule.core.units import MS_PER_KMH, N_PER_KN, W_PER_KW

SCENARIO = "metro-with-limit"
FOLDER = Path(__file__).parents[1] / "assets" / "recordings"
TRAIN: Mapping[str, Any] = {
    # 1.1 N/kN and 1.7463 N/(km/h)2 in the scenario
    "vehicle.resistance": {"constant_n_per_kn": 1.2, "quadratic_n_per_kmh2": 1.8},
    "drive.traction_efficiency": 0.845,  # 0.85 in the scenario
    "vehicle.auxiliary_power_kw": 2.5,  # none in the scenario
}
"""By what the train of the runs differs."""
STEP_S = 0.5
POSITION_STEP_M, SPEED_STEP_KMH, EFFORT_STEP_KN, POWER_STEP_KW = 1.0, 0.1, 0.1, 1.0
EFFORT_ERROR, POWER_ERROR = 0.01, 0.01
"""Standard deviations over what is measured; speeds have no error but their steps, as recorders smooth them."""
WINDOW_S = 1.0
"""Efforts and powers are means over such a time: recorders filter them, and trains change them no faster."""
WORN_WHEELS = 1.003
"""An odometer counts turns of worn wheels for more metres than they cover."""


@dataclass(frozen=True)
class Driver:
    """How a run is driven: by the plan of least energy under limits that the line does not have."""

    file: str
    travel_time_s: float
    limits: tuple[tuple[float, float, float], ...]
    seed: int


DRIVERS = (
    Driver("metro-0714.csv", 171.0, ((1150.0, 1350.0, 44.0),), 714),
    Driver("metro-1742.csv", 184.0, ((0.0, 350.0, 46.0), (1500.0, 1650.0, 44.0)), 1742),
)


def driven(driver: Driver) -> Trajectory:
    """Return the run of a driver."""
    scenario = load_scenario(SCENARIO)
    own = [limit.model_dump() for limit in scenario.line.speed_limits]
    kept = [{"from_m": start, "to_m": end, "limit_kmh": limit} for start, end, limit in driver.limits]
    # a driver's run is not refined: over the mesh of the scenario it is good enough
    changes = {
        **TRAIN,
        "solver.tolerance": 0.1,
        "timetable.travel_time_s": driver.travel_time_s,
        "line.speed_limits": [*own, *kept],
    }
    return solve(scenario.replace(**changes))


def recorded(run: Trajectory, seed: int) -> str:
    """Return what a recorder would write of a run, as CSV."""
    chance = np.random.default_rng(seed)
    time = np.append(np.arange(0.0, run.travel_time_s, STEP_S), run.travel_time_s)
    speed = np.interp(time, run.time_s, run.speed_ms) / MS_PER_KMH
    effort, power = _means(run, run.effort_n, time) / N_PER_KN, _means(run, run.supply_power_w, time) / W_PER_KW
    columns = {
        "time_s": (time, STEP_S, 1),
        "position_m": (WORN_WHEELS * np.interp(time, run.time_s, run.position_m), POSITION_STEP_M, 0),
        "speed_kmh": (speed, SPEED_STEP_KMH, 1),
        "effort_kn": (effort * (1 + EFFORT_ERROR * chance.standard_normal(len(time))), EFFORT_STEP_KN, 1),
        "line_power_kw": (power * (1 + POWER_ERROR * chance.standard_normal(len(time))), POWER_STEP_KW, 0),
        "outside_degc": (np.full(len(time), 7.5), 0.5, 1),
    }
    # the last sample lies between two steps, as a run ends when it ends
    rounded = {name: (step * np.round(values / step), digits) for name, (values, step, digits) in columns.items()}
    rounded["time_s"] = (time, 1)
    cells = [[f"{value:.{digits}f}" for value in values] for values, digits in rounded.values()]
    rows = [",".join(rounded), *(",".join(row) for row in zip(*cells, strict=True))]
    return "\n".join(rows).replace("-0,", "0,").replace("-0.0,", "0.0,") + "\n"


def _means(run: Trajectory, cells: FloatArray, time_s: FloatArray) -> FloatArray:
    """Return the means of what is constant in each cell around some times."""
    so_far = np.append(0.0, np.cumsum(cells * np.diff(run.time_s)))
    begins, ends = (np.clip(time_s + 0.5 * sign * WINDOW_S, 0.0, run.travel_time_s) for sign in (-1, 1))
    return (np.interp(ends, run.time_s, so_far) - np.interp(begins, run.time_s, so_far)) / (ends - begins)


def main() -> None:
    """Write the example runs."""
    FOLDER.mkdir(exist_ok=True)
    for driver in DRIVERS:
        run = driven(driver)
        (FOLDER / driver.file).write_text(recorded(run, driver.seed), encoding="utf-8")
        print(driver.file, f"{run.energy_kwh:.3f} kWh in {run.travel_time_s:.1f} s")


if __name__ == "__main__":
    main()
