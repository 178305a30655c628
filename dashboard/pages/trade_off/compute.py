"""The energy-time frontier of a scenario, and ENOC's map."""

from dataclasses import dataclass, replace

import numpy as np

from railjoule.core import Scenario, StrategyRefusedError
from railjoule.core.arrays import FloatArray
from railjoule.core.citation import printed_numbers
from railjoule.core.energy import share_above
from railjoule.core.strategies import prepare_task
from railjoule.core.strategies.enoc import (
    EnocCoefficients,
    best_acceleration_time,
    enoc_coefficients,
    enoc_energy,
    enoc_surface,
)
from railjoule.core.strategies.plain_line import plain_line
from railjoule.core.studies.tradeoff import Frontier, energy_time_frontier, enoc_frontier, frontier_times
from railjoule.core.units import J_PER_KWH, MS_PER_KMH

Points = tuple[FloatArray, FloatArray, FloatArray]
"""Travel times [s], acceleration times [s] and energies [kWh]."""


@dataclass(frozen=True, eq=False)
class EnocMap:
    """ENOC's energy over travel time and acceleration time, with its valley.

    Parameters
    ----------
    travel_time_s : array of shape (m,)
        Travel times [s].
    acceleration_time_s : array of shape (k,)
        Acceleration times [s].
    energy_kwh : array of shape (k, m)
        Energies [kWh]; NaN where the ramps do not fit.
    best_acceleration_s, best_energy_kwh : array of shape (m,)
        The valley: the best acceleration time for each travel time [s], and its energy [kWh].
    """

    travel_time_s: FloatArray
    acceleration_time_s: FloatArray
    energy_kwh: FloatArray
    best_acceleration_s: FloatArray
    best_energy_kwh: FloatArray


@dataclass(frozen=True)
class EnocPoint:
    """One run of ENOC: travel and acceleration time [s], energy [kWh] and maximum speed [km/h]."""

    travel_time_s: float
    acceleration_time_s: float
    energy_kwh: float
    max_speed_kmh: float


@dataclass(frozen=True, eq=False)
class TradeOff:
    """The energy-time frontier of a scenario and, on plain lines, ENOC's map.

    Parameters
    ----------
    scenario : Scenario
        The request; its own travel time does not matter.
    frontier : Frontier
        The optima.
    enoc : Frontier or None
        ENOC's energy with its best acceleration time at the frontier's times, and which of them it refuses.
    coefficients : EnocCoefficients or None
        ENOC's closed form, to ask for single points.
    enoc_map : EnocMap or None
        Its map, with the copper weight asked for.
    refusal : str
        Why there is no ENOC; empty where there is.
    """

    scenario: Scenario
    frontier: Frontier
    enoc: Frontier | None
    coefficients: EnocCoefficients | None
    enoc_map: EnocMap | None
    refusal: str

    @property
    def enoc_curve(self) -> Points:
        """The travel times that ENOC accepts [s], its energies and the optimal ones [kWh]; empty without ENOC."""
        if self.enoc is None:
            return np.zeros(0), np.zeros(0), np.zeros(0)
        accepted = np.isfinite(self.enoc.energy_kwh)
        return self.enoc.travel_time_s[accepted], self.enoc.energy_kwh[accepted], self.frontier.energy_kwh[accepted]

    @property
    def enoc_share(self) -> FloatArray:
        """ENOC's extra energy over the optimum along `enoc_curve` [%]."""
        _, enoc, optimal = self.enoc_curve
        return 100 * share_above(enoc, optimal)

    def enoc_point(self, travel_time_s: float, acceleration_time_s: float | None = None) -> EnocPoint | None:
        """Return ENOC's run in a travel time [s] by its closed form; None without ENOC.

        The acceleration time [s] is the best one where none is given.
        """
        form = self.coefficients
        if form is None:
            return None
        ramp = best_acceleration_time(form, travel_time_s) if acceleration_time_s is None else acceleration_time_s
        energy_kwh = float(enoc_energy(form, travel_time_s, ramp)) / J_PER_KWH
        return EnocPoint(travel_time_s, ramp, energy_kwh, float(form.cruise_speed_ms(travel_time_s, ramp)) / MS_PER_KMH)

    def enoc_refusal(self, travel_time_s: float) -> str:
        """Return why ENOC cannot run in a travel time [s], in one sentence; empty if it can."""
        if self.enoc is None:
            return f"ENOC {self.refusal}"
        times = self.frontier.travel_time_s
        nearest = float(times[np.argmin(np.abs(times - travel_time_s))])
        reason = dict(self.enoc.refused).get(nearest)
        return f"Here ENOC ignores limits of the vehicle: for {nearest:.1f} s it {reason}" if reason else ""

    def printed_points(self, everywhere: bool = False) -> Points:
        """Return the runs that Ftorek 2025 prints for this scenario; none for others.

        Table 2 has real timetables. Table 3, included if `everywhere`, has times up to 5000 s and 3.087 times the
        copper loss.
        """
        vehicle, line = self.scenario.vehicle, self.scenario.line
        is_in_paper = (
            vehicle.preset == "suburban-ftorek"
            and line.preset == "flat-5km"
            and vehicle.load_factor == 0
            and vehicle.drive.recuperation_factor == 1
        )
        paper = printed_numbers("ftorek-2025") if is_in_paper else {"table_2": [], "table_3": []}
        rows = paper["table_2"] + (paper["table_3"] if everywhere else [])
        times, ramps, energies = (
            np.array([row[key] for row in rows], dtype=float)
            for key in ("travel_time_s", "acceleration_time_s", "total_energy_wh")
        )
        return times, ramps, energies / 1000


