"""The shared bones of all charts: frame, axes, zoom, one cursor through all of them."""

from collections.abc import Callable, Collection, Mapping, Sequence
from functools import cache
from typing import Any, Protocol

import numpy as np
import panel as pn
from bokeh.core.properties import value
from bokeh.core.property.singletons import Undefined
from bokeh.events import Tap
from bokeh.layouts import column
from bokeh.models import (
    BasicTicker,
    BoxZoomTool,
    ColumnDataSource,
    CrosshairTool,
    CustomJS,
    CustomJSTickFormatter,
    Div,
    EditTool,
    GlyphRenderer,
    PanTool,
    Range1d,
    ResetTool,
    Span,
    WheelZoomTool,
)
from bokeh.plotting import figure
from panel.viewable import Viewable

from railjoule.core.arrays import FloatArray
from railjoule.core.energy import SMALL_ENERGY_KWH
from railjoule.dashboard.charts.label_places import Box
from railjoule.dashboard.charts.line_names import COLUMNS, Frame, Name, placed_names
from railjoule.dashboard.charts.run_columns import SHORT_COLUMN, RunColumns
from railjoule.dashboard.charts.sketches import COMPUTING, SketchKind, not_drawn, sketch_css
from railjoule.dashboard.charts.tools import add_tools, name_picture
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.scripts import function
from railjoule.dashboard.look.theme import parts_css
from railjoule.dashboard.look.tokens import DASHES, FONT, line_width
from railjoule.dashboard.parts import html as parts

TICKS = function("ticks", "tick_words(tick, digits)")
CAPTION_PX = 21
# assets/scripts/browser.js does not watch places of this class, which have nothing yet
UNDRAWN, COMPUTED = "rj-undrawn", "rj-computing"
PLACE_CSS = """
:host { overflow: clip; overflow-clip-margin: 16px; filter: var(--rj-chart-filter, none); }
@media (max-width: 899px) { :host(:not(.rj-undrawn)) { height: auto !important; } }
"""
"""On narrow screens a caption may take two lines."""
HINT_CSS = ".bk-Panel { background-color: var(--rj-surface); color: var(--rj-ink); }"
"""What the library says over a figure, it would write on white in dark colours too."""
USUAL_WIDTH_PX = 640.0
RIGHT_BORDER_PX = 30
"""The toolbar stands in it, and below it half of the last number of an axis."""
RIGHT_PX, BOTTOM_PX, TICKS_PX, TITLE_PX = RIGHT_BORDER_PX + 4, 9, 26, 20
"""What is taken at least by the right and lower edges of a figure, the numbers of its x axis and that axis's title."""
# Bokeh paints nothing beyond the frame of a figure, so that the room must be within it
END_LABEL_SHARE = 0.125
"""Share of the axis beyond the last stop that is kept free for labels at the ends of lines."""


