"""Claims of Rawicki 2013, examined."""

from functools import partial

import numpy as np

from railjoule.core.energy import share_above
from railjoule.core.phase_planning.plan import PlannedPhase
from railjoule.core.simulation.disturbances import simulate_disturbances
from railjoule.core.studies.flux_sweep import FluxSweep, sweep_flux
from railjoule.core.units import J_PER_KWH
from railjoule.core.validation.claim import Examinations, Finding, judge, undecided
from railjoule.core.validation.rawicki_identification import machine_values, printed_planner
from railjoule.core.validation.rawicki_runs import (
    RECUPERATION_FACTORS,
    drive_part_one,
    energy_kwh,
    energy_with_stop_kwh,
    make_planner,
    part_two_time_s,
    phase_length_m,
    plan_part_two,
    plan_run,
    printed_paper,
    printed_phases,
    replan,
    replan_two_segments,
    tram_scenario,
)

ABOUT_POINTS = 5.0
"""A saving of 'about 20 %' is one of 15 to 25 %."""
# The printed energies differ by up to 1.1 % from those of the identified tram; a penalty is the ratio of two.
PENALTY_POINTS = 2.0
SAME_ENERGY_PERCENT = 1.5
LATER_S = 10.0
"""An accepted delay that is tried."""
GENTLE_SHARE = 0.5
"""Braking current of a gentle driver over the full one."""
LATE_S = 0.05
"""A smaller delay is what solvers leave of a timetable."""


def saving(kr: float) -> Finding:
    """Compare the best run with that of a typical driver."""
    best, steady, gentle = energy_kwh(plan_run(kr)), energy_kwh(plan_run(kr, coast=False)), _gentle_driver_kwh(kr)
    saved, saved_gentle = (100 * (1 - best / other) for other in (steady, gentle))
    return judge(
        f"{saved:.1f} % ({best:.3f} against {steady:.3f} kWh); {saved_gentle:.1f} % against a gentle brake "
        f"({gentle:.3f} kWh)",
        abs(saved - 20.0) <= ABOUT_POINTS,
        "The paper defines no driver. This one starts at full current, holds one speed by power, does not coast and "
        f"brakes fully, in the same time; the gentle one brakes with {100 * GENTLE_SHARE:.0f} % of the current. About "
        f"20 % is taken for {20 - ABOUT_POINTS:.0f} to {20 + ABOUT_POINTS:.0f} %.",
    )


def _gentle_driver_kwh(kr: float) -> float:
    """Return the energy of a driver who holds one speed and brakes with less than the full current [kWh]."""
    scenario = tram_scenario(kr)
    drive = scenario.vehicle.drive
    current = GENTLE_SHARE * drive.braking_current_a  # type: ignore[union-attr]
    vehicle = scenario.replace(**{"drive.braking_current_a": current}).vehicle
    return energy_kwh(printed_planner(vehicle, kr, coast=False).plan(scenario.line.length_m, scenario.travel_time_s))


def longer_cruise() -> Finding:
    """Compare the cruises of Figs. 1 and 2."""
    without, full = (phase_length_m(kr, "cruise") for kr in RECUPERATION_FACTORS)
    return judge(
        f"{full:.0f} m with kr = 1, {without:.0f} m with kr = 0",
        full > without,
        "Lengths of the cruise in the best runs over 950 m in 95 s.",
    )


def cruise_and_coasting() -> Finding:
    """Return whether the best runs have both phases."""
    lengths = {kr: [phase_length_m(kr, phase) for phase in ("cruise", "coast")] for kr in RECUPERATION_FACTORS}
    free = [plan_run(kr, free_starting_current=True).cruise_m for kr in RECUPERATION_FACTORS]
    return judge(
        "; ".join(f"kr = {kr:g}: cruise {both[0]:.0f} m, coasting {both[1]:.0f} m" for kr, both in lengths.items()),
        all(length > 0 for both in lengths.values() for length in both),
        "With the paper's starts at full current. With a free starting current, which needs less energy, the cruise is "
        f"{free[0]:.0f} m for kr = 0 and {free[1]:.0f} m for kr = 1.",
    )


