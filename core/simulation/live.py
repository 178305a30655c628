"""A live run: events are set while the train drives, and the rest is planned again from its state.

The train keeps to its plan until something is set; each function returns a new `LiveRun` and changes none. An on-board
computer has little time for a plan, so that a plan ahead is made by `railjoule.core.simulation.replanning`.

A red signal is a stop whose end is known, or open until it is cleared. The plan expects an open one to stay red for as
long as the stop lasts; once that has passed, for as long again.
Source: Rawicki, "the algorithm of the energy saving control must be constantly updated".
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from railjoule.core.errors import ScenarioError, StrategyRefusedError
from railjoule.core.motion.driving import STANDING_SPEED2, brake_fully
from railjoule.core.scenario import Scenario
from railjoule.core.scenario.disturbance import (
    Disturbance,
    Event,
    RecuperationChange,
    UnplannedLimit,
    UnplannedStop,
    VoltageChange,
)
from railjoule.core.simulation.disturbances import (
    DisturbedRun,
    simulate_disturbances,
    undisturbed_plan,
    unknowing_scenario,
)
from railjoule.core.simulation.leg import SAME_PLACE_M, Leg, append_leg, join_legs, make_leg
from railjoule.core.simulation.replanning import (
    State,
    event_words,
    knowing,
    mesh_ahead,
    plan_quickly,
    require_events_on_the_line,
    strategy_for_all_lines,
)
from railjoule.core.trajectory import Trajectory

TABLES: dict[type[Event], str] = {
    UnplannedStop: "stops",
    UnplannedLimit: "speed_limits",
    VoltageChange: "voltage_changes",
    RecuperationChange: "recuperation_changes",
}
"""Fields of a disturbance by the kind of their events."""
MIN_WAIT_S = 1.0
"""Shortest further wait at a signal that is still red at the expected end of its stop [s]."""


@dataclass(frozen=True)
class LiveEvent:
    """An event of a live run.

    Parameters
    ----------
    event : Event
        The event, noticed at the position of the train.
    is_open : bool
        Whether it is a red signal without a known end.
    stood_at_m : float or None
        Position of the stand for it, once the train has left [m].
    """

    event: Event
    is_open: bool = False
    stood_at_m: float | None = None

    @property
    def is_ahead(self) -> bool:
        """Whether it is a stop that the train has not left yet."""
        return isinstance(self.event, UnplannedStop) and self.stood_at_m is None


@dataclass(frozen=True, eq=False)
class LiveRun:
    """A live run at one instant.

    Parameters
    ----------
    scenario : Scenario
        In running order, without events.
    planned : Trajectory
        The plan before the start.
    driven : tuple of Leg
        The parts driven before the present plan.
    since : State
        The state at the start of the present plan; at a stop, that of the arrival or of the last replanning.
    plan : Leg
        From there to the end.
    ahead : Trajectory
        The same plan, with its energy.
    elapsed_s : float
        Time since then [s].
    spent_j : float
        Energy of what was driven before the present plan [J].
    strategy : str
        The strategy of that plan.
    former : Leg or None
        The plan before the present one.
    events : tuple of LiveEvent
        The events that were set, in order.
    notices : tuple of (float, float, str)
        As in `DisturbedRun`.
    notes : tuple of str
        Sentences on stops, limits and windows that could not be kept.
    """

    scenario: Scenario
    planned: Trajectory
    driven: tuple[Leg, ...]
    since: State
    plan: Leg
    ahead: Trajectory
    strategy: str
    elapsed_s: float = 0.0
    spent_j: float = 0.0
    former: Leg | None = None
    events: tuple[LiveEvent, ...] = ()
    notices: tuple[tuple[float, float, str], ...] = ()
    notes: tuple[str, ...] = ()

    @property
    def time_s(self) -> float:
        """Time since the start [s]."""
        return self.since.time_s + self.elapsed_s

    @property
    def position_m(self) -> float:
        """Position of the train [m]."""
        return self.plan.place_at(self.elapsed_s)

    @property
    def speed_ms(self) -> float:
        """Its speed [m/s]."""
        if self.dwell_left_s > 0:
            return 0.0
        return float(np.sqrt(np.interp(self.position_m, self.plan.position_m, self.plan.speed2)))

    @property
    def dwell_left_s(self) -> float:
        """How long the train will stand where it is [s]; 0 where it moves."""
        arrival = self.plan.arrival_s
        node = int(np.searchsorted(arrival, self.elapsed_s, side="right")) - 1
        return max(float(arrival[node] + self.plan.dwell_s[node]) - self.elapsed_s, 0.0)

    @property
    def energy_j(self) -> float:
        """Energy so far [J]."""
        return self.spent_j + float(np.interp(self.elapsed_s, self.ahead.time_s, self.ahead.supply_energy_j))

    @property
    def remaining_j(self) -> float:
        """Energy to come by the present plan [J]."""
        return self.spent_j + self.ahead.energy.net_j - self.energy_j

    @property
    def arrival_s(self) -> float:
        """When the train arrives by the present plan [s]."""
        return self.since.time_s + self.plan.duration_s

    @property
    def delay_s(self) -> float:
        """Expected arrival less that of the timetable [s]."""
        return self.arrival_s - self.scenario.travel_time_s

    @property
    def has_arrived(self) -> bool:
        """Whether the train stands at the end of the line."""
        return self.elapsed_s >= self.plan.duration_s

    @property
    def held_at(self) -> LiveEvent | None:
        """The open signal at which the train would leave by its plan but must not."""
        for event in self.events:
            if event.is_open and event.is_ahead and self.elapsed_s >= self.departure_s(event):
                return event
        return None

    @property
    def state(self) -> State:
        """The state of the train; its scenario is the present plan's."""
        return State(self.position_m, self.speed_ms**2, self.time_s, self.since.scenario)

    def stand_node(self, event: LiveEvent) -> int:
        """Return the node of the present plan at which the train stands for a stop that is ahead."""
        assert isinstance(event.event, UnplannedStop)
        stands = (self.plan.speed2 <= STANDING_SPEED2) & (self.plan.position_m >= event.event.position_m - SAME_PLACE_M)
        return int(np.flatnonzero(stands)[0])

    def departure_s(self, event: LiveEvent) -> float:
        """Return when the train leaves a stop that is ahead, from the present plan's start [s]."""
        node = self.stand_node(event)
        return float(self.plan.arrival_s[node] + self.plan.dwell_s[node])

    def has_left(self, event: LiveEvent) -> bool:
        """Return whether the train has stood for a stop and left."""
        return not event.is_open and self.elapsed_s > self.departure_s(event)


