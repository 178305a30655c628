"""Runs of Ftorek's suburban unit that tables, claims and figures share; each is computed once."""

from functools import cache
from typing import Any

import numpy as np
from scipy.integrate import cumulative_simpson
from scipy.optimize import minimize_scalar

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.citation import printed_numbers
from railjoule.core.scenario import Scenario, load_scenario
from railjoule.core.simulation.field_oriented import FieldOrientedRun, simulate_field_oriented
from railjoule.core.strategies import prepare_task, solve
from railjoule.core.strategies.enoc import EnocCoefficients, best_acceleration_time, enoc_coefficients, enoc_energy
from railjoule.core.strategies.eoc import Variant, solve_eoc
from railjoule.core.strategies.plain_line import PlainLine, SampledRun, plain_line
from railjoule.core.trajectory import Trajectory
from railjoule.core.units import J_PER_WH, MS_PER_KMH

# EOC brakes hardest in its last metres, of which a cell of 5 m takes the mean
FINE_MESH_M = 0.5
PAPER = printed_numbers("ftorek-2025")
"""The printed numbers; not to be changed."""
STRATEGIES = ("eoc", "enoc")
TIMES_S = (270, 300, 330)
"""Travel times of Tables 1 and 2 [s]."""
BASE_TIME_S = 300
"""The travel time against which the paper gives changes [s]."""
# Found by matching the minimum of the surface; no number of the paper gives it. It is shown beside 1 so that nobody
# takes the match for a confirmation.
TABLE_3_COPPER_WEIGHT = 3.087
"""With the copper loss times this, the energy surface has its minimum where Table 3 prints it."""
# far beyond the printed minimum, so that the bracket does not choose it
LONGEST_TIME_S = 20_000.0
# The power is a polynomial of fourth degree in time, which Simpson integrates with an error of the fourth power of the
# step: 1001 samples are far below the printed digits, and place the extremes to a thousandth of a part.
SAMPLES_A_PART = 1001


@cache
def paper_scenario() -> Scenario:
    """Return the paper's run of 300 s."""
    return load_scenario(PAPER["scenario"])


@cache
def paper_line() -> PlainLine:
    """Return the line and the train of the paper."""
    return plain_line(prepare_task(paper_scenario()))


@cache
def amperes_per_newton() -> float:
    """Return the current of one motor over the effort of all [A/N]."""
    # a drive with copper loss, as in every scenario of the paper, always has a current
    return prepare_task(paper_scenario()).mesh.drive.amperes_per_newton or np.nan


@cache
def coefficients() -> EnocCoefficients:
    """Return the coefficients of ENOC's energy for the paper's line and train."""
    return enoc_coefficients(paper_line())


@cache
def eoc_run(travel_time_s: float, variant: Variant = "as_printed") -> SampledRun:
    """Return EOC's run, without the work of drag in its cost unless `variant` is `optimal`."""
    return solve_eoc(paper_line(), travel_time_s, variant)


@cache
def printed_run(strategy: str, travel_time_s: float) -> SampledRun:
    """Return the run of Table 1 (`eoc`) or Table 2 (`enoc`, with the printed acceleration time)."""
    if strategy == "eoc":
        return eoc_run(travel_time_s)
    ramp = printed_entry(strategy, travel_time_s)["acceleration_time_s"]
    return sample_trapezoid(paper_line(), travel_time_s, ramp)


