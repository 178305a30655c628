"""Claims of Ftorek 2025, examined."""

import math
from collections.abc import Iterator
from dataclasses import replace
from functools import partial

import numpy as np

from railjoule.core.strategies import solve
from railjoule.core.strategies.enoc import (
    best_acceleration_time,
    enoc_coefficients,
    enoc_energy,
)
from railjoule.core.units import J_PER_WH, MS_PER_KMH
from railjoule.core.validation.claim import Examinations, Finding, judge, undecided
from railjoule.core.validation.ftorek_runs import (
    BASE_TIME_S,
    CHANGES,
    LAST_DIGIT_POINTS,
    amperes_per_newton,
    change_percent,
    closed_loop_run,
    eoc_run,
    least_energies_j,
    optimal_run,
    paper,
    paper_line,
    paper_scenario,
    printed_run,
    surface_minimum,
    table_change_percent,
)
from railjoule.core.validation.table import CLOSE_PERCENT

STRATEGIES = ("eoc", "enoc")
TIMES_S = (270, 300, 330)
# From the paper's fastest run to three times the time of its computed minimum
ALL_TIMES_S = np.geomspace(270, 12_300, 200)
SPEEDS_KMH = (60.0, 30.0)
"""A speed and its half, for (1a) and (1b); the paper's mean speed is 60 km/h."""


def change(strategy: str, travel_time_s: int, key: str) -> Finding:
    """Examine a change of current or energy with 10 % less or more time."""
    entries = (e for e in paper()["change_percent"] if (e["strategy"], e["travel_time_s"]) == (strategy, travel_time_s))
    printed, own = next(entries)[key], table_change_percent(strategy, travel_time_s, key)
    computed = change_percent(paper_line(), amperes_per_newton(paper_scenario()), strategy, travel_time_s)[key]
    table = f"Table {1 + STRATEGIES.index(strategy)}"
    is_consistent = abs(own - printed) < LAST_DIGIT_POINTS
    relation = "agrees with" if is_consistent else "contradicts"
    return judge(
        f"{computed:+.2f} %",
        is_consistent and abs(computed - printed) < CLOSE_PERCENT,
        f"The printed number {relation} the paper's own {table}, {own:+.2f} %.",
    )


def half_speed(key: str, promised_percent: float) -> Finding:
    """Examine the saving of half the speed with one kind of friction, at constant speed over the paper's line."""
    keys = ("constant_n_per_kn", "linear_n_per_kn_per_kmh", "quadratic_n_per_kn_per_kmh2")
    only = {f"vehicle.resistance.{other}": 0.0 for other in keys if other != key}
    friction = []
    for speed in SPEEDS_KMH:
        time = {"timetable.travel_time_s": paper_line().distance_m / (speed * MS_PER_KMH)}
        ends = {"timetable.entry_speed_kmh": speed, "timetable.exit_speed_kmh": speed}
        friction.append(solve(paper_scenario().replace(**only, **time, **ends), "enoc").energy.running_resistance_j)
    full, half = friction
    saved = 100 * (1 - half / full)
    return judge(
        f"{saved:.2f} %",
        abs(saved - promised_percent) < LAST_DIGIT_POINTS,
        f"Work against this friction in runs at {SPEEDS_KMH[0]:g} and {SPEEDS_KMH[1]:g} km/h from end to end. Against "
        "constant friction it does not depend on speed.",
    )


def lowest_speed() -> Finding:
    """Examine whether a longer time, and so a lower speed, always saves energy."""
    energies = least_energies_j(enoc_coefficients(paper_line()), ALL_TIMES_S)
    longest, _ = surface_minimum(enoc_coefficients(paper_line()))
    share = 100 * (1 - np.min(energies) / energies[0])
    return judge(
        f"less energy up to {longest:,.0f} s ({share:.0f} % below 270 s)",
        longest > max(TIMES_S),
        "ENOC with its best acceleration times. Beyond, the copper loss of the effort against constant friction grows "
        "with time, and the rise is slow.",
    )


