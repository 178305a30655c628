"""Runs with set speeds, given or found by search, the optimum in their time, and the savings of a storage."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from railjoule.core import (
    RailjouleError,
    Scenario,
    ScenarioError,
    SolverError,
    StrategyRefusedError,
    TimetableError,
    Trajectory,
)
from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.limit_search.search import LimitSearch
from railjoule.core.scenario.drive import GearedMotors
from railjoule.core.strategies import prepare_task, run_strategy
from railjoule.core.strategies.line_parts import stop_nodes
from railjoule.core.strategies.set_speed_run import build_limit_problem, run_words
from railjoule.core.strategies.speed_limits import section_boundaries, speed_limits_with_search
from railjoule.core.studies.motor_map import MotorMap, OperatingPoints, motor_map, operating_points
from railjoule.core.studies.storage import (
    Storage,
    StorageNeed,
    StorageRun,
    saving_over_size,
    storage_need,
    with_storage,
)
from railjoule.core.studies.whole_line import nodes_at_stops
from railjoule.core.units import J_PER_KWH, MS_PER_KMH
from railjoule.dashboard.look.key_names import without_keys
from railjoule.dashboard.work.runs import named_refusals

LARGEST_SIZE_SHARE, SIZES = 1.5, 25
"""The curve of storages ends at this many times the size needed."""


@dataclass(frozen=True, eq=False)
class LimitRun:
    """A run under limits and the optimum over the same time.

    Parameters
    ----------
    run : Trajectory
    search : LimitSearch
        The search for its limits; only one trip if they were given.
    optimum : Trajectory or None
        In the time that the run takes.
    no_optimum : str
        Why there is none.
    need : StorageNeed
        The storage that the run needs.
    points : OperatingPoints or None
        Operating points of its motors; None for drives without them.
    """

    run: Trajectory
    search: LimitSearch
    optimum: Trajectory | None
    no_optimum: str
    need: StorageNeed
    points: OperatingPoints | None

    @property
    def limits_kmh(self) -> FloatArray:
        """Limits of the sections [km/h]."""
        return self.search.best.limits_ms / MS_PER_KMH

    @property
    def borders_m(self) -> FloatArray:
        """Borders between the sections [m]."""
        return self.search.best.boundaries_m


def compute_limit_run(scenario: Scenario, changes: Mapping[str, Any]) -> LimitRun:
    """Return the run under limits, given or found by search; `changes` has them by the keys of the file.

    Raises
    ------
    RailjouleError
        If a limit or border is out of bounds, the timetable cannot be kept or the line not be passed.
    """
    scenario = scenario.replace(**changes)
    with named_refusals(scenario):
        run, search = speed_limits_with_search(prepare_task(scenario))
    optimum, reason = optimum_over(scenario, run.travel_time_s)
    return LimitRun(
        run=run,
        search=search,
        optimum=optimum,
        no_optimum=reason,
        need=storage_need(run),
        points=operating_points(run) if isinstance(scenario.vehicle.drive, GearedMotors) else None,
    )


def optimum_over(scenario: Scenario, travel_time_s: float) -> tuple[Trajectory | None, str]:
    """Return the optimum of a scenario over another time, or None and why there is none."""
    try:
        task = prepare_task(scenario.replace(**{"timetable.travel_time_s": travel_time_s}))
        task.require_timetable()
        return run_strategy(task, "optimal"), ""
    # a scenario that is wrong in itself is no lack of an optimum: other errors go on
    except (TimetableError, SolverError, StrategyRefusedError) as refusal:
        return None, without_keys(str(refusal))


@dataclass(frozen=True, eq=False)
class InterStationRuns:
    """The inter-station runs of a line, searched each by itself and all together, over the same sections.

    Parameters
    ----------
    names : tuple of str
        From where to where each run goes.
    runs : mapping
        The whole run by the way in which it was searched, 'separate' or 'together'.
    refusals : mapping
        Why there is no such run.
    """

    names: tuple[str, ...]
    runs: Mapping[str, Trajectory]
    refusals: Mapping[str, str]


def compute_inter_station_runs(run: LimitRun) -> InterStationRuns:
    """Return a searched run beside that of the other way to search its inter-station runs."""
    scenario = run.run.scenario
    runs: dict[str, Trajectory] = {scenario.search.inter_station_runs: run.run}
    refusals: dict[str, str] = {}
    other = "together" if run.search.runs else "separate"
    changes = {"search.inter_station_runs": other, "search.boundaries_m": run.borders_m.tolist()}
    try:
        runs[other] = run_strategy(prepare_task(scenario.replace(**changes)), "speed_limits")
    except (ScenarioError, TimetableError, SolverError, StrategyRefusedError) as refusal:
        refusals[other] = without_keys(str(refusal))
    task = prepare_task(scenario)
    return InterStationRuns(tuple(run_words(task, k) for k in range(len(stop_nodes(task)) - 1)), runs, refusals)


def compute_counts(
    scenario: Scenario, changes: Mapping[str, Any], borders_m: Sequence[Sequence[float]]
) -> Iterator[tuple[tuple[Any, ...], Mapping[int, Trajectory]]]:
    """Yield the arguments, and the runs found by search over more and more sections that are not refused.

    Parameters
    ----------
    scenario : Scenario
    changes : mapping
        The settings of the search by the keys of the file.
    borders_m : sequence of sequence of float
        The borders of the sections for each run [m].
    """
    runs: dict[int, Trajectory] = {}
    for borders in borders_m:
        cut = scenario.replace(**{**changes, "search.boundaries_m": list(borders)})
        with suppress(TimetableError, SolverError, StrategyRefusedError):
            runs[len(borders) + 1] = run_strategy(prepare_task(cut), "speed_limits")
            yield (scenario, changes, borders_m), dict(runs)


def run_figures(run: Trajectory) -> tuple[FloatArray, FloatArray]:
    """Return the running times [s] and energies [kWh] of a run from stop to stop; shape (k,) each."""
    arrives, leaves = nodes_at_stops(run, np.array(run.scenario.line.in_running_order().stops_m))
    times, energies = (values[arrives[1:]] - values[leaves[:-1]] for values in (run.time_s, run.supply_energy_j))
    return times, energies / J_PER_KWH


@dataclass(frozen=True, eq=False)
class LimitTrip:
    """One trip under limits while they are moved.

    Parameters
    ----------
    position_m, speed_ms : array of shape (n,)
        Positions and speeds [m, m/s].
    energy_kwh, travel_time_s : float
        Energy at the line [kWh] and time [s].
    """

    position_m: FloatArray
    speed_ms: FloatArray
    energy_kwh: float
    travel_time_s: float


def compute_limit_trip(scenario: Scenario, changes: Mapping[str, Any]) -> LimitTrip | None:
    """Return the trip under limits given by the keys of the file, or None if only a whole run gives it.

    Raises
    ------
    RailjouleError
        If a limit or border is out of bounds or the line cannot be passed.
    """
    scenario = scenario.replace(**changes)
    limits, options = scenario.search.limits_kmh, scenario.search
    if limits is None or options.regulator == "literal":
        return None
    task = prepare_task(scenario)
    problem = build_limit_problem(task)
    given = np.array(limits) * MS_PER_KMH, section_boundaries(scenario)
    trip = problem.as_given(*given)
    if not np.isfinite(trip.running_time_s):
        return None
    position, speed2 = problem.place_nodes(*given)
    return LimitTrip(position, np.sqrt(speed2), trip.energy_j / J_PER_KWH, trip.running_time_s + task.dwell_s)


@dataclass(frozen=True, eq=False)
class StorageCurve:
    """Savings of storages of one power.

    Parameters
    ----------
    size_kwh, saved_kwh : array of shape (k,)
        Their capacities, and their savings against resistors [kWh].
    chosen : StorageRun
        With the storage asked for.
    need : StorageNeed
        The storage that the run needs.
    """

    size_kwh: FloatArray
    saved_kwh: FloatArray
    chosen: StorageRun
    need: StorageNeed


def compute_storage(
    run: LimitRun,
    size_kwh: float | None,
    power_kw: float | None,
    charging_efficiency: float,
    discharging_efficiency: float,
) -> StorageCurve:
    """Return the savings of storages over a run; size and power are those needed if none are given.

    Raises
    ------
    ScenarioError
        If a size or power is negative.
    """
    need, efficiencies = run.need, (charging_efficiency, discharging_efficiency)
    size = need.max_drop_kwh if size_kwh is None else size_kwh
    power = max(need.charging_peak_kw, need.discharging_peak_kw) if power_kw is None else power_kw
    # a run that never brakes needs no storage: the axis of sizes must still have a length
    sizes = np.linspace(0.0, max(LARGEST_SIZE_SHARE * need.max_drop_kwh, 1.1 * size, 1e-3), SIZES)
    return StorageCurve(
        size_kwh=frozen_array(sizes),
        saved_kwh=saving_over_size(run.run, sizes, power, *efficiencies),
        chosen=with_storage(run.run, Storage(size, power, *efficiencies)),
        need=need,
    )


@dataclass(frozen=True)
class MapRequest:
    """A scenario, compared with another one only by what the efficiency of its powertrain depends on."""

    scenario: Scenario = field(compare=False)
    drive: object
    traction: object
    braking: object


def compute_map(request: MapRequest) -> MotorMap | str:
    """Compute the efficiency of the powertrain, or return why its drive has none."""
    try:
        return motor_map(request.scenario)
    except RailjouleError as refusal:
        return str(refusal)
