"""The charts of Learn: speeds of two runs, energy over time with the price of a second, the phase plane."""

from collections.abc import Mapping
from operator import methodcaller
from typing import Any

import numpy as np

from railjoule.core import Scenario
from railjoule.core.studies.steady import SteadySpeeds
from railjoule.core.studies.tradeoff import Frontier
from railjoule.core.units import J_PER_KWH, MS_PER_KMH
from railjoule.dashboard.charts.axis import columns, nice_range, points, xy
from railjoule.dashboard.charts.chart import axis_line
from railjoule.dashboard.charts.dress import text_style
from railjoule.dashboard.charts.figures import LoneChart
from railjoule.dashboard.charts.names import Name
from railjoule.dashboard.charts.plot import AnyPlot, CurveChart, Plot, Stroke
from railjoule.dashboard.charts.quantities import SPEED
from railjoule.dashboard.charts.run_lines import DRIVEN_DASH, Curve, Ends, Line, RunLines, RunPlot, data_range
from railjoule.dashboard.charts.track import add_limits, draw_limits, limits_of
from railjoule.dashboard.look import words
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.pages.learn.compute import LessonResult
from railjoule.dashboard.pages.learn.lessons import LESSONS, Lesson

LINES: Mapping[str, Line] = {
    "second": Line("driven", {"line_width": 1.8, "line_dash": DRIVEN_DASH}),
    "first": Line("optimal", {"line_width": 2.6}),
}
WORTH_ENDS = (-0.7, 2.3)
"""Ends of the axis of the phase plane: near rest the value of kinetic energy grows beyond all bounds."""
STEEPEST_SHARE = 0.03
# the largest speed of metro-81-7036, the vehicle of the lessons
MOST_KMH = 80.0
TIME_TITLE = "Travel time, s"
HEADROOM = 1.12
TOP_SHARE, STRIP_KMH = 1.15, 3.0
"""The upper end of the speeds over the highest limit, and the height of a strip of phases or commands."""
DISTANCE = "Distance, m"


def draw_speeds(chart: RunLines, result: LessonResult, revealed: bool = True) -> None:
    """Draw both runs, or only the second one as long as the first is to be guessed."""
    names = dict(zip(("first", "second"), result.runs, strict=False))
    if not revealed:
        del names["first"]
    runs = {line: result.runs[name] for line, name in names.items()}
    chart.axis.fit(max(run.position_m[-1] for run in runs.values()), roomy=False)
    _, high = data_range(chart.fill(runs).values())
    chart.set_range(0, HEADROOM * high)
    chart.cursor_data["sources"] = [chart.read(line, name) for line, name in names.items()]


def make_speed_plot(lesson: Lesson) -> RunPlot:
    """Return the figure of the speeds of two runs, over an axis of its own."""
    look: dict[str, Any] = {"last": True, "zoom": False, "below": (axis_line,), "draws": draw_speeds}
    return RunPlot(f"lesson_{lesson.name}", SPEED, LINES, (200, 250, 190), lesson.lines, axis=lesson.name, **look)


PRICE = Plot(
    "lesson_price",
    "Least energy, kWh; its slope: energy saved per extra second",
    {
        "curve": Stroke("optimal", {"line_width": 2.6}),
        "tangent": Stroke("ink", {"line_width": 1.2}),
        "point": Stroke("accent", marks=True, line=False),
    },
    (200, 240, 190),
    x_title=TIME_TITLE,
)


def price_curves(result: LessonResult, frontier: Frontier) -> tuple[dict[str, Curve], Ends, Ends]:
    """Return curve, point and tangent of a price chart, and the ends of its axes."""
    run = result.runs["optimum"]
    time, energy = frontier.travel_time_s, frontier.energy_kwh
    steepest = float(np.interp(frontier.shortest_travel_time_s * (1 + STEEPEST_SHARE), time, energy))
    slope = (run.price_of_time_w or 0.0) / J_PER_KWH
    sides = 0.12 * float(time[-1] - time[0]) * np.array([-1.0, 1.0])
    curves = {
        "curve": (time, energy),
        "tangent": (run.travel_time_s + sides, run.energy_kwh - slope * sides),
        "point": (np.array([run.travel_time_s]), np.array([run.energy_kwh])),
    }
    ends = nice_range(float(np.nanmin(energy)), max(steepest, run.energy_kwh))
    return curves, (float(time[0]), float(time[-1])), ends


def draw_plane(chart: CurveChart, result: LessonResult) -> None:
    """Draw the three driving regimes, which two values of kinetic energy separate, and the run through them."""
    steady = result.steady
    if steady is None:
        return
    chart.set_ranges((0, MOST_KMH), WORTH_ENDS)
    speed = np.concatenate([curve.speed_ms for curve in result.plane]) / MS_PER_KMH
    worth = np.concatenate([curve.adjoint for curve in result.plane])
    # a little beyond the frame, as near rest the worth has no end
    chart.put("run", **xy(speed, np.clip(worth, WORTH_ENDS[0] - 1, WORTH_ENDS[1] + 1)))
    chart.put("levels", y=[steady.driving_adjoint, steady.braking_adjoint])
    tokens, (low, high) = chart.palette.tokens, WORTH_ENDS
    ends = np.array([low - 1, steady.braking_adjoint, steady.driving_adjoint, high + 1])
    fill = [tokens[name] for name in ("brake", "coast", "part_power")]
    chart.put("bands", **columns(bottom=ends[:-1], top=ends[1:]), fill=fill)
    middles = (0.5 * (low + steady.braking_adjoint), 0.5 * sum(ends[1:3]), 0.5 * (high + steady.driving_adjoint))
    chart.put("regions", y=list(middles), text=["brake", "coast", "full power"], ink=[tokens["ink2"]] * 3)
    _mark(chart, steady)


