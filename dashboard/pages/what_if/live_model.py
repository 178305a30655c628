"""The run that plays: its clock, what is set while it plays, and how it ends."""

from dataclasses import dataclass
from typing import Any

import param

from railjoule.core import Scenario
from railjoule.core.scenario.disturbance import UnplannedLimit, UnplannedStop, VoltageChange
from railjoule.core.simulation.disturbances import DisturbedRun
from railjoule.core.simulation.live import LiveRun
from railjoule.dashboard.day import FIRST_STOP_S
from railjoule.dashboard.state.numbers import TypedNumber, TypedParameters, core_bounds
from railjoule.dashboard.state.page_model import PageModel, result

PACES = (1.0, 5.0, 20.0)
"""How many times faster than in reality a run plays."""


@dataclass(frozen=True, eq=False)
class LiveResult:
    """A run that has arrived, and the same day with all events known before the start."""

    live: DisturbedRun
    known: DisturbedRun


class LiveModel(TypedParameters, PageModel):
    """The run that plays, and what is set next."""

    passing = (
        "on",
        "playing",
        "pace",
        "signal_m",
        "signal_s",
        "is_open",
        "from_m",
        "to_m",
        "limit_kmh",
        "voltage_percent",
        "replan_s",
    )

    on = param.Boolean(default=False, doc="Whether the page plays a run.")
    playing = param.Boolean(default=False, doc="Whether its clock runs.")
    pace = param.Selector(default=5.0, objects=list(PACES), doc="How many times faster than in reality.")
    signal_m = TypedNumber("Signal at, m", "m", default=500.0, **core_bounds(UnplannedStop, "position_m"))
    signal_s = TypedNumber("red for, s", "s", default=FIRST_STOP_S, **core_bounds(UnplannedStop, "duration_s"))
    is_open = param.Boolean(default=False, doc="Whether the signal stays red until it is cleared.")
    from_m = TypedNumber("Limit from, m", "m", default=600.0, **core_bounds(UnplannedLimit, "from_m"))
    to_m = TypedNumber("to, m", "m", default=700.0, **core_bounds(UnplannedLimit, "to_m"))
    limit_kmh = TypedNumber("km/h", "km/h", default=30.0, **core_bounds(UnplannedLimit, "limit_kmh"))
    voltage_percent = TypedNumber(
        "Voltage, %", "%", default=80.0, **core_bounds(VoltageChange, "line_voltage_factor", 100)
    )

    run = result(LiveRun, "The run as it is now.")
    planned = param.Event(doc="The run has another plan, or is another one.")
    replan_s = param.Number(default=0.0, doc="How long its plan ahead took [s].")
    set_signal = param.Event(doc="The red signal of the fields is set.")
    clear_signal = param.Event(doc="The next red signal is clear.")
    set_limit = param.Event(doc="The limit of the fields is set.")
    set_voltage = param.Event(doc="The supply voltage of the field is set.")
    restart = param.Event(doc="The train begins at the start again.")
    keep_events = param.Event(doc="What was set becomes the events of the page.")
    ended = result(LiveResult, "The run that has arrived, beside others.")

    def take(self, scenario: Scenario) -> None:
        """Choose places on a scenario's line."""
        length = scenario.line.length_m
        places: dict[str, Any] = {"signal_m": 0.5, "from_m": 0.6, "to_m": 0.7}
        self.param.update(**{name: round(share * length) for name, share in places.items()})
