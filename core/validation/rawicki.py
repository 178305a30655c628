"""Quantities of Rawicki 2013 that `assets/papers/rawicki-2013.toml` compares with the paper.

His start holds its full current at all speeds; above 14 m/s the pull-out torque needs less, so the strategy `phases`
needs a little less energy than his law. Here the runs are planned with his law, and once with `phases`. The argument of
most functions is the recuperation factor kr.
"""

from functools import cache
from operator import attrgetter
from typing import Any, get_args

import numpy as np

from railjoule.core.bounds import minimise
from railjoule.core.energy import share_above
from railjoule.core.scenario.disturbance import Reaction
from railjoule.core.simulation.disturbances import simulate_disturbances
from railjoule.core.strategies import prepare_task, run_strategy, solve
from railjoule.core.studies.flux_sweep import sweep_flux
from railjoule.core.units import J_PER_KWH
from railjoule.core.validation.rawicki_identification import (
    driven_values,
    identify,
    machine_values,
    nameplate_values,
    printed_planner,
    value_names,
)
from railjoule.core.validation.rawicki_runs import (
    PAPER,
    RECUPERATION_FACTORS,
    drive_part_one,
    energy_kwh,
    energy_with_stop_kwh,
    make_planner,
    part_two_time_s,
    plan_part_two,
    plan_run,
    printed_phases,
    replan,
    replan_two_segments,
    solve_phases,
    supply_energy_kwh,
    tram_scenario,
)

Quantities = dict[str, Any]

FLUX = ("drive.mutual_inductance_mh", "drive.rated_magnetising_current_a")
"""Parameters of which only the product is determined well."""
SYMBOLS = {"distance_m": ("s", "m"), "duration_s": ("t", "s"), "energy_kwh": ("En", "kWh")}
LATER_S = 10.0
"""An accepted delay that is tried."""
GENTLE_SHARE = 0.5
"""Braking current of a gentle driver over the full one."""


def _entry(key: str, kr: float, place: str = "") -> Quantities:
    """Return the first entry of a list of the file with a recuperation factor and the start of a place."""
    entries = PAPER[key]
    return next(one for one in entries if one["recuperation_factor"] == kr and one["place"].startswith(place))


def figure(place: str) -> Quantities:
    """Compute the energies of one of Figures 1 to 4 [kWh]; the run with the stop as two plans."""
    entry = next(one for one in PAPER["figure"] if one["place"] == place)
    kr = float(entry["recuperation_factor"])
    undisturbed, whole = energy_kwh(plan_run(kr)), energy_with_stop_kwh(kr)
    penalty = 100 * share_above(whole, undisturbed)
    return {
        "kr": kr,
        "printed": entry,
        "undisturbed": undisturbed,
        "whole": whole,
        "second": energy_kwh(plan_part_two(kr)),
        "printed_second": printed_part_two(kr),
        "penalty": penalty,
        "penalty_off": abs(penalty - entry.get("penalty_percent", 0.0)),
    }


def printed_part_two(kr: float) -> float:
    """Return the printed energy of the run with the stop, less that of part I [kWh]."""
    entry = next(one for one in PAPER["figure"][2:] if one["recuperation_factor"] == kr)
    part_one = sum(supply_energy_kwh(phase, kr) for phase in printed_phases("part I"))
    return float(round(entry["energy_kwh"] - part_one, 3))


def planned_phases(kr: float) -> list[Quantities]:
    """Compute the phases of part II in the best run with the same distance and time."""
    planned = {phase.phase: phase for phase in make_planner(kr).planned_phases(plan_part_two(kr))}
    return [{"printed": one, "own": planned[one["phase"]]} for one in printed_phases(f"part II, kr = {kr:g}")]


def free_current(kr: float) -> Quantities:
    """Compute the run of Figures 1 and 2 with a starting current of its choice, and at one speed."""
    free, steady = plan_run(kr, free_starting_current=True), plan_run(kr, coast=False)
    return {
        "printed": _entry("reference", kr, "free"),
        "free": energy_kwh(free),
        "current_a": free.starting_current_a,
        "steady": energy_kwh(steady),
    }


def best_force_law(kr: float) -> Quantities:
    """Compute the best of all force laws, without and with free switching [kWh]."""
    task = prepare_task(tram_scenario(kr))
    run = run_strategy(task, "optimal")
    return {
        "printed": _entry("reference", kr, "best"),
        "optimal": run.energy_kwh,
        # the relaxed optimum: machines that switch on and off at will, which bounds all force laws from below
        "switched": minimise(task).energy_j / J_PER_KWH,
        "bound": run.lower_bound_kwh,
    }


