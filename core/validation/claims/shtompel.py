"""Claims of Shtompel 2025, examined with an assumed train and line: ratios and signs count."""

from functools import partial

import numpy as np

from railjoule.core.drive.synchronous.drive import LOSS_KINDS, efficiency_maps, torque_envelope
from railjoule.core.drive.synchronous.losses import MOTOR_KINDS
from railjoule.core.physics.resistance import total_weight_kn
from railjoule.core.scenario.drive import Synchronous
from railjoule.core.strategies import solve
from railjoule.core.studies.storage import saving_over_size, storage_need
from railjoule.core.units import MS_PER_KMH, W_PER_KW
from railjoule.core.validation.claim import Examinations, Finding, judge, undecided
from railjoule.core.validation.shtompel_rows import (
    FULL_SHARE,
    SCENARIOS,
    SMALL_TORQUE,
    TIGHT_KMH,
    TIME_STEPS_S,
    costs,
    driving_efficiency,
    efficiency,
    evaluations,
    kharkiv_scenario,
    literal_braking,
    literal_run,
    map_efficiency,
    metro_drive,
    near_full_effort,
    near_full_power,
    regenerative_stop,
    run_limits,
    search_run,
    solve_optimum,
    spread,
)
from railjoule.core.validation.table import Row

# the paper gives no number for 'close to', 'small' and 'slightly'
MAJORITY_PERCENT = 50.0
NEAR_BEST_POINTS = 2.0
"""Efficiencies this close to the largest count as close to it."""
SLIGHTLY = 0.05
"""A difference of efficiencies below this is slight."""
# an efficiency that falls to zero with the torque halves with it, one that does not stays: the mean of 0.5 and 1
MOSTLY_GONE = 0.75
SAME_ENERGY_PERCENT = 0.1
"""Two searches end in the same minimum if their energies differ by less."""
LOADED_SHARE = 0.1
"""Shares of losses are compared where the shaft has at least this share of its largest power."""
LATE_SHARE = 1e-6
UNLIMITED_KW = 1e6


def _values(rows: tuple[Row, ...]) -> dict[tuple[str, str], float]:
    return {(row.case, row.quantity): row.value for row in rows}


def motor_above_drive() -> Finding:
    """Compare the efficiencies of motor and drive."""
    values = _values(efficiency())
    motor, drive = (values[whose, "greatest efficiency"] for whose in ("motor", "drive"))
    least = values["motor less drive", "least difference"]
    return judge(
        f"at best {motor:.3f} for the motor, {drive:.3f} for the drive",
        least > 0 and motor - drive < SLIGHTLY,
        f"Everywhere in the map the motor's is larger, by at least {least:.3f}.",
    )


def zero_at_no_torque() -> Finding:
    """Return the efficiency near zero torque."""
    values = _values(efficiency())
    shares = SMALL_TORQUE, 0.5 * SMALL_TORQUE
    near = [values[f"drive at {100 * share:g} % of its torque", "greatest efficiency"] for share in shares]
    return judge(
        f"at most {near[0]:.3f} at {100 * SMALL_TORQUE:g} % of the largest torque, {near[1]:.3f} at half of that",
        near[1] < MOSTLY_GONE * near[0],
        "Losses that do not depend on the torque stay, so the efficiency falls with it.",
    )


def limited_power_zone() -> Finding:
    """Return the torque that is left at large speeds."""
    drive = metro_drive()
    rest, top = torque_envelope(drive, np.array([0.0, drive.max_speed_rads]))
    return judge(
        f"{rest:.0f} N m at rest, {top:.0f} N m at {drive.max_speed_rads:.0f} rad/s",
        bool(top < rest),
        "Voltage and current of the assumed inverter bound the map at large speeds and torques.",
    )


def harmonic_losses() -> Finding:
    """Return the share of the inverter's harmonics in the losses of the motor."""
    maps = map_efficiency()
    shaft = maps.torque_nm[:, None] * maps.speed_rads[None, :]
    motor = maps.losses_w[..., :MOTOR_KINDS].sum(axis=-1)
    loaded = np.isfinite(motor) & (shaft >= LOADED_SHARE * np.max(shaft[np.isfinite(motor)]))
    share = 100 * maps.losses_w[..., LOSS_KINDS.index("harmonics")][loaded] / motor[loaded]
    return judge(
        f"{share.min():.1f} to {share.max():.1f} % of the motor's losses, {np.median(share):.1f} % in the median",
        bool(share.min() > 0),
        f"In driving with at least {100 * LOADED_SHARE:g} % of the largest power, by space vectors and in six-step "
        "operation. The paper prints no share.",
    )


