"""The state of a moving train, and the rest of its line and its time."""

import math
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.errors import ScenarioError
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
from railjoule.core.simulation.leg import SAME_PLACE_M


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
            f"disturbance.stops must be at least {SHORTEST_DISTANCE_M:g} m apart from one another and from stations."
        )
