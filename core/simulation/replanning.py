"""The state of a moving train, and the plan of the rest of its run.

A rest that cannot be kept is driven as fast as allowed. A stop noticed too late is made as soon as the brakes can. An
on-board computer has little time: its plans ahead use a strategy and a mesh that suffice for it.
"""

import math
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.drive import make_drive
from railjoule.core.errors import (
    InfeasibleLineError,
    ScenarioError,
    SolverError,
    StrategyRefusedError,
    TimetableError,
)
from railjoule.core.motion import MeshedLine, build_meshed_line
from railjoule.core.motion.driving import STANDING_SPEED2, brake_fully, braking_envelope
from railjoule.core.motion.mesh import line_mesh
from railjoule.core.scenario import Scenario, Vehicle
from railjoule.core.scenario.disturbance import (
    Event,
    RecuperationChange,
    UnplannedLimit,
    UnplannedStop,
    VoltageChange,
)
from railjoule.core.scenario.line import SHORTEST_DISTANCE_M, SpeedLimit, Station
from railjoule.core.scenario.scenario import Timetable
from railjoule.core.simulation.actual_vehicle import at_voltage, changed
from railjoule.core.simulation.leg import SAME_PLACE_M, Leg, make_leg
from railjoule.core.strategies import run_strategy
from railjoule.core.task import prepare_task

# A train that learns of something while it brakes fully continues on another mesh, which may miss a stop by some
# decimetres, or a square of speed by some tenths of a percent, though it was just able to brake for them. So much
# does not count as noticed too late; larger values would hide a notice that did come too late.
ROUNDING_M, ROUNDING_RATIO = 0.5, 1e-2
# An overshoot below a centimetre is not mentioned.
NOTICEABLE_M = 0.01
REPLAN_S = 0.05
"""A plan ahead of an on-board computer is to take no longer [s]."""
# Measured with the shipped scenarios: interior points take 4 microseconds a cell, phases 0.5 ms, Bellman 1 ms
MAX_CELLS, SLOW_CELLS = 5000, {"phases": 60, "bellman": 32}
"""Cells of the mesh ahead, beside those that stops and borders add: in general, and of slow strategies."""


@dataclass(frozen=True)
class State:
    """A moving train: position [m], square of speed [m2/s2], time [s], its scenario with all that is known."""

    position_m: float
    speed2: float
    time_s: float
    scenario: Scenario

    @property
    def speed_ms(self) -> float:
        """Speed [m/s]."""
        return math.sqrt(self.speed2)


def event_words(event: Event) -> str:
    """Return a short description of an event."""
    match event:
        case UnplannedStop():
            return f"stop of {event.duration_s:g} s at {event.position_m:g} m"
        case UnplannedLimit():
            return f"limit of {event.limit_kmh:g} km/h from {event.from_m:g} to {event.to_m:g} m"
        case VoltageChange():
            return f"supply voltage {100 * event.line_voltage_factor:g} %"
    assert isinstance(event, RecuperationChange)
    return f"recuperation {100 * event.recuperation_factor:g} %"


def change_line(scenario: Scenario, **fields: object) -> Scenario:
    """Return a scenario with other fields of its line, which were validated before."""
    return scenario.model_copy(update={"line": scenario.line.model_copy(update=fields)})


def knowing(state: State, event: Event, nominal: Vehicle) -> State:
    """Return a state in which an event is known; `nominal` is the vehicle before any event."""
    scenario, line, vehicle = state.scenario, state.scenario.line, state.scenario.vehicle
    recuperation = vehicle.drive.recuperation_factor
    match event:
        case UnplannedStop():
            added = Station(position_m=event.position_m, dwell_s=event.duration_s)
            stations = sorted((*line.stations, added), key=lambda station: station.position_m)
            return replace(state, scenario=change_line(scenario, stations=tuple(stations)))
        case UnplannedLimit():
            # limits may overlap: the lowest holds, so one more does no harm
            limit = SpeedLimit(from_m=event.from_m, to_m=event.to_m, limit_kmh=event.limit_kmh)
            return replace(state, scenario=change_line(scenario, speed_limits=(*line.speed_limits, limit)))
        case VoltageChange():
            # over the nominal voltage, whatever it was before
            vehicle = at_voltage(nominal, event.line_voltage_factor)
        case RecuperationChange():
            recuperation = event.recuperation_factor
    vehicle = changed(vehicle, drive=vehicle.drive.model_copy(update={"recuperation_factor": recuperation}))
    return replace(state, scenario=scenario.model_copy(update={"vehicle": vehicle}))


def rest_scenario(state: State, allowed_time_s: float) -> Scenario:
    """Return the scenario of what is left: the stations ahead, and the time that remains."""
    line = state.scenario.line
    ahead = tuple(
        _from_now(station, state.time_s, is_end=station == line.end_station)
        for station in line.stations
        if station.position_m > state.position_m + SAME_PLACE_M
    )
    # where no time is left, a timetable that nobody can keep: the caller then drives the fastest
    left = max(allowed_time_s - state.time_s, 1e-3)
    # the state is the start, with a speed of its own; the end stays as it is
    timetable = Timetable(travel_time_s=left, exit_speed_kmh=state.scenario.timetable.exit_speed_kmh)
    return change_line(state.scenario, stations=ahead).model_copy(update={"timetable": timetable})