def fewest_evaluations() -> Finding:
    """Compare the evaluations of two methods that find the same energy."""
    values = _values(evaluations())
    printed, other, differences = [], [], []
    for speed in SCENARIOS:
        case = f"{speed} km/h, two sections"
        printed.append(values[case, "combinations that the search tries"])
        other.append(values[case, "combinations that differential evolution tries"])
        differences.append(abs(values[case, "its energy over that of the search less 1"]))
    speeds = " and ".join(f"{speed} km/h" for speed in SCENARIOS)
    return judge(
        f"{printed[0]:.0f} and {printed[1]:.0f}; differential evolution {other[0]:.0f} and {other[1]:.0f}",
        max(differences) < SAME_ENERGY_PERCENT and all(a < b for a, b in zip(printed, other, strict=True)),
        f"At {speeds} with two sections; their energies differ by {max(differences):.3f} % at most. Another method "
        "needs no more evaluations, so these are not the fewest.",
    )


def optimal_trajectory() -> Finding:
    """Compare set speeds with the optimum in the same time."""
    values = _values(costs())
    more = {
        name: [values[f"{speed} km/h, {case}", "more than the optimum"] for speed in SCENARIOS]
        for name, case in (
            ("braking to the set speed", "brake limits, two sections"),
            ("coasting to it", "coast limits, two sections"),
            ("three sections with free ends", "coast limits, three sections, free section ends"),
        )
    }
    return judge(
        "; ".join(f"{name} +{both[0]:.1f} and +{both[1]:.1f} %" for name, both in more.items()),
        all(value < SAME_ENERGY_PERCENT for both in more.values() for value in both),
        "Energy over the optimum of Bellman's recursion in the same time, at 20 and 40 km/h: set speeds come near it "
        "with coasting and free section ends only.",
    )


def window() -> Finding:
    """Compare the times of the best limits with the window."""
    scheduled = {speed: kharkiv_scenario(speed).travel_time_s for speed in SCENARIOS}
    shares = {f"{speed} km/h": run_limits(speed, "coast").travel_time_s / time for speed, time in scheduled.items()}
    shares["40 km/h with the printed relay"] = run_limits(40, "literal").travel_time_s / scheduled[40]
    width = kharkiv_scenario(40).search.time_window
    ideal = [limit / MS_PER_KMH for limit in search_run(40, "brake").best.limits_ms]
    replayed = literal_run(ideal, kharkiv_scenario(40).search.time_step_s)
    latest = (1 + width) * scheduled[40]
    return judge(
        "; ".join(f"{share:.4f} of the scheduled time at {case}" for case, share in shares.items()),
        all(abs(share - 1) <= width + LATE_SHARE for share in shares.values()),
        "The minimum lies at the late end, as time saves energy: the earliest time never binds. The search must run "
        f"the relay itself: with the limits found for an ideal regulator it takes {replayed.travel_time_s:.1f} s, "
        f"where {latest:.1f} s are allowed.",
    )


def time_without_train() -> Finding:
    """Compare the scheduled time of the scenario, less the train, with that over the whole line."""
    scenario = kharkiv_scenario(40)
    whole = scenario.replace(**{"timetable.deduct_train_length": False}).travel_time_s
    share = 1 - scenario.travel_time_s / whole
    return undecided(
        f"{whole:.1f} s over the line, {scenario.travel_time_s:.1f} s less {scenario.vehicle.length_m:.0f} m of train",
        f"X_tr is not defined. Taken for the train's length, as here, it changes the time by {100 * share:.0f} %, more "
        f"than the window of {100 * scenario.search.time_window:g} %; between stations a train moves over all of it.",
    )


def adhesion() -> Finding:
    """Compare the set speeds without a limit of adhesion with those on wet rails."""
    vehicle = kharkiv_scenario(20).vehicle
    effort = vehicle.traction.max_effort_kn
    assert effort is not None

    def describe(rail_condition: str | None) -> str:
        found = {speed: search_run(speed, "coast", rail_condition).best.limits_ms / MS_PER_KMH for speed in SCENARIOS}
        return "; ".join(f"{one[0]:.0f} and {one[1]:.0f} km/h at {speed} km/h" for speed, one in found.items())

    return undecided(
        f"set speeds without a limit of adhesion {describe(None)}, on wet rails {describe('wet')}",
        f"The paper prints neither effort nor adhesion; an effort of {effort / total_weight_kn(vehicle):.2f} of the "
        "train's weight is assumed. Set speeds stay below 80 km/h without it, too: the time bounds them.",
    )