def driven_phases() -> list[Quantities]:
    """Compute the 24 printed numbers of phases, each phase driven between its printed speeds."""
    phases = PAPER["phase"]
    named = [(phase, name) for phase in phases for name in value_names(phase)]
    values = driven_values(tram_scenario(0.0).vehicle, phases)
    return [
        {
            **phase,
            "symbol": SYMBOLS[name][0],
            "unit": SYMBOLS[name][1],
            "printed": phase[name],
            "value": value,
            "is_braking": phase["phase"] == "brake",
        }
        for (phase, name), value in zip(named, values, strict=True)
    ]


def replanned(kr: float) -> list[Quantities]:
    """Compute the run with the stop as driver and computer replan it during the run; the paper prints the driver's."""
    runs = {reaction: replan(kr, reaction) for reaction in get_args(Reaction)}
    return [{"who": who, "energy": run.actual.energy_kwh, "late_s": run.delay_s} for who, run in runs.items()]


def nameplate() -> Quantities:
    """Compute the nameplate of a motor at rated flux, frequency and speed."""
    plate = PAPER["nameplate"]
    printed, own = nameplate_values(plate), machine_values(tram_scenario(0.0).vehicle, plate)
    apparent = 3**0.5 * plate["voltage_v"] * plate["current_a"] * plate["power_factor"]
    voltage, current, power, factor = own
    return {
        "printed": [float(f"{value:.5g}") for value in printed],
        "own": own,
        "by_plate": 100 * 1e3 * plate["power_kw"] / apparent,
        "identified": 100 * power / (1.5 * voltage * current * factor),
    }


def parameters() -> list[Quantities]:
    """Identify the numbers of the shipped tram again, with their uncertainties [%].

    The shipped file has the result of an earlier identification: the two must agree, which no printed number could
    show.
    """
    vehicle = tram_scenario(0.0).vehicle
    identification = identify(vehicle, PAPER)
    records = []
    for key, value in zip(identification.names, identification.values, strict=True):
        records.append(
            {
                "key": key,
                "shipped": attrgetter(key)(vehicle),
                "value": value,
                "percent": identification.uncertainty_percent(key),
                "flux_percent": identification.uncertainty_percent(*FLUX),
                "note": "together" if key in (*FLUX, "drive.stator_inductance_mh") else "determined",
            }
        )
    return records


def whole_trajectory(kr: float) -> Quantities:
    """Compute the energies of the strategy `phases`, whose start takes no more current than helps [kWh]."""
    part = {
        "line.sections": [{"length_m": PAPER["part_ii_length_m"]}],
        "timetable.travel_time_s": part_two_time_s(),
    }
    return {
        "printed": _entry("figure", kr),
        "whole": solve_phases(kr).energy_kwh,
        "printed_second": printed_part_two(kr),
        "second": solve(tram_scenario(kr).replace(**part), "phases").energy_kwh,
    }


def saving(kr: float) -> Quantities:
    """Compare the best run with those of two drivers who hold one speed, of whom one brakes gently."""
    scenario = tram_scenario(kr)
    drive: Any = scenario.vehicle.drive
    gentle = scenario.replace(**{"drive.braking_current_a": GENTLE_SHARE * drive.braking_current_a}).vehicle
    ride = scenario.line.length_m, scenario.travel_time_s
    best = energy_kwh(plan_run(kr))
    others = [energy_kwh(plan_run(kr, coast=False)), energy_kwh(printed_planner(gentle, kr, coast=False).plan(*ride))]
    return {"best": best, "others": others, "saved": [100 * (1 - best / other) for other in others]}


def phase_lengths() -> Quantities:
    """Compute the lengths of cruise and coasting with kr = 0 and 1, in the whole run and in its second part [m]."""
    lengths: dict[str, list[float]] = {}
    for plan, prefix in ((plan_run, ""), (plan_part_two, "second_")):
        for kr in RECUPERATION_FACTORS:
            phases = make_planner(kr).planned_phases(plan(kr))
            for name in ("cruise", "coast"):
                length_m = float(sum(one.distance_m for one in phases if one.phase == name))
                lengths.setdefault(prefix + name, []).append(length_m)
    cruise, coast = lengths["second_cruise"], lengths["second_coast"]
    return {
        **lengths,
        "longer": lengths["cruise"][1] - lengths["cruise"][0],
        "shortest": min(lengths["cruise"] + lengths["coast"]),
        "free_cruise": [plan_run(kr, free_starting_current=True).cruise_m for kr in RECUPERATION_FACTORS],
        "differs": min(cruise[1] - cruise[0], coast[0] - coast[1]),
    }


