"""The run under limits beside the optimum: speed with limits that can be dragged, effort, energy."""

from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from bokeh.events import PanEnd
from bokeh.models import ColumnDataSource, CustomJS

from railjoule.core import Trajectory
from railjoule.core.arrays import FloatArray
from railjoule.core.motion.line_profile import limit_steps
from railjoule.core.strategies.speed_limits import LEAST_LIMIT_KMH
from railjoule.core.units import J_PER_KWH, MS_PER_KMH
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.scripts import function
from railjoule.dashboard.store import LimitRun, LimitTrip
from railjoule.dashboard.views.charts import Axis, add_zero, clear, nice_range, text_style, xy
from railjoule.dashboard.views.line_names import Name
from railjoule.dashboard.views.run_lines import DRIVEN_DASH, RunLinesChart

LINES: Mapping[str, tuple[str, dict[str, Any]]] = {
    "optimum": ("optimal", {"line_width": 1.8, "line_dash": DRIVEN_DASH}),
    "run": ("speed_limits", {"line_width": 2.4}),
}
LINE_WORDS = {"optimum": "optimal in the same time", "run": "under the limits"}
HEADROOM = 1.09
GRIP_PX, SIGN_RISE_PX = 7.0, 8.0
"""Half the size of a handle, and how far above its step a limit is written."""
FAR_ABOVE = 9e3
LEAST_SECTION_M = 10
"""No border can be dragged closer to the next one."""


class LimitSpeedChart(RunLinesChart):
    """Speeds, with the limits of the sections as steps that can be dragged.

    Parameters
    ----------
    move : callable
        Takes limits [km/h] and borders [m] while a step is dragged.
    release : callable
        Called when it is let go.
    """

    unit, digits, strokes = "km/h", 1, LINES

    def __init__(
        self,
        height: int,
        axis: Axis,
        palette: Palette,
        move: Callable[[Sequence[float], Sequence[float]], None],
        release: Callable[[], None],
    ) -> None:
        super().__init__(
            "limit_speed", "Speed, km/h: drag a step to change its limit, its end to move it", height, axis, palette
        )
        self._move, self._release = move, release
        self._drawing = False

    def build(self) -> None:
        """Make the figure."""
        f = self.frame(ticks=5, zoom=False)
        self.sources["forbidden"] = ColumnDataSource({"left": [], "right": [], "bottom": []})
        area = f.quad(
            "left", "right", "bottom", FAR_ABOVE, source=self.sources["forbidden"], fill_alpha=0.55, line_color=None
        )
        self.palette.paint(area.glyph, fill_color="ground")
        self.add_lines()
        self._add_steps()
        self.add_names()

    def _add_steps(self) -> None:
        f = self.figure
        assert f is not None
        sections = ColumnDataSource({key: [] for key in ("left", "right", "limit", "middle", "text", "most")})
        borders, handles = ColumnDataSource({"x": [], "low": [], "high": []}), ColumnDataSource({"x": [], "y": []})
        self.sources.update(sections=sections, borders=borders, handles=handles)
        step = f.segment("left", "limit", "right", "limit", source=sections, line_width=2)
        rise = f.segment("x", "low", "x", "high", source=borders, line_width=2)
        grip = f.scatter("middle", "limit", source=sections, size=11, line_width=2)
        square = f.scatter("x", "y", source=handles, size=10, line_width=2, marker="square")
        sign = f.text(
            "middle",
            "limit",
            "text",
            source=sections,
            text_align="center",
            y_offset=-10,
            background_fill_alpha=0.8,
            padding=1,
            **text_style(),
        )
        for drawn in (step, rise):
            self.palette.paint(drawn.glyph, line_color="limit")
        for drawn in (grip, square):
            self.palette.paint(drawn.glyph, line_color="limit", fill_color="surface")
        self.palette.paint(sign.glyph, text_color="limit", background_fill_color="surface")
        bounds = {"least": LEAST_LIMIT_KMH, "shortest": LEAST_SECTION_M}
        drag = CustomJS(
            args={"f": f, "sections": sections, "borders": borders, "handles": handles, **bounds},
            code=function("drag_sections", "drag_sections({f, sections, borders, handles, least, shortest}, cb_obj)"),
        )
        for event in ("panstart", "pan", "panend"):
            f.js_on_event(event, drag)
        sections.on_change("data", self._take)
        f.on_event(PanEnd, lambda _: self._release())

    def _take(self, _attribute: str, _old: Any, new: Mapping[str, Any]) -> None:
        """Take the steps that the browser has moved."""
        if not self._drawing:
            self._move([float(limit) for limit in new["limit"]], [float(place) for place in new["right"]][:-1])

    def values(self, run: Trajectory) -> FloatArray:
        """Speed [km/h]."""
        return run.speed_ms / MS_PER_KMH

    def draw(self, shown: LimitRun, limits_kmh: Sequence[float], borders_m: Sequence[float]) -> None:
        """Draw both runs under the limits that stand now."""
        scenario, runs = shown.run.scenario, both(shown)
        self.fill(runs)
        if "optimum" not in runs:
            clear(self.sources["optimum"])
        most = scenario.vehicle.traction.max_speed_kmh
        top = HEADROOM * most
        self.set_range(0, top)
        places, limits = limit_steps(scenario.line.in_running_order(), most)
        self.sources["forbidden"].data = {
            "left": places[:-1].tolist(),
            "right": places[1:].tolist(),
            "bottom": limits.tolist(),
        }
        self._draw_steps(limits_kmh, [0.0, *borders_m, scenario.line.length_m], most)
        self._draw_names(runs, np.repeat(places, 2)[1:-1], np.repeat(limits, 2))

    def _draw_names(self, runs: Mapping[str, Trajectory], places_m: FloatArray, line_limits_kmh: FloatArray) -> None:
        """Name the runs clear of the steps with their handles and signs."""
        steps, frame = self.sources["sections"].data, self.frame_now
        ends = np.ravel([steps["left"], steps["right"]], order="F"), np.repeat(steps["limit"], 2)
        lines = {name: (run.position_m, self.values(run)) for name, run in runs.items()}
        signs = [
            frame.box(x, limit, text, 12, "center", SIGN_RISE_PX)
            for x, limit, text in zip(steps["middle"], steps["limit"], steps["text"], strict=True)
        ]
        grips = [
            (float(x) - GRIP_PX, float(y) - GRIP_PX, float(x) + GRIP_PX, float(y) + GRIP_PX)
            for data, column in ((steps, ("middle", "limit")), (self.sources["handles"].data, ("x", "y")))
            for x, y in zip(frame.x_px(data[column[0]]), frame.y_px(data[column[1]]), strict=True)
        ]
        names = [Name(name, LINE_WORDS[name], self.palette.tokens[LINES[name][0]]) for name in reversed(list(runs))]
        self.place_names({**lines, "steps": ends, "line": (places_m, line_limits_kmh)}, names, [*signs, *grips])

    def _draw_steps(self, limits_kmh: Sequence[float], ends_m: Sequence[float], most: float) -> None:
        left, right, limits = list(ends_m[:-1]), list(ends_m[1:]), [float(limit) for limit in limits_kmh]
        self._drawing = True
        self.sources["borders"].data = {"x": right[:-1], "low": limits[:-1], "high": limits[1:]}
        self.sources["handles"].data = {"x": right[:-1], "y": [0.5 * (one + other) for one, other in pairwise(limits)]}
        self.sources["sections"].data = {
            "left": left,
            "right": right,
            "limit": limits,
            "middle": [0.5 * (start + end) for start, end in zip(left, right, strict=True)],
            "text": [f"{limit:.1f}".removesuffix(".0") for limit in limits],
            "most": [most] * len(limits),
        }
        self._drawing = False

    def draw_trip(self, trip: LimitTrip) -> None:
        """Draw the trip of the step as it is being moved."""
        self.sources["run"].data = xy(trip.position_m, trip.speed_ms / MS_PER_KMH)