class Axis:
    """The x axis that all charts of a page share: its range, its cursor and the columns of the runs over it.

    Parameters
    ----------
    palette : Palette
    kind : type
        In which numbers the columns are sent.
    """

    def __init__(self, palette: Palette, kind: type[np.floating[Any]] = np.float32) -> None:
        # with bounds, so that neither a pan nor a zoom leads away from the line
        self.range = Range1d(0, 1, bounds=(0, 1))
        self.cursor = Span(dimension="height", line_alpha=0.55, line_width=1)
        self.follow = CustomJS(
            args={"charts": [], "range": self.range}, code=function("cursor", "follow({charts, range}, cb_obj)")
        )
        self._charts: dict[str, dict[str, object]] = {}
        self._kind = kind
        self._runs: dict[str, RunColumns] = {}
        self._extent = (0.0, 1.0)
        self._end = 1.0
        self._settled = 0
        self.range.js_on_change("tags", self.follow)
        palette.paint(self.cursor, line_color="ink")

    def fit(self, end: float, roomy: bool) -> None:
        """Show everything up to `end`, unless that is what the axis already spans: then its zoom stays."""
        self._end = end
        extent = (0.0, end * (1 + END_LABEL_SHARE) if roomy else end)
        # up to rounding: the end is computed anew with each run
        if np.allclose(extent, self._extent, rtol=1e-9):
            return
        self._extent = extent
        # bounds first: the browser clips the ends to the bounds that it knows
        self.range.update(bounds=extent, reset_start=extent[0], reset_end=extent[1], start=extent[0], end=extent[1])

    def add(self, name: str, chart: dict[str, object]) -> None:
        """Let the cursor write into one more chart's caption, once `settle` is called."""
        self._charts[name] = chart

    @property
    def extent(self) -> tuple[float, float]:
        """The ends of the whole axis, the room for labels included."""
        return self._extent

    @property
    def end(self) -> float:
        """Where the longest run ends: no ticks lie beyond it."""
        return self._end

    def columns(self, run: str) -> RunColumns:
        """Return the columns of the run of a name, which all charts over this axis share."""
        if run not in self._runs:
            self._runs[run] = RunColumns(self._kind)
        return self._runs[run]

    def settle_over(self, time: bool) -> None:
        """Settle an axis of times [s] or of places [m]."""
        if time:
            self.settle("s", 1)
        else:
            self.settle("m", 0)

    def settle(self, unit: str, digits: int) -> None:
        """Send the columns that charts have taken; tell the cursor all charts, and the unit of its place.

        To be called last within a batch of changes: each column goes once for all charts, and the browser must know all
        charts by then. The tags of the range (a count, the unit, the end of the ticks) are what assets/scripts reads:
        a changed tag calls the cursor, and a saved table has its unit from there.
        """
        for run in self._runs.values():
            run.send()
        charts = enumerate(self._charts.values())
        listed = [dict(chart, place=None if index else [unit, digits]) for index, chart in charts]
        # the browser compiles the callback anew whenever its arguments are set
        if listed != self.follow.args["charts"]:
            self.follow.args = {"charts": listed, "range": self.range}
        else:
            # a change of the range paints all its figures again; a chart that has just come needs it for no other
            self._settled += 1
        self.range.tags = [self._settled, unit, self._end]


Layer = Callable[[Any], Any]
"""Adds to a chart what it draws: a function of the chart, or `methodcaller` with one of the methods of `Chart`."""


