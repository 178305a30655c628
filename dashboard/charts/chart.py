"""The base of all charts: a place with a sketch until they are drawn, sources, glyphs, names."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Literal
from urllib.parse import quote

import panel as pn
from bokeh.models import (
    ColumnDataSource,
    GlyphRenderer,
)
from bokeh.plotting import figure
from panel.viewable import Viewable

from railjoule.core.arrays import FloatArray
from railjoule.dashboard.charts.axis import clear, same
from railjoule.dashboard.charts.dress import (
    RIGHT_BORDER_PX,
    add_zero,
    check_complete,
    lighten,
    name_picture,
    text_style,
)
from railjoule.dashboard.charts.names import COLUMNS, Box, Frame, Name, placed_names
from railjoule.dashboard.look.markup import Markup, joined, markup
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.parts import html as parts

SketchKind = Literal["lines", "bars", "map", "strip"]
COMPUTING = "Computing"
NOT_DRAWN = "This figure could not be drawn because of a program error; the server\u2019s log describes it."
SHAPES: Mapping[SketchKind, Markup] = {
    "lines": Markup('<path d="M0 98C4 40 8 16 18 16H78C90 16 96 46 100 98"/><path d="M0 99H100"/>'),
    "bars": Markup(
        '<path d="M1 52h8v48H1zM11 22h8v78h-8zM21 36h8v64h-8zM31 10h8v90h-8zM41 60h8v40h-8zM51 30h8v70h-8z'
        'M61 42h8v58h-8zM71 16h8v84h-8zM81 54h8v46h-8zM91 34h8v66h-8z"/>'
    ),
    "map": Markup(
        '<path fill-opacity=".45" d="M0 1h24v98H0z"/><path fill-opacity=".7" d="M25 1h24v48H25zM75 51h25v48H75z"/>'
        '<path d="M50 1h24v48H50zM25 51h24v48H25z"/><path fill-opacity=".55" d="M75 1h25v48H75zM50 51h24v48H50z"/>'
    ),
    "strip": Markup('<path d="M0 8h9v84H0zM10 8h46v84H10zM57 8h17v84H57zM75 8h25v84H75z"/>'),
}
"""Shapes of sketches in a square of 100 by 100, stretched to its place."""
SVG = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 100 100" preserveAspectRatio="none"{}>{}</svg>'
SKETCH_CSS = """
:host(.rj-undrawn) { position: relative; }
:host(.rj-undrawn)::before { content: %(caption)s; padding-left: 50px; white-space: pre;
  font: 500 12px/1.6 var(--rj-font); color: var(--rj-ink2); }
:host(.rj-computing)::before { content: %(message)s / %(name)s; }
:host(.rj-undrawn)::after { content: ""; position: absolute; inset: %(top)spx 14px 10px 50px;
  background: var(--rj-%(colour)s); mask: url("data:image/svg+xml,%(drawn)s") 0 0 / 100%% 100%%; }
"""
CAPTION_PX = 21
# assets/scripts/browser.js does not watch places of this class, which have nothing yet
UNDRAWN, COMPUTED = "rj-undrawn", "rj-computing"
PLACE_CSS = """
:host { overflow: clip; overflow-clip-margin: 16px; filter: var(--rj-chart-filter, none); }
:host(.rj-lit) { outline: 2px solid var(--rj-accent); }
@media (max-width: 899px) { :host(:not(.rj-undrawn)) { height: auto !important; } }
"""
"""On narrow screens a caption may take two lines."""
USUAL_WIDTH_PX = 640.0
RIGHT_PX, BOTTOM_PX, TICKS_PX, TITLE_PX = RIGHT_BORDER_PX + 4, 9, 26, 20
"""Minimum sizes of the right and lower edges of a figure, of the numbers of its x axis and of that axis's title."""
Layer = Callable[[Any], Any]
"""Adds to a chart what it draws: a function of the chart, or `methodcaller` with one of the methods of `Chart`."""


# Bokeh's models by hand: measured, HoloViews takes 19 ms to draw two lines again, this 0.7 ms
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
    """Shape of its sketch."""
    title = ""
    """Name of a figure that has no caption, or one that changes."""
    stepped = False
    unit = ""
    digits = 1
    palette: Palette

    def __init__(self, name: str, caption: str, height: int) -> None:
        self.name, self.caption, self.height = name, caption, height
        self.sources: dict[str, ColumnDataSource] = {}
        """Drawn quantities, under their names in a saved table."""
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
        self.enqueue: Callable[[Chart], None] = Chart.settle
        """Called when the chart has something to draw: it draws immediately, unless a page has a queue for it."""
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

    def wait(self, text: str = COMPUTING) -> None:
        """Show on the sketch whether the chart is being computed."""
        self.host.css_classes = [*self._classes, UNDRAWN, *([COMPUTED] if text else [])]

    def show(self, draw: Callable[[], None]) -> None:
        """Draw the last request: immediately if the chart is in sight, else when the page has time for it."""
        self.waiting = draw
        self.enqueue(self)

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
        """Say in the chart's place that it could not be drawn; the next drawing starts from scratch."""
        self.content = self.figure = None
        self.host.css_classes = self._classes
        self.host[:] = [parts.html_pane(not_drawn(self.caption, self.height))]

    look: Mapping[str, Any] = {}
    """Arguments of `frame`."""
    layers: tuple[Layer, ...] = ()
    """Its layers, from back to front."""

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
        """Write texts in a colour, on a ground that separates them from the drawing below."""
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


# ---- sketches: grey shapes where a chart will be until it is drawn


def sketch_css(kind: SketchKind, caption: str, name: str) -> str:
    """Return the style sheet that draws the sketch of a chart in its place, below its caption.

    Parameters
    ----------
    kind : str
        Its future shape.
    caption : str
        Empty where the chart has none.
    name : str
        The chart for screen readers.
    """
    style = ' fill="none" stroke="#000" stroke-width="2"' if kind == "lines" else ""
    drawn = quote(SVG.format(style, SHAPES[kind].replace("<path", '<path vector-effect="non-scaling-stroke"')))
    message = f"{caption}\\A {COMPUTING}" if kind != "strip" else caption
    return SKETCH_CSS % {
        "caption": _quoted(caption),
        "message": _quoted(message).replace("\\\\A", "\\A"),
        "name": _quoted(f"Being computed: {name}"),
        "drawn": drawn,
        "colour": "line2" if kind == "lines" else "ground",
        "top": 24 if caption else 4,
    }


def _quoted(text: str) -> str:
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", " ") + '"'


def numbers_sketch(count: int = 5) -> Markup:
    """Return the sketch of a row of numbers, as high as the row."""
    lines = joined(markup('<div class="{}"><i></i></div>', line) for line in ("label", "value", "detail"))
    cells = markup('<div class="figure">{}</div>', lines) * count
    return markup('<div class="figures sketched" role="img" aria-label="Being computed: numbers">{}</div>', cells)


def not_drawn(words: str, height: int) -> Markup:
    """Return the placeholder of a chart that could not be drawn."""
    failed = '{}<div class="failed" role="alert" style="min-height:{}px"><p>{}</p></div>'
    return markup(failed, markup('<div class="caption">{}</div>', words) if words else "", height, NOT_DRAWN)
