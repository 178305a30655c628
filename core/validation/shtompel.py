"""The claims of Shtompel, Khvorost 2025, each with the numbers that support or refute it.

The paper prints a method and hardly any number. Train and line are assumed, so what counts here are ratios and signs.
The optimum beside which limits are judged is that of Bellman's recursion over the same time, window included.
"""

from collections.abc import Callable
from functools import cache, partial
from typing import Any

import numpy as np
from scipy.optimize import differential_evolution

from railjoule.core.arrays import BoolArray, FloatArray
from railjoule.core.drive import make_drive
from railjoule.core.drive.synchronous.drive import efficiency_maps, torque_envelope
from railjoule.core.energy import share_above
from railjoule.core.limit_search.search import INFEASIBLE_J, LimitSearch
from railjoule.core.scenario import Scenario, load_scenario
from railjoule.core.scenario.drive import Synchronous
from railjoule.core.simulate.regulator import literal_spread
from railjoule.core.strategies import solve
from railjoule.core.strategies.set_speed_run import build_limit_problem
from railjoule.core.strategies.speed_limits import speed_limits_with_search
from railjoule.core.studies.storage import storage_need
from railjoule.core.task import prepare_task
from railjoule.core.trajectory import Trajectory
from railjoule.core.units import J_PER_KWH, MS_PER_KMH, W_PER_KW
from railjoule.core.validation.papers import citation, errata, printed_numbers
from railjoule.core.validation.table import Comparison, Row, Table, Validation

SCENARIOS = {20: "kharkiv-like-20kmh", 40: "kharkiv-like-40kmh"}
TIGHT_KMH = 54
MAP_POINTS = 120
FULL_SHARE = 0.97
MAJORITY_PERCENT = 50.0
# two searches end in the same minimum if their energies differ by less: the share to which ours is determined
SAME_ENERGY = 1e-3
# an efficiency that falls to zero with the torque halves with it, one that does not stays: the mean of 0.5 and 1
SMALL_TORQUE, MOSTLY_GONE = 1e-3, 0.75
TIME_STEPS_S = (0.1, 0.05, 0.02, 0.01)
FREE = {"search.boundaries_m": [800, 1600], "search.free_boundaries": True}
ASSUMED = "Train and line are assumed."
SUPPORTED, REFUTED = "Supports the claim.", "Refutes the claim."

Printed = dict[str, Any]


def validate_shtompel() -> Validation:
    """Return the paper's claims beside numbers of the assumed train and line."""
    return shtompel_comparison().validation()


def shtompel_comparison() -> Comparison:
    """Return what is to be compared of Shtompel, Khvorost 2025."""
    paper = printed_numbers("shtompel-2025")
    claims = {claim["name"]: claim for claim in paper["claim"]}
    return Comparison(
        paper="shtompel",
        citation=citation(paper),
        tables=(
            partial(_table, claims["efficiency"], efficiency),
            partial(_table, claims["fewest_evaluations"], evaluations),
            partial(_table, claims["near_full_effort"], near_full_effort),
            partial(_table, claims["regenerative_stop"], regenerative_stop),
            partial(_table, claims["storage_size"], storage_sizes),
            partial(_table, claims["near_full_power"], near_full_power),
            lambda: Table("Extra energy of set speeds over the optimum in the same time", tuple(costs())),
            lambda: Table("The printed regulator depends on its time step", tuple(spread())),
            lambda: Table("Braking by (8) and (9) as they are printed", tuple(literal_braking())),
        ),
        errata=errata(paper),
    )


def efficiency() -> list[Row]:
    """Return peaks and ends of the efficiency maps of motor and drive."""
    drive = _scenario(20).vehicle.drive
    assert isinstance(drive, Synchronous)
    speed = np.linspace(0.0, drive.max_speed_rads, MAP_POINTS)
    torque = np.linspace(0.0, float(torque_envelope(drive, speed).max()), MAP_POINTS)
    maps = efficiency_maps(drive, torque, speed)
    # without torque or speed both are 0, whatever is lost
    least = float(np.nanmin((maps.motor - maps.drive)[1:, 1:]))
    little = torque[-1] * np.array([SMALL_TORQUE, 0.5 * SMALL_TORQUE])
    near = [float(np.nanmax(row)) for row in efficiency_maps(drive, little, speed).drive]
    return [
        Row("motor", "greatest efficiency", "", None, float(np.nanmax(maps.motor)), ASSUMED),
        Row("drive", "greatest efficiency", "", None, float(np.nanmax(maps.drive)), ASSUMED),
        Row("motor less drive", "least difference", "", None, least, SUPPORTED if least > 0 else REFUTED),
        *(
            Row(
                f"drive at {100 * share:g} % of its torque",
                "greatest efficiency",
                "",
                None,
                value,
                SUPPORTED if near[1] < MOSTLY_GONE * near[0] else REFUTED,
            )
            for share, value in zip((SMALL_TORQUE, 0.5 * SMALL_TORQUE), near, strict=True)
        ),
    ]


