"""Numbers of Shtompel, Khvorost 2025 for tables and claims, each computed once.

The paper prints a method and hardly any number. Train and line are assumed, so what counts here are ratios and signs.
The optimum beside which limits are judged is that of Bellman's recursion over the same time, window included.
"""

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from scipy.optimize import differential_evolution

from railjoule.core.arrays import BoolArray, FloatArray
from railjoule.core.drive import make_drive
from railjoule.core.drive.synchronous.drive import EfficiencyMaps, efficiency_maps, torque_envelope
from railjoule.core.energy import share_above
from railjoule.core.errors import StrategyRefusedError
from railjoule.core.limit_search.search import INFEASIBLE_J, LimitSearch
from railjoule.core.scenario import Scenario, load_scenario
from railjoule.core.scenario.drive import Synchronous
from railjoule.core.strategies import run_strategy, solve
from railjoule.core.strategies.set_speed_run import build_limit_problem
from railjoule.core.strategies.speed_limits import speed_limits_with_search
from railjoule.core.studies.storage import storage_need
from railjoule.core.task import prepare_task
from railjoule.core.trajectory import Trajectory
from railjoule.core.units import J_PER_KWH, MS_PER_KMH, W_PER_KW
from railjoule.core.validation.table import Row

SCENARIOS = {20: "kharkiv-like-20kmh", 40: "kharkiv-like-40kmh"}
TIGHT_KMH = 54
MAP_POINTS = 120
FULL_SHARE = 0.97
SMALL_TORQUE = 1e-3
"""Near zero, over the largest torque of the drive."""
TIME_STEPS_S = (0.1, 0.05, 0.02, 0.01)
FREE = {"search.boundaries_m": [800, 1600], "search.free_boundaries": True}
ASSUMED = "Train and line are assumed."


@cache
def efficiency() -> tuple[Row, ...]:
    """Return peaks and ends of the efficiency maps of motor and drive."""
    maps = map_efficiency()
    # without torque or speed both are 0, whatever is lost
    least = float(np.nanmin((maps.motor - maps.drive)[1:, 1:]))
    little = maps.torque_nm[-1] * np.array([SMALL_TORQUE, 0.5 * SMALL_TORQUE])
    near = [float(np.nanmax(row)) for row in efficiency_maps(metro_drive(), little, maps.speed_rads).drive]
    return (
        Row("motor", "greatest efficiency", "", None, float(np.nanmax(maps.motor)), ASSUMED),
        Row("drive", "greatest efficiency", "", None, float(np.nanmax(maps.drive)), ASSUMED),
        Row("motor less drive", "least difference", "", None, least, ASSUMED),
        *(
            Row(f"drive at {100 * share:g} % of its torque", "greatest efficiency", "", None, value, ASSUMED)
            for share, value in zip((SMALL_TORQUE, 0.5 * SMALL_TORQUE), near, strict=True)
        ),
    )


@cache
def evaluations() -> tuple[Row, ...]:
    """Return how many trips' vectors the search looks at, and another method for the same energy."""
    rows = []
    for speed in SCENARIOS:
        search = search_run(speed, "coast")
        window = kharkiv_scenario(speed).search.time_window
        task = prepare_task(kharkiv_scenario(speed))
        problem = build_limit_problem(task)
        samples = [one for one in search.evaluations if one.stage == "sample"]
        borders = search.best.boundaries_m
        # as they were drawn: `evaluate` would scale them to the time
        times = np.array([problem.as_given(one.unscaled_ms, borders).running_time_s for one in samples])
        inside = float(np.mean(np.abs(times / task.running_time_s - 1) <= window))

        def cost(place: FloatArray, problem: Any = problem, borders: FloatArray = borders) -> float:
            return float(min(problem.evaluate("sample", place, borders).energy_j, INFEASIBLE_J))

        bounds = [(problem.least_ms, problem.most_ms)] * (len(borders) + 1)
        # the same seed each time, as its numbers are shown
        other = differential_evolution(cost, bounds, seed=1, maxiter=20, polish=False)
        case = f"{speed} km/h, two sections"
        more = 100 * share_above(float(other.fun), search.best.energy_j)
        rows += [
            Row(case, "combinations that the search tries", "", None, len(search.evaluations)),
            Row(case, "samples within the window before they are scaled", "%", None, 100 * inside),
            Row(case, "combinations that differential evolution tries", "", None, int(other.nfev)),
            Row(case, "its energy over that of the search less 1", "%", None, more),
        ]
    return tuple(rows)


@cache
def near_full_effort() -> tuple[Row, ...]:
    """Return how much of the traction energy is taken at full effort, by limits and by the optimum."""
    rows = []
    for speed in SCENARIOS:
        for case, run in (("two sections, coast", run_limits(speed, "coast")), ("optimum", solve_optimum(speed))):
            share = 100 * full_share(run)
            rows.append(Row(f"{speed} km/h, {case}", "traction energy at full effort", "%", None, share, ASSUMED))
    return tuple(rows)


