"""Runs of Rawicki's tram, each computed once for tables, claims and figures; kr is the recuperation factor."""

from dataclasses import replace
from functools import cache
from typing import Any

from railjoule.core.citation import printed_numbers
from railjoule.core.phase_planning.plan import PhasePlan, PlannedPhase
from railjoule.core.phase_planning.planner import PhasePlanner
from railjoule.core.scenario import Scenario, load_scenario
from railjoule.core.scenario.disturbance import Reaction
from railjoule.core.simulation.disturbances import DisturbedRun, simulate_disturbances
from railjoule.core.strategies import solve
from railjoule.core.trajectory import Trajectory
from railjoule.core.units import J_PER_KWH
from railjoule.core.validation.rawicki_identification import printed_planner

PAPER = printed_numbers("rawicki-2013")
"""The printed numbers; not to be changed."""
RECUPERATION_FACTORS = (0.0, 1.0)
"""Of Figs. 1 and 3, and of Figs. 2 and 4."""
STATION_DWELL_S = 20.0
"""Assumed, between two segments: it moves both runs alike."""

Printed = dict[str, Any]


@cache
def tram_scenario(kr: float) -> Scenario:
    """Return the run of Figs. 1 or 2."""
    return load_scenario(PAPER["scenario"]).replace(**{"drive.recuperation_factor": kr})


@cache
def make_planner(kr: float, **options: Any) -> PhasePlanner:
    """Return the planner whose starts hold their current; `options` are those of `[phases]`."""
    return printed_planner(tram_scenario(kr).vehicle, kr, **options)


@cache
def plan_run(kr: float, **options: Any) -> PhasePlan:
    """Return the best run of Figs. 1 or 2 with the paper's starts; arguments as in `make_planner`."""
    scenario = tram_scenario(kr)
    return make_planner(kr, **options).plan(scenario.line.length_m, scenario.travel_time_s)


@cache
def plan_part_two(kr: float, later_s: float = 0.0) -> PhasePlan:
    """Return the best run from the unplanned stop to the end.

    Parameters
    ----------
    kr : float
    later_s : float
        Accepted delay [s].
    """
    paper = PAPER
    return make_planner(kr).plan(float(paper["part_ii_length_m"]), part_two_time_s() + later_s)


@cache
def drive_part_one(kr: float) -> tuple[PlannedPhase, ...]:
    """Return the phases of part I, which the driver chose: they are data and no result of a plan."""
    start, cruise, _ = printed_phases("part I")
    speed, cruise_m = float(start["end_ms"]), float(cruise["distance_m"])
    driven = replace(plan_part_two(kr), cruise_speed_ms=speed, brake_speed_ms=speed, cruise_m=cruise_m)
    return make_planner(kr).planned_phases(driven)


@cache
def solve_phases(kr: float) -> Trajectory:
    """Return the run of Figs. 1 or 2 by the strategy `phases`."""
    return solve(tram_scenario(kr), "phases")


@cache
def replan(kr: float, reaction: Reaction) -> DisturbedRun:
    """Return the run with the stop, replanned on the way by the one who reacts to it."""
    scenario = load_scenario("tram-950m-stop").replace(**{"drive.recuperation_factor": kr})
    return simulate_disturbances(scenario, reaction)


@cache
def replan_two_segments(kr: float) -> DisturbedRun:
    """Return the run with the stop over two equal segments in the double time, replanned by the paper's driver."""
    scenario = load_scenario("tram-950m-stop")
    length, time = scenario.line.length_m, scenario.travel_time_s
    changes = {
        "drive.recuperation_factor": kr,
        "line.sections": [{"length_m": 2 * length}],
        "line.stations": [{"position_m": length, "dwell_s": STATION_DWELL_S}],
        "timetable.travel_time_s": 2 * time + STATION_DWELL_S,
    }
    return simulate_disturbances(scenario.replace(**changes), "driver")


def energy_with_stop_kwh(kr: float) -> float:
    """Return the energy of parts I and II [kWh]."""
    return sum(phase.energy_j for phase in drive_part_one(kr)) / J_PER_KWH + energy_kwh(plan_part_two(kr))


def energy_kwh(plan: PhasePlan) -> float:
    """Return the energy of a plan [kWh]."""
    return plan.energy_j / J_PER_KWH


def printed_phases(part: str) -> list[Printed]:
    """Return the printed phases of a part."""
    return [phase for phase in PAPER["phase"] if phase["part"] == part]


def part_two_time_s() -> float:
    """Return the printed time of part II for kr = 0, the sum of its phases [s]; that for kr = 1 is the same."""
    return float(round(sum(phase["duration_s"] for phase in printed_phases("part II, kr = 0")), 6))


def supply_energy_kwh(phase: Printed, kr: float) -> float:
    """Return the printed energy of a phase [kWh]: braking energies are printed for kr = 1 and count by the share."""
    energy = float(phase.get("energy_kwh", 0.0))
    return energy if energy > 0 else kr * energy
