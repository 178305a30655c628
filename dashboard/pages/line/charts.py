"""The charts of Line over the distance: speed, train path, time supplement and energy of each leg."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from operator import methodcaller
from typing import Any

import numpy as np
from bokeh.events import PanEnd

from railjoule.core import Trajectory
from railjoule.core.arrays import FloatArray
from railjoule.core.studies.whole_line import Leg, Sharing, WholeLine
from railjoule.core.units import J_PER_KWH, J_PER_WH
from railjoule.dashboard.charts import quantities
from railjoule.dashboard.charts.axis import Axis, columns, nice_range, xy
from railjoule.dashboard.charts.chart import zero_line
from railjoule.dashboard.charts.dress import dragged, text_style
from railjoule.dashboard.charts.figures import DistanceChart
from railjoule.dashboard.charts.names import text_width_px
from railjoule.dashboard.charts.plot import AxisPlot
from railjoule.dashboard.charts.quantities import POSITION
from railjoule.dashboard.charts.run_charts import LineStrip
from railjoule.dashboard.charts.run_lines import Line, RunLines, RunPlot, data_range
from railjoule.dashboard.charts.track import (
    add_limits,
    add_neutral_sections,
    add_passing_points,
    add_stations,
    draw_limits,
    draw_neutral_sections,
    draw_passing_points,
    draw_stations,
    limits_of,
)
from railjoule.dashboard.look import words
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.pages.line.compute import LineRuns

SHARING_WORDS: Mapping[Sharing, str] = {
    "optimum": "optimal supplement",
    "proportional": "proportional supplement",
    "equal": "equal supplement",
    "given": "present timetable",
}
SHARING_TOKENS: Mapping[Sharing, str] = {
    "optimum": "optimal",
    "proportional": "phases",
    "equal": "enoc",
    "given": "speed_limits",
}
LINES: Mapping[str, Line] = {
    "given": Line("speed_limits", {"line_width": 1.8, "line_dash": [2, 3]}),
    "equal": Line("enoc", {"line_width": 1.8, "line_dash": [8, 3, 2, 3]}),
    "proportional": Line("phases", {"line_width": 1.8, "line_dash": [4, 3]}),
    "optimum": Line("optimal", {"line_width": 2.4}),
}
# over the highest limit: the names of the stations hang down from the upper edge
HEADROOM = 1.2
WORD_PX = 6.8
SIGN_PX = 11
GROUP_SHARE, GAP_SHARE = 0.75, 0.1
"""Width of a leg's bars over the leg, and of the gap behind a bar over what it has."""
LEAST_SLACK_S = 0.1
"""No station can be dragged so far that a leg next to it keeps less."""


def compared(runs: LineRuns, other: Sharing) -> dict[str, Trajectory]:
    """Return the runs to draw by the names of their lines: the optimum and one other way of sharing."""
    return {other: runs.runs[other].run, "optimum": runs.best.run}


def stations(legs: Sequence[Leg]) -> list[float]:
    """Return the positions of the stations between the ends [m]."""
    return [leg.end_m for leg in legs[:-1]]


def draw_speeds(chart: RunLines, runs: LineRuns, other: Sharing, width_px: float) -> None:
    """Draw limits, runs and as many names of stations as fit."""
    best = runs.best
    chart.fill(compared(runs, other))
    _, limits = draw_limits(chart, *limits_of(best.run.scenario))
    top = HEADROOM * float(np.max(limits))
    chart.set_range(0, top)
    draw_stations(chart, stations(best.legs))
    line = best.run.scenario.line.in_running_order()
    draw_neutral_sections(chart, line, np.asarray, top)
    draw_passing_points(chart, line, np.asarray)
    stops = [(best.legs[0].start_m, best.legs[0].departs_from), *((leg.end_m, leg.arrives_at) for leg in best.legs)]
    chosen = fitting(stops, best.run.distance_m / width_px)
    chart.put(
        "names",
        x=[place for place, _, _ in chosen],
        y=[top] * len(chosen),
        text=[name for _, name, _ in chosen],
        align=[align for _, _, align in chosen],
    )


def draw_paths(chart: RunLines, runs: LineRuns, other: Sharing) -> None:
    """Draw time over position, as a train graph does."""
    _, latest = data_range(chart.fill(compared(runs, other)).values())
    chart.set_range(0, 1.04 * latest)
    draw_stations(chart, stations(runs.best.legs))