def rigid_chain() -> Finding:
    """Compare energies with one, five and forty cars on the changing gradients."""
    run = run_limits(40, "coast")
    own, cars = run.scenario.vehicle.car_count, run.energy_kwh
    assert own is not None
    one, many = (
        solve(run.scenario.replace(**{"vehicle.car_count": count}), "speed_limits").energy_kwh for count in (1, 8 * own)
    )
    return judge(
        f"{one:.3f} kWh with one body, {cars:.3f} kWh with {own} cars, {many:.3f} kWh with {8 * own}",
        abs(cars - many) < abs(one - many),
        "Set speeds at 40 km/h. Weight that is spread over the length is the limit of many cars; the gain here is "
        f"{100 * abs(one / many - 1):.1f} %.",
    )


def time_step() -> Finding:
    """Return the energies of the printed regulator over its time step."""
    energy = [value for (_, quantity), value in _values(spread()).items() if quantity == "energy"]
    return undecided(
        f"{energy[0]:.2f} kWh with steps of {TIME_STEPS_S[0]:g} s, {energy[-1]:.2f} kWh with {TIME_STEPS_S[-1]:g} s",
        "The relay (5) switches at each step, so its energy depends on the step; none is printed.",
    )


def near_best_efficiency(speed_kmh: int) -> Finding:
    """Return how much of the traction energy is taken close to the largest efficiency."""
    best = _values(efficiency())["drive", "greatest efficiency"]
    share = 100 * driving_efficiency(solve_optimum(speed_kmh)).energy_share_above(best - NEAR_BEST_POINTS / 100)
    limits = 100 * driving_efficiency(run_limits(speed_kmh, "coast")).energy_share_above(best - NEAR_BEST_POINTS / 100)
    return judge(
        f"{share:.0f} % of the traction energy in the optimum, {limits:.0f} % with set speeds",
        share > MAJORITY_PERCENT,
        f"Within {NEAR_BEST_POINTS:g} points of the largest efficiency of the drive, {best:.3f}; the claim is taken "
        "for more than half of the energy.",
    )


def partial_traction(speed_kmh: int) -> Finding:
    """Return how much of the traction energy is taken at full effort."""
    values = _values(near_full_effort())
    quantity = "traction energy at full effort"
    best, limits = (
        max(100 - values[f"{speed_kmh} km/h, {case}", quantity], 0.0) for case in ("optimum", "two sections, coast")
    )
    return judge(
        f"{best:.0f} % of the traction energy at partial effort in the optimum, {limits:.0f} % with set speeds",
        best < MAJORITY_PERCENT,
        f"Full is above {100 * FULL_SHARE:g} % of the effort at that speed; the claim is taken for less than half.",
    )


def electric_stop() -> Finding:
    """Return the energy that braking returns."""
    values = _values(regenerative_stop())
    by_limits = [values[f"{speed} km/h, two sections", "recuperated, of the energy drawn"] for speed in SCENARIOS]
    best = [solve_optimum(speed).energy for speed in SCENARIOS]
    by_optimum = [100 * energy.recuperated_j / energy.traction_j for energy in best]
    return judge(
        f"{by_limits[0]:.1f} and {by_limits[1]:.1f} % of the energy drawn with set speeds at 20 and 40 km/h",
        min(*by_limits, *by_optimum) > 0,
        f"In the optimum {by_optimum[0]:.1f} and {by_optimum[1]:.1f} %: a slow train coasts before it brakes.",
    )


def storage_size() -> Finding:
    """Return whether a storage of the largest drop takes all that braking generates."""
    run = run_limits(40, "coast")
    drop = storage_need(run).largest_drop_kwh
    half, full, double = saving_over_size(run, drop * np.array([0.5, 1.0, 2.0]), UNLIMITED_KW, 1.0, 1.0)
    braked, best = (storage_need(one).largest_drop_kwh for one in (run_limits(40, "brake"), solve_optimum(40)))
    return judge(
        f"{drop:.3f} kWh; it saves {full:.3f} kWh, half of it {half:.3f} and twice of it {double:.3f} kWh",
        bool(half < full and np.isclose(full, double, rtol=1e-6)),
        "Set speeds with coasting at 40 km/h, storage without losses. The size depends on the run: "
        f"{braked:.2f} kWh with braking to set speeds, {best:.2f} kWh in the optimum.",
    )


