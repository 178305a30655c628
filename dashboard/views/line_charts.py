"""The charts of Line: speed, train path, and what each leg gets of time and needs of energy, all over the distance."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from bokeh.models import ColumnDataSource

from railjoule.core import Trajectory
from railjoule.core.arrays import FloatArray
from railjoule.core.motion.line_profile import limit_steps
from railjoule.core.studies.whole_line import Leg, Sharing, WholeLine
from railjoule.core.units import J_PER_KWH, MS_PER_KMH
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.store import LineRuns
from railjoule.dashboard.views.charts import Axis, add_zero, clear, columns, nice_range, text_style, xy
from railjoule.dashboard.views.run_lines import RunLinesChart

SHARING_WORDS: Mapping[Sharing, str] = {
    "optimum": "optimal reserve",
    "proportional": "proportional reserve",
    "equal": "equal reserve",
}
SHARING_TOKENS: Mapping[Sharing, str] = {"optimum": "optimal", "proportional": "phases", "equal": "enoc"}
LINES: Mapping[str, tuple[str, dict[str, Any]]] = {
    "equal": ("enoc", {"line_width": 1.8, "line_dash": [8, 3, 2, 3]}),
    "proportional": ("phases", {"line_width": 1.8, "line_dash": [4, 3]}),
    "optimum": ("optimal", {"line_width": 2.4}),
}
HEADROOM = 1.2
FAR_ABOVE = 9e3
WORD_PX = 6.8
S_PER_MIN = 60.0
BAR_SHARE, GROUP_SHARE = 0.25, 0.75
"""Widths of a bar and of a leg's three bars over the leg."""


class LineChart(RunLinesChart):
    """A quantity of the optimum and of the run that is compared with it, with the stations as hairlines."""

    strokes = LINES

    def add_stations(self) -> None:
        """Add the hairlines of the stations."""
        assert self.figure is not None
        self.sources["stations"] = ColumnDataSource({"x": []})
        line = self.figure.vspan("x", source=self.sources["stations"], line_width=1, level="underlay")
        self.palette.paint(line.glyph, line_color="line2")

    def fill_both(self, runs: LineRuns, other: Sharing) -> float:
        """Fill the lines of the optimum and of one other way of sharing; return the greatest value."""
        for sharing in LINES:
            if sharing not in ("optimum", other):
                clear(self.sources[sharing])
        return self.fill({other: runs.runs[other].run, "optimum": runs.best.run})[1]

    def draw_stations(self, legs: Sequence[Leg]) -> None:
        """Draw the hairlines of the stations between the ends."""
        self.sources["stations"].data = columns(x=np.array([leg.end_m for leg in legs[:-1]]))


class LineSpeedChart(LineChart):
    """Speed under the limits, with the names of the stations."""

    unit, digits = "km/h", 1

    def __init__(self, height: int, axis: Axis, palette: Palette) -> None:
        super().__init__("line_speed", "Speed, km/h", height, axis, palette)

    def build(self) -> None:
        """Make the figure."""
        f = self.frame(ticks=5)
        self.sources["forbidden"] = ColumnDataSource({"left": [], "right": [], "bottom": []})
        area = f.quad(
            "left", "right", "bottom", FAR_ABOVE, source=self.sources["forbidden"], fill_alpha=0.55, line_color=None
        )
        self.palette.paint(area.glyph, fill_color="ground")
        self.sources["limit"] = ColumnDataSource({"x": [], "y": []})
        limit = f.line("x", "y", source=self.sources["limit"], line_width=1.2)
        self.palette.paint(limit.glyph, line_color="limit")
        self.add_stations()
        self.add_lines()
        self.sources["names"] = ColumnDataSource({"x": [], "y": [], "text": [], "align": []})
        names = f.text(
            "x",
            "y",
            "text",
            text_align="align",
            source=self.sources["names"],
            text_baseline="top",
            y_offset=2,
            **text_style(11),
        )
        self.palette.paint(names.glyph, text_color="ink2")

    def values(self, run: Trajectory) -> FloatArray:
        """Speed [km/h]."""
        return run.speed_ms / MS_PER_KMH

    def draw(self, runs: LineRuns, other: Sharing, width_px: float) -> None:
        """Draw limits, runs and as many names of stations as fit."""
        best = runs.best
        scenario = best.run.scenario
        places, limits = limit_steps(scenario.line.in_running_order(), scenario.vehicle.traction.max_speed_kmh)
        self.fill_both(runs, other)
        top = HEADROOM * float(np.max(limits))
        self.set_range(0, top)
        self.sources["forbidden"].data = columns(left=places[:-1], right=places[1:], bottom=limits)
        self.sources["limit"].data = xy(np.repeat(places, 2)[1:-1], np.repeat(limits, 2))
        self.draw_stations(best.legs)
        stops = [(best.legs[0].start_m, best.legs[0].departs_from), *((leg.end_m, leg.arrives_at) for leg in best.legs)]
        chosen = fitting(stops, best.run.distance_m / width_px)
        self.sources["names"].data = {
            "x": [place for place, _, _ in chosen],
            "y": [top] * len(chosen),
            "text": [name for _, name, _ in chosen],
            "align": [align for _, _, align in chosen],
        }


