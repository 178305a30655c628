"""Charts with a line for each of some runs, and what several of them draw beside the lines."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from bokeh.models import GlyphRenderer

from railjoule.core.arrays import FloatArray
from railjoule.core.motion.line_profile import limit_steps, neutral_stretches
from railjoule.core.scenario import Line as ScenarioLine
from railjoule.core.scenario import Scenario
from railjoule.dashboard.charts.chart import Axis, Chart, DistanceChart, add_zero, columns, nice_range, xy
from railjoule.dashboard.charts.label_places import text_width_px
from railjoule.dashboard.charts.quantities import Quantity, along
from railjoule.dashboard.look import words
from railjoule.dashboard.look.paint import Palette

DRIVEN_DASH = [6, 3]
FAR_ABOVE = 9e3
"""The tint of what is forbidden ends there, beyond any speed [km/h] to which an axis reaches."""

SIGN_PX = 11
PASSES = "passes"
"""The source of the places that the train passes at a given speed."""
PASS_LIFT_PX = 4
NEUTRAL, NEUTRAL_SIGNS = "neutral", "neutral_signs"
"""The sources of the bands of neutral sections and of their words."""
NEUTRAL_SHARE, NEUTRAL_LIFT_PX, NEUTRAL_WORD = 0.05, 2, "neutral"
"""Height of a band over that of the axis, its word, and how far above the band that stands."""

Curve = tuple[FloatArray, FloatArray]
"""Places and values of a line, in the units of the axes."""


@dataclass(frozen=True)
class Line:
    """How a run is drawn.

    Parameters
    ----------
    token : str
        The colour.
    stroke : mapping
        Width and dash.
    of : str
        Which run is drawn, where that is not the one of the line's own name.
    quantity : Quantity or None
        What of it, where that is not the chart's.
    """

    token: str
    stroke: Mapping[str, Any]
    of: str = ""
    quantity: Quantity | None = None


@dataclass(frozen=True)
class Form:
    """How the figure of a chart looks.

    Parameters
    ----------
    ticks, digits : int
        Requested on the y axis; decimals of their numbers.
    zero : bool
        Whether there is a line at zero.
    last : bool
        Whether it has the x axis, as the lowest of its page.
    room : float
        Share of the values' range that is left free above and below.
    over_time : bool
        Whether it lies over time when it is built.
    """

    ticks: int = 4
    digits: int = 0
    zero: bool = False
    last: bool = False
    room: float = 0.06
    over_time: bool = False


PLAIN = Form()


class RunLines(DistanceChart):
    """A quantity of several runs, a line for each of them.

    Parameters
    ----------
    name : str
        As in `Chart`.
    quantity : Quantity
    lines : mapping of str to Line
        By the name of each line, in the order of drawing.
    height, axis, palette
        As in `DistanceChart`.
    caption : str
        Where it is not that of the quantity.
    form : Form
    """

    def __init__(
        self,
        name: str,
        quantity: Quantity,
        lines: Mapping[str, Line],
        height: int,
        axis: Axis,
        palette: Palette,
        caption: str = "",
        form: Form = PLAIN,
    ) -> None:
        super().__init__(name, caption or quantity.words, height, axis, palette)
        self.quantity, self.lines, self.form = quantity, lines, form
        self.unit, self.digits, self.stepped = quantity.unit, quantity.digits, quantity.stepped
        self._over = along(form.over_time)
        self.renderers: dict[str, GlyphRenderer] = {}

    def build(self) -> None:
        """Make the figure."""
        f = self.frame(with_axis=self.form.last, ticks=self.form.ticks, digits=self.form.digits)
        self._over = along(self.form.over_time)
        self.beneath()
        if self.form.zero:
            add_zero(f, self.palette)
        if self.form.last:
            f.xaxis.axis_label = self._over.words
        self.add_lines()
        self.above()

    def beneath(self) -> None:
        """Draw what lies beneath the lines."""

    def above(self) -> None:
        """Draw what lies above the lines."""

    def add_lines(self) -> None:
        """Add the lines, which all draw columns of the axis' runs; each is hidden until there is a run for it."""
        assert self.figure is not None
        # "before", as `at_nodes` gives each node the value of the cell that ends there
        draw, mode = (self.figure.step, {"mode": "before"}) if self.stepped else (self.figure.line, {})
        for name, line in self.lines.items():
            column, source = self._column(line), self.axis.columns(line.of or name)
            source.declare(self._over.name, column)
            drawn = draw(self._over.name, column, source=source.source, **line.stroke, **mode)
            # hidden, as a line that came later would bring new models; saved tables call it by this name
            drawn.update(name=name, visible=False)
            self.palette.paint(drawn.glyph, line_color=line.token)
            self.renderers[name] = drawn

    def _column(self, line: Line) -> str:
        return (line.quantity or self.quantity).name

    def values(self, run: Any) -> FloatArray:
        """Return the quantity at the nodes of a run."""
        return self.quantity.values(run)

    def fill(self, runs: Mapping[str, Any], over_time: bool = False) -> dict[str, Curve]:
        """Draw these runs and no other; return what their lines are."""
        x = along(over_time)
        self._lie_over(x)
        drawn = {}
        for name, line in self.lines.items():
            key = line.of or name
            run, renderer = runs.get(key), self.renderers[name]
            if renderer.visible != (run is not None):
                renderer.visible = run is not None
            if run is not None:
                curve = x.values(run), line.quantity.values(run) if line.quantity else self.values(run)
                self.axis.columns(key).take(run, {x.name: curve[0], self._column(line): curve[1]})
                drawn[name] = curve
        order = list(runs)
        names = sorted(drawn, key=lambda name: order.index(self.lines[name].of or name))
        self.told["sources"] = [self.read(name, name) for name in names]
        return drawn

    def read(self, name: str, word: str, *unit: Any, y: str = "") -> list[Any]:
        """Return what the cursor needs of a line: its word, its source and columns, a unit and digits of its own."""
        line = self.lines[name]
        source = self.axis.columns(line.of or name).source
        return [word, source, self._over.name, y or self._column(line), *unit]

    def _lie_over(self, x: Quantity) -> None:
        """Draw the lines over time or distance; both are columns of the same sources."""
        if x is self._over:
            return
        self._over = x
        for name, line in self.lines.items():
            self.axis.columns(line.of or name).declare(x.name)
            self.renderers[name].glyph.x = x.name
        if self.form.last and self.figure is not None:
            self.figure.xaxis.axis_label = x.words


