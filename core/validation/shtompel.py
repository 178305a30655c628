"""Quantities of Shtompel, Khvorost 2025 that `assets/papers/shtompel-2025.toml` compares with the paper.

The paper prints a method and hardly any number. Train and line are assumed, so ratios and signs count.
The reference of limits is the optimum of Bellman's recursion over the same time, window included.
"""

from functools import cache
from typing import Any

import numpy as np
from scipy.optimize import differential_evolution

from railjoule.core.arrays import BoolArray, FloatArray
from railjoule.core.drive import make_drive
from railjoule.core.drive.synchronous.drive import LOSS_KINDS, EfficiencyMaps, efficiency_maps, torque_envelope
from railjoule.core.drive.synchronous.losses import MOTOR_KINDS
from railjoule.core.energy import share_above
from railjoule.core.errors import StrategyRefusedError
from railjoule.core.limit_search.search import INFEASIBLE_J, LimitSearch
from railjoule.core.physics.resistance import total_weight_kn
from railjoule.core.scenario import Scenario, load_scenario
from railjoule.core.strategies import run_strategy, solve
from railjoule.core.strategies.set_speed_run import build_limit_problem
from railjoule.core.strategies.speed_limits import speed_limits_with_search
from railjoule.core.studies.storage import saving_over_size, storage_need
from railjoule.core.task import prepare_task
from railjoule.core.trajectory import Trajectory
from railjoule.core.units import J_PER_KWH, MS_PER_KMH, W_PER_KW

Quantities = dict[str, Any]

SCENARIOS = {20: "kharkiv-like-20kmh", 40: "kharkiv-like-40kmh"}
MAP_POINTS = 120
FULL_SHARE = 0.97
"""Effort and power above this share of the maximum count as full."""
SMALL_TORQUE = 1e-3
"""Near zero, over the largest torque of the drive."""
TIME_STEPS_S = (0.1, 0.05, 0.02, 0.01)
FREE = {"search.boundaries_m": [800, 1600], "search.free_boundaries": True}
NEAR_BEST_SHARE = 0.02
"""Efficiencies this close to the largest count as close to it; the paper gives no number."""
LOADED_SHARE = 0.1
"""Shares of losses are compared where the shaft has at least this share of its largest power."""
UNLIMITED_KW = 1e6


def kharkiv_scenario(speed_kmh: int) -> Scenario:
    """Return the run of the assumed line at an average speed [km/h]."""
    if speed_kmh in SCENARIOS:
        return load_scenario(SCENARIOS[speed_kmh])
    return load_scenario(SCENARIOS[40]).replace(**{"timetable.average_speed_kmh": speed_kmh})


def allow_window(scenario: Scenario) -> Scenario:
    """Return a scenario with the time that a search for limits may take."""
    time = (1 + scenario.search.time_window) * scenario.travel_time_s
    return scenario.replace(**{"timetable.travel_time_s": time})


@cache
def solve_optimum(speed_kmh: int) -> Trajectory:
    """Return the run of least energy, as late as limits may be."""
    return solve(allow_window(kharkiv_scenario(speed_kmh)), "bellman")


@cache
def search_limits(
    speed_kmh: int, regulator: str, free: bool = False, rail_condition: str | None = None
) -> tuple[Trajectory, LimitSearch]:
    """Return the run under the best limits of two sections, or of three whose ends are free, with their search."""
    changes: Quantities = {"search.regulator": regulator, "line.rail_condition": rail_condition}
    return speed_limits_with_search(
        prepare_task(kharkiv_scenario(speed_kmh).replace(**changes, **FREE if free else {}))
    )


@cache
def map_efficiency() -> EfficiencyMaps:
    """Return the efficiency maps of motor and drive in driving, up to the largest torque."""
    drive: Any = kharkiv_scenario(20).vehicle.drive
    speed = np.linspace(0.0, drive.max_speed_rads, MAP_POINTS)
    torque = np.linspace(0.0, float(torque_envelope(drive, speed).max()), MAP_POINTS)
    return efficiency_maps(drive, torque, speed)


