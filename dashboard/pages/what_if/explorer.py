"""Explore the draws: any two of their quantities over each other, the others beside, to brush.

It is opened by hand: before that nothing of it is computed or on the page, and nothing once it is closed.
"""

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import panel_material_ui as pmui
from bokeh.models import BoxAnnotation, ColumnDataSource, CustomJS
from panel import Row

from railjoule.core.arrays import FloatArray
from railjoule.core.studies.table import StudyTable
from railjoule.dashboard.charts.chart import nice_range
from railjoule.dashboard.charts.figures import LoneChart
from railjoule.dashboard.look import words
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.scripts import function
from railjoule.dashboard.pages.what_if.chance_charts import SHOWN
from railjoule.dashboard.parts import html as parts

Bounds = dict[str, tuple[float, float]]
"""From where to where a brush reaches, by the names of columns."""


@dataclass(frozen=True)
class Column:
    """A quantity of each run.

    Parameters
    ----------
    words : str
        Quantity and unit, as on an axis.
    values : callable
        Takes a table, gives an array of shape (done,) in that unit.
    show : callable
        How a number of that array reads, without its unit.
    """

    words: str
    values: Callable[[StudyTable], FloatArray]
    show: Callable[[float], str]

    @property
    def name(self) -> str:
        """The quantity, as within a sentence."""
        name = self.words.rpartition(", ")[0]
        return name[0].lower() + name[1:]

    @property
    def unit(self) -> str:
        """The unit."""
        return self.words.rpartition(", ")[2]

    def with_unit(self, value: float) -> str:
        """Return a number with its unit."""
        return f"{self.show(value)} {self.unit}"


def _drawn(name: str, title: str, show: Callable[[float], str], scale: float = 1.0) -> Column:
    return Column(title, lambda table: scale * table[name], show)


def _percent(show: Callable[[float], str]) -> Callable[[float], str]:
    return lambda percent: show(percent / 100)


COLUMNS: Mapping[str, Column] = {
    "load": _drawn("load_factor", "Load, %", lambda value: words.number(value, 0), 100),
    "error": _drawn("coordinate_error_m", "Position error, m", words.signed),
    "resistance": _drawn("resistance_factor", "Running resistance, %", words.number, 100),
    "voltage": _drawn("line_voltage_factor", "Supply voltage, %", words.number, 100),
    "departure": _drawn("departure_delay_s", "Departure delay, s", words.time),
    "speed": _drawn("speed_error", "Speed error, %", lambda value: words.signed(value, 2), 100),
    **{name: _drawn(f"{name}_error_m", f"{name.upper()}'s place, m", words.stop_error) for name in ("d1", "d2", "d3")},
    "energy": Column("Energy, kWh", lambda table: table.energy_kwh, words.energy),
    "extra": Column("Extra energy, %", lambda table: 100 * table.over_replanned, _percent(words.share_difference)),
    "above_plan": Column(
        "Extra energy against the plan, %",
        lambda table: 100 * table.overconsumption,
        _percent(words.share_difference),
    ),
    "late": Column("Delay at the stop, s", lambda table: table.delay_s, words.delay),
    "overshoot": Column("Overshoot, m", lambda table: table.stop_error_m, words.stop_error),
}
POINTS = "draws"
"""The name of the figure of points; those of the histograms begin with it."""
FIRST = "load", "extra"
"""The quantities to the right and upwards at first."""
OUTCOMES = "extra", "late", "overshoot"
"""The results whose medians are written."""
HINT = "Drag over the points or along a histogram to brush; click in a figure to let go of its brush."


def histogram_name(column: str) -> str:
    """Return the name of the figure that shows how often a column's values came out."""
    return f"{POINTS}_{column}"


def varied(table: StudyTable) -> dict[str, FloatArray]:
    """Return the columns in which runs that reached the end differ, of these runs alone; shapes (reached,)."""
    reached = np.isfinite(table.energy_kwh)
    columns = {name: column.values(table)[reached] for name, column in COLUMNS.items()}
    return {
        name: values for name, values in columns.items() if np.all(np.isfinite(values)) and len(np.unique(values)) > 1
    }


def parse_brushes(text: str) -> dict[str, Bounds]:
    """Return the brushes in a browser's JSON, by figure; invalid ones, and those of unknown columns, are left out."""
    try:
        sent = json.loads(text)
    except (ValueError, RecursionError):
        return {}
    if not isinstance(sent, Mapping):
        return {}
    found = {str(figure): _parse_bounds(brush) for figure, brush in sent.items()}
    return {figure: brush for figure, brush in found.items() if brush}