def start_run(scenario: Scenario) -> LiveRun:
    """Return a run before its start, on time and aware of its place; errors as `undisturbed_plan`."""
    # the vehicle then has its actual load, resistance and voltage
    accepted = Disturbance(accepted_delay_s=scenario.disturbance.accepted_delay_s)
    nominal = unknowing_scenario(scenario).model_copy(update={"disturbance": accepted})
    planned = undisturbed_plan(nominal)
    start = State(0.0, float(planned.speed_ms[0]) ** 2, 0.0, nominal)
    return LiveRun(nominal, planned, (), start, make_leg(planned), planned, nominal.strategy)


def advance(run: LiveRun, seconds: float) -> LiveRun:
    """Return a run some time later: at most at its end, or at the departure from a signal that is still red."""
    waits = [run.departure_s(event) for event in run.events if event.is_open and event.is_ahead]
    return replace(run, elapsed_s=min(run.elapsed_s + seconds, run.plan.duration_s, *waits))


def set_event(run: LiveRun, event: Event, is_open: bool = False) -> LiveRun:
    """Return a run whose train learns of an event where it is, planned again from there.

    Parameters
    ----------
    run : LiveRun
    event : Event
        A stop is a red signal; where the train learns of it is replaced.
    is_open : bool
        Whether a stop lasts until `clear_signal`; its duration is then what the plan expects.

    Raises
    ------
    ScenarioError
        If it lies behind the train or beyond the line, or a stop is too close to another one.
    InfeasibleLineError
        If the brakes do not stop the train before the end of the line.
    """
    noticed = event.model_copy(update={"noticed_at_m": run.position_m, "noticed_at_s": None})
    _require_ahead(run, noticed)
    set_before = [one.event for one in run.events if not isinstance(one.event, UnplannedStop) or one.is_ahead]
    require_events_on_the_line(with_events(run.scenario, [*set_before, noticed]))
    notice = (run.position_m, run.time_s, event_words(event))
    noted = replace(run, notices=(*run.notices, notice))
    return _replanned(noted, (*run.events, LiveEvent(noticed, is_open)), run.dwell_left_s)


def clear_signal(run: LiveRun, signal: LiveEvent) -> LiveRun:
    """Return a run one of whose red signals is clear, planned again."""
    assert isinstance(signal.event, UnplannedStop)
    stands = run.dwell_left_s > 0 or run.held_at is signal
    place = run.plan.position_m[run.stand_node(signal)]
    others = tuple(one for one in run.events if one is not signal)
    if stands and abs(run.position_m - place) <= SAME_PLACE_M:
        return _replanned(run, (*others, replace(signal, is_open=False, stood_at_m=float(place))), 0.0)
    note = f"The signal at {signal.event.position_m:g} m cleared before the train stood at it: no event is kept of it."
    return _replanned(replace(run, notes=(*run.notes, note)), others, run.dwell_left_s)


def wait_longer(run: LiveRun) -> LiveRun:
    """Return a run that waits at a signal that is still red for as long again, planned again."""
    signal = run.held_at
    if signal is None:
        return run
    assert isinstance(signal.event, UnplannedStop)
    return _replanned(run, run.events, max(signal.event.duration_s, MIN_WAIT_S))


def finished_run(run: LiveRun) -> DisturbedRun:
    """Return the run to its end by its present plan, as `simulate_disturbances` does."""
    legs = append_leg(run.driven, run.plan)
    timetabled = legs[-1].scenario.model_copy(update={"timetable": run.scenario.timetable})
    actual = join_legs(legs, timetabled, run.planned.strategy)
    return DisturbedRun(run.planned, actual, run.scenario.travel_time_s, run.notices, run.notes)