@cache
def efficiency() -> Quantities:
    """Compute peaks and ends of the efficiency maps, and the share of harmonics in the losses of the motor."""
    maps = map_efficiency()
    drive: Any = kharkiv_scenario(20).vehicle.drive
    little = maps.torque_nm[-1] * np.array([SMALL_TORQUE, 0.5 * SMALL_TORQUE])
    near = [float(np.nanmax(row)) for row in efficiency_maps(drive, little, maps.speed_rads).drive]
    rest, top = torque_envelope(drive, maps.speed_rads[[0, -1]])
    shaft, losses = np.outer(maps.torque_nm, maps.speed_rads), maps.losses_w[..., :MOTOR_KINDS].sum(axis=-1)
    loaded = np.isfinite(losses) & (shaft >= LOADED_SHARE * np.max(shaft[np.isfinite(losses)]))
    share = 100 * maps.losses_w[..., LOSS_KINDS.index("harmonics")][loaded] / losses[loaded]
    return {
        "motor": float(np.nanmax(maps.motor)),
        "drive": float(np.nanmax(maps.drive)),
        "motor_less_drive": np.nanmax(maps.motor) - np.nanmax(maps.drive),
        # without torque or speed both are 0, whatever is lost
        "least_difference": float(np.nanmin((maps.motor - maps.drive)[1:, 1:])),
        "near": near,
        "near_ratio": near[1] / near[0],
        "torque_nm": (rest, top),
        "torque_lost_nm": rest - top,
        "top_rads": maps.speed_rads[-1],
        "harmonics": (share.min(), share.max(), np.median(share)),
    }


@cache
def evaluations(speed_kmh: int) -> Quantities:
    """Count the vectors that the search tries, and those of another method for the same energy."""
    search, scenario = search_limits(speed_kmh, "coast")[1], kharkiv_scenario(speed_kmh)
    task = prepare_task(scenario)
    problem, borders = build_limit_problem(task), search.best.boundaries_m
    samples = [one for one in search.evaluations if one.stage == "sample"]
    # as they were drawn: `evaluate` would scale them to the time
    times = np.array([problem.as_given(one.unscaled_ms, borders).running_time_s for one in samples])

    def cost(place: FloatArray) -> float:
        return float(min(problem.evaluate("sample", place, borders).energy_j, INFEASIBLE_J))

    bounds = [(problem.min_ms, problem.most_ms)] * (len(borders) + 1)
    # the same seed each time, as its numbers are shown
    other = differential_evolution(cost, bounds, seed=1, maxiter=20, polish=False)
    return {
        "tried": len(search.evaluations),
        "inside_percent": 100 * float(np.mean(np.abs(times / task.running_time_s - 1) <= scenario.search.time_window)),
        "other_tried": int(other.nfev),
        "other_more": 100 * share_above(float(other.fun), search.best.energy_j),
    }


def both_evaluations() -> Quantities:
    """Compare both searches at 20 and 40 km/h."""
    both = {f"at_{speed}": evaluations(speed) for speed in SCENARIOS}
    excess = max(one["tried"] - one["other_tried"] for one in both.values())
    return {**both, "excess": excess, "most": max(abs(one["other_more"]) for one in both.values())}


def _effort_share(run: Trajectory, cells: BoolArray) -> float:
    """Return the share of traction energy in some of the cells [%]."""
    # auxiliaries flow while the train coasts, brakes and stands as well, and are no traction then
    energy = np.maximum(run.supply_power_w, 0.0) * np.diff(run.time_s) * (run.tractive_effort_n > 0)
    return 100 * float(np.sum(energy[cells]) / np.sum(energy))


def _near_best_share(run: Trajectory) -> float:
    """Return the share of the energy of the intermediate circuit near the largest efficiency of the drive [%]."""
    drive: Any = run.scenario.vehicle.drive
    duration, length = np.diff(run.time_s), np.diff(run.position_m)
    moving = duration > 0
    speed, effort = length[moving] / duration[moving], run.tractive_effort_n[moving]
    power = make_drive(drive).electrical_power_w(effort, speed)
    # an effort of rounding takes no power
    driving = (effort > 0) & (power > 0)
    shaft, energy = effort * speed * (1 + drive.gear_loss_share), (power * duration[moving])[driving]
    near = shaft[driving] / power[driving] > efficiency()["drive"] - NEAR_BEST_SHARE
    return 100 * float(np.sum(energy[near]) / np.sum(energy))