def _cruise() -> FluxSweep:
    """Return the printed cruise of part I over the flux."""
    return sweep_flux(tram_scenario(0.0).vehicle, float(printed_phases("part I")[1]["start_ms"]))


def better_efficiency() -> Finding:
    """Compare efficiencies with less flux and with the rated flux."""
    sweep = _cruise()
    best, within, rated = sweep.least_loss, sweep.within_voltage, sweep.rated
    return judge(
        f"{100 * best.efficiency:.1f} % at {best.flux_current_a:.1f} A and {best.phase_voltage_v:.0f} V, "
        f"{100 * rated.efficiency:.1f} % at the rated {rated.flux_current_a:.1f} A and {rated.phase_voltage_v:.0f} V",
        best.efficiency > within.efficiency > rated.efficiency and best.phase_voltage_v < within.phase_voltage_v,
        f"Cruise at {sweep.speed_ms:g} m/s on level track, {best.input_power_w:.0f} W a motor against "
        f"{rated.input_power_w:.0f} W. The rated flux needs more than the {sweep.max_phase_voltage_v:.0f} V of the "
        f"inverter; the maximum flux within them gives {100 * within.efficiency:.1f} %.",
    )


def better_power_factor() -> Finding:
    """Compare power factors with less flux and with the rated flux."""
    sweep = _cruise()
    best, within, rated = sweep.least_loss, sweep.within_voltage, sweep.rated
    return judge(
        f"{best.power_factor:.3f} at {best.flux_current_a:.1f} A, {rated.power_factor:.3f} at the rated "
        f"{rated.flux_current_a:.1f} A",
        best.power_factor > within.power_factor > rated.power_factor,
        "The cruise of the claim above; input power with the iron loss over apparent power. At "
        f"{within.flux_current_a:.1f} A, the maximum within the voltage, it is {within.power_factor:.3f}.",
    )


def many_variants() -> Finding:
    """Return the range of voltages, frequencies and fluxes with the effort of a cruise."""
    sweep = _cruise()
    allowed = [one for one in sweep.points if one.phase_voltage_v <= sweep.max_phase_voltage_v]
    low, high = allowed[0], allowed[-1]
    return judge(
        f"{low.flux_current_a:.1f} to {high.flux_current_a:.1f} A of flux current, {low.phase_voltage_v:.0f} to "
        f"{high.phase_voltage_v:.0f} V",
        high.phase_voltage_v > low.phase_voltage_v,
        f"All give {sweep.effort_n:.0f} N at {sweep.speed_ms:g} m/s; a motor loses {low.loss_w:.0f} W and "
        f"{high.loss_w:.0f} W at the ends and {sweep.least_loss.loss_w:.0f} W at best.",
    )


def start_above_resistance() -> Finding:
    """Compare the tractive effort of a start with the resistance."""
    model = make_planner(0.0).model
    speeds = np.array([0.0, float(printed_phases("part II, kr = 0")[0]["end_ms"])])
    ratios = model.starting_effort_n(speeds) / model.resistance_n(speeds)
    return judge(
        f"{ratios[0]:.0f} times at rest, {ratios[1]:.1f} times at {speeds[1]:g} m/s",
        bool(ratios.min() > 2),
        "Full starting current over the running resistance, from rest to the highest speed that the paper prints.",
    )


def recuperation_saves() -> Finding:
    """Compare the energies of Figs. 1 and 2."""
    without, full = (energy_kwh(plan_run(kr)) for kr in RECUPERATION_FACTORS)
    printed = [entry["energy_kwh"] for entry in printed_paper()["figure"][:2]]
    off = [100 * abs(share_above(own, other)) for own, other in zip((without, full), printed, strict=True)]
    return judge(
        f"{full:.3f} and {without:.3f} kWh: {100 * (1 - full / without):.1f} % less",
        max(off) <= SAME_ENERGY_PERCENT and full < without,
        f"Printed are {printed[1]} and {printed[0]} kWh, {100 * (1 - printed[1] / printed[0]):.1f} % less; with the "
        f"identified tram the difference is at most {max(off):.1f} %.",
    )