class PathChart(LineChart):
    """When the train is where: the train paths of the timetable's graph."""

    unit, digits = "min", 2

    def __init__(self, height: int, axis: Axis, palette: Palette) -> None:
        super().__init__("line_path", "Train path: time, min", height, axis, palette)

    def build(self) -> None:
        """Make the figure."""
        self.frame(ticks=5)
        self.add_stations()
        self.add_lines()

    def values(self, run: Trajectory) -> FloatArray:
        """Time since the start [min]."""
        return run.time_s / S_PER_MIN

    def draw(self, runs: LineRuns, other: Sharing) -> None:
        """Draw both train paths."""
        latest = self.fill_both(runs, other)
        self.set_range(0, 1.04 * latest)
        self.draw_stations(runs.best.legs)


class LegBars(LineChart):
    """Three bars on each leg, one for each way of sharing the time.

    Parameters
    ----------
    name, words : str
        As in `Chart`.
    value : callable
        What is drawn of a leg.
    show : callable
        How the optimum's numbers above the bars read.
    """

    kind = "bars"

    def __init__(
        self,
        name: str,
        words: str,
        height: int,
        axis: Axis,
        palette: Palette,
        value: Callable[[Leg], float],
        show: Callable[[float], str],
        last: bool = False,
    ) -> None:
        super().__init__(name, words, height, axis, palette)
        self.value, self.show_value, self.last = value, show, last

    def build(self) -> None:
        """Make the figure."""
        f = self.frame(with_axis=self.last, ticks=3)
        self.add_stations()
        add_zero(f, self.palette)
        for sharing, token in SHARING_TOKENS.items():
            self.sources[sharing] = ColumnDataSource({"left": [], "right": [], "top": []})
            bars = f.quad("left", "right", bottom=0, top="top", source=self.sources[sharing], line_color=None)
            self.palette.paint(bars.glyph, fill_color=token)
        self.sources["signs"] = ColumnDataSource({"x": [], "y": [], "text": []})
        signs = f.text(
            "x", "y", "text", source=self.sources["signs"], text_align="center", y_offset=-2, **text_style(11)
        )
        self.palette.paint(signs.glyph, text_color=SHARING_TOKENS["optimum"])
        if self.last:
            f.xaxis.axis_label = "Distance, m"

    def draw(self, runs: LineRuns, width_px: float) -> None:
        """Draw the bars."""
        bars = [bar_columns(runs.runs[sharing], place, self.value) for place, sharing in enumerate(SHARING_TOKENS)]
        for sharing, (left, right, top) in zip(SHARING_TOKENS, bars, strict=True):
            self.sources[sharing].data = columns(left=left, right=right, top=top)
        tallest = np.max([top for *_, top in bars], axis=0)
        low, high = min(0.0, *(float(top.min()) for *_, top in bars)), max(0.0, float(tallest.max()))
        self.set_range(*nice_range(low, high, 0.16) if low < 0 else (0.0, 1.22 * max(high, 1e-9)))
        self.draw_stations(runs.best.legs)
        (left, _, top), *_, (_, right, _) = bars
        texts = [self.show_value(value) for value in top]
        needed = np.array([0.8 + 0.6 * len(text) for text in texts]) * WORD_PX
        fits = (right - left) / runs.best.run.distance_m * width_px > needed
        self.sources["signs"].data = {
            **xy((0.5 * (left + right))[fits], np.maximum(tallest, 0.0)[fits]),
            "text": [text for text, fit in zip(texts, fits, strict=True) if fit],
        }


def bar_columns(
    line: WholeLine, place: int, value: Callable[[Leg], float]
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return left and right ends [m] and heights of the bars of one way of sharing, the `place`-th of three."""
    start = np.array([leg.start_m for leg in line.legs])
    length = np.array([leg.end_m for leg in line.legs]) - start
    left = start + length * (0.5 * (1 - GROUP_SHARE) + BAR_SHARE * place)
    return left, left + 0.9 * BAR_SHARE * length, np.array([value(leg) for leg in line.legs])


def supplement_s(leg: Leg) -> float:
    """Time supplement of a leg [s]."""
    return leg.supplement_s


def energy_kwh(leg: Leg) -> float:
    """Energy of a leg [kWh]."""
    return leg.energy_j / J_PER_KWH


def fitting(stops: Sequence[tuple[float, str]], m_per_px: float) -> list[tuple[float, str, str]]:
    """Return places, names and alignment of the stations whose names have room, the ends first.

    Parameters
    ----------
    stops : sequence of (float, str)
        Place [m] and name of each station.
    m_per_px : float
        Scale of the chart.
    """
    taken: list[tuple[float, float]] = []
    chosen = []
    last = len(stops) - 1
    for k in [0, last, *range(1, last)]:
        place, name = stops[k]
        length = (len(name) * WORD_PX + 8) * m_per_px
        align = "left" if k == 0 else "right" if k == last else "center"
        left = place - {"left": 0.0, "center": 0.5, "right": 1.0}[align] * length
        if all(left + length <= start or left >= end for start, end in taken):
            taken.append((left, left + length))
            chosen.append((place, name, align))
    return chosen