@cache
def regenerative_stop() -> tuple[Row, ...]:
    """Return the energy that the electric brake returns."""
    rows = []
    for speed in SCENARIOS:
        run = run_limits(speed, "coast")
        share = 100 * run.energy.recuperated_j / run.energy.traction_j
        rows.append(Row(f"{speed} km/h, two sections", "recuperated, of the energy drawn", "%", None, share, ASSUMED))
    return tuple(rows)


@cache
def storage_sizes() -> tuple[Row, ...]:
    """Return the largest drops of cumulative energy."""
    rows = []
    for speed in SCENARIOS:
        runs = {
            "brake limits": run_limits(speed, "brake"),
            "coast limits, two sections": run_limits(speed, "coast"),
            "optimum": solve_optimum(speed),
        }
        needed = storage_need(runs["optimum"]).largest_drop_kwh
        for case, run in runs.items():
            drop = storage_need(run).largest_drop_kwh
            note = ASSUMED if run is runs["optimum"] else f"{drop / needed:.1f} times what the optimum needs."
            rows.append(Row(f"{speed} km/h, {case}", "largest drop", "kWh", None, drop, note))
    return tuple(rows)


@cache
def near_full_power() -> tuple[Row, ...]:
    """Return the optimum's largest power, and what a drive of half the power would cost more."""
    rows = []
    for speed in (*SCENARIOS, TIGHT_KMH):
        scenario = kharkiv_scenario(speed)
        full = solve_optimum(speed)
        power = scenario.vehicle.traction.max_power_kw
        assert power is not None
        half = solve(allow_window(scenario).replace(**{"vehicle.traction.max_power_kw": 0.5 * power}), "bellman")
        speeds = 0.5 * (full.speed_ms[1:] + full.speed_ms[:-1])
        at_wheels_kw = full.tractive_effort_n * speeds / W_PER_KW
        largest, share = float(np.max(at_wheels_kw)), 100 * energy_share(full, at_wheels_kw > FULL_SHARE * power)
        more = 100 * share_above(half.energy_kwh, full.energy_kwh)
        case = f"{speed} km/h, optimum"
        rows += [
            Row(case, "largest power at the wheels", "kW", None, largest, ASSUMED),
            Row(case, "traction energy at full power", "%", None, share, f"{100 - share:.0f} % of it at less power."),
            Row(case, "more energy with half the power", "%", None, more, ASSUMED),
        ]
    return tuple(rows)


@cache
def costs() -> tuple[Row, ...]:
    """Return energies under limits over that of the optimum."""
    rows = []
    for speed in SCENARIOS:
        best = solve_optimum(speed).energy_kwh
        rows.append(Row(f"{speed} km/h, optimum", "energy", "kWh", None, best, ASSUMED))
        runs = {
            "brake limits, two sections": run_limits(speed, "brake"),
            "coast limits, two sections": run_limits(speed, "coast"),
            "coast limits, three sections, free section ends": run_limits(speed, "coast", True),
        }
        for case, run in runs.items():
            more = 100 * share_above(run.energy_kwh, best)
            rows.append(Row(f"{speed} km/h, {case}", "more than the optimum", "%", None, more, ASSUMED))
    return tuple(rows)


@cache
def spread() -> tuple[Row, ...]:
    """Return the printed regulator's energies and times with different steps of time."""
    limits = [limit / MS_PER_KMH for limit in search_run(40, "literal").best.limits_ms]
    rows = []
    for step in TIME_STEPS_S:
        try:
            run = literal_run(limits, step)
            found, refusal = (run.energy_kwh, run.travel_time_s), ""
        except StrategyRefusedError as error:
            found, refusal = (np.nan, np.nan), f"No run: it {error}"
        case = f"40 km/h, steps of {step:g} s"
        rows.append(Row(case, "energy", "kWh", None, found[0], refusal))
        rows.append(Row(case, "time", "s", None, found[1], refusal))
    return tuple(rows)


def literal_run(limits_kmh: list[float], time_step_s: float) -> Trajectory:
    """Return the run of the printed regulator at 40 km/h; raises StrategyRefusedError where it drives none."""
    search = {"search.limits_kmh": limits_kmh, "search.regulator": "literal", "search.time_step_s": time_step_s}
    return run_strategy(prepare_task(kharkiv_scenario(40).replace(**search)), "speed_limits")