# Bokeh's models by hand: measured, HoloViews takes 19 ms to draw two lines anew, this 0.7 ms
class Chart:
    """A figure with a caption above it; a grey sketch stands in its place until it is drawn for the first time.

    Parameters
    ----------
    name : str
        A short name, part of the style classes.
    caption : str
        Quantity and unit.
    height : int
        Height of the figure [px].
    """

    kind: SketchKind = "lines"
    """What its sketch looks like."""
    title = ""
    """What the figure is called where it has no caption, or one that changes."""
    stepped = False
    unit = ""
    digits = 1
    palette: Palette

    def __init__(self, name: str, caption: str, height: int) -> None:
        self.name, self.caption, self.height = name, caption, height
        self.sources: dict[str, ColumnDataSource] = {}
        """What is drawn, each under the name that a saved table gives it."""
        self.host = pn.Column(
            # from the second one assets/scripts/dom.js reads which chart this is
            css_classes=["rj-chart", f"rj-chart-{name}", UNDRAWN, COMPUTED],
            sizing_mode="stretch_width",
            height=self._tall,
            margin=0,
            stylesheets=[PLACE_CSS + sketch_css(self.kind, caption, caption or self.spoken)],
        )
        self.visible = False
        self.width_px = USUAL_WIDTH_PX
        """How wide its place is at least [px]: where more room turns up, names stay as free as they are."""
        self.scenario_title = ""
        """The title of the scenario, for the names of saved pictures."""
        self.figure: figure | None = None
        self.content: Viewable | None = None
        self.queue: Queue = AT_ONCE
        self.waiting: Callable[[], None] | None = None

    @property
    def _tall(self) -> int:
        return self.height + (CAPTION_PX if self.caption else 0)

    @property
    def _classes(self) -> list[str]:
        return [name for name in self.host.css_classes if name not in {UNDRAWN, COMPUTED}]

    @property
    def spoken(self) -> str:
        """The name of the figure for screen readers: Bokeh 3.9.2 fails in the browser where it changes later."""
        return self.title or self.caption or self.name

    @property
    def is_drawn(self) -> bool:
        """Whether it stands on the page, and not its sketch."""
        return self.content is not None and list(self.host) == [self.content]

    def resize(self, height: int) -> None:
        """Change the height of the figure [px]."""
        if height == self.height:
            return
        self.height = height
        self.host.height = self._tall
        if self.figure is not None:
            self.figure.height = height

    def wait(self, told: str = COMPUTING) -> None:
        """Show on the sketch whether the chart is being computed."""
        self.host.css_classes = [*self._classes, UNDRAWN, *([COMPUTED] if told else [])]

    def show(self, draw: Callable[[], None]) -> None:
        """Draw what is asked for last: at once if the chart is in sight, else when the page has time for it."""
        self.waiting = draw
        self.queue.add(self)

    def settle(self) -> None:
        """Draw what waits; the chart takes the place of its sketch once it is drawn without an error."""
        if self.waiting is None:
            return
        # before it draws: what fails would be drawn again and again
        draw, self.waiting = self.waiting, None
        if self.content is None:
            self.build()
            draw()
            # a surface stands in the place of a figure, but has no models of Bokeh
            if self.figure is not None and isinstance(self.figure, figure):
                lighten(self.figure)
                check_complete(self.figure)
        else:
            draw()
        if isinstance(self.figure, figure):
            name_picture(self.figure, self.scenario_title, self.caption or self.spoken)
        # only now: whatever changes within the document makes Bokeh search all of it
        if not self.is_drawn:
            self.host.css_classes = self._classes
            self.host[:] = [self.content]

    def frame_over(self, x: tuple[float, float], y: tuple[float, float]) -> Frame:
        """Return the part of the figure that is drawn in, as large as it is at least."""
        f = self.figure
        assert f is not None
        x_axis, y_axis = f.xaxis[0], f.yaxis[0]
        below = TICKS_PX + (TITLE_PX if x_axis.axis_label else 0) if x_axis.visible else BOTTOM_PX
        left = f.min_border_left + (TITLE_PX if y_axis.axis_label else 0)
        # in a place narrower than its borders nothing fits, but sizes stay above zero
        return Frame(max(self.width_px - left - RIGHT_PX, 1.0), max(self.height - below - 2.0, 1.0), x, y)

    def fail(self) -> None:
        """Say in the chart's place that it could not be drawn; what is drawn next is drawn anew."""
        self.content = self.figure = None
        self.host.css_classes = self._classes
        self.host[:] = [parts.html_pane(not_drawn(self.caption, self.height))]

    look: Mapping[str, Any] = {}
    """What `frame` is given."""
    layers: tuple[Layer, ...] = ()
    """What is drawn, from back to front."""

    def frame(self, *args: Any, **look: Any) -> figure:
        """Return the empty figure, and put it under its caption."""
        raise NotImplementedError

    def build(self) -> None:
        """Make `figure` and `content`."""
        self.frame(**self.look)
        self.add(*self.layers)

    # ---- what is drawn in a figure

    def add(self, *layers: Layer) -> None:
        """Let the figure draw layers, each above those before."""
        for layer in layers:
            layer(self)

    def source(self, name: str, *columns: str) -> ColumnDataSource:
        """Return a new, empty source with these columns, or with those of a line."""
        self.sources[name] = ColumnDataSource({column: [] for column in columns or ("x", "y")}, name=name)
        return self.sources[name]

    def put(self, name: str, /, **columns: Any) -> None:
        """Have these columns in the source of a name; what stands there already is not sent again."""
        source = self.sources[name]
        if source.data.keys() != columns.keys():
            source.data = dict(columns)
        elif changed := {key: column for key, column in columns.items() if not same(source.data[key], column)}:
            source.data.update(changed)

    def glyphs(self, kind: str, name: str, *fields: Any, paint: Mapping[str, str], **style: Any) -> GlyphRenderer:
        """Let the figure draw glyphs of a kind from the source of a name, which is made where there is none.

        Parameters
        ----------
        kind : str
            A method of Bokeh's figure.
        name : str
        fields : str or number
            Names of columns, and values that all glyphs have.
        paint : mapping
            The tokens of its colours, by Bokeh's names of them; they follow the theme.
        style
            Further properties of the glyphs.
        """
        if name not in self.sources:
            self.source(name, *(field for field in fields if isinstance(field, str)))
        drawn: GlyphRenderer = getattr(self.figure, kind)(*fields, source=self.sources[name], **style)
        self.palette.paint(drawn.glyph, **paint)
        return drawn

    def line(self, name: str, token: str, **style: Any) -> GlyphRenderer:
        """Draw a line of a colour."""
        return self.glyphs("line", name, "x", "y", paint={"line_color": token}, **style)

    def dots(self, name: str, fill: str = "accent", edge: str = "surface", **style: Any) -> GlyphRenderer:
        """Draw marks with an edge."""
        return self.glyphs("scatter", name, "x", "y", paint={"fill_color": fill, "line_color": edge}, **style)

    def hairlines(self, name: str, token: str, **style: Any) -> GlyphRenderer:
        """Draw upright lines through the whole figure."""
        return self.glyphs("vspan", name, "x", paint={"line_color": token}, **{"line_width": 1, **style})

    def signs(self, name: str, token: str, size: int = 11, **style: Any) -> GlyphRenderer:
        """Write texts in a colour."""
        return self.glyphs("text", name, "x", "y", "text", paint={"text_color": token}, **text_style(size), **style)

    def coloured_signs(self, name: str, size: int = 11, **style: Any) -> GlyphRenderer:
        """Write texts, each in the colour that the source gives it."""
        if name not in self.sources:
            self.source(name, "x", "y", "text", "colour")
        return self.glyphs("text", name, "x", "y", "text", text_color="colour", paint={}, **text_style(size), **style)

    def grounded_signs(
        self, name: str, token: str, size: int = 12, at: tuple[str, str] = ("x", "y"), **style: Any
    ) -> None:
        """Write texts in a colour, on a ground that keeps them apart from what they lie upon."""
        paint = {"text_color": token, "background_fill_color": "surface"}
        ground = {"background_fill_alpha": 0.8, "padding": 1}
        self.glyphs("text", name, *at, "text", paint=paint, **{**ground, **text_style(size), **style})

    def add_names(self, source: str = "names", size: int = 12) -> None:
        """Let the figure write the names of its lines, above all that is drawn."""
        self.source(source, *COLUMNS)
        placed = {"text_align": "align", "x_offset": "dx", "text_baseline": "middle"}
        self.coloured_signs(source, size, **placed).level = "overlay"

    def place_names(
        self,
        lines: Mapping[str, tuple[FloatArray, FloatArray]],
        names: Sequence[Name],
        taken: Sequence[Box] = (),
        source: str = "names",
        size: int = 12,
    ) -> None:
        """Write the names of lines where there is room for them."""
        self.put(source, **placed_names(self.frame_now, lines, names, taken, size))

    @property
    def frame_now(self) -> Frame:
        """The part of the figure that is drawn in, with what its axes span."""
        raise NotImplementedError

    def clear(self, *names: str) -> None:
        """Empty the sources of these names; of all where none is named."""
        for name in names or self.sources:
            clear(self.sources[name])


