"""A plan under random conditions: load, resistance, voltage, departure and errors of measurement."""

from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Executor
from typing import Any, NamedTuple

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.compilation import require_compiled
from railjoule.core.energy import share_above
from railjoule.core.errors import InfeasibleLineError, ScenarioError
from railjoule.core.scenario import Scenario
from railjoule.core.scenario.disturbance import Distribution, Fixed, LogNormal, Normal, Triangular, Uniform
from railjoule.core.simulation.actual_vehicle import NO_JERK_LIMIT, voltage_notes
from railjoule.core.simulation.following import (
    follow,
    plan_for,
    plan_knowing_load,
    replanned_rests,
    stop_positions_m,
)
from railjoule.core.studies.rows import RowByRow, rows_in_order
from railjoule.core.studies.table import StudyTable
from railjoule.core.trajectory import Trajectory

# The order is part of the result: each quantity has a column of the random numbers, so that the same seed always draws
# the same runs. Quantities that are added to a block would change all of its numbers: they need a block of their own.
CONDITIONS = ("load_factor", "coordinate_error_m", "resistance_factor", "line_voltage_factor", "departure_delay_s")
SENSOR_ERRORS = ("d1_error_m", "d2_error_m", "d3_error_m")
QUANTITIES = (*CONDITIONS, "speed_error", *SENSOR_ERRORS)
"""The random quantities in the order of their numbers: a block of conditions, and one of errors of measurement."""
RESULTS = 3
"""Energy, delay and stopping error."""
# Wide enough for the defaults, whose standard deviations are 3 and 8 per cent, and narrow enough that a drive keeps
# some voltage and a train some resistance: a run without them cannot be simulated.
FACTOR_BOUNDS = (0.05, 2.0)
"""Bounds of random factors."""
LONGEST_DELAY_S, MAX_SPEED_ERROR = 86400.0, 0.5
"""The bounds of the scenario for its own delay and error."""
# Energy bends little over the load: straight lines between nine plans are exact to 2e-4 (measured on liashenko-ii and
# tram-950m), and nine plans are fewer than one a run.
PLANNED_LOADS = np.linspace(0.0, 1.0, 9)
"""Shares of the largest load whose own plans are computed; between them their energy is interpolated."""
ON_TIME_S = 0.05
"""A delay that no timetable shows [s]."""
RUNS_PER_STEP = 40
"""A page draws its histogram at each step: about ten times a second."""


def monte_carlo(scenario: Scenario, executor: Executor | None = None) -> StudyTable:
    """Return random runs of a plan, with a row for each run; NaN where the real train cannot pass the line.

    Its columns are the `QUANTITIES` drawn, energy as driven, overconsumption against the plan, and against the plan of
    the actual load, delay at the end, last stopping error, and energy of the plan for the actual load. With dwells that
    scatter, also the dwell less the planned one and the delay of the arrival at each station, and energy and delay of a
    run whose rest is planned again at each late departure, which makes up for the delay as far as it can.

    Parameters
    ----------
    scenario : Scenario
        The plan, and in `montecarlo` the distributions, the number of runs and the seed.
    executor : Executor, optional
        Executor of the runs; by default this thread.

    Raises
    ------
    ScenarioError
        If a distribution has nothing within the bounds of its quantity.
    RailjouleError
        As in `railjoule.core.solve` for the plan.
    """
    *_, last = monte_carlo_steps(scenario, executor)
    return last