def evaluations() -> list[Row]:
    """Return how many trips' vectors the search looks at, and another method for the same energy."""
    rows = []
    for speed in SCENARIOS:
        search = _search(speed, "coast")
        window = _scenario(speed).search.time_window
        task = prepare_task(_scenario(speed))
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
        rows += [
            Row(case, "combinations that the search tries", "", None, len(search.evaluations)),
            Row(case, "samples within the window before they are scaled", "%", None, 100 * inside),
            Row(case, "combinations that differential evolution tries", "", None, int(other.nfev)),
            Row(
                case,
                "its energy over ours less 1",
                "%",
                None,
                100 * share_above(float(other.fun), search.best.energy_j),
                _search_judged(float(other.fun), search.best.energy_j),
            ),
        ]
    return rows


def near_full_effort() -> list[Row]:
    """Return how much of the traction energy is taken at full effort, by limits and by the optimum."""
    rows = []
    for speed in SCENARIOS:
        for case, run in (("two sections, coast", _limits(speed, "coast")), ("optimum", _optimum(speed))):
            share = 100 * _full_share(run)
            note = _judged_by_majority(share) if case == "optimum" else ASSUMED
            rows.append(Row(f"{speed} km/h, {case}", "traction energy at full effort", "%", None, share, note))
    return rows


def regenerative_stop() -> list[Row]:
    """Return what the electric brake brings back."""
    rows = []
    for speed in SCENARIOS:
        run = _limits(speed, "coast")
        share = 100 * run.energy.recuperated_j / run.energy.traction_j
        note = SUPPORTED if share > 0 else REFUTED
        rows.append(Row(f"{speed} km/h, two sections", "recuperated, of the energy drawn", "%", None, share, note))
    return rows


def storage_sizes() -> list[Row]:
    """Return the largest drops of cumulative energy."""
    rows = []
    for speed in SCENARIOS:
        runs = {
            "brake limits": _limits(speed, "brake"),
            "coast limits, two sections": _limits(speed, "coast"),
            "optimum": _optimum(speed),
        }
        needed = storage_need(runs["optimum"]).largest_drop_kwh
        for case, run in runs.items():
            drop = storage_need(run).largest_drop_kwh
            note = ASSUMED if run is runs["optimum"] else f"{drop / needed:.1f} times what the optimum needs."
            rows.append(Row(f"{speed} km/h, {case}", "largest drop", "kWh", None, drop, note))
    return rows


def near_full_power() -> list[Row]:
    """Return the optimum's largest power, and what a drive of half the power would cost more."""
    rows = []
    for speed in (*SCENARIOS, TIGHT_KMH):
        scenario = _scenario(speed)
        full = _optimum(speed)
        power = scenario.vehicle.traction.max_power_kw
        assert power is not None
        half = solve(_late(scenario).with_(**{"vehicle.traction.max_power_kw": 0.5 * power}), "bellman")
        speeds = 0.5 * (full.speed_ms[1:] + full.speed_ms[:-1])
        at_wheels_kw = full.tractive_effort_n * speeds / W_PER_KW
        largest, share = float(np.max(at_wheels_kw)), 100 * _energy_share(full, at_wheels_kw > FULL_SHARE * power)
        more = 100 * share_above(half.energy_kwh, full.energy_kwh)
        case = f"{speed} km/h, optimum"
        close = SUPPORTED if largest > FULL_SHARE * power else REFUTED
        rows += [
            Row(case, "largest power at the wheels", "kW", None, largest, close),
            Row(case, "traction energy at full power", "%", None, share, f"{100 - share:.0f} % of it at less power."),
            Row(case, "more energy with half the power", "%", None, more, ASSUMED),
        ]
    return rows


