"""The charts of Learn: speeds of two runs, energy over time with the price of a second, the phase plane."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from bokeh.models import ColumnDataSource, Range1d, Span

from railjoule.core import Trajectory
from railjoule.core.arrays import FloatArray
from railjoule.core.studies.steady import SteadySpeeds
from railjoule.core.units import J_PER_KWH, MS_PER_KMH
from railjoule.dashboard.look import words
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.store import LessonResult
from railjoule.dashboard.views.charts import Axis, Chart, columns, nice_range, text_style, write_names, xy
from railjoule.dashboard.views.figures import captioned, empty_figure
from railjoule.dashboard.views.line_names import Name, name_source, placed_names
from railjoule.dashboard.views.run_lines import DRIVEN_DASH, RunLinesChart

LINES: Mapping[str, tuple[str, dict[str, Any]]] = {
    "second": ("driven", {"line_width": 1.8, "line_dash": DRIVEN_DASH}),
    "first": ("optimal", {"line_width": 2.6}),
}
WORTH_ENDS = (-0.7, 2.3)
"""What of the phase plane is shown: near rest the worth of motion grows beyond all bounds."""
STEEPEST_SHARE = 0.03
HEADROOM = 1.12


class LessonSpeedChart(RunLinesChart):
    """Speeds of two runs.

    Parameters
    ----------
    lesson, caption : str
        The lesson's name, and what the lines are.
    """

    unit, digits, strokes = "km/h", 1, LINES

    def __init__(self, lesson: str, caption: str, height: int, palette: Palette) -> None:
        super().__init__(f"lesson_{lesson}", caption, height, Axis(palette), palette)

    def build(self) -> None:
        """Make the figure."""
        f = self.frame(with_axis=True, zoom=False)
        self.palette.paint(f.xaxis[0], axis_line_color="line2")
        f.xaxis.axis_label = "Distance, m"
        self.add_lines()

    def values(self, run: Trajectory) -> FloatArray:
        """Speed [km/h]."""
        return run.speed_ms / MS_PER_KMH

    def draw(self, result: LessonResult) -> None:
        """Draw both runs."""
        first, second, *_ = result.runs.values()
        self.axis.fit(max(first.position_m[-1], second.position_m[-1]), roomy=False)
        _, high = self.fill({"first": first, "second": second})
        self.set_range(0, HEADROOM * high)
        names = dict(zip(("first", "second"), result.runs, strict=False))
        self.told["sources"] = [[name, self.sources[line]] for line, name in names.items()]
        self.axis.settle("m", 0)


class PriceChart(Chart):
    """The least energy over travel time, with the price of a second as its slope."""

    def __init__(self, height: int, palette: Palette) -> None:
        super().__init__("lesson_price", "Least energy, kWh; its slope: energy saved per extra second", height)
        self.palette = palette
        self.x_range, self.y_range = Range1d(0, 1), Range1d(0, 1)
        self.sources = {name: ColumnDataSource({"x": [], "y": []}) for name in ("curve", "tangent", "point")}

    def build(self) -> None:
        """Make the figure."""
        f = empty_figure(
            self.height, self.x_range, self.y_range, self.words, self.palette, ticks=4, x_title="Travel time, s"
        )
        curve = f.line("x", "y", source=self.sources["curve"], line_width=2.6)
        tangent = f.line("x", "y", source=self.sources["tangent"], line_width=1.2)
        point = f.scatter("x", "y", source=self.sources["point"], size=10, line_width=2)
        self.palette.paint(curve.glyph, line_color="optimal")
        self.palette.paint(tangent.glyph, line_color="ink")
        self.palette.paint(point.glyph, fill_color="accent", line_color="surface")
        self.figure = f
        self.content = captioned(self.words, f)

    def draw(self, result: LessonResult) -> None:
        """Draw curve, point and tangent."""
        frontier, run = result.frontier, result.runs["optimum"]
        if frontier is None:
            return
        time, energy = frontier.travel_time_s, frontier.energy_kwh
        steepest = float(np.interp(frontier.shortest_travel_time_s * (1 + STEEPEST_SHARE), time, energy))
        slope = (run.price_of_time_w or 0.0) / J_PER_KWH
        reach = 0.12 * float(time[-1] - time[0])
        ends = np.array([-reach, reach])
        self.sources["curve"].data = xy(time, energy)
        self.sources["tangent"].data = xy(run.travel_time_s + ends, run.energy_kwh - slope * ends)
        self.sources["point"].data = {"x": [run.travel_time_s], "y": [run.energy_kwh]}
        low, high = nice_range(float(np.nanmin(energy)), max(steepest, run.energy_kwh))
        self.x_range.update(start=float(time[0]), end=float(time[-1]))
        self.y_range.update(start=low, end=high)


class PhasePlaneChart(Chart):
    """What a joule of motion is worth over speed: above, between and below two lines the driver does other things."""

    kind = "map"

    def __init__(self, lesson: str, height: int, palette: Palette) -> None:
        caption = "Phase plane: value of a joule of kinetic energy, J from the supply, over speed, km/h"
        super().__init__(f"plane_{lesson}", caption, height)
        self.palette = palette
        self.x_range, self.y_range = Range1d(0, 80), Range1d(*WORTH_ENDS)
        self.bands = ColumnDataSource({"bottom": [], "top": [], "fill": []})
        self.names = ColumnDataSource({"y": [], "text": [], "ink": []})
        self.run = ColumnDataSource({"x": [], "y": []})
        self.marks, self.signs = ColumnDataSource({"x": [], "y": []}), name_source()
        self.driving, self.braking = (Span(dimension="width", line_width=1) for _ in range(2))

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
            x_title="Speed, km/h",
            y_title="Worth, J",
        )
        f.quad(-10, 1e3, "top", "bottom", source=self.bands, fill_color="fill", fill_alpha=0.35, line_color=None)
        f.text(
            self.x_range.end - 1,
            "y",
            "text",
            text_color="ink",
            source=self.names,
            text_align="right",
            text_baseline="middle",
            **text_style(11),
        )
        for span in (self.driving, self.braking):
            self.palette.paint(span, line_color="ink3")
            f.add_layout(span)
        line = f.line("x", "y", source=self.run, line_width=2.6)
        dots = f.scatter("x", "y", source=self.marks, size=8, line_width=2)
        write_names(f, self.signs, 11)
        self.palette.paint(line.glyph, line_color="optimal")
        self.palette.paint(dots.glyph, fill_color="accent", line_color="surface")
        self.figure = f
        self.content = captioned(self.words, f)

    def draw(self, result: LessonResult) -> None:
        """Draw the three regions and the run through them."""
        steady = result.steady
        if steady is None:
            return
        speed = np.concatenate([curve.speed_ms for curve in result.plane]) / MS_PER_KMH
        worth = np.concatenate([curve.adjoint for curve in result.plane])
        self.run.data = xy(speed, np.clip(worth, WORTH_ENDS[0] - 1, WORTH_ENDS[1] + 1))
        self.driving.location, self.braking.location = steady.driving_adjoint, steady.braking_adjoint
        self._draw_regions(steady)
        self._mark(steady)

    def _draw_regions(self, steady: SteadySpeeds) -> None:
        tokens, (low, high) = self.palette.tokens, WORTH_ENDS
        ends = (low - 1, steady.braking_adjoint, steady.driving_adjoint, high + 1)
        self.bands.data = {
            **columns(bottom=np.array(ends[:-1]), top=np.array(ends[1:])),
            "fill": [tokens[name] for name in ("brake", "coast", "part_power")],
        }
        middles = (0.5 * (low + steady.braking_adjoint), 0.5 * sum(ends[1:3]), 0.5 * (high + steady.driving_adjoint))
        self.names.data = {
            "y": list(middles),
            "text": ["brake", "coast", "full power"],
            "ink": [tokens["ink2"]] * 3,
        }

    def _mark(self, steady: SteadySpeeds) -> None:
        reaches = steady.highest_ms >= 0.999 * steady.hold_ms
        word = "hold" if reaches else "motors off at"
        points = [
            (steady.highest_ms / MS_PER_KMH, steady.driving_adjoint),
            (steady.brake_ms / MS_PER_KMH, steady.braking_adjoint),
        ]
        texts = (
            f"{word} {words.speed(steady.highest_ms, 1)} km/h",
            f"brake from {words.speed(steady.brake_ms, 1)} km/h",
        )
        self.marks.data = {"x": [x for x, _ in points], "y": [y for _, y in points]}
        ink, ends = self.palette.tokens["ink"], np.array([0.0, float(self.x_range.end)])
        names = [Name(text, text, ink, point=point) for text, point in zip(texts, points, strict=True)]
        frame = self.frame_over((0.0, float(self.x_range.end)), WORTH_ENDS)
        lines = {
            "run": (np.asarray(self.run.data["x"]), np.asarray(self.run.data["y"])),
            "driving": (ends, np.full(2, steady.driving_adjoint)),
            "braking": (ends, np.full(2, steady.braking_adjoint)),
        }
        regions = [
            frame.box(ends[1] - 1, y, text, align="right", lift_px=-7)
            for y, text in zip(self.names.data["y"], self.names.data["text"], strict=True)
        ]
        self.signs.data = placed_names(frame, lines, names, [*regions, *(frame.dot(*point) for point in points)], 11)
