"""The actual run: a plan that meets another load, a position error and events, and what each of them costs.

The train follows its plan with its actual load and its own estimate of its position, as in `following`. Both are
known from the notice of its first event on, and it goes on as in `disturbances`. The causes are added one after
another in the order of CAUSES; each has the energy by which the run changes when it is added to those before it, so
that they sum to the whole.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Literal, get_args

from railjoule.core.scenario import Scenario
from railjoule.core.scenario.disturbance import Disturbance, Reaction
from railjoule.core.scenario.options import SimulationOptions
from railjoule.core.simulation.actual_vehicle import actually_loaded
from railjoule.core.simulation.disturbances import LATE_S, DisturbedRun, simulate_disturbances, undisturbed_plan
from railjoule.core.simulation.following import Following, follow, plan_for
from railjoule.core.simulation.leg import DrivenPlan, make_leg
from railjoule.core.trajectory import Trajectory
from railjoule.core.units import J_PER_KWH

CauseName = Literal["load", "position", "conditions", "stops", "events"]
CAUSES: tuple[CauseName, ...] = get_args(CauseName)
"""Load; place and measured speed; resistance and line voltage; unplanned stops; limits and changes on the way."""
FREE_REST = "After the first event the train brakes without the target curve."


@dataclass(frozen=True)
class Cause:
    """One reason why a run needs more than its plan.

    Parameters
    ----------
    name : str
        One of CAUSES.
    energy_j : float
        Energy beyond that of the causes before it; negative where it saves [J].
    """

    name: CauseName
    energy_j: float

    @property
    def energy_kwh(self) -> float:
        """The same in kWh."""
        return self.energy_j / J_PER_KWH


@dataclass(frozen=True, eq=False)
class ActualRun(DrivenPlan):
    """A plan and its actual run.

    Parameters
    ----------
    scenario : Scenario
        The plan's, with the disturbance that it meets.
    causes : tuple of Cause
        Sources of the energy beyond the plan, in the order of CAUSES; only those that differ from the plan.
    following : Following or None
        The run with its load and place before any event; None where nothing is followed.
    disturbed : DisturbedRun or None
        The run with its events; None where there are none.
    delay_s : float
        Delay of the arrival against the plan, with events against the timetable [s].
    notes : tuple of str
        Sentences on stops, limits and windows that could not be kept.
    """

    scenario: Scenario
    causes: tuple[Cause, ...]
    following: Following | None
    disturbed: DisturbedRun | None
    delay_s: float
    notes: tuple[str, ...]

    @property
    def extra_kwh(self) -> float:
        """Energy beyond that of the plan; the causes sum to it [kWh]."""
        return self.actual.energy_kwh - self.planned.energy_kwh

    @property
    def max_cause(self) -> Cause | None:
        """The cause that changes the energy most, if there is one."""
        return max(self.causes, key=lambda cause: abs(cause.energy_j), default=None)


def actual_run(scenario: Scenario, reaction: Reaction | None = None, planned: Trajectory | None = None) -> ActualRun:
    """Return the actual run of a scenario's plan under its disturbance, and the energy that each cause adds.

    Parameters
    ----------
    scenario : Scenario
        With its disturbance: actual load, error of the place, resistance, line voltage, and events.
    reaction : str, optional
        The one that reacts to the events, instead of their own `reaction`.
    planned : Trajectory, optional
        The plan, if it is known: that of `solve_plan`.

    Raises
    ------
    ScenarioError
        If an event lies outside the line, two stops at one place, or an error of the place beyond the way to a stop.
    RailjouleError
        As `railjoule.core.solve` for the plan; InfeasibleLineError if the train comes to a stand on its way.
    """
    # stations may be moved below to where the train stood for them
    scenario = scenario.with_fixed_time()
    plan = planned or solve_plan(scenario)
    run, following, disturbed = plan, None, None
    causes = []
    for name, disturbance, options in _stages(scenario):
        # differences of whole runs, each with one cause more: they sum to the whole by construction, but depend on
        # the order, as the causes work on one another
        before = run.energy.net_j
        stage = scenario.model_copy(update={"disturbance": disturbance, "simulation": options})
        if name in {"stops", "events"}:
            start = run if following is None else following.actual
            if following is not None:
                stage = _with_stops_made(stage, start, following)
            disturbed = simulate_disturbances(stage, reaction, start)
            run = disturbed.actual
        else:
            following = follow(plan, stage)
            run = following.actual
        causes.append(Cause(name, run.energy.net_j - before))
    delay_s = run.travel_time_s - plan.travel_time_s
    notes: tuple[str, ...] = ()
    if disturbed is not None:
        delay_s = disturbed.delay_s
        # against the timetable of the disturbed run; `delay_s` of this one includes the departure, and is shown as such
        late = f"The train arrives {delay_s:.1f} s late."
        notes = tuple(note for note in disturbed.notes if delay_s <= LATE_S or note != late)
        if following is not None and scenario.simulation.target_braking:
            notes = (*notes, FREE_REST)
    return ActualRun(
        scenario=scenario,
        planned=plan,
        actual=run,
        causes=tuple(causes),
        following=following,
        disturbed=None if disturbed is None else replace(disturbed, planned=plan),
        # nothing in a run depends on the time of day, so a later departure shifts all of it
        delay_s=scenario.disturbance.departure_delay_s + delay_s,
        notes=notes,
    )


def solve_plan(scenario: Scenario) -> Trajectory:
    """Return the plan at the start of a run; errors as `railjoule.core.solve`.

    It keeps to the target braking curves of the scenario if load or position differ from the plan.
    """
    return plan_for(scenario) if is_followed(scenario) else undisturbed_plan(scenario)


def is_followed(scenario: Scenario) -> bool:
    """Return whether load, position or conditions differ from the plan; else a train drives its plan up to an event."""
    return any(name not in {"stops", "events"} for name, *_ in _stages(scenario))


def _stages(scenario: Scenario) -> Iterator[tuple[CauseName, Disturbance, SimulationOptions]]:
    """Yield each cause that differs from the plan, with disturbance and options of it and those before it."""
    real, options = scenario.disturbance, scenario.simulation
    # the load comes first, with a position measured well: its cost is then the same with any odometer
    load = {"actual_load_factor": real.actual_load_factor, "actual_load_t": real.actual_load_t}
    if actually_loaded(scenario.vehicle, real).load_mass_kg != scenario.vehicle.load_mass_kg:
        well = options.model_copy(update={"speed_error": 0.0, "sensor_errors_m": (0.0, 0.0, 0.0)})
        yield "load", Disturbance(**load), well
    followed = Disturbance(**load, coordinate_error_m=real.coordinate_error_m)
    if real.coordinate_error_m != 0 or options.speed_error != 0 or any(options.sensor_errors_m):
        yield "position", followed, options
    factors = {"resistance_factor": real.resistance_factor, "line_voltage_factor": real.line_voltage_factor}
    has_other_rails = real.rail_condition is not None and scenario.line.all_rail_conditions != {real.rail_condition}
    if has_other_rails or any(factor != 1 for factor in factors.values()):
        yield "conditions", followed.model_copy(update={**factors, "rail_condition": real.rail_condition}), options
    # from here on the position is that of the followed run
    known = real.model_copy(update={"coordinate_error_m": 0.0, "departure_delay_s": 0.0})
    if real.stops:
        nothing_else = {"speed_limits": (), "voltage_changes": (), "recuperation_changes": ()}
        yield "stops", known.model_copy(update=nothing_else), options
    if len(real.events) > len(real.stops):
        yield "events", known, options


def _with_stops_made(scenario: Scenario, driven: Trajectory, following: Following) -> Scenario:
    """Return a scenario whose stations passed before the first notice lie where the train stood for them.

    A train that stood short of a station would otherwise stop there again once its position is known.
    """
    leg, line = make_leg(driven), scenario.line.in_running_order()
    noticed_m = min(
        leg.place_at(event.noticed_at_s) if event.noticed_at_s is not None else event.noticed_at_m or 0.0
        for event in scenario.disturbance.events
    )
    errors = dict(zip((one.position_m for one in line.inner_stations), following.stop_errors_m, strict=False))
    made = {place: place + error for place, error in errors.items() if place + error <= noticed_m}
    stations = tuple(
        station.model_copy(update={"position_m": made.get(station.position_m, station.position_m)})
        for station in line.stations
    )
    return scenario.model_copy(update={"line": line.model_copy(update={"stations": stations})})