def monte_carlo_steps(scenario: Scenario, executor: Executor | None = None) -> Iterator[StudyTable]:
    """Yield the table of `monte_carlo` empty, and again after every few runs; parameters and errors as there."""
    require_compiled()
    planned = plan_for(scenario)
    drawn = draw(scenario)
    replanned = _replanned_energies(scenario, drawn["load_factor"])
    dwells = draw_dwells(scenario)
    attributes = {
        "title": scenario.title,
        "strategy": scenario.strategy,
        "planned_energy_kwh": planned.energy_kwh,
        "seed": scenario.montecarlo.seed,
        "notes": (
            *(() if np.all(drawn["line_voltage_factor"] == 1) else voltage_notes(scenario.vehicle)),
            *(() if scenario.vehicle.max_jerk_ms3 is None else (NO_JERK_LIMIT,)),
        ),
    }

    def table(results: FloatArray) -> StudyTable:
        done, (energy, delay, stop_error, *more) = len(results), results.T
        stations = range(1, dwells.shape[1] + 1)
        names = [*(f"arrival_delay_{number}_s" for number in stations), "made_up_kwh", "made_up_delay_s"]
        columns = {
            **{name: values[:done] for name, values in drawn.items()},
            **{f"dwell_delay_{number}_s": dwells[:done, number - 1] for number in stations},
            "energy_kwh": energy,
            "overconsumption": share_above(energy, planned.energy_kwh),
            "over_replanned": share_above(energy, replanned[:done]),
            "delay_s": delay,
            "stop_error_m": stop_error,
            "replanned_kwh": replanned[:done],
            **dict(zip(names if more else (), more, strict=True)),
        }
        return StudyTable(scenario, {"run": range(done)}, columns, attributes, done)

    work, samples = drawn_runs(planned, scenario), np.column_stack([*(drawn[name] for name in QUANTITIES), dwells])
    for rows in rows_in_order(work, samples, executor, RUNS_PER_STEP):
        yield table(rows.values)


def drawn_runs(planned: Trajectory, scenario: Scenario) -> RowByRow:
    """Return the work that follows a plan with rows of `QUANTITIES`: energy [kWh], delay [s], stopping error [m].

    Rows with dwells behind have more results, as the columns of `monte_carlo`.

    Parameters
    ----------
    planned : Trajectory
        The plan that is followed.
    scenario : Scenario
        The actual train and line; rows of random values replace its disturbance.
    """
    stations = len(scenario.line.inner_stations) if has_dwell_scatter(scenario) else 0
    replan = replanned_rests(scenario) if stations else None

    def run(drawn: Sequence[float]) -> tuple[float, ...]:
        actual = drawn_scenario(scenario, dict(zip(QUANTITIES, drawn, strict=False)))
        dwells = drawn[len(QUANTITIES) :]
        driven = follow(planned, actual, dwells)
        results = driven.actual.energy_kwh, driven.delay_s, driven.stop_error_m
        if not dwells:
            return results
        made_up = follow(planned, actual, dwells, replan)
        return *results, *driven.arrival_delays_s[:-1], made_up.actual.energy_kwh, made_up.delay_s

    # a train may be too heavy for a ramp: such a run stays NaN
    return RowByRow(run, RESULTS + (stations + 2 if stations else 0), InfeasibleLineError)


class Punctuality(NamedTuple):
    """Arrivals at one place in all runs with scattered dwells that reach the end.

    Parameters
    ----------
    place : str
        Station, or the end with the way of driving.
    mean_delay_s, late_delay_s : float
        Mean delay, and the delay that 95 % of the runs do not exceed [s].
    share_on_time : float
        Share of the runs that are late by no more than `disturbance.accepted_delay_s`.
    energy_kwh : float or None
        Mean energy of the whole run, at the end [kWh].
    """

    place: str
    mean_delay_s: float
    late_delay_s: float
    share_on_time: float
    energy_kwh: float | None


