"""The actual conditions of a run: load, position, sensors, events and chance, for all pages that simulate them."""

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any, get_args

import param

from railjoule.core import Scenario
from railjoule.core.scenario.disturbance import (
    Disturbance,
    Event,
    LogNormal,
    Reaction,
    RecuperationChange,
    UnplannedLimit,
    UnplannedStop,
    VoltageChange,
)
from railjoule.core.scenario.line import SHORTEST_DISTANCE_M
from railjoule.core.scenario.options import TARGET_BRAKING_KEYS, MonteCarloOptions, SimulationOptions
from railjoule.dashboard.look import words
from railjoule.dashboard.state.kept import Items
from railjoule.dashboard.state.numbers import TypedNumber, TypedParameters, core_bounds, keyed
from railjoule.dashboard.state.scenario import ScenarioModel

EVENTS: Mapping[str, type[Event]] = {
    "stop": UnplannedStop,
    "limit": UnplannedLimit,
    "voltage": VoltageChange,
    "recuperation": RecuperationChange,
}
"""The kinds of events."""
TABLES = {
    "stop": "stops",
    "limit": "speed_limits",
    "voltage": "voltage_changes",
    "recuperation": "recuperation_changes",
}
"""Their tables in the scenario's file."""
KEYS: Mapping[str, Mapping[str, tuple[str, float]]] = {
    "stop": {"position_m": ("position_m", 1), "duration_s": ("duration_s", 1)},
    "limit": {"position_m": ("from_m", 1), "to_m": ("to_m", 1), "limit_kmh": ("limit_kmh", 1)},
    "voltage": {"share_percent": ("line_voltage_factor", 100)},
    "recuperation": {"share_percent": ("recuperation_factor", 100)},
}
"""Their fields, each with its key in the file, and a number of the page over that of the file."""
KIND_WORDS = {"stop": "Stop", "limit": "Limit", "voltage": "Supply voltage", "recuperation": "Recuperation"}
NO_EVENTS: Mapping[str, Any] = {f"disturbance.{table}": [] for table in TABLES.values()}
NOTICE_BEFORE_M, FIRST_LIMIT_M, FIRST_STOP_S = 230.0, 100.0, 20.0
"""Distance between notice and event [m]; length of a new limit [m] and duration of a new stop [s]."""
BY_KIND = {
    (kind, field): core_bounds(EVENTS[kind], *key) for kind, fields in KEYS.items() for field, key in fields.items()
}
"""Bounds of the fields of each kind of event."""


class EventModel(TypedParameters):
    """One event, in the units of the page."""

    kept = ("kind", "position_m", "to_m", "duration_s", "limit_kmh", "share_percent", "noticed_at_m")

    kind = param.Selector(default="stop", objects=list(TABLES), doc="The kind of event.")
    position_m = TypedNumber("at, m", "m", default=300.0, **core_bounds(UnplannedLimit, "from_m"))
    to_m = TypedNumber("to, m", "m", default=400.0, **core_bounds(UnplannedLimit, "to_m"))
    duration_s = TypedNumber("stops for, s", "s", default=5.0, **core_bounds(UnplannedStop, "duration_s"))
    limit_kmh = TypedNumber("km/h", "km/h", default=30.0, **core_bounds(UnplannedLimit, "limit_kmh"))
    share_percent = TypedNumber("of nominal, %", "%", default=80.0, bounds=(0.0, 200.0))
    noticed_at_m = TypedNumber("noticed at, m", "m", default=70.0, **core_bounds(Event, "noticed_at_m"))

    def field_bounds(self, field: str) -> tuple[float | None, float | None]:
        """Return the bounds of a field for this kind of event."""
        own = BY_KIND.get((self.kind, field))
        return super().field_bounds(field) if own is None else own["bounds"]

    def closed_ends(self, field: str) -> tuple[bool, bool]:
        """Return whether a field includes its bounds, for this kind of event."""
        own = BY_KIND.get((self.kind, field))
        return super().closed_ends(field) if own is None else own["inclusive_bounds"]

    @property
    def values(self) -> dict[str, float]:
        """The event by the keys of the scenario's file, without its notice."""
        return {key: getattr(self, field) / scale for field, (key, scale) in KEYS[self.kind].items()}

    @property
    def document(self) -> dict[str, float]:
        """The event as in the scenario's file."""
        return {**self.values, "noticed_at_m": float(self.noticed_at_m)}

    @property
    def sign(self) -> str:
        """The text at the event in a figure."""
        if self.kind == "stop":
            return f"stop {words.number(self.duration_s, 0)} s"
        if self.kind == "limit":
            return f"limit {words.number(self.limit_kmh, 0)}"
        return f"{KIND_WORDS[self.kind].lower()} {words.number(self.share_percent, 0)} %"

    def move(self, place_m: float) -> None:
        """Move the event to another place [m]; the distance of its notice stays."""
        ahead = max(self.position_m - self.noticed_at_m, 0.0)
        self.param.update(position_m=place_m, noticed_at_m=max(place_m - ahead, 0.0))