@cache
def driving(speed_kmh: int) -> Quantities:
    """Compute energies and shares of the optimum and of runs under the best limits, and the best efficiency."""
    best, scheduled = solve_optimum(speed_kmh), kharkiv_scenario(speed_kmh).travel_time_s
    runs = {
        "optimum": best,
        "coast": search_limits(speed_kmh, "coast")[0],
        "brake": search_limits(speed_kmh, "brake")[0],
        "free": search_limits(speed_kmh, "coast", free=True)[0],
    }
    drops = {name: storage_need(run).max_drop_kwh for name, run in runs.items()}
    shares = {
        name: _effort_share(run, run.tractive_effort_n > FULL_SHARE * run.max_effort_n) for name, run in runs.items()
    }
    found: Quantities = {
        name: {
            "energy_kwh": run.energy_kwh,
            "more": 100 * share_above(run.energy_kwh, best.energy_kwh),
            "full_effort": shares[name],
            "partial_effort": max(100 - shares[name], 0.0),
            "near_best": _near_best_share(run),
            "recuperated": 100 * run.energy.recuperated_j / run.energy.traction_j,
            "drop_kwh": drops[name],
            "drop_ratio": drops[name] / drops["optimum"],
            "time_share": run.travel_time_s / scheduled,
        }
        for name, run in runs.items()
    }
    return {**found, "best": efficiency()["drive"]}


def both_speeds() -> Quantities:
    """Return the quantities of driving at 20 and 40 km/h."""
    return {f"at_{speed}": driving(speed) for speed in SCENARIOS}


@cache
def full_power(speed_kmh: int) -> Quantities:
    """Compute the optimum's largest power, and the extra energy of a drive of half the power."""
    scenario, full = kharkiv_scenario(speed_kmh), solve_optimum(speed_kmh)
    power: Any = scenario.vehicle.traction.max_power_kw
    half = solve(allow_window(scenario).replace(**{"vehicle.traction.max_power_kw": 0.5 * power}), "bellman")
    at_wheels_kw = full.tractive_effort_n * 0.5 * (full.speed_ms[1:] + full.speed_ms[:-1]) / W_PER_KW
    share = _effort_share(full, at_wheels_kw > FULL_SHARE * power)
    return {
        "largest_kw": float(np.max(at_wheels_kw)),
        "largest_share": float(np.max(at_wheels_kw)) / power,
        "share": share,
        "rest": 100 - share,
        "more": 100 * share_above(half.energy_kwh, full.energy_kwh),
    }


def efficient_full_power() -> Quantities:
    """Compare the efficiencies at full and at half power at the same speeds."""
    vehicle = kharkiv_scenario(20).vehicle
    drive: Any = vehicle.drive
    power: Any = vehicle.traction.max_power_kw
    top = vehicle.traction.max_speed_kmh
    speeds = np.linspace(0.5 * top, top, 5) * MS_PER_KMH
    rads = speeds * drive.gear_ratio * 2 / drive.wheel_diameter_m
    full, half = (
        np.diag(
            efficiency_maps(
                drive, share * power * W_PER_KW * (1 + drive.gear_loss_share) / drive.motors / rads, rads
            ).drive
        )
        for share in (1.0, 0.5)
    )
    return {
        "full": full[2],
        "half": half[2],
        "speed_kmh": speeds[2] / MS_PER_KMH,
        "range_kmh": (0.5 * top, top),
        "least_gain": np.min(full - half),
        "more": full_power(20)["more"],
    }


@cache
def spread() -> list[Quantities]:
    """Compute the printed regulator's energies and times with different steps of time."""
    limits = [limit / MS_PER_KMH for limit in search_limits(40, "literal")[1].best.limits_ms]
    found: list[Quantities] = []
    for step in TIME_STEPS_S:
        try:
            run = literal_run(limits, step)
            result = {"energy_kwh": run.energy_kwh, "travel_time_s": run.travel_time_s, "refusal": ""}
        except StrategyRefusedError as error:
            result = {"energy_kwh": np.nan, "travel_time_s": np.nan, "refusal": str(error)}
        found.append({"time_step_s": step, **result})
    return found