def punctuality(table: StudyTable) -> tuple[Punctuality, ...]:
    """Return the punctuality at each station and at the end, of runs that keep to the plan and that make up for delays.

    Empty where no dwells scatter, or no run has reached the end yet.
    """
    reached = np.isfinite(table.energy_kwh)
    if not has_dwell_scatter(table.scenario) or not reached.any():
        return ()
    stations = table.scenario.line.in_running_order().inner_stations
    places = [
        (station.name or f"station {number + 1}", f"arrival_delay_{number}_s", "")
        for number, station in enumerate(stations, 1)
    ]
    places += [("end, keeps to plan", "delay_s", "energy_kwh"), ("end, makes up", "made_up_delay_s", "made_up_kwh")]
    accepted_s = table.scenario.disturbance.accepted_delay_s + ON_TIME_S
    found = []
    for place, name, energy in places:
        delays = table[name][reached]
        mean_kwh = float(table[energy][reached].mean()) if energy else None
        late_s, share = float(np.quantile(delays, 0.95)), float((delays <= accepted_s).mean())
        found.append(Punctuality(place, float(delays.mean()), late_s, share, mean_kwh))
    return tuple(found)


def has_dwell_scatter(scenario: Scenario) -> bool:
    """Return whether dwells differ from the planned ones."""
    options = scenario.montecarlo
    return bool(options.dwell_delay_s != type(options).model_fields["dwell_delay_s"].default)


def draw_dwells(scenario: Scenario) -> FloatArray:
    """Return dwells less the planned ones [s], of shape (runs, stations); without columns where they do not scatter."""
    if not has_dwell_scatter(scenario):
        return np.zeros((scenario.montecarlo.runs, 0))
    options, stations = scenario.montecarlo, scenario.line.in_running_order().inner_stations
    probabilities = np.random.default_rng((options.seed, 2)).random((options.runs, len(stations)))
    columns = [
        _truncated("dwell_delay_s", options.dwell_delay_s, 0.0, (-station.dwell_s, LONGEST_DELAY_S), column)
        for station, column in zip(stations, probabilities.T, strict=True)
    ]
    return frozen_array(np.column_stack(columns))


def drawn_scenario(scenario: Scenario, drawn: Mapping[str, float]) -> Scenario:
    """Return a scenario with values of some `QUANTITIES`; the others do not change."""
    disturbance: dict[str, float | None] = {name: drawn[name] for name in CONDITIONS if name in drawn}
    if "load_factor" in disturbance:
        disturbance |= {"actual_load_factor": disturbance.pop("load_factor"), "actual_load_t": None}
    values, options = {**planned_values(scenario), **drawn}, scenario.simulation
    measured = {
        "speed_error": values["speed_error"],
        "sensor_errors_m": tuple(values[name] for name in SENSOR_ERRORS),
    }
    return scenario.model_copy(
        update={
            "disturbance": scenario.disturbance.model_copy(update=disturbance),
            "simulation": options.model_copy(update=measured),
        }
    )


def planned_values(scenario: Scenario) -> dict[str, float]:
    """Return the values of all `QUANTITIES` that the scenario itself has."""
    return {
        **{name: getattr(scenario.disturbance, name) for name in CONDITIONS if name != "load_factor"},
        "load_factor": scenario.vehicle.load_share,
        "speed_error": scenario.simulation.speed_error,
        **dict(zip(SENSOR_ERRORS, scenario.simulation.sensor_errors_m, strict=True)),
    }