class Queue(Protocol):
    """Decides when charts draw."""

    def add(self, chart: Chart) -> None:
        """Let a chart draw what waits, now or later."""


class AtOnce:
    """Draws at once: for charts that no page leads."""

    def add(self, chart: Chart) -> None:
        """Draw."""
        chart.settle()


AT_ONCE = AtOnce()


def lighten(f: figure) -> None:
    """Take off what a figure has for points that are chosen or muted: nothing is, and it is more than half of it."""
    edited = {renderer for tool in f.tools if isinstance(tool, EditTool) for renderer in tool.renderers}
    for renderer in f.renderers:
        if isinstance(renderer, GlyphRenderer) and renderer not in edited:
            renderer.update(selection_glyph=None, nonselection_glyph=None, hover_glyph=None, muted_glyph=None)


def check_complete(f: figure) -> None:
    """Raise an error if a model of a figure lacks what it cannot do without.

    Bokeh itself finds out when it sends the models to the browser: the message with all else that it holds would be
    lost, and the browser and the server would no longer agree on what is on the page.
    """
    for model in f.references():
        for name in required(model.__class__):
            getattr(model, name)


@cache
def required(kind: Any) -> tuple[str, ...]:
    """Return the names of the properties that models of a kind must be given."""
    described = ((name, kind.lookup(name)) for name in kind.properties())
    return tuple(name for name, one in described if one.serialized and one.property._default is Undefined)


