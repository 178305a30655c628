"""Layers beside the lines of runs: limits, stations, neutral sections, passing points, steps that can be dragged."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from bokeh.models import ColumnDataSource, CustomJS

from railjoule.core.arrays import FloatArray
from railjoule.core.motion.line_profile import limit_steps, neutral_stretches
from railjoule.core.scenario import Line as ScenarioLine
from railjoule.core.scenario import Scenario
from railjoule.dashboard.charts.axis import columns, xy
from railjoule.dashboard.charts.chart import Chart
from railjoule.dashboard.charts.dress import dragged
from railjoule.dashboard.charts.names import text_width_px
from railjoule.dashboard.charts.run_lines import Curve
from railjoule.dashboard.look import words

FAR_ABOVE = 9e3
"""The tint of what is forbidden ends there, beyond any speed [km/h] to which an axis reaches."""
SIGN_PX = 11
PASSES = "passes"
"""The source of the places that the train passes at a given speed."""
PASS_LIFT_PX = 4
NEUTRAL, NEUTRAL_SIGNS = "neutral", "neutral_signs"
"""The sources of the bands of neutral sections and of their words."""
STEPS, MOVED = "steps", "moved"
"""Sources of what is drawn, and of what the browser has moved."""
END_PX = 9
NEUTRAL_SHARE, NEUTRAL_LIFT_PX, NEUTRAL_WORD = 0.05, 2, "neutral"
"""Height of a band over that of the axis, its word, and how far above the band that stands."""


# under this name, as under "borders", charts/download.py leaves a source out of saved tables
def add_tint(chart: Chart, name: str = "forbidden") -> None:
    """Let a chart tint what lies above limits."""
    sides = ("left", "right", "bottom", FAR_ABOVE)
    chart.glyphs("quad", name, *sides, paint={"fill_color": "ground"}, fill_alpha=0.55, line_color=None)


def add_limits(chart: Chart) -> None:
    """Let a chart draw the speed limits, with the tint above them."""
    add_tint(chart)
    chart.line("limit", "limit", line_width=1.2)


def limits_of(scenario: Scenario) -> tuple[FloatArray, FloatArray]:
    """Return the borders [m] and limits [km/h] of a line in the order in which it is run."""
    places, limits = limit_steps(
        scenario.line.in_running_order(), scenario.vehicle.traction.max_speed_kmh, scenario.limits_last_m
    )
    return np.asarray(places), np.asarray(limits)


def as_steps(borders: FloatArray, levels: FloatArray) -> Curve:
    """Return the line along levels between borders."""
    return np.repeat(borders, 2)[1:-1], np.repeat(levels, 2)


def draw_limits(chart: Chart, borders: FloatArray, limits: FloatArray, tinted: bool = True) -> Curve:
    """Draw the limits between borders, in the units of the axes, and what lies above them; return their line."""
    steps = as_steps(borders, limits)
    # once: columns that change twice within a message reach the browser with unlike lengths between
    if tinted:
        chart.put("forbidden", **columns(left=borders[:-1], right=borders[1:], bottom=limits))
    else:
        chart.clear("forbidden")
    if "limit" in chart.sources:
        chart.put("limit", **xy(*steps))
    return steps


def add_stations(chart: Chart) -> None:
    """Add the hairlines of the stations."""
    chart.hairlines("stations", "line2", level="underlay")


def draw_stations(chart: Chart, places_m: Sequence[float]) -> None:
    """Draw the hairlines of the stations."""
    chart.put("stations", **columns(x=np.array(places_m)))


def add_neutral_sections(chart: Chart) -> None:
    """Add the bands of neutral sections, at the foot of the chart, and their words."""
    sides, hatched = ("left", "right", 0, "top"), {"line_color": "ink3", "hatch_color": "ink3"}
    chart.glyphs("quad", NEUTRAL, *sides, paint=hatched, fill_color=None, line_width=0.5, hatch_pattern="/")
    chart.source(NEUTRAL_SIGNS, "x", "y", "text")
    chart.signs(NEUTRAL_SIGNS, "ink2", x_offset=2, y_offset=-NEUTRAL_LIFT_PX)


def draw_neutral_sections(
    chart: Chart, line: ScenarioLine, x_of_place: Callable[[FloatArray], FloatArray], top: float
) -> None:
    """Draw the neutral sections of a line in running order, as `draw_passing_points`; the axis ends at `top`."""
    left, right = (x_of_place(places) for places in neutral_stretches(line).T)
    height = np.full(len(left), NEUTRAL_SHARE * top)
    chart.put(NEUTRAL, **columns(left=left, right=right, top=height))
    named, free_px = [], -np.inf
    for number, begin_px in enumerate(chart.frame_now.x_px(left).tolist()):
        # a word may reach beyond its band, but not into the next word
        if begin_px >= free_px:
            named.append(number)
            free_px = begin_px + text_width_px(f"{NEUTRAL_WORD} ", SIGN_PX)
    chart.put(NEUTRAL_SIGNS, **xy(left[named], height[named]), text=[NEUTRAL_WORD] * len(named))


def add_passing_points(chart: Chart) -> None:
    """Add the places that the train passes at a given speed: hairlines as of stations, and a mark at the speed."""
    chart.source(PASSES, "x", "y", "text")
    chart.hairlines(PASSES, "line2", level="underlay")
    chart.dots(PASSES, "surface", "ink2", size=9, marker="diamond", line_width=1.6)
    chart.signs(PASSES, "ink2", x_offset=7, y_offset=-PASS_LIFT_PX)


def draw_passing_points(chart: Chart, line: ScenarioLine, x_of_place: Callable[[FloatArray], FloatArray]) -> None:
    """Draw the passing points of a line in running order, at the axis positions that `x_of_place` returns."""
    points = line.passing_points
    x = x_of_place(np.array([point.position_m for point in points]))
    speeds = np.array([point.speed_kmh for point in points])
    texts = [f"{point.name or 'pass'} {words.tenths(point.speed_kmh)}" for point in points]
    chart.put(PASSES, **xy(x, speeds), text=texts)


# ---- steps whose levels and ends can be dragged: limits of the line, or set speeds of sections


def add_steps(chart: Chart, token: str, **bounds: Any) -> tuple[ColumnDataSource, CustomJS]:
    """Let a chart draw steps that can be dragged; return the source of what was moved, and the callback.

    Parameters
    ----------
    chart : Chart
    token : str
        Their colour.
    **bounds
        As `drag_steps` of assets/scripts/drag.js has them.
    """
    assert chart.figure is not None
    steps = chart.source(STEPS, "left", "right", "limit", "middle", "text", "movable")
    moved = chart.source(MOVED, "left", "right", "limit")
    edge, grip = {"line_color": token}, {"line_color": token, "fill_color": "surface"}
    if bounds["shared"]:
        chart.glyphs("step", STEPS, "left", "limit", paint=edge, line_width=2, mode="after")
    chart.glyphs("segment", STEPS, "left", "limit", "right", "limit", paint=edge, line_width=2)
    chart.glyphs("scatter", STEPS, "middle", "limit", paint=grip, size=10, line_width=2)
    for end in ("right",) if bounds["shared"] else ("left", "right"):
        chart.glyphs("scatter", STEPS, end, "limit", paint=grip, size="movable", line_width=2, marker="square")
    chart.grounded_signs(STEPS, token, at=("middle", "limit"), text_align="center", y_offset=-9)
    return moved, dragged(chart.figure, "drag", "drag_steps", steps=steps, moved=moved, **bounds)


def draw_steps(chart: Chart, steps: Sequence[tuple[float, float, float, bool]]) -> None:
    """Draw steps: beginning and end, level, and whether ends can be moved.

    They are sent whatever stands there: the browser moves them before the server does.
    """
    left, right, limit, movable = (list(column) for column in zip(*steps, strict=True)) if steps else ([], [], [], [])
    chart.sources[STEPS].data = {
        "left": left,
        "right": right,
        "limit": limit,
        "middle": [0.5 * (start + end) for start, end in zip(left, right, strict=True)],
        "text": [f"{round(level, 1):g}" for level in limit],
        "movable": [END_PX * moves for moves in movable],
    }