def _from_now(station: Station, time_s: float, is_end: bool) -> Station:
    """Return a station whose window of arrival counts from a time of the run [s]."""
    earliest, latest = station.earliest_arrival_s, station.latest_arrival_s
    window = {
        "earliest_arrival_s": None if earliest is None else max(earliest - time_s, 0.0),
        # a window that has passed stays one that nobody can keep
        # at the end, the time that is allowed has it already, with the delay that is accepted
        "latest_arrival_s": None if latest is None or is_end else max(latest - time_s, 1e-3),
    }
    return station.model_copy(update=window)


def nodes_ahead(state: State, end_m: float) -> FloatArray:
    """Return the nodes of what is left up to a place [m], finer where the train starts or stops."""
    mesh = line_mesh(state.scenario.line, state.scenario.solver.mesh_m, state.scenario.limits_last_m)
    # no cell of less than a millimetre at either end, whose force would be rounding over rounding
    inside = mesh[(mesh > state.position_m + 1e-3) & (mesh < end_m - 1e-3)]
    return np.concatenate([[state.position_m], inside, [end_m]])


def mesh_ahead(state: State, end_m: float, final_ms: float | None = None) -> MeshedLine:
    """Return the meshed line from a state to a place [m], with a speed there [m/s]; by default the timetable's."""
    return build_meshed_line(state.scenario, state.speed_ms, final_ms, nodes_ahead(state, end_m))


def require_events_on_the_line(scenario: Scenario) -> None:
    """Raise ScenarioError for events outside the line and stops at one place."""
    disturbance, length = scenario.disturbance, scenario.line.length_m
    for name in ("coordinate_error_m", "departure_delay_s"):
        value = getattr(disturbance, name)
        if value != 0:
            raise ScenarioError(
                f"disturbance.{name} = {value:g} must be 0 in a run with stops, limits or other voltages: it is "
                "simulated only for followed plans."
            )
    begins = [
        *((f"stops[{k}].position_m", stop.position_m, SHORTEST_DISTANCE_M) for k, stop in enumerate(disturbance.stops)),
        *((f"speed_limits[{k}].from_m", one.from_m, 0.0) for k, one in enumerate(disturbance.speed_limits)),
    ]
    for name, place_m, min_m in begins:
        if place_m > length - min_m or place_m == length:
            raise ScenarioError(
                f"disturbance.{name} = {place_m:g} must lie before the end of the line at {length:g} m."
            )
    # closer than this, two stops would leave no meshed line between them
    places = [stop.position_m for stop in disturbance.stops]
    places += [station.position_m for station in scenario.line.in_running_order().inner_stations]
    if any(later - earlier < SHORTEST_DISTANCE_M for earlier, later in pairwise(sorted(places))):
        raise ScenarioError(
            f"disturbance.stops must be at least {SHORTEST_DISTANCE_M:g} m from one another and from stations."
        )


