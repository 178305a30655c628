"""The run under limits beside the optimum: speed with limits that can be dragged, effort, energy."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
from bokeh.events import PanEnd
from bokeh.plotting import figure

from railjoule.core import Trajectory
from railjoule.core.strategies.set_speed_run import MIN_LIMIT_KMH
from railjoule.dashboard.charts.chart import Axis, dragged
from railjoule.dashboard.charts.line_names import Name
from railjoule.dashboard.charts.quantities import POSITION, SPEED, Quantity
from railjoule.dashboard.charts.run_lines import (
    DRIVEN_DASH,
    Curve,
    FittedRunLines,
    Form,
    Line,
    RunLines,
    add_tint,
    draw_limits,
    limits_of,
)
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.pages.speed_limits.compute import LimitRun, LimitTrip

UNDER_LIMITS = "with the set speeds"
LINES: Mapping[str, Line] = {
    "optimal in the same time": Line("optimal", {"line_width": 1.8, "line_dash": DRIVEN_DASH}, "optimum"),
    UNDER_LIMITS: Line("speed_limits", {"line_width": 2.4}, "run"),
}
"""By the names at the lines and under the cursor."""
TRIP = "trip"
"""The run as the chart of speeds has it: while a step is dragged it alone shows the trip, which has no efforts."""
HEADROOM = 1.09
GRIP_PX, SIGN_RISE_PX = 7.0, 8.0
"""Half the size of a handle, and how far above its step a limit is written."""
MIN_SECTION_M = 10
"""No border can be dragged closer to the next one."""


class LimitSpeedChart(RunLines):
    """Speeds, with the limits of the sections as steps that can be dragged.

    Parameters
    ----------
    move : callable
        Takes limits [km/h] and borders [m] while a step is dragged.
    release : callable
        Called when it is let go.
    """

    def __init__(
        self,
        height: int,
        axis: Axis,
        palette: Palette,
        move: Callable[[Sequence[float], Sequence[float]], None],
        release: Callable[[], None],
    ) -> None:
        lines = {**LINES, UNDER_LIMITS: replace(LINES[UNDER_LIMITS], of=TRIP)}
        caption = "Speed, km/h: drag a step to change its set speed, its end to move it"
        super().__init__("limit_speed", SPEED, lines, height, axis, palette, caption, Form(ticks=5))
        self._move, self._release = move, release
        self._drawing = False

    def frame(self, *args: Any, **style: Any) -> figure:
        """Return the empty figure; it has no zoom, as a drag moves a step."""
        return super().frame(*args, **{**style, "zoom": False})

    def beneath(self) -> None:
        """Tint what the line's own limits forbid."""
        add_tint(self)

    def above(self) -> None:
        """Draw the steps with their handles and numbers, and let the browser drag them."""
        f = self.figure
        assert f is not None
        sections = self.source("sections", "left", "right", "limit", "middle", "text", "most")
        borders, handles = self.source("borders", "x", "low", "high"), self.source("handles")
        red, grip = {"line_color": "limit"}, {"line_color": "limit", "fill_color": "surface"}
        self.glyphs("segment", "sections", "left", "limit", "right", "limit", paint=red, line_width=2)
        self.glyphs("segment", "borders", "x", "low", "x", "high", paint=red, line_width=2)
        self.glyphs("scatter", "sections", "middle", "limit", paint=grip, size=11, line_width=2)
        self.glyphs("scatter", "handles", "x", "y", paint=grip, size=10, line_width=2, marker="square")
        self.grounded_signs("sections", "limit", at=("middle", "limit"), text_align="center", y_offset=-10)
        bounds = {"least": MIN_LIMIT_KMH, "shortest": MIN_SECTION_M}
        dragged(f, "drag_sections", sections=sections, borders=borders, handles=handles, **bounds)
        sections.on_change("data", self._take)
        f.on_event(PanEnd, lambda _: self._release())
        self.add_names()

    def _take(self, _attribute: str, _old: Any, new: Mapping[str, Any]) -> None:
        """Take the steps that the browser has moved."""
        # the source calls for what is drawn here, too
        if not self._drawing:
            # the last section ends with the line: that is no border
            self._move([float(limit) for limit in new["limit"]], [float(place) for place in new["right"]][:-1])

    def draw(self, shown: LimitRun, limits_kmh: Sequence[float], borders_m: Sequence[float]) -> None:
        """Draw both runs under the limits that stand now."""
        scenario = shown.run.scenario
        runs = both(shown)
        curves = self.fill({TRIP if name == "run" else name: run for name, run in runs.items()})
        self.told["sources"] = [self.read(name, name) for name in curves]
        most = scenario.vehicle.traction.max_speed_kmh
        self.set_range(0, HEADROOM * most)
        line = draw_limits(self, *limits_of(scenario))
        self._draw_steps(limits_kmh, [0.0, *borders_m, scenario.line.length_m], most)
        self._draw_names(curves, line)

    def _draw_names(self, curves: Mapping[str, Curve], line: Curve) -> None:
        """Name the runs clear of the steps with their handles and signs, and of the limits of the line."""
        steps, frame = self.sources["sections"].data, self.frame_now
        # by columns ("F"): left and right end of one section after the other, each at its limit
        ends = np.ravel([steps["left"], steps["right"]], order="F"), np.repeat(steps["limit"], 2)
        signs = [
            frame.box(x, limit, text, 12, "center", SIGN_RISE_PX)
            for x, limit, text in zip(steps["middle"], steps["limit"], steps["text"], strict=True)
        ]
        grips = [
            (float(x) - GRIP_PX, float(y) - GRIP_PX, float(x) + GRIP_PX, float(y) + GRIP_PX)
            for data, column in ((steps, ("middle", "limit")), (self.sources["handles"].data, ("x", "y")))
            for x, y in zip(frame.x_px(data[column[0]]), frame.y_px(data[column[1]]), strict=True)
        ]
        tokens = self.palette.tokens
        names = [Name(name, name, tokens[LINES[name].token]) for name in reversed(list(curves))]
        self.place_names({**curves, "steps": ends, "line": line}, names, [*signs, *grips])

    def _draw_steps(self, limits_kmh: Sequence[float], ends_m: Sequence[float], most: float) -> None:
        left, right, limits = list(ends_m[:-1]), list(ends_m[1:]), [float(limit) for limit in limits_kmh]
        # sent whatever stands there: the browser has dragged these steps, and may be ahead of what is known here
        self._drawing = True
        self.sources["borders"].data = {"x": right[:-1], "low": limits[:-1], "high": limits[1:]}
        self.sources["handles"].data = {"x": right[:-1], "y": [0.5 * (one + other) for one, other in pairwise(limits)]}
        self.sources["sections"].data = {
            "left": left,
            "right": right,
            "limit": limits,
            "middle": [0.5 * (start + end) for start, end in zip(left, right, strict=True)],
            # as assets/scripts/drag_sections.js writes it under the mouse
            "text": [f"{limit:.1f}".removesuffix(".0") for limit in limits],
            "most": [most] * len(limits),
        }
        self._drawing = False

    def draw_trip(self, trip: LimitTrip) -> None:
        """Draw the trip of the step as it is being moved."""
        self.axis.columns(TRIP).take(trip, {POSITION.name: trip.position_m, SPEED.name: SPEED.values(trip)})


class LimitChart(FittedRunLines):
    """Another quantity of both runs."""

    def __init__(self, quantity: Quantity, height: int, axis: Axis, palette: Palette, last: bool = False) -> None:
        form = Form(ticks=3, zero=True, last=last, room=0.08)
        super().__init__(f"limit_{quantity.name}", quantity, LINES, height, axis, palette, form=form)


def both(shown: LimitRun) -> dict[str, Trajectory]:
    """Return the runs to draw by the names of their lines: the optimum only where there is one."""
    optimum = {} if shown.optimum is None else {"optimum": shown.optimum}
    return {**optimum, "run": shown.run}