class LegBars(DistanceChart):
    """Bars on each leg, one for each way of sharing the time.

    Parameters
    ----------
    name, caption : str
        As in `Chart`.
    value : callable
        Value of a leg.
    show : callable
        How the optimum's numbers above the bars read.
    """

    kind = "bars"
    zoom = True

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
        self.value, self.show_value = value, show
        self.look = {"zoom": self.zoom, "ticks": 3, "x_title": POSITION.words if last else ""}

    layers = (
        add_stations,
        zero_line,
        *(
            methodcaller(
                *("glyphs", "quad", sharing, "left", "right", 0, "top"), paint={"fill_color": token}, line_color=None
            )
            for sharing, token in SHARING_TOKENS.items()
        ),
        # to the left of the bar's right end: to the right the next bar of the leg may be taller
        methodcaller(*("grounded_signs", "signs", SHARING_TOKENS["optimum"], SIGN_PX), text_align="right", y_offset=-2),
    )

    def draw(self, runs: LineRuns, other: Sharing, width_px: float) -> None:
        """Draw the bars of the optimum and of another way of sharing."""
        there = self.drawn(runs, other)
        bars = [bar_columns(runs.runs[name], place, len(there), self.value) for place, name in enumerate(there)]
        for sharing in SHARING_TOKENS:
            if sharing not in there:
                self.clear(sharing)
        for sharing, (left, right, top) in zip(there, bars, strict=True):
            self.put(sharing, **columns(left=left, right=right, top=top))
        tallest = np.max([top for *_, top in bars], axis=0)
        low, high = min(0.0, *(float(top.min()) for *_, top in bars)), max(0.0, float(tallest.max()))
        self.fit(low, high)
        draw_stations(self, stations(runs.best.legs))
        (_, right, top), *_, (_, group_end, _) = bars
        texts = [self.show_value(value) for value in top]
        # from the last bar of the leg before
        room_m = right - np.append(0.0, group_end[:-1])
        fits = room_m / runs.best.run.distance_m * width_px > [text_width_px(text, SIGN_PX) for text in texts]
        self.put(
            "signs",
            **xy(right[fits], np.maximum(top, 0.0)[fits]),
            text=[text for text, fit in zip(texts, fits, strict=True) if fit],
        )

    def drawn(self, runs: LineRuns, other: Sharing) -> list[Sharing]:
        """Return the ways of sharing that are drawn, from left to right."""
        return ["optimum", other]

    def fit(self, low: float, high: float) -> None:
        """Set the ends of the y axis, with room for the numbers above the bars."""
        self.set_range(*nice_range(low, high, 0.16) if low < 0 else (0.0, 1.22 * max(high, 1e-9)))


class SlackChart(LegBars):
    """Time supplements, with stations that can be dragged: up, the train arrives there later."""

    zoom = False  # a drag moves a station
    moving = False
    """Whether a station is being dragged."""
    move: Callable[[int, float], None]
    """Receives the number of a station and its present arrival [s] while it is dragged."""
    release: Callable[[], None]
    """Called when the station is released."""

    def __init__(self, height: int, axis: Axis, palette: Palette) -> None:
        caption = "Supplement of each leg, s; drag a station"
        super().__init__("supplements", caption, height, axis, palette, lambda leg: leg.supplement_s, words.time)

    def build(self) -> None:
        """Make the figure, and let the browser drag its stations."""
        super().build()
        f = self.figure
        assert f is not None
        grips = self.source("grips", *GRIP_COLUMNS)
        moved, sign = self.source("moved", "number", "time"), self.source("sign", "x", "y", "text")
        self.dots("grips", "surface", "accent", size=10, line_width=2)
        self.glyphs(
            "text",
            "sign",
            "x",
            "y",
            "text",
            paint={"text_color": "ink", "background_fill_color": "surface"},
            text_align="center",
            y_offset=-12,
            background_fill_alpha=0.85,
            padding=2,
            **text_style(),
        )
        dragged(f, "drag", "drag_points", points=grips, sign=sign, moved=moved)
        moved.on_change("data", self._take)
        f.on_event(PanEnd, lambda _: self.release())

    def _take(self, _attribute: str, _old: Any, new: Mapping[str, Any]) -> None:
        """Take what the browser has moved; what is emptied here calls, too."""
        if len(new["number"]):
            self.move(int(new["number"][0]), float(new["time"][0]))

    def drawn(self, runs: LineRuns, other: Sharing) -> list[Sharing]:
        """Return the ways of sharing that are drawn; a given timetable always, as its bars are dragged."""
        return list(dict.fromkeys((*super().drawn(runs, other), *(name for name in runs.runs if name == "given"))))

    def draw(self, runs: LineRuns, other: Sharing, width_px: float) -> None:
        """Draw bars and stations; a station that is being dragged stays where the browser has it."""
        super().draw(runs, other, width_px)
        if not self.moving:
            # sent whatever stands here: the browser has moved them without a word
            self.sources["grips"].data = grip_columns(runs)
            self.clear("moved", "sign")

    def fit(self, low: float, high: float) -> None:
        """Set the ends of the y axis, but not under a hand that drags."""
        if not self.moving:
            super().fit(low, high)


