"""A run whose train learns under way of stops, limits, another line voltage or another recuperation.

Reactions, as defined for Rawicki's unplanned stops:

driver
    The driver holds the speed or keeps coasting, and brakes fully for the stop; before a limit he keeps to the plan.
    After that the rest is planned again. He does not notice another voltage or recuperation, and keeps to the plan as
    far as the train can.
computer
    From the notice on, all of the rest is planned again, the division of time between its parts included.
known
    The event is planned for before the start; another voltage or recuperation from its notice on, as by a computer.

Plans of the rest: `railjoule.core.simulation.replanning`.
Source: Rawicki, (44)-(55) and Figs. 3 and 4.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from railjoule.core.errors import InfeasibleLineError
from railjoule.core.motion import build_meshed_line
from railjoule.core.motion.driving import STANDING_SPEED2, braking_envelope, drive
from railjoule.core.scenario import Scenario
from railjoule.core.scenario.disturbance import (
    Event,
    Reaction,
    UnplannedLimit,
    UnplannedStop,
    VoltageChange,
)
from railjoule.core.simulation.actual_vehicle import actual_vehicle, notes_on, voltage_notes
from railjoule.core.simulation.leg import SAME_PLACE_M, DrivenPlan, Leg, append_leg, join_legs, make_leg
from railjoule.core.simulation.replanning import (
    Replanner,
    State,
    dwell_at_end,
    event_words,
    knowing,
    mesh_ahead,
    require_events_on_the_line,
)
from railjoule.core.strategies import run_strategy
from railjoule.core.task import prepare_task
from railjoule.core.trajectory import Trajectory
from railjoule.core.units import MS_PER_KMH

# A later arrival than this is mentioned; less is what the solvers leave of a timetable.
LATE_S = 0.05


@dataclass(frozen=True, eq=False)
class DisturbedRun(DrivenPlan):
    """A run with events, and its plan without them.

    Parameters
    ----------
    allowed_time_s : float
        Time that the timetable gives [s].
    notices : tuple of (float, float, str)
        Position [m], time [s] and description of each notice.
    notes : tuple of str
        Sentences on stops, limits and windows that could not be kept.
    """

    allowed_time_s: float
    notices: tuple[tuple[float, float, str], ...]
    notes: tuple[str, ...]

    @property
    def delay_s(self) -> float:
        """Arrival less that of the timetable [s]."""
        return self.actual.travel_time_s - self.allowed_time_s


def undisturbed_plan(scenario: Scenario) -> Trajectory:
    """Return the plan without events; errors as `railjoule.core.solve`."""
    unknowing = unknowing_scenario(scenario)
    return run_strategy(prepare_task(unknowing), unknowing.strategy)


def simulate_disturbances(
    scenario: Scenario, reaction: Reaction | None = None, planned: Trajectory | None = None
) -> DisturbedRun:
    """Drive a scenario whose train learns of its disturbances on the way.

    Parameters
    ----------
    scenario : Scenario
        With its disturbance.
    reaction : str, optional
        The one that reacts, instead of the `reaction` of the events.
    planned : Trajectory, optional
        The undisturbed plan, if it is known.

    Raises
    ------
    ScenarioError
        If an event lies outside the line, or two stops at one place.
    RailjouleError
        As `railjoule.core.solve`, if the undisturbed plan or a rest cannot be driven at all.
    """
    return _Simulation(scenario, reaction).run(planned or undisturbed_plan(scenario))


def unknowing_scenario(scenario: Scenario) -> Scenario:
    """Return a scenario in running order with the train as it is, nothing known of its events."""
    timed = scenario.with_fixed_time()
    return actual_vehicle(timed.model_copy(update={"line": timed.line.in_running_order()}))


class _Simulation(Replanner):
    """One run while it is driven: events, driven legs, notes."""

    def __init__(self, scenario: Scenario, reaction: Reaction | None) -> None:
        super().__init__(scenario.travel_time_s + scenario.disturbance.accepted_delay_s)
        require_events_on_the_line(scenario)
        self.scenario, self.unknowing = scenario, unknowing_scenario(scenario)
        events = scenario.disturbance.events
        self.events = [event.model_copy(update={"reaction": reaction}) for event in events] if reaction else [*events]
        self.notices: list[tuple[float, float, str]] = []
        voltages = any(isinstance(event, VoltageChange) for event in events)
        self.notes += voltage_notes(scenario.vehicle) if voltages else notes_on(scenario)
        self.driven: tuple[Leg, ...] = ()

    def run(self, planned: Trajectory) -> DisturbedRun:
        """Drive it, with the plan without events."""
        state, ahead = State(0.0, self.scenario.timetable.end_speeds_ms[0] ** 2, 0.0, self.unknowing), []
        for event in self.events:
            # only these can be planned for before they begin
            if event.reaction == "known" and isinstance(event, UnplannedStop | UnplannedLimit):
                state = knowing(state, event, self.unknowing.vehicle)
            else:
                ahead.append(event)
        plan = self.plan(state) if len(ahead) < len(self.events) else make_leg(planned)
        while ahead:
            notice = self._next_notice(plan, state, ahead)
            if notice is None:
                break
            place, number = notice
            event = ahead.pop(number)
            driven = plan.until(place)
            self.driven = append_leg(self.driven, driven)
            state = State(place, float(driven.speed2[-1]), state.time_s + driven.duration_s, state.scenario)
            self.notices.append((place, state.time_s, event_words(event)))
            plan = self._react(plan, state, event)
            state = replace(state, scenario=plan.scenario)
        self.driven = append_leg(self.driven, plan)
        final = self.driven[-1].scenario.model_copy(update={"timetable": self.scenario.timetable})
        actual = join_legs(self.driven, final, planned.strategy)
        allowed = self.scenario.travel_time_s
        delay = actual.travel_time_s - allowed
        if delay > self.scenario.disturbance.accepted_delay_s + LATE_S:
            self.notes.append(f"The train arrives {delay:.1f} s late.")
        return DisturbedRun(planned, actual, allowed, tuple(self.notices), tuple(self.notes))

    def _next_notice(self, plan: Leg, state: State, ahead: Sequence[Event]) -> tuple[float, int] | None:
        """Return position and number of the event of the next notice on a plan; None if there is none on it."""
        found: list[tuple[float, int]] = []
        for number, event in enumerate(ahead):
            if event.noticed_at_s is None:
                found.append((max(event.noticed_at_m or 0.0, state.position_m), number))
            elif event.noticed_at_s - state.time_s <= plan.duration_s:
                found.append((plan.place_at(max(event.noticed_at_s - state.time_s, 0.0)), number))
        place, number = min(found, default=(np.inf, 0))
        return (place, number) if place < plan.position_m[-1] - SAME_PLACE_M else None

    def _react(self, plan: Leg, state: State, event: Event) -> Leg:
        """Return the leg from a state to the end, as driver or computer react to an event."""
        informed = knowing(state, event, self.unknowing.vehicle)
        if event.reaction != "driver":
            return self.plan(informed)
        rest = plan.beyond(state.position_m)
        if isinstance(event, UnplannedStop):
            return self._stop_by_driver(rest, informed, event)
        if isinstance(event, UnplannedLimit):
            return self._slow_by_driver(rest, informed, event)
        return _kept(rest, informed)

    def _stop_by_driver(self, rest: Leg, state: State, stop: UnplannedStop) -> Leg:
        """Hold the speed or coast on, brake fully before the stop, stand, plan the rest."""
        mesh = mesh_ahead(state, stop.position_m, 0.0)
        nodes, envelope = mesh.position_m, braking_envelope(mesh)
        # too fast even for full braking: the replanning handles that
        if state.speed2 > envelope[0] * (1 + 1e-9):
            return self.plan(state)
        # a train that brakes already has no speed to hold: it keeps to its plan until it must brake for the stop
        effort = rest.effort_at(state.position_m) if len(rest.position_m) > 1 else 0.0
        moves_steadily = state.speed2 > STANDING_SPEED2 and effort >= -1e-6 * mesh.data.traction.constant_n
        target2 = np.interp(nodes, rest.position_m, rest.speed2)
        if moves_steadily:
            is_coasting = abs(effort) <= 1e-6 * mesh.data.traction.constant_n
            held2 = np.full(len(nodes), 0.0 if is_coasting else state.speed2)
            target2, _ = drive(mesh.data, held2, state.speed2, coasts=np.full(len(nodes) - 1, is_coasting))
        # only the braking before the stop cuts it: full braking, as a driver who is surprised does
        speed2 = np.minimum(target2, envelope)
        speed2[0] = state.speed2
        # one who coasts too slowly to arrive drives on
        if np.any(speed2[1:-1] <= STANDING_SPEED2):
            return self.plan(state)
        stands = dwell_at_end(nodes, stop.duration_s)
        return self.drive_and_plan(Leg(state.scenario, nodes, speed2, stands), state)

    def _slow_by_driver(self, rest: Leg, state: State, limit: UnplannedLimit) -> Leg:
        """Keep to the plan, but under the limit and what braking before it takes; then plan the rest."""
        # a leg ends at its first stop, as its meshed line has no dwell within
        end = min(limit.to_m, float(rest.position_m[-1]))
        stops = rest.position_m[rest.dwell_s > 0]
        end = float(np.min(stops[stops > state.position_m + SAME_PLACE_M], initial=end))
        final = min(float(np.sqrt(np.interp(end, rest.position_m, rest.speed2))), limit.limit_kmh * MS_PER_KMH)
        mesh = mesh_ahead(state, end, final)
        nodes, envelope = mesh.position_m, braking_envelope(mesh)
        if state.speed2 > envelope[0] * (1 + 1e-9):
            return self.plan(state)
        target2 = np.minimum(np.interp(nodes, rest.position_m, rest.speed2), envelope)
        speed2, _ = drive(mesh.data, target2, state.speed2)
        stands = float(rest.dwell_s[np.abs(rest.position_m - end) <= SAME_PLACE_M].sum())
        return self.drive_and_plan(Leg(state.scenario, nodes, speed2, dwell_at_end(nodes, stands)), state)


def _kept(rest: Leg, state: State) -> Leg:
    """Return the rest of a plan as a train with another voltage or recuperation keeps to it."""
    ends = [*np.flatnonzero(rest.dwell_s > 0).tolist(), len(rest.position_m) - 1]
    speed2 = rest.speed2.copy()
    first = 0
    for last in dict.fromkeys(ends):
        if last > first:
            mesh = build_meshed_line(state.scenario, position_m=rest.position_m[first : last + 1])
            driven, stand = drive(mesh.data, rest.speed2[first : last + 1], float(speed2[first]))
            if stand >= 0:
                raise InfeasibleLineError(f"At {mesh.position_m[stand]:.0f} m the train comes to a stand.")
            speed2[first : last + 1] = driven
        first = last
    return replace(rest, scenario=state.scenario, speed2=speed2)