def _parse_bounds(sent: Any) -> Bounds:
    if not isinstance(sent, Mapping):
        return {}
    return {name: (float(ends[0]), float(ends[1])) for name, ends in sent.items() if name in COLUMNS and _is_span(ends)}


def _is_span(ends: Any) -> bool:
    numbers = isinstance(ends, list | tuple) and len(ends) == 2 and all(type(end) in {int, float} for end in ends)
    return numbers and all(map(math.isfinite, ends)) and ends[0] <= ends[1]


def common(brushes: Mapping[str, Bounds]) -> Bounds:
    """Return the bounds common to all brushes; an end before its start holds no row."""
    bounds: Bounds = {}
    for brush in brushes.values():
        for name, (low, high) in brush.items():
            lowest, highest = bounds.get(name, (-math.inf, math.inf))
            bounds[name] = max(low, lowest), min(high, highest)
    return bounds


def held_rows(columns: Mapping[str, FloatArray], bounds: Bounds) -> Any:
    """Return for each row whether it lies within bounds: from the start, up to but not including the end."""
    count = len(next(iter(columns.values())))
    return np.logical_and.reduce(
        [
            np.ones(count, bool),
            *((columns[name] >= low) & (columns[name] < high) for name, (low, high) in bounds.items()),
        ]
    )


def brush_words(table: StudyTable, columns: Mapping[str, FloatArray], bounds: Bounds) -> list[str]:
    """Return in sentences the number of runs within bounds, and their medians beside those of all runs."""
    held = held_rows(columns, bounds)
    count, stuck = len(held), table.done - len(held)
    lost = f" In {words.number(stuck, 0)} more the train comes to a stand." if stuck else ""
    if not bounds:
        return [f"{words.number(count, 0)} draws that reached the end.{lost} {HINT}"]
    where = "; ".join(
        f"{COLUMNS[name].name} {COLUMNS[name].show(low)} to {COLUMNS[name].with_unit(high)}"
        for name, (low, high) in bounds.items()
    )
    within = f"{words.number(held.sum(), 0)} of {words.number(count, 0)} draws ({words.share(held.mean())} %)"
    counted = f"{within}: {where}.{lost}"
    if not held.any():
        return [counted]
    medians = ", ".join(
        f"{COLUMNS[name].name} {_median(name, columns[name][held])} (all: {_median(name, columns[name])})"
        for name in OUTCOMES
        if name in columns
    )
    return [counted, f"Medians of these: {medians}."]


def _median(name: str, values: FloatArray) -> str:
    return COLUMNS[name].with_unit(float(np.median(values)))


# ---- figures and brushes

EVENTS = "panstart", "pan", "panend", "tap"
OPEN, CLOSE = "Explore the draws", "Close the draws"
WAITS = "The draws can be explored once all of them are there."
BINS = 30
LAYERS = {"all": "line2", "brushed": "driven"}
"""All draws and, above them, those within the brushes, with their colours."""
GRID_CSS = """
:host { display: grid; grid-template-columns: repeat(3, minmax(0, 1fr)); gap: 4px 16px; align-items: start; }
@media (max-width: 1099px) { :host { grid-template-columns: repeat(2, minmax(0, 1fr)); } }
@media (max-width: 599px) { :host { grid-template-columns: minmax(0, 1fr); } }
"""
PLACE_CSS = ":host { padding: 0 20px 20px 14px; } @media (max-width: 899px) { :host { padding: 0 12px 16px; } }"
HEIGHTS = {POINTS: (320, 400, 280), **{histogram_name(name): (110, 130, 110) for name in COLUMNS}}
"""Of each chart [px], as on all pages."""
SELECT: dict[str, Any] = {"size": "small", "margin": (6, 12, 6, 0), "width": 270}