class Replanner:
    """Plans the rest of a run from a state.

    Parameters
    ----------
    allowed_time_s : float
        Time of the whole run, the accepted delay included [s].

    Attributes
    ----------
    notes : list of str
        Sentences on stops, limits and windows that the plans could not keep.
    is_fastest : bool
        Whether the last plan drives as fast as allowed, as the time is too short.
    """

    def __init__(self, allowed_time_s: float) -> None:
        self.allowed_time_s = allowed_time_s
        self.notes: list[str] = []
        self.is_fastest = False

    def drive_and_plan(self, leg: Leg, state: State) -> Leg:
        """Return a leg and the best run from its end."""
        end = float(leg.position_m[-1])
        if end >= state.scenario.line.length_m - SAME_PLACE_M:
            return leg
        after = State(end, float(leg.speed2[-1]), state.time_s + leg.duration_s, state.scenario)
        return leg.then(self.plan(after))

    def plan(self, state: State) -> Leg:
        """Return the best run from a state to the end, or the fastest if the time is too short."""
        rest = rest_scenario(state, self.allowed_time_s)
        try:
            task = prepare_task(rest, state.speed_ms, position_m=nodes_ahead(state, rest.line.length_m))
        except InfeasibleLineError:
            # a standing train has nothing to brake for: its line is infeasible for good
            if state.speed2 <= STANDING_SPEED2:
                raise
            return self._brake_at_once(state)
        try:
            return replace(make_leg(run_strategy(task, rest.strategy)), scenario=state.scenario)
        except ScenarioError:
            line, no_window = state.scenario.line, {"earliest_arrival_s": None, "latest_arrival_s": None}
            stations = tuple(station.model_copy(update=no_window) for station in line.stations)
            if stations == line.stations:
                raise
            # a window of arrival that this train cannot keep any more
            self.notes.append("The windows of arrival ahead cannot be kept any more, and are given up.")
            free = change_line(state.scenario, stations=stations)
            return replace(self.plan(replace(state, scenario=free)), scenario=state.scenario)
        except TimetableError:
            self.is_fastest = True
            return replace(make_leg(run_strategy(task, "fastest")), scenario=state.scenario)

    def _brake_at_once(self, state: State) -> Leg:
        """Brake fully until all that lies ahead can be kept again, or to a stand beyond a stop."""
        mesh = mesh_ahead(state, state.scenario.line.length_m)
        nodes = mesh.position_m
        run, distance = brake_fully(mesh.data, state.speed2)
        stands = np.inf if np.isnan(distance) else state.position_m + distance
        stations = state.scenario.line.inner_stations
        missed = [station for station in stations if state.position_m < station.position_m < stands]
        if not missed:
            return self.drive_and_plan(self._slowed(state, nodes, run, braking_envelope(mesh)), state)
        if not np.isfinite(stands):
            raise InfeasibleLineError(
                f"From {state.position_m:.0f} m on, the brakes do not stop the train before the end of the line."
            )
        return self._beyond(state, np.append(nodes[nodes < stands - SAME_PLACE_M], stands), run, missed)

    def _slowed(self, state: State, nodes: FloatArray, run: FloatArray, envelope: FloatArray) -> Leg:
        """Return full braking until the limits ahead can be kept."""
        # the tolerance is that of comparing two sums of the same cells, one from each end
        slow = np.flatnonzero((run <= envelope * (1 + 1e-9)) & (run > 0))
        if not len(slow):
            raise InfeasibleLineError(
                f"From {state.position_m:.0f} m on, the brakes cannot keep the limits and stops ahead."
            )
        end = int(slow[0])
        if run[0] > envelope[0] * (1 + ROUNDING_RATIO):
            self.notes.append(f"A limit becomes known too late: the train is slow enough only at {nodes[end]:.0f} m.")
        return Leg(state.scenario, nodes[: end + 1], run[: end + 1], np.zeros(end + 1))

    def _beyond(self, state: State, places: FloatArray, run: FloatArray, missed: list[Station]) -> Leg:
        """Return full braking to a stand beyond stops, which are made there, and the rest."""
        overshoot = float(places[-1]) - missed[0].position_m
        if overshoot > ROUNDING_M:
            names = ", ".join(f"{station.position_m:.0f} m" for station in missed)
            self.notes.append(
                f"The stop at {names} becomes known too late: the train stands at {places[-1]:.1f} m, "
                f"{overshoot:.1f} m too far."
            )
        elif overshoot > NOTICEABLE_M:
            self.notes.append(
                f"The train overshoots its stop at {missed[0].position_m:.0f} m by {overshoot:.2f} m: its brakes "
                "cannot do more."
            )
        line = state.scenario.line
        made = Station(position_m=float(places[-1]), dwell_s=sum(station.dwell_s for station in missed))
        kept = [station for station in line.stations if station not in missed]
        # a train that learns of more while it brakes still stands there
        stations = tuple(sorted((*kept, made), key=lambda station: station.position_m))
        scenario = change_line(state.scenario, stations=stations)
        leg = Leg(scenario, places, np.append(run[: len(places) - 1], 0.0), dwell_at_end(places, made.dwell_s))
        return self.drive_and_plan(leg, replace(state, scenario=scenario))


def dwell_at_end(nodes: FloatArray, dwell_s: float) -> FloatArray:
    """Return dwells [s] of a leg that stands only at its last node; shape of the nodes."""
    dwell = np.zeros(len(nodes))
    dwell[-1] = dwell_s
    return dwell


def plan_quickly(state: State, allowed_time_s: float) -> tuple[Leg, str, list[str]]:
    """Return the plan from a state to the end, its strategy, and sentences on what it cannot keep.

    Parameters
    ----------
    state : State
    allowed_time_s : float
        Time of the whole run, the accepted delay included [s].

    Raises
    ------
    InfeasibleLineError
        If the line ahead cannot be driven.
    """
    scenario, stand_in = state.scenario, strategy_for_all_lines(state.scenario)
    own = scenario.strategy if scenario.strategy in {"phases", "fastest"} else stand_in
    refusals: list[StrategyRefusedError | SolverError] = []
    for strategy in dict.fromkeys((own, stand_in)):
        # cells so long that the plan takes REPLAN_S at most
        cells = SLOW_CELLS.get(strategy, MAX_CELLS)
        mesh_m = max(scenario.solver.mesh_m, (scenario.line.length_m - state.position_m) / cells)
        solver = scenario.solver.model_copy(update={"mesh_m": mesh_m})
        quick = scenario.model_copy(update={"strategy": strategy, "solver": solver})
        planner = Replanner(allowed_time_s)
        try:
            leg = planner.plan(replace(state, scenario=quick))
        except (StrategyRefusedError, SolverError) as refusal:
            refusals.append(refusal)
        else:
            return leg, "fastest" if planner.is_fastest else strategy, planner.notes
    raise refusals[-1]


def strategy_for_all_lines(scenario: Scenario) -> str:
    """Return the fast strategy that takes every line."""
    # the optimum of a drive with idle losses decides where it is on, which takes a tenth of a second and more
    return "bellman" if make_drive(scenario.vehicle.drive).has_idle_losses else "optimal"