def sample_trapezoid(line: PlainLine, travel_time_s: float, acceleration_time_s: float) -> SampledRun:
    """Return ENOC's run between rest and rest, sampled over time: Ftorek et al. 2025, Figure 2 and (11).

    Parameters
    ----------
    line : PlainLine
        Length, inertia, resistance and copper loss.
    travel_time_s, acceleration_time_s : float
        T_m and T_e [s]; T_e is at most half of T_m.
    """
    peak = line.distance_m / (travel_time_s - acceleration_time_s)
    ramp_ms2 = peak / acceleration_time_s
    parts = (
        (acceleration_time_s, 0.0, ramp_ms2),
        (travel_time_s - 2 * acceleration_time_s, peak, 0.0),
        (acceleration_time_s, peak, -ramp_ms2),
    )
    columns = []
    # part by part, as the effort jumps at the corners and Simpson across a jump would be of first order
    start_s, start_m, start_j, shaft = 0.0, 0.0, 0.0, 0.0
    for duration_s, start_ms, acceleration_ms2 in parts:
        if duration_s <= 0:  # a triangle has no cruise
            continue
        time = np.linspace(0, duration_s, SAMPLES_A_PART)
        speed = start_ms + acceleration_ms2 * time
        resistance = line.resistance_n(speed)
        effort = line.inertia_kg * acceleration_ms2 + resistance
        power = effort * speed + line.loss_coefficient * effort**2
        energies = start_j + cumulative_simpson(power, x=time, initial=0)
        places = start_m + (start_ms + 0.5 * acceleration_ms2 * time) * time
        columns.append((start_s + time, places, speed, np.full_like(time, acceleration_ms2), effort, energies))
        start_s, start_m, start_j = start_s + duration_s, float(places[-1]), float(energies[-1])
        shaft += float(cumulative_simpson(resistance * speed, x=time)[-1])
    joined = (frozen_array(np.concatenate(column)) for column in zip(*columns, strict=True))
    time, place, speed, accelerations, effort, energies = joined
    return SampledRun(time, place, speed, accelerations, effort, energies, shaft)


def printed_entry(strategy: str, travel_time_s: float) -> dict[str, float]:
    """Return the entry of Table 1 (`eoc`) or Table 2 (`enoc`) for a travel time [s]."""
    table: list[dict[str, float]] = PAPER["table_1" if strategy == "eoc" else "table_2"]
    return next(entry for entry in table if entry["travel_time_s"] == travel_time_s)


def run_values(run: SampledRun) -> dict[str, float]:
    """Compute the columns of Tables 1 and 2, by their keys in the paper's file."""
    return {
        "max_speed_kmh": float(np.max(run.speed_ms)) / MS_PER_KMH,
        "max_current_a": amperes_per_newton() * float(np.max(run.effort_n)),
        "min_current_a": amperes_per_newton() * float(np.min(run.effort_n)),
        "shaft_energy_wh": run.shaft_energy_j / J_PER_WH,
        "peak_energy_wh": run.peak_energy_j / J_PER_WH,
        "total_energy_wh": run.total_energy_j / J_PER_WH,
    }


@cache
def optimal_run(travel_time_s: float) -> Trajectory:
    """Return the optimum for a travel time [s]."""
    return solve(paper_scenario().replace(**{"timetable.travel_time_s": float(travel_time_s)}), "optimal")


@cache
def closed_loop_run(
    strategy: str, travel_time_s: float, flux: str = "constant", precompensator: bool = True
) -> FieldOrientedRun:
    """Return a run of Table 1 or Table 2 driven in closed loop by the machines."""
    changes: dict[str, Any] = {
        "strategy": strategy,
        "timetable.travel_time_s": float(travel_time_s),
        "simulation.kind": "field_oriented",
        "simulation.flux": flux,
        "simulation.precompensator": precompensator,
        "solver.mesh_m": FINE_MESH_M,
        "eoc.variant": "as_printed",
    }
    if strategy == "enoc":
        changes["enoc.acceleration_time_s"] = printed_entry(strategy, travel_time_s)["acceleration_time_s"]
    return simulate_field_oriented(paper_scenario().replace(**changes))


@cache
def surface_minimum(coefficients: EnocCoefficients) -> tuple[float, float]:
    """Compute travel time and acceleration time of the least energy of ENOC [s]."""
    # nested, as the best ramp for a time has a search of its own
    time = minimize_scalar(
        lambda time_s: float(min_energies_j(coefficients, np.array([time_s]))[0]),
        bounds=(1.0, LONGEST_TIME_S),
        method="bounded",
        options={"xatol": 1e-6},
    ).x
    return float(time), best_acceleration_time(coefficients, time)


def min_energies_j(coefficients: EnocCoefficients, times_s: FloatArray) -> FloatArray:
    """Compute ENOC's energies with its best acceleration times for travel times [J]; shape as the times."""
    ramps = np.array([best_acceleration_time(coefficients, float(time)) for time in times_s])
    return enoc_energy(coefficients, times_s, ramps)