def best_time(has_constant: bool) -> Finding:
    """Examine the number of travel times of least energy for each combination of linear and quadratic friction."""
    line = paper_line()
    minima, ends = [], []
    for linear, quadratic in ((1.0, 0.0), (0.0, 1.0), (1.0, 1.0)):
        friction = replace(
            line,
            constant_n=line.constant_n if has_constant else 0.0,
            linear=linear * line.linear,
            quadratic=quadratic * line.quadratic,
        )
        slopes = np.sign(np.diff(least_energies_j(enoc_coefficients(friction), ALL_TIMES_S)))
        minima.append(int(np.sum(np.diff(slopes) > 0)))
        ends.append(bool(np.all(slopes < 0)))
    where = f"between {ALL_TIMES_S[0]:,.0f} and {ALL_TIMES_S[-1]:,.0f} s, for linear, quadratic and both frictions"
    reason = "ENOC with its best acceleration time at each travel time."
    if has_constant:
        return judge(f"{minima[0]}, {minima[1]} and {minima[2]} minima {where}", minima == [1, 1, 1], reason)
    return judge(f"the energy {'falls' if all(ends) else 'does not fall'} throughout, {where}", all(ends), reason)


def surface_lowest_point() -> Finding:
    """Examine the place of the minimum of Figure 6(a)."""
    time, ramp = surface_minimum(enoc_coefficients(paper_line()))
    printed = paper()["table_3"][0]
    return judge(
        f"T_m = {time:,.0f} s and T_e = {ramp:.1f} s",
        abs(time / printed["travel_time_s"] - 1) < CLOSE_PERCENT / 100,
        "With the copper loss that fits Table 2; with 3.087 times that loss, the minimum lies at the printed place.",
    )


def halved_times(point: int) -> Finding:
    """Examine the energy at a point of Table 3 above that at its minimum."""
    coefficients = enoc_coefficients(paper_line())
    least, energy = (
        float(enoc_energy(coefficients, entry["travel_time_s"], entry["acceleration_time_s"]))
        for entry in (paper()["table_3"][0], paper()["table_3"][point])
    )
    computed, printed = 100 * (energy / least - 1), paper()["table_3"][point]["increase_percent"]
    return judge(
        f"{computed:+.2f} %",
        abs(computed - printed) < CLOSE_PERCENT,
        "At the printed times, with the copper loss that fits Table 2. The printed energies give the printed increase.",
    )


def steep_slope() -> Finding:
    """Examine the fall of ENOC's energy per second of travel time."""
    energies = least_energies_j(enoc_coefficients(paper_line()), ALL_TIMES_S) / J_PER_WH
    slopes = [float(-np.interp(time, ALL_TIMES_S, np.gradient(energies, ALL_TIMES_S))) for time in (270, 330, 500)]
    return judge(
        f"{slopes[0]:.1f}, {slopes[1]:.1f} and {slopes[2]:.1f} Wh for each second at 270, 330 and 500 s",
        slopes[0] > slopes[1] > slopes[2],
        "ENOC with its best acceleration time at each travel time.",
    )


def minimum_of_eoc() -> Finding:
    """Examine whether less energy than EOC's is possible."""
    saved = [
        100
        * (1 - optimal_run(paper_scenario(), entry["travel_time_s"]).energy.net_j / J_PER_WH / entry["total_energy_wh"])
        for entry in paper()["table_1"]
    ]
    return judge(
        f"{min(saved):.1f} to {max(saved):.1f} % less is possible",
        max(saved) <= 0,
        "The printed runs leave the work of drag out of their cost. With it, a boundary value solver and an interior "
        "point agree on the optimum to seven digits.",
    )


def order_of_both() -> Finding:
    """Examine EOC's energy against ENOC's."""
    by_peak, by_best = [], []
    coefficients = enoc_coefficients(paper_line())
    for time in TIMES_S:
        eoc, enoc = (printed_run(paper_line(), strategy, time).total_energy_j for strategy in STRATEGIES)
        best = float(enoc_energy(coefficients, time, best_acceleration_time(coefficients, time)))
        by_peak.append(100 * (enoc / eoc - 1))
        by_best.append(100 * (best / eoc - 1))
    return judge(
        f"ENOC needs {min(by_peak):.1f} to {max(by_peak):.1f} % more",
        min(by_peak + by_best) > 0,
        f"EOC as printed against the ramps of (15). With ENOC's own best ramps, from which (15) departs, it needs only "
        f"{min(by_best):.3f} to {max(by_best):.2f} % more.",
    )