def costs() -> list[Row]:
    """Return energies under limits over that of the optimum."""
    rows = []
    for speed in SCENARIOS:
        best = _optimum(speed).energy_kwh
        rows.append(Row(f"{speed} km/h, optimum", "energy", "kWh", None, best, ASSUMED))
        runs = {
            "brake limits, two sections": _limits(speed, "brake"),
            "coast limits, two sections": _limits(speed, "coast"),
            "coast limits, three sections, free section ends": _limits(speed, "coast", True),
        }
        for case, run in runs.items():
            more = 100 * share_above(run.energy_kwh, best)
            rows.append(Row(f"{speed} km/h, {case}", "more than the optimum", "%", None, more, ASSUMED))
    return rows


def spread() -> list[Row]:
    """Return the printed regulator's energies and times with different steps of time."""
    limits = [limit / MS_PER_KMH for limit in _search(40, "literal").best.limits_ms]
    rows = []
    for run in literal_spread(_scenario(40), limits, TIME_STEPS_S):
        case = f"40 km/h, steps of {run.time_step_s:g} s"
        refusal = f"No run: it {run.refusal}" if run.refusal else ""
        rows.append(Row(case, "energy", "kWh", None, run.energy_kwh, refusal))
        rows.append(Row(case, "time", "s", None, run.travel_time_s, refusal))
    return rows


def literal_braking() -> list[Row]:
    """Return what the brake brings back by the printed formulas: power over efficiency, and a gear that gives power."""
    run = _limits(40, "brake")
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
    return [
        Row(case, "work that the wheels supply", "kWh", None, supplied),
        Row(case, "recuperated by (8) and (9)", "kWh", None, by_print, note if by_print > supplied else ""),
        Row(case, "recuperated", "kWh", None, float(np.sum(generated * duration)) / J_PER_KWH),
    ]


def _table(claim: Printed, rows: Callable[[], list[Row]]) -> Table:
    return Table(claim["text"].rstrip("."), tuple(rows()), claim["place"])


def _judged_by_majority(share_percent: float) -> str:
    """Judge a claim of how most of the energy is taken; the paper gives no number for 'close to' and 'small'."""
    return SUPPORTED if share_percent > MAJORITY_PERCENT else REFUTED


def _search_judged(other_j: float, ours_j: float) -> str:
    if ours_j <= other_j * (1 + SAME_ENERGY):
        return "An even search over one ratio is enough here; this says nothing about more sections."
    return "The other method finds less: an even search over one ratio is not enough."


def _full_share(run: Trajectory) -> float:
    """Return the share of traction energy that is taken at full effort."""
    return _energy_share(run, run.tractive_effort_n > FULL_SHARE * run.largest_effort_n)


def _energy_share(run: Trajectory, cells: BoolArray) -> float:
    """Return the share of traction energy that is taken in some of the cells."""
    # auxiliaries flow while the train coasts, brakes and stands as well, and are no traction then
    energy = np.maximum(run.line_power_w, 0.0) * np.diff(run.time_s) * (run.tractive_effort_n > 0)
    return float(np.sum(energy[cells]) / np.sum(energy))


def _scenario(speed_kmh: int) -> Scenario:
    if speed_kmh in SCENARIOS:
        return load_scenario(SCENARIOS[speed_kmh])
    return load_scenario(SCENARIOS[40]).with_(**{"timetable.average_speed_kmh": speed_kmh})


def _late(scenario: Scenario) -> Scenario:
    """Return a scenario with the time that a search for limits may take."""
    # what limits are judged by may take as long as they do
    time = (1 + scenario.search.time_window) * scenario.travel_time_s
    return scenario.with_(**{"timetable.travel_time_s": time})


@cache
def _optimum(speed_kmh: int) -> Trajectory:
    return solve(_late(_scenario(speed_kmh)), "bellman")


@cache
def _searched(speed_kmh: int, regulator: str, free: bool) -> tuple[Trajectory, LimitSearch]:
    changes: dict[str, Any] = {"search.regulator": regulator} | (FREE if free else {})
    return speed_limits_with_search(prepare_task(_scenario(speed_kmh).with_(**changes)))


def _limits(speed_kmh: int, regulator: str, free: bool = False) -> Trajectory:
    return _searched(speed_kmh, regulator, free)[0]


def _search(speed_kmh: int, regulator: str) -> LimitSearch:
    return _searched(speed_kmh, regulator, False)[1]