def full_power(speed_kmh: int) -> Finding:
    """Return the largest power of the optimum."""
    values, case = _values(near_full_power()), f"{speed_kmh} km/h, optimum"
    largest, share = values[case, "largest power at the wheels"], values[case, "traction energy at full power"]
    more = values[case, "more energy with half the power"]
    power = kharkiv_scenario(speed_kmh).vehicle.traction.max_power_kw
    assert power is not None
    return judge(
        f"{largest:.0f} kW at most; {share:.0f} % of the traction energy at full power",
        largest > FULL_SHARE * power,
        f"Close is above {100 * FULL_SHARE:g} % of {power:g} kW. Half the power needs {more:.2f} % more energy.",
    )


def efficient_full_power() -> Finding:
    """Compare the efficiencies at full and at half power at the same speeds."""
    scenario, drive = kharkiv_scenario(20), metro_drive()
    power, top = scenario.vehicle.traction.max_power_kw, scenario.vehicle.traction.max_speed_kmh
    assert power is not None
    speeds = np.linspace(0.5 * top, top, 5) * MS_PER_KMH
    full, half = (_efficiency_at(drive, share * power * W_PER_KW, speeds) for share in (1.0, 0.5))
    middle = len(speeds) // 2
    more = _values(near_full_power())["20 km/h, optimum", "more energy with half the power"]
    return judge(
        f"{full[middle]:.3f} at full power, {half[middle]:.3f} at half power at {speeds[middle] / MS_PER_KMH:.0f} km/h",
        bool(np.all(full > half)),
        f"At each speed from {0.5 * top:.0f} to {top:.0f} km/h. In the slow run at 20 km/h this decides little: half "
        f"the power needs {more:.2f} % more energy.",
    )


def _efficiency_at(drive: Synchronous, power_w: float, speed_ms: np.ndarray) -> np.ndarray:
    """Return efficiencies of the drive where all motors give a power at the wheels [W] at speeds [m/s]."""
    rads = speed_ms * drive.gear_ratio * 2 / drive.wheel_diameter_m
    torque = power_w * (1 + drive.gear_loss_share) / drive.motors / rads
    return np.diag(efficiency_maps(drive, torque, rads).drive)


def power_in_braking() -> Finding:
    """Compare the energy by (8) and (9) with the work at the wheels."""
    values, case = _values(literal_braking()), "40 km/h, brake limits"
    supplied, printed, recuperated = (
        values[case, quantity]
        for quantity in ("work that the wheels supply", "recuperated by (8) and (9)", "recuperated")
    )
    return judge(
        f"{printed:.2f} kWh by (8) and (9), of {supplied:.2f} kWh that the wheels supply",
        printed <= supplied,
        f"In braking the power is multiplied by the efficiency, which gives {recuperated:.2f} kWh.",
    )


EXAMINATIONS: Examinations = {
    "motor_above_drive": motor_above_drive,
    "zero_at_no_torque": zero_at_no_torque,
    "limited_power_zone": limited_power_zone,
    "harmonic_losses": harmonic_losses,
    "power_in_braking": power_in_braking,
    "rigid_chain": rigid_chain,
    "time_step": time_step,
    "window": window,
    "time_without_train": time_without_train,
    "fewest_evaluations": fewest_evaluations,
    "adhesion": adhesion,
    "optimal_trajectory": optimal_trajectory,
    "near_best_efficiency_20": partial(near_best_efficiency, 20),
    "near_best_efficiency_40": partial(near_best_efficiency, 40),
    "partial_traction_20": partial(partial_traction, 20),
    "partial_traction_40": partial(partial_traction, 40),
    "electric_stop": electric_stop,
    "storage_size": storage_size,
    "full_power_20": partial(full_power, 20),
    "full_power_40": partial(full_power, 40),
    "full_power_54": partial(full_power, TIGHT_KMH),
    "efficient_full_power": efficient_full_power,
}
"""The examination of each claim, by its name in the paper's file."""