class LimitEffortChart(RunLinesChart):
    """Efforts in the cells."""

    unit, digits, stepped, strokes = "kN", 0, True, LINES

    def __init__(self, height: int, axis: Axis, palette: Palette) -> None:
        super().__init__("limit_effort", "Tractive (+) and braking (\u2212) effort, kN", height, axis, palette)

    def build(self) -> None:
        """Make the figure."""
        f = self.frame(ticks=3)
        add_zero(f, self.palette)
        self.add_lines()

    def values(self, run: Trajectory) -> FloatArray:
        """Effort [kN]; each node has that of the cell before it."""
        return np.append(run.effort_n[:1], run.effort_n) / 1e3

    def draw(self, shown: LimitRun) -> None:
        """Draw both runs."""
        self.set_range(*nice_range(*fill_both(self, shown), 0.08))


class LimitEnergyChart(RunLinesChart):
    """Energy drawn so far."""

    unit, digits, strokes = "kWh", 2, LINES

    def __init__(self, height: int, axis: Axis, palette: Palette) -> None:
        super().__init__("limit_energy", "Energy drawn so far, kWh", height, axis, palette)

    def build(self) -> None:
        """Make the figure."""
        f = self.frame(with_axis=True, ticks=3)
        add_zero(f, self.palette)
        f.xaxis.axis_label = "Distance, m"
        self.add_lines()

    def values(self, run: Trajectory) -> FloatArray:
        """Line energy so far [kWh]."""
        return run.line_energy_j / J_PER_KWH

    def draw(self, shown: LimitRun) -> None:
        """Draw both runs."""
        self.set_range(*nice_range(*fill_both(self, shown), 0.08))


def both(shown: LimitRun) -> dict[str, Trajectory]:
    """Return the runs to draw by the names of their lines: the optimum only where there is one."""
    optimum = {} if shown.optimum is None else {"optimum": shown.optimum}
    return {**optimum, "run": shown.run}


def fill_both(chart: RunLinesChart, shown: LimitRun) -> tuple[float, float]:
    """Fill the lines of both runs; return the least and the greatest value."""
    if shown.optimum is None:
        clear(chart.sources["optimum"])
    return chart.fill(both(shown))