@cache
def literal_braking() -> tuple[Row, ...]:
    """Return the braking energy by the printed formulas: power over efficiency, and a gear that gives power."""
    run = run_limits(40, "brake")
    drive = make_drive(run.scenario.vehicle.drive)
    share = run.scenario.vehicle.drive.gear_loss_share  # type: ignore[union-attr]
    duration, length = np.diff(run.time_s), np.diff(run.position_m)
    speed = length / duration
    wheel = run.electric_braking_n * speed
    generated = np.maximum(-drive.electrical_power_w(-run.electric_braking_n, speed), 0.0)
    useful = generated > 0
    # (8) and (9) divide by the efficiency and add the gear's loss, as if in driving
    efficiency = generated[useful] / (wheel[useful] * (1 - share))
    printed = np.sum((wheel[useful] / efficiency + share * wheel[useful]) * duration[useful])
    case = "40 km/h, brake limits"
    supplied, by_print = float(np.sum(wheel * duration)) / J_PER_KWH, float(printed) / J_PER_KWH
    note = "More than the wheels supply: in braking, power is multiplied by the efficiency."
    return (
        Row(case, "work that the wheels supply", "kWh", None, supplied),
        Row(case, "recuperated by (8) and (9)", "kWh", None, by_print, note if by_print > supplied else ""),
        Row(case, "recuperated", "kWh", None, float(np.sum(generated * duration)) / J_PER_KWH),
    )


def full_share(run: Trajectory) -> float:
    """Return the share of traction energy that is taken at full effort."""
    return energy_share(run, run.tractive_effort_n > FULL_SHARE * run.largest_effort_n)


def energy_share(run: Trajectory, cells: BoolArray) -> float:
    """Return the share of traction energy that is taken in some of the cells."""
    # auxiliaries flow while the train coasts, brakes and stands as well, and are no traction then
    energy = np.maximum(run.line_power_w, 0.0) * np.diff(run.time_s) * (run.tractive_effort_n > 0)
    return float(np.sum(energy[cells]) / np.sum(energy))


@dataclass(frozen=True, eq=False)
class DrivingEfficiency:
    """Efficiency of the drive in the cells of a run in which it drives; arrays of shape (k,).

    Parameters
    ----------
    efficiency : array
        Power of the shafts over that of the intermediate circuit.
    energy_j : array
        Energy of the intermediate circuit [J].
    """

    efficiency: FloatArray
    energy_j: FloatArray

    def energy_share_above(self, efficiency: float) -> float:
        """Return the share of the energy that is taken at more than an efficiency."""
        return float(np.sum(self.energy_j[self.efficiency > efficiency]) / np.sum(self.energy_j))


def driving_efficiency(run: Trajectory) -> DrivingEfficiency:
    """Return the efficiency of motors and inverters along a run."""
    parameters = run.scenario.vehicle.drive
    assert isinstance(parameters, Synchronous)
    duration, length = np.diff(run.time_s), np.diff(run.position_m)
    moving = duration > 0
    speed, effort = length[moving] / duration[moving], run.tractive_effort_n[moving]
    power = make_drive(parameters).electrical_power_w(effort, speed)
    # an effort of rounding takes no power
    driving = (effort > 0) & (power > 0)
    shaft = effort * speed * (1 + parameters.gear_loss_share)
    return DrivingEfficiency(shaft[driving] / power[driving], (power * duration[moving])[driving])


def metro_drive() -> Synchronous:
    """Return the drive of the assumed train."""
    drive = kharkiv_scenario(20).vehicle.drive
    assert isinstance(drive, Synchronous)
    return drive


@cache
def map_efficiency() -> EfficiencyMaps:
    """Return the efficiency maps of motor and drive in driving, up to the largest torque."""
    drive = metro_drive()
    speed = np.linspace(0.0, drive.max_speed_rads, MAP_POINTS)
    torque = np.linspace(0.0, float(torque_envelope(drive, speed).max()), MAP_POINTS)
    return efficiency_maps(drive, torque, speed)


def kharkiv_scenario(speed_kmh: int) -> Scenario:
    """Return the run of the assumed line at an average speed [km/h]."""
    if speed_kmh in SCENARIOS:
        return load_scenario(SCENARIOS[speed_kmh])
    return load_scenario(SCENARIOS[40]).replace(**{"timetable.average_speed_kmh": speed_kmh})


def allow_window(scenario: Scenario) -> Scenario:
    """Return a scenario with the time that a search for limits may take."""
    # what limits are judged by may take as long as they do
    time = (1 + scenario.search.time_window) * scenario.travel_time_s
    return scenario.replace(**{"timetable.travel_time_s": time})


@cache
def solve_optimum(speed_kmh: int) -> Trajectory:
    """Return the run of least energy, as late as limits may be."""
    return solve(allow_window(kharkiv_scenario(speed_kmh)), "bellman")


@cache
def _searched(speed_kmh: int, regulator: str, free: bool, rail_condition: str | None) -> tuple[Trajectory, LimitSearch]:
    changes: dict[str, Any] = {"search.regulator": regulator, "line.rail_condition": rail_condition}
    return speed_limits_with_search(
        prepare_task(kharkiv_scenario(speed_kmh).replace(**changes, **FREE if free else {}))
    )


def run_limits(speed_kmh: int, regulator: str, free: bool = False) -> Trajectory:
    """Return the run under the best limits of two sections, or of three whose ends are free."""
    return _searched(speed_kmh, regulator, free, None)[0]


def search_run(speed_kmh: int, regulator: str, rail_condition: str | None = None) -> LimitSearch:
    """Return the search for the limits of two sections."""
    return _searched(speed_kmh, regulator, False, rail_condition)[1]