def event_model(event: Event) -> EventModel:
    """Return the model of an event of a scenario's file."""
    kind = next(kind for kind, of in EVENTS.items() if isinstance(event, of))
    values = {field: scale * getattr(event, key) for field, (key, scale) in KEYS[kind].items()}
    return EventModel(kind=kind, noticed_at_m=event.noticed_at_m or 0.0, **values)


# ---- the conditions

FIRST_LOAD_PERCENT, FIRST_ERROR_M = 100.0, 10.0
"""Load and position error at first, where the scenario names none: conditions under which the plan fails."""
LOAD_AND_POSITION = ("actual_load_percent", "coordinate_error_m")
SENSOR_FIELDS = ("reset_sensor_m", "calibration_length_m", "stop_sensor_m", "target_deceleration_ms2")
SENSOR_ERRORS = ("d1_error_m", "d2_error_m", "d3_error_m")
FOLLOWING = ("speed_error_percent", "target_braking", *SENSOR_FIELDS, *SENSOR_ERRORS)
"""The measurements of the train that follows the plan."""
CHANCE = (
    "load_deviation_percent",
    "error_deviation_m",
    "resistance_deviation_percent",
    "voltage_deviation_percent",
    "speed_deviation_percent",
    "sensor_deviation_m",
    "mean_departure_delay_s",
    "seed",
)
"""The distributions of the Monte Carlo study, and its seed."""
# beyond any distance of a sensor from its stop a mistake, which the file would accept
MAX_SENSOR_ERROR_M = 1000.0


def _deviation(key: str, label: str, digits: int, largest: float, scale: float = 1.0) -> TypedNumber:
    """Return a field for the standard deviation of a distribution, with the default of the core."""
    drawn = getattr(MonteCarloOptions(), key)
    default = drawn.log_standard_deviation if isinstance(drawn, LogNormal) else drawn.standard_deviation
    doc = MonteCarloOptions.model_fields[key].description or ""
    return TypedNumber(
        label, label.rsplit(maxsplit=1)[-1], digits, default=round(scale * default, 6), bounds=(0.01, largest), doc=doc
    )