def _mark(chart: CurveChart, steady: SteadySpeeds) -> None:
    """Mark where the run changes its regime."""
    switches = [
        (steady.highest_ms / MS_PER_KMH, steady.driving_adjoint),
        (steady.brake_ms / MS_PER_KMH, steady.braking_adjoint),
    ]
    word = "hold" if steady.highest_ms >= 0.999 * steady.hold_ms else "motors off at"
    texts = f"{word} {words.speed(steady.highest_ms, 1)} km/h", f"brake from {words.speed(steady.brake_ms, 1)} km/h"
    chart.put("marks", **points(switches))
    ink, ends = chart.palette.tokens["ink"], np.array([0.0, MOST_KMH])
    names = [Name(text, text, ink, point=point) for text, point in zip(texts, switches, strict=True)]
    frame, regions = chart.frame_now, chart.sources["regions"].data
    lines = {
        "run": (np.asarray(chart.sources["run"].data["x"]), np.asarray(chart.sources["run"].data["y"])),
        "driving": (ends, np.full(2, steady.driving_adjoint)),
        "braking": (ends, np.full(2, steady.braking_adjoint)),
    }
    taken = [
        frame.box(MOST_KMH - 1, y, text, align="right", lift_px=-7)
        for y, text in zip(regions["y"], regions["text"], strict=True)
    ]
    chart.place_names(lines, names, [*taken, *(frame.dot(*point) for point in switches)], size=11)


def make_plane_plot(lesson: Lesson) -> Plot:
    """Return the figure of the value of a joule of kinetic energy over speed."""
    return Plot(
        f"plane_{lesson.name}",
        "Phase plane: value of a joule of kinetic energy, J from the supply, over speed, km/h",
        heights=(250, 300, 240),
        x_title=SPEED.words,
        y_title="Worth, J",
        digits=1,
        sketch="map",
        layers=PLANE_LAYERS,
        draws=draw_plane,
    )


PLANE_LAYERS = (
    methodcaller("source", "bands", "bottom", "top", "fill"),
    methodcaller(
        # wider than any zoom: the regions have no ends along the speed
        *("glyphs", "quad", "bands", -10, 1e3, "top", "bottom"),
        paint={},
        fill_color="fill",
        fill_alpha=0.35,
        line_color=None,
    ),
    methodcaller("source", "regions", "y", "text", "ink"),
    methodcaller(
        *("glyphs", "text", "regions", MOST_KMH - 1, "y", "text"),
        paint={},
        text_color="ink",
        text_align="right",
        text_baseline="middle",
        **text_style(11),
    ),
    methodcaller("glyphs", "hspan", "levels", "y", paint={"line_color": "ink3"}, line_width=1),
    methodcaller("line", "run", "optimal", line_width=2.6),
    methodcaller("dots", "marks", size=8, line_width=2),
    methodcaller("add_names", size=11),
)


FIGURES: Mapping[str, tuple[AnyPlot, ...]] = {
    lesson.name: (
        make_speed_plot(lesson),
        *([PRICE] if lesson.name == "multiplier" else ()),
        *([make_plane_plot(lesson)] if lesson.name in {"multiplier", "recuperation"} else ()),
    )
    for lesson in LESSONS
}
"""The figures of each lesson; that of the speeds is the first."""


class LessonSpeedChart(LoneChart):
    """Speeds over the distance of the line of a lesson, below its limits.

    Parameters
    ----------
    name, caption, height, palette
        As in `LoneChart`.
    scenario : Scenario
        The lesson's.
    """

    x_title = DISTANCE

    def __init__(self, name: str, caption: str, scenario: Scenario, height: int, palette: Palette) -> None:
        super().__init__(name, caption, height, palette)
        self.limits = limits_of(scenario)
        self.set_ranges((0, float(self.limits[0][-1])), (0, TOP_SHARE * float(np.max(self.limits[1]))))

    def build(self) -> None:
        """Make the figure, with the limits."""
        self.frame(x_title=self.x_title)
        add_limits(self)
        self.signs("signs", "limit", x_offset=4, y_offset=-2)

    def add_strip(self, name: str, token: str = "", **style: Any) -> None:
        """Add a strip of stretches along the way, in one colour or in those of the column `fill`."""
        sides, paint = ("left", "right", 0, STRIP_KMH), {"fill_color": token} if token else {}
        self.glyphs("quad", name, *sides, paint=paint, line_color=None, **style)

    def draw_limits(self) -> None:
        """Draw the limits, and their numbers."""
        borders, limits = self.limits
        draw_limits(self, borders, limits)
        self.put("signs", **xy(borders[:-1], limits), text=[f"limit {words.number(limit, 0)}" for limit in limits])