GRIP_COLUMNS = ("x", "y", "rest", "time", "low", "high", "name")


def grip_columns(runs: LineRuns) -> dict[str, list[Any]]:
    """Return handles of the stations with their ranges: on the bars of the given timetable, else of the optimum.

    Between two arrivals that a timetable gives the optimum shares the time, so that all of it there can be moved.
    """
    grips: dict[str, list[Any]] = {name: [] for name in GRIP_COLUMNS}
    if runs.is_example:
        return grips
    line = runs.runs.get("given", runs.best)
    inner = runs.scenario.line.in_running_order().inner_stations
    # the legs that share their time: those without a given arrival between them
    group = np.cumsum([0, *(station.arrival_s is not None for station in inner)])
    spare = np.array([max(leg.supplement_s - LEAST_SLACK_S, 0.0) for leg in line.legs])
    for k, leg in enumerate(line.legs[:-1]):
        number = np.arange(len(line.legs))
        before = float(spare[(number <= k) & (group == group[k])].sum())
        after = float(spare[(number > k) & (group == group[k + 1])].sum())
        height = leg.supplement_s
        # below the axis nothing can be seen or held
        ends = max(height - before, 0.0), height + after
        values = (leg.end_m, height, height, leg.arrival_s, *ends, leg.arrives_at)
        for name, value in zip(GRIP_COLUMNS, values, strict=True):
            grips[name].append(value)
    return grips


def bar_columns(
    line: WholeLine, place: int, count: int, value: Callable[[Leg], float]
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return left and right ends [m] and heights of the bars of one way of sharing, the `place`-th of `count`."""
    start = np.array([leg.start_m for leg in line.legs])
    length = np.array([leg.end_m for leg in line.legs]) - start
    share = GROUP_SHARE / count
    left = start + length * (0.5 * (1 - GROUP_SHARE) + share * place)
    # a price that is not known has no bar
    height = np.nan_to_num([value(leg) for leg in line.legs])
    return left, left + (1 - GAP_SHARE) * share * length, height


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


# ---- all figures of the page

SPEED = RunPlot(
    *("line_speed", quantities.SPEED, LINES, (230, 290, 210)),
    ticks=5,
    below=(add_limits, add_neutral_sections, add_stations),
    above=(
        methodcaller("source", "names", "x", "y", "text", "align"),
        methodcaller("signs", "names", "ink2", text_align="align", text_baseline="top", y_offset=2),
        add_passing_points,
    ),
    draws=draw_speeds,
)
TRACK = AxisPlot("line", LineStrip, (98, 106, 94))
PATH = RunPlot("line_path", quantities.PATH, LINES, (180, 230, 170), ticks=5, below=(add_stations,), draws=draw_paths)
SUPPLEMENTS = AxisPlot("supplements", SlackChart, (140, 170, 140))
PRICE = AxisPlot(
    "leg_price",
    partial(
        LegBars,
        *("leg_price", "An extra second on each leg saves, Wh/s"),
        value=lambda leg: leg.price_of_time_w / J_PER_WH,
        show=lambda wh_per_s: words.price(wh_per_s * J_PER_WH),
    ),
    (110, 130, 100),
)
ENERGY = AxisPlot(
    "leg_energy",
    partial(
        LegBars,
        *("leg_energy", "Energy of each leg, kWh"),
        value=lambda leg: leg.energy_j / J_PER_KWH,
        show=words.energy,
        last=True,
    ),
    (140, 160, 130),
)
