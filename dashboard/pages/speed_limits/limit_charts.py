"""The figures of Speed limits that are no plain curves: set speeds that can be dragged, and the search for them."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from operator import methodcaller
from typing import Any

import numpy as np
from bokeh.events import PanEnd
from bokeh.models import LinearColorMapper
from bokeh.transform import transform

from railjoule.core import Trajectory
from railjoule.core.arrays import FloatArray
from railjoule.core.limit_search.search import LimitSearch
from railjoule.core.strategies.set_speed_run import MIN_LIMIT_KMH
from railjoule.core.units import J_PER_KWH, MS_PER_KMH
from railjoule.dashboard.charts import quantities
from railjoule.dashboard.charts.axis import Axis, columns, xy
from railjoule.dashboard.charts.dress import dragged
from railjoule.dashboard.charts.figures import LoneChart
from railjoule.dashboard.charts.machine_map import MotorMapChart
from railjoule.dashboard.charts.names import Name
from railjoule.dashboard.charts.plot import AxisPlot, Plot, Stroke
from railjoule.dashboard.charts.quantities import EFFORT, ENERGY, POSITION
from railjoule.dashboard.charts.run_charts import LineStrip
from railjoule.dashboard.charts.run_lines import DRIVEN_DASH, Curve, Line, RunLines, RunPlot
from railjoule.dashboard.charts.surface import CIVIDIS
from railjoule.dashboard.charts.track import add_limits, draw_limits, limits_of
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.pages.speed_limits.compute import LimitRun, LimitTrip

UNDER_LIMITS = "with the set speeds"
LINES: Mapping[str, Line] = {
    "optimal in the same time": Line("optimal", {"line_width": 1.8, "line_dash": DRIVEN_DASH}, "optimum"),
    UNDER_LIMITS: Line("speed_limits", {"line_width": 2.4}, "run"),
}
"""By the names at the lines and under the cursor."""
TRIP = "trip"
"""The run of the chart of speeds, the only one to show the trip while a step is dragged."""
HEADROOM = 1.09
GRIP_PX, SIGN_RISE_PX = 7.0, 8.0
"""Half the size of a handle, and how far above its step a limit is written."""
MIN_SECTION_M = 10
"""No border can be dragged closer to the next one."""
EXPENSIVE = 0.75
"""The colours end at this quantile of the energies: the most expensive set speeds of an even search matter little."""
NEAR_KMH = 2
"""Two points of the search that are closer than this share one name."""


class LimitSpeedChart(RunLines):
    """Speeds, with the set speeds of the sections as steps that can be dragged."""

    move: Callable[[Sequence[float], Sequence[float]], None]
    """Receives set speeds [km/h] and borders [m] while a step is dragged."""
    release: Callable[[], None]
    """Called when the step is released."""

    _drawing = False

    def __init__(self, height: int, axis: Axis, palette: Palette) -> None:
        lines = {**LINES, UNDER_LIMITS: replace(LINES[UNDER_LIMITS], of=TRIP)}
        caption, heights = "Speed, km/h; drag a set speed or its end", (height, height, height)
        # it has no zoom, as a drag moves a step
        look: dict[str, Any] = {"ticks": 5, "zoom": False, "below": (add_limits,), "above": (self.add_steps,)}
        super().__init__(RunPlot("limit_speed", quantities.SPEED, lines, heights, caption, **look), axis, palette)

    def add_steps(self, _: Any) -> None:
        """Draw the steps with their handles and numbers, and let the browser drag them."""
        f = self.figure
        assert f is not None
        sections = self.source("sections", "left", "right", "limit", "middle", "text", "most")
        borders, handles = self.source("borders", "x", "low", "high"), self.source("handles")
        edge, grip = {"line_color": "speed_limits"}, {"line_color": "speed_limits", "fill_color": "surface"}
        self.glyphs("segment", "sections", "left", "limit", "right", "limit", paint=edge, line_width=2)
        self.glyphs("segment", "borders", "x", "low", "x", "high", paint=edge, line_width=2)
        self.glyphs("scatter", "sections", "middle", "limit", paint=grip, size=11, line_width=2)
        self.glyphs("scatter", "handles", "x", "y", paint=grip, size=10, line_width=2, marker="square")
        self.grounded_signs("sections", "speed_limits", at=("middle", "limit"), text_align="center", y_offset=-10)
        bounds = {"least": MIN_LIMIT_KMH, "shortest": MIN_SECTION_M}
        dragged(f, "drag_sections", sections=sections, borders=borders, handles=handles, **bounds)
        sections.on_change("data", self._take)
        f.on_event(PanEnd, lambda _: self.release())
        self.add_names()

    def _take(self, _attribute: str, _old: Any, new: Mapping[str, Any]) -> None:
        """Take the steps that the browser has moved."""
        # the source calls for what is drawn here, too
        if not self._drawing:
            # the last section ends with the line: that is no border
            self.move([float(limit) for limit in new["limit"]], [float(place) for place in new["right"]][:-1])

    def draw(self, shown: LimitRun, limits_kmh: Sequence[float], borders_m: Sequence[float]) -> None:
        """Draw both runs under the limits that stand now."""
        scenario = shown.run.scenario
        runs = both(shown)
        curves = self.fill({TRIP if name == "run" else name: run for name, run in runs.items()})
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
        self.name_lines(curves, {"steps": ends, "line": line}, [*signs, *grips])

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
        self.axis.columns(TRIP).take(
            trip, {POSITION.name: trip.position_m, quantities.SPEED.name: quantities.SPEED.values(trip)}
        )


def both(shown: LimitRun) -> dict[str, Trajectory]:
    """Return the runs to draw by the names of their lines: the optimum only where there is one."""
    optimum = {} if shown.optimum is None else {"optimum": shown.optimum}
    return {**optimum, "run": shown.run}


class SearchPlaneChart(LoneChart):
    """Limits of two neighbouring sections, as the search drew them and as it drove them."""

    kind = "map"
    look: Mapping[str, Any] = {"ticks": 5}

    def __init__(self, height: int, palette: Palette) -> None:
        super().__init__("search_plane", "Search: set speeds tried, km/h; blue: less energy", height, palette)
        self.mapper = LinearColorMapper(palette=list(CIVIDIS), low=0, high=1)
        # the cheapest would vanish in the dark without an edge
        driven = {"size": 6.5, "fill_color": transform("energy", self.mapper), "line_width": 0.7}
        tried = {"size": 4, "fill_color": None, "line_width": 1}
        self.layers = (
            methodcaller("glyphs", "scatter", "asked", "x", "y", paint={"line_color": "groundline"}, **tried),
            methodcaller("source", "driven", "x", "y", "energy"),
            methodcaller("glyphs", "scatter", "driven", "x", "y", paint={"line_color": "ink3"}, **driven),
            methodcaller("line", "path", "ink3", line_width=1),
            methodcaller("source", "ends", "x", "y", "marker"),
            methodcaller("dots", "ends", "speed_limits", marker="marker", size=11, line_width=2),
            methodcaller("add_names", size=11),
        )

    def draw(self, search: LimitSearch, first: int, before: int = 0) -> None:
        """Draw the search in the limits of a section and the next one.

        `first` counts from 0 within the search, `before` are the sections of the line before those of the search.
        """
        assert self.figure is not None
        if len(search.best.limits_ms) < 2:
            self.clear()
            return
        pair = slice(first, first + 2)
        tried = search.evaluations
        asked = np.array([one.unscaled_ms[pair] for one in tried]) / MS_PER_KMH
        driven = np.array([one.limits_ms[pair] for one in tried]) / MS_PER_KMH
        energy: FloatArray = np.array([one.energy_j for one in tried]) / J_PER_KWH
        # infinite where a trip is late
        known, samples = np.isfinite(energy), np.array([one.stage == "sample" for one in tried])
        self.figure.xaxis.axis_label = f"Section {before + first + 1}, km/h"
        self.figure.yaxis.axis_label = f"Section {before + first + 2}, km/h"
        self.put("asked", **xy(*asked[samples].T))
        self.put("driven", **columns(x=driven[known, 0], y=driven[known, 1], energy=energy[known]))
        if known.any():
            # 1e-9: where all trips cost the same, the colours must still span something
            self.mapper.update(low=float(energy[known].min()), high=float(np.quantile(energy[known], EXPENSIVE)) + 1e-9)
        self.put("path", **xy(*driven[known & ~samples].T))
        start, end = driven[int(np.argmin(np.where(samples, energy, np.inf)))], search.best.limits_ms[pair] / MS_PER_KMH
        self.put("ends", x=[start[0], end[0]], y=[start[1], end[1]], marker=["circle", "diamond"])
        top = 1.04 * float(max(asked.max(), driven[known].max() if known.any() else 0.0))
        self.set_ranges((0.0, top), (0.0, top))
        ink, place = self.palette.tokens["ink2"], (float(end[0]), float(end[1]))
        names = [Name("found", "found", ink, point=place)]
        if float(np.abs(start - end).max()) >= NEAR_KMH:
            names.append(Name("first", "best of the first search", ink, point=(float(start[0]), float(start[1]))))
        self.place_names({}, names, [self.frame_now.dot(*place, 6)], size=11)


# ---- all figures of the page

SPEED = AxisPlot("limit_speed", LimitSpeedChart, (290, 360, 240))
TRACK = AxisPlot("line", LineStrip, (104, 112, 98))
OTHERS = (
    RunPlot("limit_effort", EFFORT, LINES, (104, 120, 96), ticks=3, zero=True, room=0.08),
    RunPlot("limit_energy", ENERGY, LINES, (130, 150, 120), ticks=3, zero=True, room=0.08, last=True),
)
PLANE = Plot("search_plane", "", heights=(280, 330, 260), chart=SearchPlaneChart)
MAP = Plot("motor_map", "", heights=(300, 360, 280), chart=MotorMapChart)
SAVED = Plot(
    "storage",
    "Saved by storage instead of brake resistors, kWh",
    {
        "receptive": Stroke("good", {"line_width": 1.2, "line_dash": [4, 3]}, "fully receptive supply"),
        "curve": Stroke("accent", {"line_width": 2.2}),
        "chosen": Stroke("accent", word="this storage", marks=True, line=False),
    },
    (220, 260, 200),
    x_title="Size, kWh",
    digits=1,
    x_digits=1,
    from_zero=True,
    uprights={"needed": "line2"},
    room=0.2,
)