@cache
def cruise() -> Quantities:
    """Compute efficiency and power factor of the printed cruise of part I over the flux."""
    sweep = sweep_flux(tram_scenario(0.0).vehicle, float(printed_phases("part I")[1]["start_ms"]))
    best, within, rated = sweep.min_loss, sweep.within_voltage, sweep.rated
    allowed = [one for one in sweep.points if one.phase_voltage_v <= sweep.max_phase_voltage_v]
    low, high = allowed[0], allowed[-1]
    efficiencies, factors = (
        [getattr(one, key) for one in (best, within, rated)] for key in ("efficiency", "power_factor")
    )
    return {
        "sweep": sweep,
        "efficiency": [100 * value for value in efficiencies],
        "efficiency_falls": min(-np.diff(efficiencies)),
        "factor_falls": min(-np.diff(factors)),
        "voltage_falls": within.phase_voltage_v - best.phase_voltage_v,
        "low": low,
        "high": high,
        "voltage_range_v": high.phase_voltage_v - low.phase_voltage_v,
    }


def start_above_resistance() -> Quantities:
    """Compute the tractive effort of a start over the resistance."""
    model = make_planner(0.0).model
    speeds = np.array([0.0, float(printed_phases("part II, kr = 0")[0]["end_ms"])])
    ratios = model.starting_effort_n(speeds) / model.resistance_n(speeds)
    return {"ratios": ratios, "top_ms": speeds[1], "least": ratios.min()}


def recuperation() -> Quantities:
    """Compare the energies of Figs. 1 and 2 [kWh]."""
    energy = [energy_kwh(plan_run(kr)) for kr in RECUPERATION_FACTORS]
    printed = [entry["energy_kwh"] for entry in PAPER["figure"][:2]]
    return {
        "energy": energy,
        "printed": printed,
        "less": 100 * (1 - energy[1] / energy[0]),
        "printed_less": 100 * (1 - printed[1] / printed[0]),
        "off": max(100 * abs(share_above(own, other)) for own, other in zip(energy, printed, strict=True)),
    }


def disturbed_runs() -> Quantities:
    """Compute the runs with the stop: their delays, and energies of driver and computer [kWh]."""
    runs = {who: [replan(kr, who) for kr in RECUPERATION_FACTORS] for who in get_args(Reaction)}
    energies = {who: [run.actual.energy_kwh for run in both] for who, both in runs.items()}
    two, one = replan_two_segments(0.0), runs["driver"][0]
    more, shared = (run.actual.energy_kwh - run.planned.energy_kwh for run in (one, two))
    return {
        **energies,
        "gain": min(np.subtract(energies["driver"], energies["computer"])),
        "latest_s": max(run.delay_s for run in runs["driver"]),
        "time_s": one.actual.travel_time_s,
        "spare_s": part_two_time_s() - make_planner(0.0).fastest(plan_part_two(0.0).distance_m).running_time_s,
        "printed_s": part_two_time_s(),
        "more": more,
        "shared": shared,
        "saved": more - shared,
        "segment_m": one.planned.position_m[-1],
        "two_late_s": two.delay_s,
    }


def second_part() -> Quantities:
    """Compare the second part with the undisturbed run, with an accepted delay, and both starts; kr = 0."""
    undisturbed, second, later = plan_run(0.0), plan_part_two(0.0), plan_part_two(0.0, LATER_S)
    starts = [
        sum(phase.energy_j for phase in phases if phase.phase == "start") / J_PER_KWH
        for phases in (drive_part_one(0.0), make_planner(0.0).planned_phases(second))
    ]
    return {
        "speed_ms": [undisturbed.cruise_speed_ms, second.cruise_speed_ms],
        "faster_ms": second.cruise_speed_ms - undisturbed.cruise_speed_ms,
        "energy": [energy_kwh(undisturbed), energy_kwh(second), energy_kwh(later)],
        "less": energy_kwh(second) - energy_kwh(later),
        "starts": starts,
        "starts_above": sum(starts) - energy_kwh(undisturbed),
    }


def changed_recuperation() -> Quantities:
    """Compute a run in which the recuperation factor falls from 1 to 0.5 at 300 m [kWh]."""
    change = [{"recuperation_factor": 0.5, "noticed_at_m": 300.0, "reaction": "computer"}]
    run = simulate_disturbances(tram_scenario(1.0).replace(**{"disturbance.recuperation_changes": change}))
    return {"actual": run.actual.energy_kwh, "planned": run.planned.energy_kwh}


def printed_times() -> Quantities:
    """Compute the sum of the printed times [s]."""
    first = sum(phase["duration_s"] for phase in printed_phases("part I"))
    stop, total = PAPER["stop_duration_s"], tram_scenario(0.0).travel_time_s
    whole = first + stop + part_two_time_s()
    nearer = abs(whole - total) - abs(first + part_two_time_s() - total)
    return {"first": first, "second": part_two_time_s(), "stop": stop, "whole": whole, "total": total, "nearer": nearer}