class Day(TypedParameters):
    """The actual conditions: one value of each for Drive's actual run and for What if.

    Parameters
    ----------
    scenario : ScenarioModel
        Its file gives the first values.
    """

    kept = ("on", "reaction", *LOAD_AND_POSITION, *FOLLOWING, "events", "accepted_delay_s", *CHANCE)
    passing = ("most_load_percent",)

    on = param.Boolean(default=False, doc="Whether the actual run is drawn beside the plan.")
    reaction = param.Selector(default="driver", objects=list(get_args(Reaction)), doc="The reaction to an event.")
    actual_load_percent = keyed(
        *(Disturbance, "actual_load_factor", "Actual load, % of capacity", "%", 0, 100),
        default=FIRST_LOAD_PERCENT,
        step=1,
    )
    coordinate_error_m = keyed(
        *(Disturbance, "coordinate_error_m", "Position error", "m"),
        default=FIRST_ERROR_M,
        softbounds=(-25, 25),
        step=1,
    )
    speed_error_percent = keyed(
        *(SimulationOptions, "speed_error", "Speed error", "%", 1, 100), softbounds=(-5, 5), step=0.1
    )
    target_braking = param.Boolean(default=SimulationOptions().target_braking, doc="Brake along the target curve.")
    reset_sensor_m = keyed(SimulationOptions, "reset_sensor_m", "D1, resets position", "m")
    calibration_length_m = keyed(SimulationOptions, "calibration_length_m", "D1 to D2, calibrates", "m")
    stop_sensor_m = keyed(SimulationOptions, "stop_sensor_m", "D3, resets position", "m")
    target_deceleration_ms2 = keyed(SimulationOptions, "target_deceleration_ms2", "Target curve", "m/s\u00b2", 2)
    d1_error_m, d2_error_m, d3_error_m = (
        TypedNumber(f"{name} place error, m", "m", 1, default=0.0, bounds=(-MAX_SENSOR_ERROR_M, MAX_SENSOR_ERROR_M))
        for name in ("D1", "D2", "D3")
    )
    events = param.List(default=[], item_type=EventModel, doc="The events on the way.")
    accepted_delay_s = keyed(
        *(Disturbance, "accepted_delay_s", "Accepted delay", "s"), default=0.0, softbounds=(0, 60), step=1
    )
    load_deviation_percent = _deviation("load_factor", "Load, \u00b1 %", 0, 100, 100)
    error_deviation_m = _deviation("coordinate_error_m", "Position error, \u00b1 m", 1, 1000)
    resistance_deviation_percent = _deviation("resistance_factor", "Resistance, \u00b1 %", 1, 100, 100)
    voltage_deviation_percent = _deviation("line_voltage_factor", "Supply voltage, \u00b1 %", 1, 50, 100)
    speed_deviation_percent = _deviation("speed_error", "Speed error, \u00b1 %", 2, 10, 100)
    sensor_deviation_m = _deviation("d1_error_m", "Sensor places, \u00b1 m", 1, 100)
    mean_departure_delay_s = TypedNumber("Departure delay, mean, s", "s", default=0.0, bounds=(0, 3600))
    seed = keyed(MonteCarloOptions, "seed", "Seed", bounds=(0, 2**31))

    most_load_percent = param.Number(default=100.0, doc="The vehicle's crush load, % of capacity.")
    changed = param.Event(doc="An event has other numbers.")

    def __init__(self, scenario: ScenarioModel, **params: Any) -> None:
        super().__init__(**params)
        self.scenario = scenario
        self._items = Items(lambda *_: self.param.trigger("changed"))
        # before any other watcher of the events
        self.param.watch(lambda *_: self._items.follow(self.events, lambda event: event.kept), "events")
        scenario.follow(lambda scenario: scenario.vehicle.crush_load_factor, self._take_crush_load)
        scenario.follow(lambda scenario: scenario.disturbance, self._take_events)
        scenario.follow(lambda scenario: (scenario.disturbance, scenario.simulation), self._take_conditions)
        self.take(scenario.edited)

    # ---- values of a scenario

    def take(self, scenario: Scenario) -> None:
        """Take over the conditions of a scenario's file."""
        self._take_crush_load()
        self._take_events(scenario)
        self._take_conditions(scenario)

    def _take_crush_load(self, *_: Any) -> None:
        self.most_load_percent = self.scenario.most_load_percent

    def _take_events(self, scenario: Scenario) -> None:
        events = scenario.disturbance.events
        self.param.update(
            events=[event_model(event) for event in events],
            accepted_delay_s=scenario.disturbance.accepted_delay_s,
            reaction=events[0].reaction if events else "driver",
        )

    def _take_conditions(self, scenario: Scenario) -> None:
        disturbance, simulation = scenario.disturbance, scenario.simulation
        named = disturbance.has_load or disturbance.coordinate_error_m != 0
        load_percent = 100 * scenario.actual_load_share
        sensors = {name: getattr(simulation, name) for name in SENSOR_FIELDS}
        self.param.update(
            actual_load_percent=load_percent if named else FIRST_LOAD_PERCENT,
            coordinate_error_m=disturbance.coordinate_error_m if named else FIRST_ERROR_M,
            speed_error_percent=100 * simulation.speed_error,
            target_braking=simulation.target_braking,
            **dict(zip(SENSOR_ERRORS, simulation.sensor_errors_m, strict=True)),
            # a file without target braking has no sensors
            **{name: place for name, place in sensors.items() if place is not None},
        )

    def parse(self, field: str, text: str) -> float:
        """Return the number in a text for a field; the vehicle bounds the load."""
        number = super().parse(field, text)
        if field == "actual_load_percent" and number > self.most_load_percent:
            raise ValueError(f"At most {self.most_load_percent:g}, the vehicle's crush load.")
        return number

    # ---- values for a scenario

    @property
    def conditions(self) -> Mapping[str, Any]:
        """Load, position, speed error and sensors, by the keys of the file."""
        sensors: dict[str, Any] = dict.fromkeys(f"simulation.{key}" for key in TARGET_BRAKING_KEYS)
        if self.target_braking:
            sensors = {f"simulation.{key}": float(getattr(self, key)) for key in SENSOR_FIELDS}
            sensors["simulation.sensor_errors_m"] = tuple(float(getattr(self, name)) for name in SENSOR_ERRORS)
        return {
            "disturbance.actual_load_factor": self.actual_load_percent / 100,
            "disturbance.coordinate_error_m": float(self.coordinate_error_m),
            "simulation.speed_error": self.speed_error_percent / 100,
            "simulation.target_braking": self.target_braking,
            **sensors,
        }

    @property
    def event_tables(self) -> Mapping[str, Any]:
        """The events and the accepted delay, by the keys of the file."""
        tables: dict[str, Any] = {key: [] for key in NO_EVENTS}
        for event in self.events:
            tables[f"disturbance.{TABLES[event.kind]}"].append(event.document)
        return {**tables, "disturbance.accepted_delay_s": float(self.accepted_delay_s)}

    @property
    def actual_changes(self) -> Mapping[str, Any]:
        """All differences of the actual run from the plan, by the keys of the file; one reaction to all events."""
        events = {
            key: [{**event, "reaction": self.reaction} for event in value] if isinstance(value, list) else value
            for key, value in self.event_tables.items()
        }
        return {**self.conditions, **events}

    @property
    def event_changes(self) -> Mapping[str, Any]:
        """The events by the keys of the file; with the actual run switched on, also its load and position."""
        conditions: dict[str, Any] = dict(self.conditions)
        if not self.on:
            conditions = {"disturbance.coordinate_error_m": 0.0}
            if self.scenario.edited.disturbance.has_load:
                conditions |= {"disturbance.actual_load_factor": None, "disturbance.actual_load_t": None}
        # a later departure shifts all runs by the same time, and is not an event
        return {**conditions, "disturbance.departure_delay_s": 0.0, **self.event_tables}

    def chance_changes(self, runs: int) -> Mapping[str, Any]:
        """Return the distributions, by the keys of the file: normal, but for resistance and departure."""

        def normal(deviation: float) -> dict[str, Any]:
            return {"distribution": "normal", "standard_deviation": deviation}

        resistance = {
            "distribution": "log_normal",
            "median": 1.0,
            "log_standard_deviation": self.resistance_deviation_percent / 100,
        }
        late = self.mean_departure_delay_s
        departure = {"distribution": "exponential", "mean": late} if late else {"distribution": "fixed", "value": 0.0}
        return {
            **self.conditions,
            "montecarlo.runs": runs,
            "montecarlo.seed": self.seed,
            "montecarlo.load_factor": normal(self.load_deviation_percent / 100),
            "montecarlo.coordinate_error_m": normal(float(self.error_deviation_m)),
            "montecarlo.resistance_factor": resistance,
            "montecarlo.line_voltage_factor": normal(self.voltage_deviation_percent / 100),
            "montecarlo.departure_delay_s": departure,
            "montecarlo.speed_error": normal(self.speed_deviation_percent / 100),
            **{f"montecarlo.{name}": normal(float(self.sensor_deviation_m)) for name in SENSOR_ERRORS},
        }

    # ---- events

    def as_planned(self) -> None:
        """Set the conditions of the plan: its load, the right position, no events."""
        self.param.update(actual_load_percent=self.scenario.planned_load_percent, coordinate_error_m=0.0, events=[])

    @property
    def stops(self) -> Sequence[EventModel]:
        """The unplanned stops."""
        return [event for event in self.events if event.kind == "stop"]

    def occupied_m(self, besides: EventModel | None = None) -> list[float]:
        """Return all places where the train stands, both ends included, except for one event [m]."""
        line = self.scenario.edited.line.in_running_order()
        stops = [stop.position_m for stop in self.stops if stop is not besides]
        return sorted({0.0, line.length_m, *(station.position_m for station in line.inner_stations), *stops})

    def free_m(self) -> float:
        """Return the middle of the longest stretch without a stop [m]."""
        before, after = max(pairwise(self.occupied_m()), key=lambda ends: ends[1] - ends[0])
        return 0.5 * (before + after)

    def add_stop(self) -> None:
        """Add a stop where the train drives farthest without one."""
        self.drop("stop", self.free_m())

    def drop(self, kind: str, place_m: float) -> None:
        """Add an event of a kind at a place [m]."""
        # core/scenario accepts no event at 0 m
        place = float(max(round(place_m), 1))
        event = EventModel(
            kind=kind,
            position_m=place,
            to_m=place + FIRST_LIMIT_M,
            duration_s=FIRST_STOP_S,
            # changes of voltage and recuperation begin where they are noticed
            noticed_at_m=max(place - NOTICE_BEFORE_M, 0.0) if kind in {"stop", "limit"} else place,
        )
        self.events = [*self.events, event]

    def remove(self, event: EventModel) -> None:
        """Remove an event."""
        self.events = [other for other in self.events if other is not event]

    def checked_place(self, stop: EventModel, place_m: float) -> float:
        """Return a place for a stop [m]; raises ValueError with a sentence if it is occupied or beyond the line."""
        length = self.scenario.edited.line.length_m
        if place_m > length - SHORTEST_DISTANCE_M:
            raise ValueError(f"A stop at {place_m:g} m lies beyond the line, {length:g} m.")
        near = [other for other in self.occupied_m(stop) if abs(other - place_m) < SHORTEST_DISTANCE_M]
        if near:
            raise ValueError(
                f"A stop at {place_m:g} m must be {SHORTEST_DISTANCE_M:g} m from the one at {near[0]:g} m."
            )
        return place_m