class DistanceChart(Chart):
    """A chart over the page's shared axis."""

    def __init__(self, name: str, caption: str, height: int, axis: Axis, palette: Palette, left: int = 50) -> None:
        super().__init__(name, caption, height)
        self.axis, self.palette, self.left = axis, palette, left
        self.y_range = Range1d(0, 1)
        self.press: Callable[[float], None] = lambda _: None
        """Called with the place of a press [m]."""

    def frame(
        self, with_axis: bool = False, zoom: bool = True, ticks: int = 4, digits: int = 0, x_title: str = ""
    ) -> figure:
        """Return the empty figure, and put it under its caption; a title makes the x axis visible."""
        f = figure(
            height=self.height,
            sizing_mode="stretch_width",
            x_range=self.axis.range,
            y_range=self.y_range,
            tools="",
            outline_line_color=None,
            # the same for all charts of an axis, however long their numbers are: places stand above each other
            min_border_left=self.left,
            min_border_right=RIGHT_BORDER_PX,
            min_border_top=2,
            min_border_bottom=7,
            # Bokeh itself gives a canvas neither a role nor a name
            html_attributes={"role": "figure", "aria-label": self.spoken},
        )
        dress(f, self.palette, ticks, digits)
        f.xaxis.update(visible=with_axis or bool(x_title), axis_label=x_title or None)
        if zoom:
            # only the width: all charts share this axis, and each has a y axis of its own
            box = BoxZoomTool(dimensions="width")
            # without the key, the wheel scrolls the page
            wheel = WheelZoomTool(dimensions="width", modifiers={"ctrl": True})
            f.add_tools(PanTool(dimensions="width"), wheel, box, ResetTool())
            f.toolbar.active_drag = box
            f.toolbar.active_scroll = wheel
        f.add_tools(CrosshairTool(overlay=self.axis.cursor))
        add_tools(f, self.spoken, self.palette)
        f.js_on_event("mousemove", self.axis.follow)
        f.js_on_event("mouseleave", self.axis.follow)
        self.figure = f
        # the cursor writes its values here, where they hide no data, as a tooltip would
        caption = Div(
            text=self.caption,
            stylesheets=[parts_css()],
            margin=0,
            visible=bool(self.caption),
            css_classes=["rj-caption"],
        )
        caption.styles = {
            "padding": f"4px 0 0 {self.left}px",
            "font-size": "12px",
            "color": "var(--rj-ink2)",
            "font-family": "var(--rj-font)",
        }
        self.content = pn.pane.Bokeh(
            column(caption, f, sizing_mode="stretch_width", spacing=0), margin=0, sizing_mode="stretch_width"
        )
        # assets/scripts/cursor.js reads these by their names
        self.told = {
            "caption": caption,
            "words": self.caption,
            "sources": [],
            "stepped": self.stepped,
            "unit": self.unit,
            "digits": self.digits,
            # below it the cursor writes one decimal more, as `words.energy` does
            "small": SMALL_ENERGY_KWH if self.unit == "kWh" else 0,
        }
        self.axis.add(self.name, self.told)
        return f

    over_time = False
    """Whether it lies over time."""

    def take_presses(self) -> None:
        """Tell where the line is pressed; over time the axis has no places."""
        assert self.figure is not None
        self.figure.on_event(Tap, self._press)

    def _press(self, event: Any) -> None:
        if event.x is not None and not self.over_time and 0 < event.x < self.axis.end:
            self.press(float(event.x))

    def set_cursor_sources(self, *names: str) -> None:
        """Let the cursor read the lines of these sources."""
        self.told["sources"] = [[name, self.sources[name], "x", "y"] for name in names]

    def follow_line(self, name: str) -> None:
        """Write the values of one line in the caption, at the place of the mouse."""
        self.told["sources"] = [["", self.sources[name], "x", "y"]]

    def rename(self, caption: str) -> None:
        """Give the chart another caption; its `title` names the figure for screen readers."""
        self.caption = self.told["words"] = caption
        above = self.told["caption"]
        if isinstance(above, Div) and above.text != caption:
            above.text = caption

    @property
    def frame_now(self) -> Frame:
        """The frame over the whole axis, whatever part of it is zoomed in on."""
        return self.frame_over(self.axis.extent, (float(self.y_range.start), float(self.y_range.end)))

    def set_range(self, low: float, high: float) -> None:
        """Set the ends of the y axis, and let the ticks of the x axis end with the run."""
        x_axis = None if self.figure is None else self.figure.xaxis[0]
        # a change costs the library much more than a look at what there is
        if x_axis is not None and x_axis.visible and x_axis.bounds != (0, self.axis.end):
            x_axis.bounds = (0, self.axis.end)
        if (self.y_range.start, self.y_range.end) != (low, high):
            self.y_range.update(start=low, end=high)


def zero_line(chart: Chart) -> None:
    """Let a chart draw the line at zero."""
    assert chart.figure is not None
    add_zero(chart.figure, chart.palette)