def penalty(kr: float) -> Finding:
    """Return by how much the stop raises the energy."""
    entry = next(one for one in printed_paper()["figure"][2:] if one["recuperation_factor"] == kr)
    printed, found = entry["penalty_percent"], 100 * share_above(energy_with_stop_kwh(kr), energy_kwh(plan_run(kr)))
    return judge(
        f"{found:.1f} %",
        abs(found - printed) <= PENALTY_POINTS,
        f"{abs(found - printed):.1f} points from the printed {printed} %, of which {PENALTY_POINTS:g} are allowed: a "
        "penalty is a ratio of two energies.",
    )


def delay_recovered() -> Finding:
    """Return the delay at the end of the run with the stop."""
    runs = [replan(kr, "driver") for kr in RECUPERATION_FACTORS]
    latest = max(run.delay_s for run in runs)
    spare = part_two_time_s() - make_planner(0.0).fastest(plan_part_two(0.0).distance_m).running_time_s
    return judge(
        f"{latest:.1f} s late after {runs[0].actual.travel_time_s:.1f} s with the stop",
        latest <= LATE_S,
        f"The second part could be driven {spare:.1f} s faster than its printed {part_two_time_s():.2f} s.",
    )


def quicker_ride() -> Finding:
    """Compare speed and energy of part II with those without a stop, and with an accepted delay."""
    kr = 0.0
    undisturbed, second, later = plan_run(kr), plan_part_two(kr), plan_part_two(kr, LATER_S)
    less = energy_kwh(second) - energy_kwh(later)
    return judge(
        f"{second.cruise_speed_ms:.1f} m/s instead of {undisturbed.cruise_speed_ms:.1f} m/s; {less:.3f} kWh less in "
        f"the second part with {LATER_S:g} s more",
        second.cruise_speed_ms > undisturbed.cruise_speed_ms and less > 0,
        f"Cruising speeds with kr = 0; the second part needs {energy_kwh(second):.3f} kWh in time and "
        f"{energy_kwh(later):.3f} kWh if it may take {LATER_S:g} s more.",
    )


def second_start() -> Finding:
    """Return the energy of the second start."""
    part_two = make_planner(0.0).phases_of(plan_part_two(0.0))
    first, second = _start_kwh(drive_part_one(0.0)), _start_kwh(part_two)
    undisturbed = energy_kwh(plan_run(0.0))
    return judge(
        f"{second:.3f} kWh for the second start, {first:.3f} kWh for the first",
        first + second > undisturbed,
        f"With kr = 0; the whole run without the stop needs {undisturbed:.3f} kWh.",
    )


def _start_kwh(phases: tuple[PlannedPhase, ...]) -> float:
    return sum(phase.energy_j for phase in phases if phase.phase == "start") / J_PER_KWH


def different_runs() -> Finding:
    """Compare the best second parts with and without recuperation."""
    lengths = [
        (phase_length_m(kr, "cruise", plan_part_two(kr)), phase_length_m(kr, "coast", plan_part_two(kr)))
        for kr in RECUPERATION_FACTORS
    ]
    (cruise_0, coast_0), (cruise_1, coast_1) = lengths
    return judge(
        f"cruise {cruise_0:.0f} and {cruise_1:.0f} m, coasting {coast_0:.0f} and {coast_1:.0f} m",
        cruise_1 > cruise_0 and coast_1 < coast_0,
        "With kr = 0 and 1. Printed are 60.08 and 128.0 m of cruise, 347.2 and 291.9 m of coasting: the same order.",
    )