def distance_to_optimum() -> Finding:
    """Examine ENOC's energy above the optimum with the whole cost."""
    coefficients, printed, best = enoc_coefficients(paper_line()), [], []
    for time in TIMES_S:
        least = eoc_run(paper_line(), time, "optimal").total_energy_j
        own = float(enoc_energy(coefficients, time, best_acceleration_time(coefficients, time)))
        printed.append(100 * (printed_run(paper_line(), "enoc", time).total_energy_j / least - 1))
        best.append(100 * (own / least - 1))
    return undecided(
        f"{min(best):.1f} to {max(best):.1f} % above the optimum",
        f"The paper does not define near. With the ramps of (15), which it drives, ENOC needs {min(printed):.1f} to "
        f"{max(printed):.1f} % more than the optimum.",
    )


def quintic() -> Finding:
    """Examine the root of (13) as it is printed, for T_m = 300 s."""
    k, t = enoc_coefficients(paper_line()), float(BASE_TIME_S)
    s, best = k.distance_m, best_acceleration_time(k, t)
    # (13) with the printed -(2/3) ks Tm^2 and -7 k1
    printed = [
        -4 / 3 * k.ks,
        10 / 3 * k.ks * t + 3 * k.k5 * s,
        3 * k.k1 - 2 / 3 * k.ks * t**2 - 9 / 2 * k.k5 * s * t - 24 / 5 * k.k3 * s**2,
        -7 * k.k1 + 2 / 3 * k.ks * t**3 + 3 / 2 * k.k5 * s * t**2 + 12 / 5 * k.k3 * s**2 * t,
        5 * k.k1 * t**2,
        -k.k1 * t**3,
    ]
    roots = np.roots(printed)
    real = roots.real[(np.abs(roots.imag) < 1e-6 * t) & (roots.real > 0) & (roots.real < t / 2)]
    found = ", ".join(f"{root:.2f} s" for root in np.sort(real)) or "no root below half of the time"
    return judge(
        f"{found}; minimum at {best:.2f} s",
        bool(np.any(np.abs(real - best) < CLOSE_PERCENT / 100 * best)),
        "At T_m = 300 s. Two terms of (13) are misprinted; corrected, its root is the minimum of (12).",
    )


def same_peak() -> Finding:
    """Examine the maximum speeds of both strategies."""
    runs = [[printed_run(paper_line(), strategy, time) for strategy in STRATEGIES] for time in TIMES_S]
    differences = [100 * float(np.max(enoc.speed_ms) / np.max(eoc.speed_ms) - 1) for eoc, enoc in runs]
    return judge(
        f"{', '.join(f'{difference:+.2f} %' for difference in differences)} of EOC's maximum speed",
        max(map(abs, differences)) < CLOSE_PERCENT,
        "Printed acceleration times against EOC as printed. On page Compare ENOC has its own best ramps, not those of "
        "(15).",
    )


def recuperated() -> Finding:
    """Examine the energy that braking returns against the fall from the peak."""
    shares = []
    for strategy in STRATEGIES:
        for time in TIMES_S:
            run = printed_run(paper_line(), strategy, time)
            returned = -float(np.sum(np.minimum(np.diff(run.energy_j), 0.0)))
            shares.append(100 * ((run.peak_energy_j - run.total_energy_j) / returned - 1))
    least, most = min(shares), max(shares)
    return judge(
        f"{least:+.2f} to {most:+.2f} % of the energy returned",
        max(map(abs, shares)) < CLOSE_PERCENT,
        "Just before the train stands, the copper loss exceeds the power of braking, so that a little is taken again.",
    )