def axis_line(chart: Chart) -> None:
    """Let a chart draw the line of its x axis."""
    assert chart.figure is not None
    chart.palette.paint(chart.figure.xaxis[0], axis_line_color="line2")


def no_grid(chart: Chart) -> None:
    """Take the grid off a chart."""
    assert chart.figure is not None
    chart.figure.ygrid.visible = False


def dress(f: figure, palette: Palette, ticks: int, digits: int) -> None:
    """Give a figure the look of all charts: y grid only, no lines on the axes, numbers as people write them."""
    f.stylesheets = [HINT_CSS]
    for axis in (f.xaxis[0], f.yaxis[0]):
        axis.update(
            axis_line_color=None,
            major_tick_line_color=None,
            minor_tick_line_color=None,
            major_label_text_font=FONT,
            major_label_text_font_size="11px",
            major_label_standoff=4,
            axis_label_text_font=FONT,
            axis_label_text_font_size="12px",
            axis_label_text_font_style="normal",
            axis_label_standoff=4,
        )
        palette.paint(axis, major_label_text_color="ink3", axis_label_text_color="ink2")
    f.xaxis[0].formatter = CustomJSTickFormatter(code=TICKS, args={"digits": 0})
    f.yaxis[0].formatter = CustomJSTickFormatter(code=TICKS, args={"digits": digits})
    f.yaxis[0].ticker = BasicTicker(desired_num_ticks=ticks)
    f.ygrid.ticker = f.yaxis[0].ticker
    f.xgrid.grid_line_color = None
    palette.paint(f.ygrid[0], grid_line_color="grid")


def add_zero(f: figure, palette: Palette) -> None:
    """Add the zero line to a figure."""
    zero = Span(location=0, dimension="width", line_width=1)
    palette.paint(zero, line_color="line2")
    f.add_layout(zero)


def dragged(figure: figure, script: str, **args: Any) -> CustomJS:
    """Let a script answer drags on a figure, which it has as `f` beside what is named; return its callback.

    The script's module exports a function of its own name, which takes these by name, and the event.
    """
    call = f"{script}({{{', '.join(['f', *args])}}}, cb_obj)"
    drag = CustomJS(args={"f": figure, **args}, code=function(script, call))
    for event in ("panstart", "pan", "panend"):
        figure.js_on_event(event, drag)
    return drag


def text_style(size: int = 12) -> dict[str, object]:
    """Return the properties of text glyphs in charts."""
    # as values: Bokeh would take a bare text for the name of a column
    return {"text_font": value(FONT), "text_font_size": value(f"{size}px")}


def style_of(name: str) -> dict[str, object]:
    """Return width and dash of a strategy's line, or of the pinned run's."""
    return {"line_width": line_width(name), "line_dash": DASHES[name]}


def nice_range(low: float, high: float, share: float = 0.06) -> tuple[float, float]:
    """Return ends of an axis that leave some room around values."""
    # where all values are one, the axis must still have a height
    room = share * max(high - low, 1e-9)
    return low - room, high + room


def clear(source: ColumnDataSource) -> None:
    """Empty a source without changing its columns."""
    if any(len(column) for column in source.data.values()):
        source.data = {key: [] for key in source.data}


def same(one: Any, other: Any) -> bool:
    """Return whether two columns hold the same; pictures, which are long, count as different."""
    if len(one) != len(other) or any(isinstance(value, np.ndarray) for column in (one, other) for value in column[:1]):
        return False
    if isinstance(one, np.ndarray) or isinstance(other, np.ndarray):
        return np.array_equal(one, other)
    return list(one) == list(other)


def columns(**arrays: FloatArray) -> dict[str, FloatArray | list[float]]:
    """Return the columns of a source; short ones as lists, which travel within the message instead of beside it."""
    return {
        name: [*map(_nine_digits, array)] if len(array) <= SHORT_COLUMN else array for name, array in arrays.items()
    }


def _nine_digits(number: float) -> float:
    # a millimetre in a thousand kilometres; all digits would take twice as many letters
    return float(f"{number:.9g}")


def xy(x: FloatArray, y: FloatArray) -> dict[str, FloatArray | list[float]]:
    """Return the columns of a line."""
    return columns(x=np.asarray(x), y=np.asarray(y))


def points(places: Collection[tuple[float, float]]) -> dict[str, list[float]]:
    """Return the columns of a few points."""
    return {"x": [x for x, _ in places], "y": [y for _, y in places]}