class BrushedChart(LoneChart):
    """A figure of the draws that can be brushed: points of two columns, or a histogram of one."""

    title = "Draws"

    def __init__(
        self, columns: tuple[str, ...], caption: str, dark: bool, join: Callable[["BrushedChart"], None]
    ) -> None:
        self.columns, self.kind = columns, "map" if len(columns) > 1 else "bars"
        name = POINTS if len(columns) > 1 else histogram_name(columns[0])
        # colours of its own, which go with it
        super().__init__(name, caption, HEIGHTS[name][0], Palette(dark))
        self.box = BoxAnnotation(visible=False, fill_alpha=0.12, line_alpha=0.8, line_width=1)
        self._join, self._is_joined = join, False

    def build(self) -> None:
        """Make the figure, with a box for its brush, which the browser shows."""
        points = len(self.columns) > 1
        f = self.frame(ticks=4, x_title=COLUMNS[self.columns[0]].words if points else "")
        for layer, token in LAYERS.items():
            if points:
                style: dict[str, Any] = {"size": 3.5, "fill_alpha": 0.6, "line_color": None}
                self.glyphs("scatter", layer, *self.columns, paint={"fill_color": token}, **style)
            else:
                bars = {"fill_color": token, "line_color": "surface"}
                self.glyphs("quad", layer, "left", "right", 0, "top", paint=bars, line_width=0.5)
        f.yaxis.visible = f.ygrid.visible = points
        self.palette.paint(self.box, fill_color="accent", line_color="accent")
        f.add_layout(self.box)

    def draw(self, *values: FloatArray) -> None:
        """Draw the values of its columns, all of them brushed."""
        ends = [nice_range(*map(float, np.quantile(one, SHOWN))) for one in values]
        drawn: dict[str, FloatArray] = dict(zip(self.columns, values, strict=True))
        if len(self.columns) == 1:
            counts, edges = np.histogram(values[0], BINS, ends[0])
            drawn = {"left": edges[:-1], "right": edges[1:], "top": counts}
            ends.append((0.0, 1.06 * max(float(counts.max()), 1.0)))
        for layer in LAYERS:
            self.put(layer, **{name: column.tolist() for name, column in drawn.items()})
        self.set_ranges(ends[0], ends[1])

    def settle(self) -> None:
        """Draw the figure; figures refer to each other only once they stand on the page, or they get another look."""
        super().settle()
        if self.is_drawn and not self._is_joined:
            self._is_joined = True
            self._join(self)


class Explorer:
    """The part of the page.

    Parameters
    ----------
    page : Page
        With the draws as `chance`, and whether they are still `drawing`.
    changed : callable
        Called when `charts` has become another list.
    """

    def __init__(self, page: Any, changed: Callable[[], None]) -> None:
        self.state, self.model, self._changed = page.desk, page, changed
        self.charts: tuple[BrushedChart, ...] = ()
        self.is_open = False
        self._table: StudyTable | None = None
        self._columns: Mapping[str, FloatArray] = {}
        self._axes = FIRST
        self._brushing: Brushing | None = None
        self.button = pmui.Button(
            label=OPEN, variant="outlined", size="small", margin=(8, 0, 4, 6), on_click=lambda _: self._turn()
        )
        self.waiting = parts.html_pane(parts.note_paragraphs([WAITS]))
        self.place = parts.stack()
        self.view = parts.stack(self.button, self.place, css=PLACE_CSS)

    def follow(self) -> None:
        """Follow the draws and the colours: other draws are other figures, and the former ones are removed."""
        if self.model.chance is not self._table:
            self._table = self.model.chance
            if self.charts:
                self._let_go()
        for chart in self.charts:
            chart.palette.switch(self.state.dark)
        if self.is_open and not self.charts:
            self._begin()

    def _turn(self) -> None:
        self.is_open = not self.is_open
        self.button.label = CLOSE if self.is_open else OPEN
        if self.is_open:
            self._begin()
        else:
            self._let_go()

    def _let_go(self) -> None:
        self._brushing, self.charts = None, ()
        self.place.clear()
        self._changed()

    def _begin(self) -> None:
        """Lay out the controls and the figures of the table, or a sentence that it is not complete yet."""
        self._columns = {} if self._table is None or self.model.drawing else varied(self._table)
        if len(self._columns) < 2:
            if list(self.place) != [self.waiting]:
                self.place[:] = [self.waiting]
            return
        names = list(self._columns)
        # the axes stay as they were chosen, where the table has such columns
        x, y = self._axes if set(self._axes) <= set(names) else names[:2]
        options = {COLUMNS[name].words: name for name in names}
        self.x, self.y = (
            pmui.Select(label=label, options=options, value=value, **SELECT)
            for label, value in (("To the right", x), ("Upwards", y))
        )
        for select in (self.x, self.y):
            select.param.watch(self._choose, "value")
        # the figures below must not move while one brushes
        self.words = parts.html_pane(styles={"min-height": "76px"})
        self.reset = pmui.Button(
            label="Let go of all brushes",
            variant="text",
            size="small",
            margin=(10, 0, 0, 0),
            disabled=True,
            on_click=lambda _: self._release(),
        )
        self.figures = parts.stack()
        row = Row(self.y, self.x, self.reset, margin=(0, 0, 0, 6), stylesheets=[parts.WRAP_CSS])
        self.place[:] = [row, self.words, self.figures]
        self._draw()

    def _choose(self, event: Any) -> None:
        """Draw the chosen quantities; where both would be one, they change places."""
        other = self.y if event.obj is self.x else self.x
        if other.value == event.new:
            # leads back here, with two that differ
            other.value = event.old
        else:
            self._draw()

    def _draw(self) -> None:
        """Draw the figures of the chosen axes; brushes in histograms stay."""
        self._axes = x, y = self.x.value, self.y.value
        others = [name for name in self._columns if name not in self._axes]
        names = {histogram_name(name) for name in others}
        before = {} if self._brushing is None else self._brushing.brushes
        brushes = {name: brush for name, brush in before.items() if name in names}
        self._brushing = Brushing(self._columns, brushes, self._show_words)
        dark, join = self.state.dark, self._brushing.add
        points = BrushedChart((x, y), f"{COLUMNS[y].words}, over {COLUMNS[x].name}", dark, join)
        histograms = [BrushedChart((name,), COLUMNS[name].words, dark, join) for name in others]
        self.charts = (points, *histograms)
        self._changed()
        self.figures[:] = [points.host, parts.stack(*(chart.host for chart in histograms), css=GRID_CSS)]
        self._show_words(common(brushes))
        for chart in self.charts:
            chart.show(partial(chart.draw, *(self._columns[name] for name in chart.columns)))

    def _release(self) -> None:
        if self._brushing is not None:
            self._brushing.set({})

    def _show_words(self, bounds: Bounds) -> None:
        if self._table is not None:
            self.reset.disabled = not bounds
            self.words.object = parts.note_paragraphs(brush_words(self._table, self._columns, bounds))