class FittedRunLines(RunLines):
    """Lines of runs, the axis fitted to them."""

    def draw(self, runs: Mapping[str, Any], over_time: bool = False) -> None:
        """Draw these runs."""
        self.set_range(*nice_range(*ends_of(self.fill(runs, over_time).values()), self.form.room))


def ends_of(curves: Collection[Curve]) -> tuple[float, float]:
    """Return the least and the greatest value of lines."""
    return min(float(y.min()) for _, y in curves), max(float(y.max()) for _, y in curves)


# ---- what else charts draw


# under this name, as under "borders", charts/numbers.py leaves a source out of saved tables
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


def draw_limits(chart: Chart, borders: FloatArray, limits: FloatArray) -> Curve:
    """Draw the limits between borders, in the units of the axes; return their line."""
    steps = as_steps(borders, limits)
    chart.put("forbidden", **columns(left=borders[:-1], right=borders[1:], bottom=limits))
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
    """Draw the passing points of a line in running order, which lie on the axis where `x_of_place` says."""
    points = line.passing_points
    x = x_of_place(np.array([point.position_m for point in points]))
    speeds = np.array([point.speed_kmh for point in points])
    texts = [f"{point.name or 'pass'} {words.tenths(point.speed_kmh)}" for point in points]
    chart.put(PASSES, **xy(x, speeds), text=texts)
