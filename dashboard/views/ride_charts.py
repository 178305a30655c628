"""Rides with events: speed and energy of all reactions on one axis, and energy over the delay at the end."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from bokeh.events import Tap
from bokeh.models import ColumnDataSource, Range1d

from railjoule.core import Trajectory
from railjoule.core.arrays import FloatArray
from railjoule.core.units import J_PER_KWH, MS_PER_KMH
from railjoule.dashboard.look import words
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.models.disturbances import EventModel
from railjoule.dashboard.store import LateArrivals
from railjoule.dashboard.views.charts import Axis, Chart, nice_range, text_style, xy
from railjoule.dashboard.views.events import event_sign
from railjoule.dashboard.views.figures import captioned, empty_figure
from railjoule.dashboard.views.line_names import Name
from railjoule.dashboard.views.run_lines import DRIVEN_DASH, RunLinesChart

LINES: Mapping[str, tuple[str, dict[str, Any]]] = {
    "undisturbed": ("pinned", {"line_width": 1.8}),
    "driver": ("driven", {"line_width": 1.8, "line_dash": DRIVEN_DASH}),
    "known": ("phases", {"line_width": 2.0, "line_dash": [2, 2]}),
    "computer": ("accent", {"line_width": 2.2}),
}
"""Colour and stroke of each ride, in the order of drawing."""
NAMES = {"computer": "replanned", "known": "with advance notice"}
"""What rides are called in a chart, where that is not their key."""

SIGN_DROP_PX = 15
"""The sign of an event hangs down so far from its place."""


class RideSpeedChart(RunLinesChart):
    """Speeds, with the events where they happen; a press drops a new one."""

    unit, digits, strokes = "km/h", 1, LINES

    def __init__(self, height: int, axis: Axis, palette: Palette, drop: Callable[[float], None]) -> None:
        super().__init__("ride_speed", "Speed, km/h", height, axis, palette)
        self._drop = drop
        self._over_time = False

    def build(self) -> None:
        """Make the figure."""
        f = self.frame(ticks=5)
        self.sources["limits"] = ColumnDataSource({"left": [], "right": [], "bottom": []})
        area = f.quad("left", "right", "bottom", 9e3, source=self.sources["limits"], fill_alpha=0.55, line_color=None)
        self.palette.paint(area.glyph, fill_color="ground")
        self.sources["events"] = ColumnDataSource({"x": [], "y": [], "text": []})
        line = f.vspan("x", source=self.sources["events"], line_width=1.4)
        self.palette.paint(line.glyph, line_color="limit")
        self.sources["notices"] = ColumnDataSource({"x": []})
        notice = f.vspan("x", source=self.sources["notices"], line_width=1, line_dash=[1, 3])
        self.palette.paint(notice.glyph, line_color="ink3")
        self.add_lines()
        sign = f.text(
            "x", "y", "text", source=self.sources["events"], x_offset=4, text_baseline="top", **text_style(11)
        )
        self.palette.paint(sign.glyph, text_color="limit")
        self.add_names()
        f.on_event(Tap, self._press)

    def _press(self, event: Any) -> None:
        if event.x is not None and not self._over_time and 0 < event.x < self.axis.end:
            self._drop(float(event.x))

    def values(self, run: Trajectory) -> FloatArray:
        """Speed [km/h]."""
        return run.speed_ms / MS_PER_KMH

    def draw(self, runs: Mapping[str, Trajectory], events: list[EventModel], over_time: bool) -> None:
        """Draw all rides, the events and where they become known."""
        self._over_time = over_time
        _, high = self.fill(runs, over_time)
        top = 1.28 * high
        self.set_range(0, top)
        shown = [] if over_time else [event for event in events if event.kind in {"stop", "limit"}]
        self.sources["events"].data = {
            "x": [event.position_m for event in shown],
            "y": [top * (0.99 - 0.08 * (k % 3)) for k in range(len(shown))],
            "text": [event_sign(event) for event in shown],
        }
        limits = [event for event in shown if event.kind == "limit"]
        self.sources["limits"].data = {
            "left": [event.position_m for event in limits],
            "right": [event.to_m for event in limits],
            "bottom": [event.limit_kmh for event in limits],
        }
        self.sources["notices"].data = {"x": [] if over_time else [event.noticed_at_m for event in events]}
        self._draw_names(runs, over_time)

    def _draw_names(self, runs: Mapping[str, Trajectory], over_time: bool) -> None:
        """Name the lines where nothing else is, and clear of the signs of the events."""
        lines = {name: (run.time_s if over_time else run.position_m, self.values(run)) for name, run in runs.items()}
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
            Name(name, NAMES.get(name, name), self.palette.tokens["ink3" if name == "undisturbed" else LINES[name][0]])
            for name in reversed(list(runs))
        ]
        self.place_names({**lines, **borders, **upright}, names, taken)


class RideEnergyChart(RunLinesChart):
    """Energy drawn so far."""

    unit, digits, strokes = "kWh", 2, LINES

    def __init__(self, height: int, axis: Axis, palette: Palette) -> None:
        super().__init__("ride_energy", "Energy drawn so far, kWh", height, axis, palette)

    def build(self) -> None:
        """Make the figure."""
        self.frame(with_axis=True, digits=1)
        self.add_lines()

    def values(self, run: Trajectory) -> FloatArray:
        """Line energy so far [kWh]."""
        return run.line_energy_j / J_PER_KWH

    def draw(self, runs: Mapping[str, Trajectory], over_time: bool) -> None:
        """Draw the energies and name the axis."""
        assert self.figure is not None
        self.set_range(*nice_range(*self.fill(runs, over_time)))
        self.figure.xaxis.axis_label = "Time, s" if over_time else "Distance, m"


class LateChart(Chart):
    """Energy over the delay at the end: its slope is the price of each second caught up."""

    def __init__(self, height: int, palette: Palette) -> None:
        super().__init__("late_arrival", "Energy, kWh, over the delay at the end, s", height)
        self.palette, self.x_range, self.y_range = palette, Range1d(0, 1), Range1d(0, 1)

    def build(self) -> None:
        """Make the figure."""
        f = empty_figure(
            self.height,
            self.x_range,
            self.y_range,
            self.words,
            self.palette,
            ticks=4,
            digits=1,
            x_title="Delay at the end, s",
        )
        self.figure = f
        self.sources = {}
        for name, (token, style) in LINES.items():
            if name != "undisturbed":
                self.sources[name] = ColumnDataSource({"x": [], "y": []})
                line = f.line("x", "y", source=self.sources[name], **style)
                self.palette.paint(line.glyph, line_color=token)
        self.sources["present"] = ColumnDataSource({"x": [], "y": []})
        point = f.scatter("x", "y", source=self.sources["present"], size=9, line_width=2)
        self.palette.paint(point.glyph, fill_color="accent", line_color="surface")
        self.content = captioned(self.words, f)

    def draw(self, late: LateArrivals, present: list[tuple[float, float]]) -> None:
        """Draw the curves so far, and the present rides as points."""
        ends: list[float] = []
        levels: list[float] = []
        for reaction, energy in late.energy_kwh.items():
            delay = late.delay_s[reaction]
            known = np.isfinite(energy)
            order = np.argsort(delay[known])
            self.sources[reaction].data = xy(delay[known][order], energy[known][order])
            ends += delay[known].tolist()
            levels += energy[known].tolist()
        self.sources["present"].data = {"x": [x for x, _ in present], "y": [y for _, y in present]}
        if levels:
            self.x_range.update(start=min(0.0, *ends), end=max(ends) + 1e-6)
            low, high = nice_range(min(levels), max(levels))
            self.y_range.update(start=low, end=high)


def saved_by(late: LateArrivals, reaction: str) -> str:
    """Return what the first seconds of delay save, in words."""
    delay, energy = late.delay_s[reaction], late.energy_kwh[reaction]  # type: ignore[index]
    known = np.flatnonzero(np.isfinite(energy))
    if len(known) < 3 or delay[known[2]] <= delay[known[0]]:
        return "\u2013"
    price = (energy[known[0]] - energy[known[2]]) / (delay[known[2]] - delay[known[0]]) * J_PER_KWH
    return words.price(price)