def literal_run(limits_kmh: list[float], time_step_s: float) -> Trajectory:
    """Return the run of the printed regulator at 40 km/h; raises StrategyRefusedError where it drives none."""
    search = {"search.limits_kmh": limits_kmh, "search.regulator": "literal", "search.time_step_s": time_step_s}
    return run_strategy(prepare_task(kharkiv_scenario(40).replace(search)), "speed_limits")


@cache
def literal_braking() -> Quantities:
    """Compute the braking energy by the printed formulas: power over efficiency, and a gear that gives power [kWh]."""
    run = search_limits(40, "brake")[0]
    drive: Any = run.scenario.vehicle.drive
    share, duration = drive.gear_loss_share, np.diff(run.time_s)
    speed = np.diff(run.position_m) / duration
    wheel = run.electric_braking_n * speed
    generated = np.maximum(-make_drive(drive).electrical_power_w(-run.electric_braking_n, speed), 0.0)
    useful = generated > 0
    # (8) and (9) divide by the efficiency and add the gear's loss, as if in driving
    efficiency = generated[useful] / (wheel[useful] * (1 - share))
    printed = np.sum((wheel[useful] / efficiency + share * wheel[useful]) * duration[useful])
    supplied = float(np.sum(wheel * duration)) / J_PER_KWH
    return {
        "supplied": supplied,
        "printed": float(printed) / J_PER_KWH,
        "recuperated": float(np.sum(generated * duration)) / J_PER_KWH,
        "is_more": printed / J_PER_KWH > supplied,
    }


def window() -> Quantities:
    """Compute the times of the best limits over the scheduled time."""
    scenario = kharkiv_scenario(40)
    relay = search_limits(40, "literal")[0].travel_time_s / scenario.travel_time_s
    shares = [*(driving(speed)["coast"]["time_share"] for speed in SCENARIOS), relay]
    ideal = [limit / MS_PER_KMH for limit in search_limits(40, "brake")[1].best.limits_ms]
    replayed = literal_run(ideal, scenario.search.time_step_s)
    return {
        "shares": shares,
        "most_off": max(abs(share - 1) for share in shares),
        "replayed_s": replayed.travel_time_s,
        "latest_s": (1 + scenario.search.time_window) * scenario.travel_time_s,
    }


def time_without_train() -> Quantities:
    """Compare the scheduled time, less the train, with that over the whole line."""
    scenario = kharkiv_scenario(40)
    whole = scenario.replace(**{"timetable.deduct_train_length": False}).travel_time_s
    return {
        "whole_s": whole,
        "time_s": scenario.travel_time_s,
        "train_m": scenario.vehicle.length_m,
        "share": 100 * (1 - scenario.travel_time_s / whole),
        "window": 100 * scenario.search.time_window,
    }


def adhesion() -> Quantities:
    """Compute the set speeds without a limit of adhesion and on wet rails [km/h]."""
    vehicle = kharkiv_scenario(20).vehicle
    effort: Any = vehicle.traction.max_effort_kn
    found = {
        f"{rail or 'dry'}_{speed}": search_limits(speed, "coast", rail_condition=rail)[1].best.limits_ms / MS_PER_KMH
        for rail in (None, "wet")
        for speed in SCENARIOS
    }
    return {**found, "effort_share": effort / total_weight_kn(vehicle)}


def rigid_chain() -> Quantities:
    """Compute energies with one, five and forty cars on the changing gradients [kWh]."""
    run = search_limits(40, "coast")[0]
    own: Any = run.scenario.vehicle.car_count
    one, many = (
        solve(run.scenario.replace(**{"vehicle.car_count": count}), "speed_limits").energy_kwh for count in (1, 8 * own)
    )
    gain = abs(one - many) - abs(run.energy_kwh - many)
    return {
        "one": one,
        "cars": run.energy_kwh,
        "many": many,
        "count": (own, 8 * own),
        "closer": gain,
        "gain": 100 * abs(one / many - 1),
    }


def storage_size() -> Quantities:
    """Compute the savings with storages of half, all and twice the largest drop [kWh]."""
    drop, run = driving(40)["coast"]["drop_kwh"], search_limits(40, "coast")[0]
    half, full, double = saving_over_size(run, drop * np.array([0.5, 1.0, 2.0]), UNLIMITED_KW, 1.0, 1.0)
    saved = {"half": half, "full": full, "double": double}
    return {**driving(40), **saved, "first_gain": full - half, "second_gain": double / full - 1}
