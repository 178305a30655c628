"""The run that plays: its clock, what is set while it plays, and how it ends."""

from dataclasses import dataclass
from functools import partial
from typing import Any

import param

from railjoule.core import Scenario, ScenarioError
from railjoule.core.scenario.disturbance import UnplannedLimit, UnplannedStop, VoltageChange
from railjoule.core.simulation.disturbances import DisturbedRun
from railjoule.core.simulation.live import LiveRun, clear_signal, set_event
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
        "step",
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
    step = param.Callable(default=None, allow_None=True, doc="Replaces the run by one with another plan.")
    restart = param.Event(doc="The train begins at the start again.")
    ended = result(LiveResult, "The run that has arrived, beside others.")

    def set_signal(self, *_: Any) -> None:
        """Set the red signal of the fields."""
        signal = UnplannedStop(position_m=self.signal_m, duration_s=self.signal_s)
        self.step = partial(set_event, event=signal, is_open=self.is_open)

    def clear_signal(self, *_: Any) -> None:
        """Clear the red signal that the train meets first."""
        # another function each time, as the same value would be no change
        self.step = partial(clear_first)

    def set_limit(self, *_: Any) -> None:
        """Set the lower limit of the fields."""
        if self.from_m >= self.to_m:
            begins, ends = f"{self.from_m:g} m", f"{self.to_m:g} m"
            self.failure = ScenarioError(f"Limit to {ends}: it begins at {begins}. Choose an end beyond that.")
            return
        limit = UnplannedLimit(from_m=self.from_m, to_m=self.to_m, limit_kmh=self.limit_kmh)
        self.step = partial(set_event, event=limit)

    def set_voltage(self, *_: Any) -> None:
        """Set the supply voltage of the field."""
        self.step = partial(set_event, event=VoltageChange(line_voltage_factor=self.voltage_percent / 100))

    def take(self, scenario: Scenario) -> None:
        """Choose places on a scenario's line."""
        length = scenario.line.length_m
        places: dict[str, Any] = {"signal_m": 0.5, "from_m": 0.6, "to_m": 0.7}
        self.param.update(**{name: round(share * length) for name, share in places.items()})


def clear_first(run: LiveRun) -> LiveRun:
    """Return a run whose next red signal is clear; the same run where none is red."""
    red = [one for one in run.events if one.is_ahead and not run.has_left(one)]
    return clear_signal(run, min(red, key=run.stand_node)) if red else run