def accepted_delay() -> Finding:
    """Compare the extra energy of the stop if its delay is recovered in one segment, and in two."""
    one = replan(0.0, "driver")
    two = replan_two_segments(0.0)
    undisturbed, shared = (run.actual.energy_kwh - run.planned.energy_kwh for run in (one, two))
    return judge(
        f"{shared:.3f} kWh more with two segments, {undisturbed:.3f} kWh more with one",
        shared < undisturbed and two.delay_s <= LATE_S,
        f"The ride with the stop, kr = 0, and a second segment of {one.planned.position_m[-1]:.0f} m with the same "
        f"time; the tram is {two.delay_s:.1f} s late at its end.",
    )


def updated_run() -> Finding:
    """Compare a run that a computer replans from the notice on with one that a driver stops by hand."""
    runs = {kr: [replan(kr, who).actual.energy_kwh for who in ("computer", "driver")] for kr in RECUPERATION_FACTORS}
    return judge(
        "; ".join(
            f"kr = {kr:g}: {computer:.3f} instead of {driver:.3f} kWh" for kr, (computer, driver) in runs.items()
        ),
        all(computer < driver for computer, driver in runs.values()),
        "A computer that replans from the notice at 70.11 m on, against the paper's driver, who holds the speed and "
        "brakes; both arrive in time.",
    )


def all_disturbances() -> Finding:
    """Return a run with a disturbance that the paper names and does not show."""
    change = [{"recuperation_factor": 0.5, "noticed_at_m": 300.0, "reaction": "computer"}]
    run = simulate_disturbances(tram_scenario(1.0).replace(**{"disturbance.recuperation_changes": change}))
    return undecided(
        f"{run.actual.energy_kwh:.3f} kWh if kr falls from 1 to 0.5 at 300 m, {run.planned.energy_kwh:.3f} kWh planned",
        "The paper shows results only for a stop; there is no printed number for limits, voltage or recuperation.",
    )


def rated_efficiency() -> Finding:
    """Return the efficiency of the motor by the nameplate and by the identified machine."""
    plate = printed_paper()["nameplate"]
    by_plate = 1e3 * plate["power_kw"] / (3**0.5 * plate["voltage_v"] * plate["current_a"] * plate["power_factor"])
    voltage, current, power, factor = machine_values(tram_scenario(0.0).vehicle, plate)
    identified = power / (1.5 * voltage * current * factor)
    return undecided(
        f"{100 * by_plate:.1f} % by the nameplate's other numbers, {100 * identified:.1f} % of the identified motor",
        "The number is misprinted: 90.6, 90.8 or 90.68 % may be meant.",
    )


def time_without_stop() -> Finding:
    """Return the sum of the printed times."""
    first = sum(phase["duration_s"] for phase in printed_phases("part I"))
    stop, total = printed_paper()["stop_duration_s"], tram_scenario(0.0).travel_time_s
    whole = first + stop + part_two_time_s()
    return judge(
        f"{first:.2f} + {part_two_time_s():.2f} s of phases and {stop} s of the stop: {whole:.2f} s",
        abs(first + part_two_time_s() - total) < abs(whole - total),
        f"The printed phases of Figs. 3 and 4 take {total:g} s only with the stop.",
    )


EXAMINATIONS: Examinations = {
    "saving_without_recuperation": partial(saving, 0.0),
    "saving_with_recuperation": partial(saving, 1.0),
    "longer_cruise": longer_cruise,
    "cruise_and_coasting": cruise_and_coasting,
    "better_efficiency": better_efficiency,
    "better_power_factor": better_power_factor,
    "many_variants": many_variants,
    "start_above_resistance": start_above_resistance,
    "recuperation_saves": recuperation_saves,
    "penalty_without_recuperation": partial(penalty, 0.0),
    "penalty_with_recuperation": partial(penalty, 1.0),
    "delay_recovered": delay_recovered,
    "quicker_ride": quicker_ride,
    "second_start": second_start,
    "different_runs": different_runs,
    "accepted_delay": accepted_delay,
    "updated_run": updated_run,
    "all_disturbances": all_disturbances,
    "rated_efficiency": rated_efficiency,
    "time_without_stop": time_without_stop,
}
"""The examination of each claim, by its name in the paper's file."""