def draw(scenario: Scenario) -> dict[str, FloatArray]:
    """Return values of all `QUANTITIES` from their distributions, each of shape (runs,).

    A distribution is cut off at the bounds of its quantity; the load's are 0 and 1, or the crush load where the plan or
    the distribution itself goes above 1. More runs with the same seed begin with the same values, and another
    distribution of one quantity leaves the others as they were.

    Raises
    ------
    ScenarioError
        If a distribution has nothing within the bounds.
    """
    options = scenario.montecarlo
    # Blocks of uniform numbers, row by row, and the distributions by their quantiles: so the first rows do not depend
    # on the number of runs, and a column not on the distributions of the others.
    probabilities = np.hstack(
        [
            np.random.default_rng(options.seed).random((options.runs, len(CONDITIONS))),
            np.random.default_rng((options.seed, 1)).random((options.runs, len(QUANTITIES) - len(CONDITIONS))),
        ]
    )
    shortest_distance_m = float(min(np.diff([0.0, *stop_positions_m(scenario)])))
    # an error of a whole section would put the train at another stop; the bound itself is excluded
    places = np.nextafter(-shortest_distance_m, 0), np.nextafter(shortest_distance_m, 0)
    bounds = {
        "load_factor": (0.0, _max_load(scenario)),
        "coordinate_error_m": places,
        "resistance_factor": FACTOR_BOUNDS,
        "line_voltage_factor": FACTOR_BOUNDS,
        "departure_delay_s": (0.0, LONGEST_DELAY_S),
        "speed_error": (np.nextafter(-MAX_SPEED_ERROR, 0), np.nextafter(MAX_SPEED_ERROR, 0)),
        **dict.fromkeys(SENSOR_ERRORS, places),
    }
    planned = planned_values(scenario)
    return {
        name: frozen_array(_truncated(name, getattr(options, name), planned[name], bounds[name], probabilities[:, k]))
        for k, name in enumerate(QUANTITIES)
    }


def _max_load(scenario: Scenario) -> float:
    """Return the largest load factor that may be drawn: of full trains, unless more is asked for."""
    load = scenario.montecarlo.load_factor
    named = [getattr(load, name, None) or 0.0 for name in ("value", "mean", "median", "mode", "high")]
    beyond = max(scenario.vehicle.load_share, *named) > 1
    return scenario.vehicle.crush_load_factor if beyond else 1.0


def _truncated(
    name: str, distribution: Distribution, planned: float, bounds: tuple[float, float], probabilities: FloatArray
) -> FloatArray:
    """Return the quantiles at `probabilities` of what a distribution has within the bounds."""
    low, high = bounds
    if isinstance(distribution, Fixed):
        if not low <= distribution.value <= high:
            value = distribution.value
            raise ScenarioError(f"montecarlo.{name}.value = {value:g} must lie within {low:g} to {high:g}.")
        return np.full(len(probabilities), distribution.value)
    known = _scipy_distribution(distribution, planned)
    first, last = known.cdf([low, high])
    # the inverse of the truncated distribution: no draw is rejected, so every run uses one number
    values: FloatArray = known.ppf(first + (last - first) * probabilities)
    if not (last > first and np.all(np.isfinite(values))):
        raise ScenarioError(f"montecarlo.{name}: the distribution has no values within {low:g} to {high:g}.")
    # ppf and cdf are inverse to each other only to rounding
    return np.clip(values, low, high)


def _scipy_distribution(distribution: Distribution, planned: float) -> Any:
    """Return a distribution of SciPy."""
    from scipy import stats  # noqa: PLC0415  (slow to import, and rarely needed)

    if isinstance(distribution, Uniform):
        return stats.uniform(distribution.low, distribution.high - distribution.low)
    if isinstance(distribution, Triangular):
        width = distribution.high - distribution.low
        return stats.triang((distribution.mode - distribution.low) / width, distribution.low, width)
    if isinstance(distribution, Normal):
        mean = planned if distribution.mean is None else distribution.mean
        return stats.norm(mean, distribution.standard_deviation)
    if isinstance(distribution, LogNormal):
        return stats.lognorm(distribution.log_standard_deviation, scale=distribution.median)
    return stats.expon(scale=distribution.mean)  # type: ignore[union-attr]


def _replanned_energies(scenario: Scenario, load_factors: FloatArray) -> FloatArray:
    """Return the energy [kWh] of plans for the actual load; NaN beyond the loads that have a plan."""
    # loads without a plan are left out, and np.interp must not extrapolate
    loads = (_max_load(scenario) * PLANNED_LOADS).tolist()
    planned = {load: plan_knowing_load(scenario, load) for load in loads}
    known = {load: plan.energy_kwh for load, plan in planned.items() if plan is not None}
    if not known:
        return np.full(len(load_factors), np.nan)
    return np.interp(load_factors, list(known), list(known.values()), left=np.nan, right=np.nan)
