"""The charts of Line: speed, train path, and what each leg gets of time and needs of energy, all over the distance."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from railjoule.core import Trajectory
from railjoule.core.arrays import FloatArray
from railjoule.core.studies.whole_line import Leg, Sharing, WholeLine
from railjoule.core.units import J_PER_KWH
from railjoule.dashboard.charts.chart import Axis, DistanceChart, add_zero, columns, nice_range, xy
from railjoule.dashboard.charts.quantities import PATH, POSITION, SPEED
from railjoule.dashboard.charts.run_lines import (
    Form,
    Line,
    RunLines,
    add_limits,
    add_stations,
    draw_limits,
    draw_stations,
    ends_of,
    limits_of,
)
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.pages.line.compute import LineRuns

SHARING_WORDS: Mapping[Sharing, str] = {
    "optimum": "optimal reserve",
    "proportional": "proportional reserve",
    "equal": "equal reserve",
}
SHARING_TOKENS: Mapping[Sharing, str] = {"optimum": "optimal", "proportional": "phases", "equal": "enoc"}
LINES: Mapping[str, Line] = {
    "equal": Line("enoc", {"line_width": 1.8, "line_dash": [8, 3, 2, 3]}),
    "proportional": Line("phases", {"line_width": 1.8, "line_dash": [4, 3]}),
    "optimum": Line("optimal", {"line_width": 2.4}),
}
# over the highest limit: the names of the stations hang down from the upper edge
HEADROOM = 1.2
WORD_PX = 6.8
BAR_SHARE, GROUP_SHARE = 0.25, 0.75
"""Widths of a bar and of a leg's three bars over the leg."""


def compared(runs: LineRuns, other: Sharing) -> dict[str, Trajectory]:
    """Return the runs to draw by the names of their lines: the optimum and one other way of sharing."""
    return {other: runs.runs[other].run, "optimum": runs.best.run}


def stations(legs: Sequence[Leg]) -> list[float]:
    """Return where the stations between the ends lie [m]."""
    return [leg.end_m for leg in legs[:-1]]


class LineSpeedChart(RunLines):
    """Speed under the limits, with the names of the stations."""

    def __init__(self, height: int, axis: Axis, palette: Palette) -> None:
        super().__init__("line_speed", SPEED, LINES, height, axis, palette, form=Form(ticks=5))

    def beneath(self) -> None:
        """Draw limits and stations beneath the lines."""
        add_limits(self)
        add_stations(self)

    def above(self) -> None:
        """Write the names of the stations."""
        self.source("names", "x", "y", "text", "align")
        self.signs("names", "ink2", text_align="align", text_baseline="top", y_offset=2)

    def draw(self, runs: LineRuns, other: Sharing, width_px: float) -> None:
        """Draw limits, runs and as many names of stations as fit."""
        best = runs.best
        self.fill(compared(runs, other))
        _, limits = draw_limits(self, *limits_of(best.run.scenario))
        top = HEADROOM * float(np.max(limits))
        self.set_range(0, top)
        draw_stations(self, stations(best.legs))
        stops = [(best.legs[0].start_m, best.legs[0].departs_from), *((leg.end_m, leg.arrives_at) for leg in best.legs)]
        chosen = fitting(stops, best.run.distance_m / width_px)
        self.put(
            "names",
            x=[place for place, _, _ in chosen],
            y=[top] * len(chosen),
            text=[name for _, name, _ in chosen],
            align=[align for _, _, align in chosen],
        )


class PathChart(RunLines):
    """When the train is where: the train paths of the timetable's graph."""

    def __init__(self, height: int, axis: Axis, palette: Palette) -> None:
        super().__init__("line_path", PATH, LINES, height, axis, palette, form=Form(ticks=5))

    def beneath(self) -> None:
        """Draw the stations beneath the lines."""
        add_stations(self)

    def draw(self, runs: LineRuns, other: Sharing) -> None:
        """Draw both train paths."""
        _, latest = ends_of(self.fill(compared(runs, other)).values())
        self.set_range(0, 1.04 * latest)
        draw_stations(self, stations(runs.best.legs))


class LegBars(DistanceChart):
    """Three bars on each leg, one for each way of sharing the time.

    Parameters
    ----------
    name, caption : str
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
        caption: str,
        height: int,
        axis: Axis,
        palette: Palette,
        value: Callable[[Leg], float],
        show: Callable[[float], str],
        last: bool = False,
    ) -> None:
        super().__init__(name, caption, height, axis, palette)
        self.value, self.show_value, self.last = value, show, last

    def build(self) -> None:
        """Make the figure."""
        f = self.frame(with_axis=self.last, ticks=3)
        add_stations(self)
        add_zero(f, self.palette)
        for sharing, token in SHARING_TOKENS.items():
            sides = ("left", "right", 0, "top")
            self.glyphs("quad", sharing, *sides, paint={"fill_color": token}, line_color=None)
        self.signs("signs", SHARING_TOKENS["optimum"], text_align="center", y_offset=-2)
        if self.last:
            f.xaxis.axis_label = POSITION.words

    def draw(self, runs: LineRuns, width_px: float) -> None:
        """Draw the bars."""
        bars = [bar_columns(runs.runs[sharing], place, self.value) for place, sharing in enumerate(SHARING_TOKENS)]
        for sharing, (left, right, top) in zip(SHARING_TOKENS, bars, strict=True):
            self.put(sharing, **columns(left=left, right=right, top=top))
        tallest = np.max([top for *_, top in bars], axis=0)
        low, high = min(0.0, *(float(top.min()) for *_, top in bars)), max(0.0, float(tallest.max()))
        self.set_range(*nice_range(low, high, 0.16) if low < 0 else (0.0, 1.22 * max(high, 1e-9)))
        draw_stations(self, stations(runs.best.legs))
        (left, _, top), *_, (_, right, _) = bars
        texts = [self.show_value(value) for value in top]
        needed = np.array([0.8 + 0.6 * len(text) for text in texts]) * WORD_PX
        fits = (right - left) / runs.best.run.distance_m * width_px > needed
        self.put(
            "signs",
            **xy((0.5 * (left + right))[fits], np.maximum(tallest, 0.0)[fits]),
            text=[text for text, fit in zip(texts, fits, strict=True) if fit],
        )


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