def zero_lag() -> Finding:
    """Examine the distance between train and reference with and without the pre-compensator."""
    with_it, without = (
        max(
            closed_loop_run(paper_scenario(), strategy, BASE_TIME_S, precompensator=there).max_tracking_error_m
            for strategy in STRATEGIES
        )
        for there in (True, False)
    )
    return judge(
        f"at most {1e3 * with_it:.1f} mm behind, without the pre-compensator {without:.1f} m",
        with_it < CLOSE_PERCENT / 100 * without,
        "Both strategies at T_m = 300 s in closed loop, in which the reference is known ahead.",
    )


def distance() -> Finding:
    """Examine where the trains stand."""
    worst = max(abs(closed_loop_run(paper_scenario(), *case).final_error_m) for case in _cases())
    return judge(
        f"within {1e3 * worst:.1f} mm", worst < 0.5, "Six runs in closed loop; half a metre counts as reached."
    )


def two_ways() -> Finding:
    """Examine the integral of input power against the sum of its parts."""
    runs = [closed_loop_run(paper_scenario(), *case) for case in _cases()]
    worst = max(100 * abs(run.energy_by_parts_kwh / run.energy_by_input_power_kwh - 1) for run in runs)
    return judge(
        # rounded up, as only the rounding of the sums is left
        f"within {math.ceil(1e6 * worst) / 100:.2f} ppm",
        worst < LAST_DIGIT_POINTS,
        "Six runs in closed loop. Both contain the loss of the magnetising current, which the tables leave out.",
    )


def less_flux() -> Finding:
    """Examine the losses with the flux of least loss against those with the rated flux."""
    rated, least = (
        sum(v for k, v in closed_loop_run(paper_scenario(), "enoc", BASE_TIME_S, flux).parts_j.items() if k in LOSSES)
        for flux in ("constant", "least_loss")
    )
    return judge(
        f"{100 * (1 - least / rated):.0f} % less loss",
        least < rated,
        f"ENOC at T_m = 300 s: {rated / J_PER_WH:.0f} Wh of losses with the rated flux, {least / J_PER_WH:.0f} Wh with "
        "the flux of least loss. The paper's own runs keep the flux.",
    )


LOSSES = ("stator_copper", "rotor_copper", "magnetising", "iron")


def any_drive() -> Finding:
    """Return why the claim on all drives stays open."""
    return undecided(
        "one train on one line",
        "The paper prints no other load. The claims on travel times above hold for each combination of its frictions.",
    )


def mean_speed() -> Finding:
    """Examine the mean speed of the run of 300 s."""
    computed = paper_line().distance_m / BASE_TIME_S / MS_PER_KMH
    return judge(f"{computed:.2f} km/h", abs(computed - 60) < 0.005, "5000 m in 300 s.")


def _cases() -> Iterator[tuple[str, int]]:
    return ((strategy, time) for strategy in STRATEGIES for time in TIMES_S)


EXAMINATIONS: Examinations = {
    **{
        f"{strategy}-{time}-{key.rpartition('_')[0].replace('_', '-')}": partial(change, strategy, time, key)
        for strategy in STRATEGIES
        for time in TIMES_S
        if time != BASE_TIME_S
        for key in CHANGES
    },
    "half-speed-linear": partial(half_speed, "linear_n_per_kn_per_kmh", 50.0),
    "half-speed-quadratic": partial(half_speed, "quadratic_n_per_kn_per_kmh2", 75.0),
    "lowest-speed": lowest_speed,
    "no-best-time": partial(best_time, has_constant=False),
    "one-best-time": partial(best_time, has_constant=True),
    "minimum": surface_lowest_point,
    "halved-once": partial(halved_times, 1),
    "halved-twice": partial(halved_times, 2),
    "steep": steep_slope,
    "eoc-minimum": minimum_of_eoc,
    "eoc-below-enoc": order_of_both,
    "near-optimal": distance_to_optimum,
    "quintic": quintic,
    "same-peak": same_peak,
    "recuperated": recuperated,
    "zero-lag": zero_lag,
    "distance": distance,
    "two-ways": two_ways,
    "flux": less_flux,
    "any-drive": any_drive,
    "mean-speed": mean_speed,
}
"""The examination of each claim, by its name in the paper's file."""