class Brushing:
    """Figures of the same rows, which the browser brushes; assets/scripts/brush.js has the other half.

    Parameters
    ----------
    columns : mapping
        The rows.
    brushes : dict
        The brushes at first, by figure.
    changed : callable
        Called with the bounds of all brushes together once one of them has changed.
    """

    def __init__(
        self, columns: Mapping[str, FloatArray], brushes: dict[str, Bounds], changed: Callable[[Bounds], None]
    ) -> None:
        self._brushed, self._count = changed, 0
        self.rows = ColumnDataSource(dict(columns))
        self.rows.tags = [json.dumps(brushes), 0]
        self.rows.on_change("tags", self._hear)
        self._callback = CustomJS(code=function("brush", "brush({rows, parts}, cb_obj)"))
        self.rows.js_on_change("tags", self._callback)
        self._charts: list[BrushedChart] = []

    @property
    def brushes(self) -> dict[str, Bounds]:
        """The brushes by figure."""
        return parse_brushes(str(self.rows.tags[0])) if self.rows.tags else {}

    def add(self, chart: BrushedChart) -> None:
        """Let a figure be brushed."""
        assert chart.figure is not None
        for event in EVENTS:
            chart.figure.js_on_event(event, self._callback)
        self._charts.append(chart)
        figures = [
            {
                "name": one.name,
                "figure": one.figure,
                "columns": list(one.columns),
                "box": one.box,
                "brushed": one.sources["brushed"],
            }
            for one in self._charts
        ]
        self._callback.args = {"rows": self.rows, "parts": figures}
        if self.brushes:
            # the new figure does not show them yet
            self.set(self.brushes)

    def set(self, brushes: dict[str, Bounds]) -> None:
        """Replace all brushes."""
        self._count += 1
        # as a text: a dict of Python would be a map there, and an object of the browser a dict here
        self.rows.tags = [json.dumps(brushes), -self._count]
        # within a message that is still to be sent, the library calls no listener for a change by Python
        self._brushed(common(brushes))

    def _hear(self, _attribute: str, _old: Any, _new: Any) -> None:
        self._brushed(common(self.brushes))
