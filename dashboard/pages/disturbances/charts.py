"""Rides with events: speed and energy of all reactions on one axis, and energy over the delay at the end."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from bokeh.events import Tap

from railjoule.core import Trajectory
from railjoule.core.units import J_PER_KWH
from railjoule.dashboard.charts.chart import Axis, nice_range, points, xy
from railjoule.dashboard.charts.figures import LoneChart
from railjoule.dashboard.charts.line_names import Name
from railjoule.dashboard.charts.quantities import ENERGY, SPEED
from railjoule.dashboard.charts.run_lines import (
    DRIVEN_DASH,
    Curve,
    FittedRunLines,
    Form,
    Line,
    RunLines,
    add_tint,
    ends_of,
)
from railjoule.dashboard.day import EventModel
from railjoule.dashboard.look import words
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.pages.disturbances.compute import LateArrivals

LINES: Mapping[str, Line] = {
    "undisturbed": Line("pinned", {"line_width": 1.8}),
    "driver": Line("driven", {"line_width": 1.8, "line_dash": DRIVEN_DASH}),
    "with advance notice": Line("phases", {"line_width": 2.0, "line_dash": [2, 2]}, "known"),
    "replanned": Line("accent", {"line_width": 2.2}, "computer"),
}
"""Colour and stroke of each ride by its name at the line and under the cursor, in the order of drawing."""
NAME_TOKENS = {"undisturbed": "ink3"}
"""In which colour a name is written, where that of its line is too pale."""
HEADROOM = 1.28
"""The upper end of the axis over the highest speed: the signs of the events stand between."""
SAVED_OVER_S = 1.5
"""The saving of a second is that of the first delay which is so much later than the smallest one [s]."""
SIGN_DROP_PX = 15
"""The sign of an event hangs down so far from its place."""


class RideSpeedChart(RunLines):
    """Speeds, with the events where they happen; a press drops a new one."""

    def __init__(self, height: int, axis: Axis, palette: Palette, drop: Callable[[float], None]) -> None:
        super().__init__("ride_speed", SPEED, LINES, height, axis, palette, form=Form(ticks=5))
        self._drop = drop
        self._over_time = False

    def beneath(self) -> None:
        """Draw the events beneath the lines, and where they become known."""
        assert self.figure is not None
        self.source("limits", "left", "right", "bottom")
        add_tint(self, "limits")
        self.source("events", "x", "y", "text")
        self.hairlines("events", "limit", line_width=1.4)
        self.hairlines("notices", "ink3", line_dash=[1, 3])
        self.figure.on_event(Tap, self._press)

    def above(self) -> None:
        """Write what the events are, and the names of the lines."""
        self.signs("events", "limit", x_offset=4, text_baseline="top")
        self.add_names()

    def _press(self, event: Any) -> None:
        # over time the axis has no places
        if event.x is not None and not self._over_time and 0 < event.x < self.axis.end:
            self._drop(float(event.x))

    def draw(self, runs: Mapping[str, Trajectory], events: list[EventModel], over_time: bool) -> None:
        """Draw all rides, the events and where they become known."""
        self._over_time = over_time
        lines = self.fill(runs, over_time)
        top = HEADROOM * ends_of(lines.values())[1]
        self.set_range(0, top)
        shown = [] if over_time else [event for event in events if event.kind in {"stop", "limit"}]
        self.put(
            "events",
            x=[event.position_m for event in shown],
            # at three heights by turns, as events may be close to each other
            y=[top * (0.99 - 0.08 * (k % 3)) for k in range(len(shown))],
            text=[event.sign for event in shown],
        )
        limits = [event for event in shown if event.kind == "limit"]
        self.put(
            "limits",
            left=[event.position_m for event in limits],
            right=[event.to_m for event in limits],
            bottom=[event.limit_kmh for event in limits],
        )
        self.put("notices", x=[] if over_time else [event.noticed_at_m for event in events])
        self._draw_names(lines)

    def _draw_names(self, lines: Mapping[str, Curve]) -> None:
        """Name the lines where nothing else is, and clear of the signs of the events."""
        events, frame = self.sources["events"].data, self.frame_now
        limits = self.sources["limits"].data
        borders = {
            f"limit {k}": (np.array([left, right]), np.array([level, level]))
            for k, (left, right, level) in enumerate(
                zip(limits["left"], limits["right"], limits["bottom"], strict=True)
            )
        }
        hairlines = [*events["x"], *self.sources["notices"].data["x"]]
        upright = {f"hairline {k}": frame.upright(float(x)) for k, x in enumerate(hairlines)}
        # from the top downwards
        taken = [
            frame.box(x, y, text, lift_px=-SIGN_DROP_PX)
            for x, y, text in zip(events["x"], events["y"], events["text"], strict=True)
        ]
        names = [
            Name(name, name, self.palette.tokens[NAME_TOKENS.get(name, LINES[name].token)])
            for name in reversed(list(lines))
        ]
        self.place_names({**lines, **borders, **upright}, names, taken)


def ride_energy_chart(height: int, axis: Axis, palette: Palette) -> FittedRunLines:
    """Return the chart of energy drawn so far."""
    return FittedRunLines("ride_energy", ENERGY, LINES, height, axis, palette, form=Form(digits=1, last=True))


class LateChart(LoneChart):
    """Energy over the delay at the end: its slope is the price of each second caught up."""

    def __init__(self, height: int, palette: Palette) -> None:
        super().__init__("late_arrival", "Energy, kWh, over the delay at the end, s", height, palette)

    def build(self) -> None:
        """Make the figure."""
        self.frame(ticks=4, digits=1, x_title="Delay at the end, s")
        for name, line in LINES.items():
            if name != "undisturbed":
                self.line(line.of or name, line.token, **line.stroke)
        self.dots("present", size=9, line_width=2)

    def draw(self, late: LateArrivals, present: list[tuple[float, float]]) -> None:
        """Draw the curves so far, and the present rides as points."""
        ends: list[float] = []
        levels: list[float] = []
        for reaction, energy in late.energy_kwh.items():
            delay = late.delay_s[reaction]
            known = np.isfinite(energy)
            # the delay at the end need not rise with the one that is accepted
            order = np.argsort(delay[known])
            self.put(reaction, **xy(delay[known][order], energy[known][order]))
            ends += delay[known].tolist()
            levels += energy[known].tolist()
        self.put("present", **points(present))
        if levels:
            # where nothing is late, the axis must still have a length
            self.set_ranges((min(0.0, *ends), max(ends) + 1e-6), nice_range(min(levels), max(levels)))


def saved_by(late: LateArrivals, reaction: str) -> str:
    """Return what the first seconds of delay save, in words."""
    delay, energy = late.delay_s[reaction], late.energy_kwh[reaction]  # type: ignore[index]
    known = np.flatnonzero(np.isfinite(energy))
    # a train that cannot make up all of its delay arrives no later for the first delays that are accepted
    later = known[delay[known] >= delay[known[0]] + SAVED_OVER_S] if len(known) else known
    if not len(later):
        return "\u2013"
    first, then = known[0], later[0]
    return words.price((energy[first] - energy[then]) / (delay[then] - delay[first]) * J_PER_KWH)
