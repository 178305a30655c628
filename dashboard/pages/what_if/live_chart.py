"""The speed of a run that plays: what was driven, the plan ahead, the plan before, and the train."""

from collections.abc import Callable
from typing import Any

import numpy as np
from bokeh.events import Tap

from railjoule.core.arrays import FloatArray
from railjoule.core.simulation.leg import Leg
from railjoule.core.simulation.live import LiveEvent, LiveRun
from railjoule.core.units import MS_PER_KMH
from railjoule.dashboard.charts.chart import Axis, DistanceChart, xy
from railjoule.dashboard.charts.line_names import Name
from railjoule.dashboard.charts.plot import ChartOverAxis
from railjoule.dashboard.charts.quantities import SPEED
from railjoule.dashboard.charts.run_lines import (
    DRIVEN_DASH,
    Curve,
    add_limits,
    add_stations,
    draw_limits,
    draw_stations,
    limits_of,
)
from railjoule.dashboard.look import words
from railjoule.dashboard.look.paint import Palette

LINES = {"former plan": "pinned", "plan ahead": "accent", "driven": "driven"}
"""The colours of the lines, in the order of drawing."""
NAMES = {"former plan": "ink3", "plan ahead": "accent", "driven": "driven"}
"""The colours in which they are named."""
STROKES: dict[str, dict[str, Any]] = {
    "former plan": {"line_width": 1.8, "line_dash": [2, 3]},
    "plan ahead": {"line_width": 2.2, "line_dash": DRIVEN_DASH},
    "driven": {"line_width": 2.4},
}
HEADROOM = 1.2
"""The upper end of the axis over the highest speed."""
LIMIT_ROOM = 1.1
"""The same over the highest limit: the signs of the signals stand between."""
# a cell of a coarse plan is drawn in as many pieces as it is seen to be curved
DRAWN_POINTS = 400


class LiveSpeedChart(DistanceChart):
    """Speed over distance while a run plays; a press sets a red signal."""

    def __init__(self, height: int, axis: Axis, palette: Palette) -> None:
        super().__init__("live_speed", SPEED.words, height, axis, palette)
        self.unit, self.digits = SPEED.unit, SPEED.digits
        self.press: Callable[[float], None] = lambda _: None
        """Called with the place of a press [m]."""
        self._plan: Leg | None = None
        self._drawn_m = 0.0

    def build(self) -> None:
        """Make the figure."""
        f = self.frame(with_axis=True, ticks=5)
        f.xaxis.axis_label = "Distance, m"
        add_limits(self)
        add_stations(self)
        self.hairlines("signals", "limit", line_width=1.4)
        for name, token in LINES.items():
            self.line(name, token, **STROKES[name])
        self.dots("train", "surface", "driven", size=11, line_width=3)
        self.signs("signs", "limit", x_offset=4, text_baseline="top")
        self.add_names()
        f.on_event(Tap, self._press)
        self.set_cursor_sources(*LINES)

    def _press(self, event: Any) -> None:
        if event.x is not None and 0 < event.x < self.axis.end:
            self.press(float(event.x))

    def draw(self, run: LiveRun) -> None:
        """Draw a run with its plan."""
        driven = [_curve(leg) for leg in (*run.driven, run.plan.until(run.position_m))]
        curves = {
            "former plan": _curve(run.former) if run.former is not None else (np.empty(0), np.empty(0)),
            "plan ahead": _curve(run.plan),
            "driven": (np.concatenate([x for x, _ in driven]), np.concatenate([y for _, y in driven])),
        }
        for name, (x, y) in curves.items():
            # as lists: `stream` adds to them
            self.put(name, x=x.tolist(), y=y.tolist())
        borders, limits = limits_of(run.since.scenario)
        limit = draw_limits(self, borders, limits)
        draw_stations(self, [station.position_m for station in run.scenario.line.inner_stations])
        speeds = [float(y.max()) for _, y in curves.values() if len(y)]
        speeds.append(run.planned.max_speed_kmh)
        top = max(HEADROOM * max(speeds), LIMIT_ROOM * float(limits.max()))
        self.set_range(0, top)
        signals = [one for one in run.events if one.is_ahead and not run.has_left(one)]
        places = [float(one.event.position_m) for one in signals]  # type: ignore[attr-defined]
        self.put("signals", x=places)
        self.put("signs", x=places, y=[0.99 * top] * len(places), text=[_sign(one) for one in signals])
        self._plan, self._drawn_m = run.plan, run.position_m
        self._draw_train(run)
        shown = {name: curve for name, curve in curves.items() if len(curve[0]) > 1}
        names = [Name(name, name, self.palette.tokens[NAMES[name]]) for name in reversed(shown)]
        taken = [self.frame_now.box(x, 0.99 * top, "red 000 s", lift_px=-15) for x in places]
        self.place_names({**shown, "limit": limit}, names, taken)

    def move(self, run: LiveRun) -> None:
        """Move the train on, over the plan that is drawn."""
        if self.figure is None or run.plan is not self._plan:
            return
        now = run.position_m
        between = (run.plan.position_m > self._drawn_m) & (run.plan.position_m < now)
        x = np.append(run.plan.position_m[between], now)
        y = np.sqrt(np.interp(x, run.plan.position_m, run.plan.speed2)) / MS_PER_KMH
        if now > self._drawn_m:
            self.sources["driven"].stream({"x": x.tolist(), "y": y.tolist()})
        self._drawn_m = now
        self._draw_train(run)

    def _draw_train(self, run: LiveRun) -> None:
        self.put("train", **xy(np.array([run.position_m]), np.array([run.speed_ms / MS_PER_KMH])))


PLAYED = ChartOverAxis("live_speed", LiveSpeedChart, (300, 380, 240), "live")


def _curve(leg: Leg) -> Curve:
    """Return places [m] and speeds [km/h] of a leg, fine enough for the root of a straight line."""
    first, last = float(leg.position_m[0]), float(leg.position_m[-1])
    places: FloatArray = np.union1d(leg.position_m, np.linspace(first, last, DRAWN_POINTS))
    return places, np.sqrt(np.interp(places, leg.position_m, leg.speed2)) / MS_PER_KMH


def _sign(signal: LiveEvent) -> str:
    """Return the sign of a red signal."""
    return "red" if signal.is_open else f"red {words.number(signal.event.duration_s, 0)} s"  # type: ignore[attr-defined]