MAP_SIZE = 80
NARROW_MAP_S = ((1.2, 2.5), (15.0, 110.0))
"""Travel times of the map as multiples of the shortest time, and acceleration times [s], for real timetables."""
WIDE_MAP_S = ((600.0, 5000.0), (10.0, 250.0))
"""Travel and acceleration times of Figure 6a of Ftorek 2025 [s]."""


def compute_trade_off(scenario: Scenario, longest_time_s: float, wide_map: bool, copper_weight: float) -> TradeOff:
    """Return the frontier of a scenario and, on plain lines, ENOC's curve and map.

    Parameters
    ----------
    scenario : Scenario
        Its own travel time does not matter.
    longest_time_s : float
        The end of the frontier, or earlier [s].
    wide_map : bool
        Whether ENOC's map has the times of the paper's figure.
    copper_weight : float
        Copper loss of that map over the vehicle's own.

    Raises
    ------
    RailjouleError
        If the line cannot be run over at all.
    """
    task = prepare_task(scenario)
    # at least as far as the slider of the travel time goes: TIMETABLE_RANGE in state/scenario.py
    share = max(2.0, (longest_time_s - task.dwell_s) / task.shortest_time_s)
    frontier = energy_time_frontier(task, frontier_times(task, longest_share=share))
    try:
        line = plain_line(task)
    except StrategyRefusedError as refusal:
        return TradeOff(scenario, frontier, None, None, None, str(refusal))
    # only for the map: ENOC's curve and single points keep the vehicle's own loss
    weighted = replace(line, loss_coefficient=line.loss_coefficient * copper_weight)
    return TradeOff(
        scenario=scenario,
        frontier=frontier,
        enoc=enoc_frontier(task, frontier.travel_time_s),
        coefficients=enoc_coefficients(line),
        enoc_map=_enoc_map(enoc_coefficients(weighted), None if wide_map else task.shortest_time_s),
        refusal="",
    )


def compute_enoc_map(scenario: Scenario) -> EnocMap | None:
    """Return ENOC's map for real timetables, or None where ENOC does not take the scenario."""
    task = prepare_task(scenario)
    try:
        line = plain_line(task)
    except StrategyRefusedError:
        return None
    return _enoc_map(enoc_coefficients(line), task.shortest_time_s)


def _enoc_map(coefficients: EnocCoefficients, shortest_time_s: float | None) -> EnocMap:
    """Return the map around a shortest time, or that of the paper's figure."""
    (first, last), ends = WIDE_MAP_S if shortest_time_s is None else NARROW_MAP_S
    unit = 1.0 if shortest_time_s is None else shortest_time_s
    times, ramps = np.linspace(first * unit, last * unit, MAP_SIZE), np.linspace(*ends, MAP_SIZE)
    best = np.array([best_acceleration_time(coefficients, time) for time in times])
    energies = enoc_energy(coefficients, times, best) / J_PER_KWH
    return EnocMap(times, ramps, enoc_surface(coefficients, times, ramps) / J_PER_KWH, best, energies)