def known_run(run: LiveRun) -> DisturbedRun:
    """Return the run of a train with advance notice of the events; errors as `simulate_disturbances`."""
    scenario = with_events(run.scenario, events_to_keep(run))
    try:
        return simulate_disturbances(scenario, "known", run.planned)
    except StrategyRefusedError:
        stands_in = scenario.model_copy(update={"strategy": strategy_for_all_lines(scenario)})
        return simulate_disturbances(stands_in, "known", run.planned)


def events_to_keep(run: LiveRun) -> tuple[Event, ...]:
    """Return the events as a scenario has them: stops with the time for which the train stands by its present plan."""
    legs = append_leg(run.driven, run.plan)
    return tuple(_with_duration(run, one, legs) for one in run.events)


def with_events(scenario: Scenario, events: Iterable[Event]) -> Scenario:
    """Return a scenario whose disturbance has these events and no others."""
    given = list(events)
    tables = {name: tuple(event for event in given if type(event) is kind) for kind, name in TABLES.items()}
    disturbance = scenario.disturbance.model_copy(update=tables)
    return scenario.model_copy(update={"disturbance": disturbance})


def _require_ahead(run: LiveRun, event: Event) -> None:
    """Refuse a stop or a limit that lies behind the train."""
    here, state = run.position_m, run.state
    if isinstance(event, UnplannedStop) and event.position_m <= here + SAME_PLACE_M:
        mesh = mesh_ahead(state, state.scenario.line.length_m)
        _, distance = brake_fully(mesh.data, state.speed2)
        # brakes that do not stop the train leave the end of the line
        nearest = float(mesh.position_m[-1]) if np.isnan(distance) else here + distance
        raise ScenarioError(
            f"A red signal at {event.position_m:g} m is not ahead of the train at {here:.0f} m. The nearest place "
            f"where the train can stop is {nearest:.0f} m."
        )
    if isinstance(event, UnplannedLimit) and event.to_m <= here + SAME_PLACE_M:
        raise ScenarioError(
            f"A limit that ends at {event.to_m:g} m is not ahead of the train at {here:.0f} m. Choose an end beyond it."
        )


def _replanned(run: LiveRun, events: tuple[LiveEvent, ...], dwell_s: float) -> LiveRun:
    """Return a run with other events, planned again from where it is after so long a stand there [s]."""
    place = run.position_m
    cut = run.plan.until(place)
    cut = replace(cut, dwell_s=np.append(cut.dwell_s[:-1], max(cut.dwell_s[-1] - run.dwell_left_s, 0.0)))
    events = tuple(
        replace(one, stood_at_m=float(run.plan.position_m[run.stand_node(one)]))
        if one in run.events and one.is_ahead and run.has_left(one)
        else one
        for one in events
    )
    state = replace(run.state, scenario=_informed(run, events))
    leaving = replace(state, time_s=state.time_s + dwell_s)
    leg, strategy, notes = plan_quickly(leaving, run.scenario.travel_time_s + run.scenario.disturbance.accepted_delay_s)
    plan = replace(leg, dwell_s=np.append(leg.dwell_s[0] + dwell_s, leg.dwell_s[1:]))
    # a cut cell is counted as the whole run counts it
    spent_j = run.spent_j + cut.trajectory(strategy).energy.net_j if len(cut.position_m) > 1 else run.energy_j
    return replace(
        run,
        driven=append_leg(run.driven, cut),
        since=state,
        plan=plan,
        ahead=plan.trajectory(strategy),
        strategy=strategy,
        elapsed_s=0.0,
        spent_j=spent_j,
        former=run.plan,
        events=events,
        notes=tuple(dict.fromkeys((*run.notes, *notes))),
    )


def _informed(run: LiveRun, events: tuple[LiveEvent, ...]) -> Scenario:
    """Return the scenario with all events that still matter."""
    state = replace(run.state, scenario=run.scenario)
    for one in events:
        event = one.event
        if isinstance(event, UnplannedStop):
            if not one.is_ahead:
                continue
            # a train that brakes to a stand beyond a signal still stands there
            place = float(run.plan.position_m[run.stand_node(one)]) if one in run.events else event.position_m
            if place <= state.position_m + SAME_PLACE_M:
                continue
            event = event.model_copy(update={"position_m": place})
        state = knowing(state, event, run.scenario.vehicle)
    return state.scenario


def _with_duration(run: LiveRun, one: LiveEvent, legs: tuple[Leg, ...]) -> Event:
    """Return an event; a stop with the time that the train stands for it."""
    if not isinstance(one.event, UnplannedStop):
        return one.event
    place = one.stood_at_m if one.stood_at_m is not None else float(run.plan.position_m[run.stand_node(one)])
    stands = sum(float(leg.dwell_s[np.abs(leg.position_m - place) <= SAME_PLACE_M].sum()) for leg in legs)
    return one.event.model_copy(update={"duration_s": stands})
