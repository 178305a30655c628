"""The look of all figures: axes, grid, fonts, colours, toolbar."""

from functools import cache
from typing import Any

from bokeh.core.properties import value
from bokeh.core.property.singletons import Undefined
from bokeh.models import (
    BasicTicker,
    CustomJS,
    CustomJSTickFormatter,
    EditTool,
    FullscreenTool,
    GlyphRenderer,
    Range,
    SaveTool,
    Span,
)
from bokeh.plotting import figure

from railjoule.dashboard.look.markup import Markup, joined, markup
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.scripts import function
from railjoule.dashboard.look.tokens import DASHES, FONT, LIGHT, line_width
from railjoule.dashboard.look.words import slug

FIGURE_CSS = """
:host(:fullscreen) { background: var(--rj-surface); }
:host(:fullscreen)::before { content: attr(aria-label); position: absolute; z-index: 1; top: 6px; right: 40px;
  max-width: calc(100% - 110px); padding: 2px 8px; border-radius: 6px; text-align: right; pointer-events: none;
  font: 600 14px/1.3 var(--rj-font); color: var(--rj-ink2);
  background: color-mix(in srgb, var(--rj-surface) 80%, transparent); }
"""
"""On the full screen, the name of the figure is its title."""
TOOLBAR_CSS = """
:host { --icon-color: var(--rj-ink3); --highlight-color: var(--rj-accent); }
:host(.bk-hidden) { visibility: visible; opacity: 1; }
@media (hover: hover) { :host(.bk-hidden) > :not(:focus-visible) { opacity: 0; } }
:host > .bk-horizontal, :host > .bk-vertical { background: var(--rj-surface); border-color: var(--rj-line2); }
"""
"""The toolbar is invisible until the mouse or the keyboard focus is there; touch screens always show it."""
TICKS = function("numbers", "written(tick, digits, 3)")
HINT_CSS = ".bk-Panel { background-color: var(--rj-surface); color: var(--rj-ink); }"
"""Notes of the library over a figure, which it would write on white in dark colours too."""
POINT_CSS = Markup(
    ":host { --tooltip-color: var(--rj-surface) !important; --tooltip-border: var(--rj-line2) !important; "
    "--tooltip-arrow-color: var(--rj-line2) !important; opacity: 1 !important; } "
    "div.point-tip { font: 12px/1.45 var(--rj-font); color: var(--rj-ink2); max-width: 260px; white-space: normal; } "
    "div.point-tip b { color: var(--rj-ink); font-weight: 600; }"
)
"""Of the text under the mouse, which Bokeh draws within its own root."""
LEFT_PX = 50
"""Room of the numbers of the y axis."""
RIGHT_BORDER_PX = 30
"""The toolbar stands in it, and below it half of the last number of an axis."""
DARK_INK, WHITE = LIGHT["ink"], "#FFFFFF"


def add_tools(f: figure, caption: str, palette: Palette) -> None:
    """Add full screen and saving to the toolbar of a figure, and hide the buttons of all other tools.

    Parameters
    ----------
    f : figure
    caption : str
        The name of the saved picture.
    palette : Palette
    """
    for tool in f.tools:
        tool.visible = False
    f.add_tools(FullscreenTool(), SaveTool(filename=slug(caption)))
    f.toolbar.update(logo=None, autohide=True, stylesheets=[TOOLBAR_CSS])
    f.update(toolbar_location="right", stylesheets=[*f.stylesheets, FIGURE_CSS])
    # a saved picture needs the background of the page; fills leave pixels at the edges half painted, lines do not
    places = ("background_fill", "border_fill", "outline_line", "border_line")
    palette.paint(f, **{f"{place}_color": "surface" for place in places})


def name_picture(f: figure, scenario: str, caption: str) -> None:
    """Name the file of a saved picture after its scenario and its figure."""
    name = "-".join(filter(None, (slug(scenario), slug(caption))))
    for tool in f.tools:
        if isinstance(tool, SaveTool) and tool.filename != name:
            tool.filename = name


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


def dragged(figure: figure, script: str, answer: str = "", **args: Any) -> CustomJS:
    """Let a script answer drags on a figure, which it has as `f` beside what is named; return its callback.

    The script's module exports a function of that name, or of its own, which takes these by name, and the event.
    """
    call = f"{answer or script}({{{', '.join(['f', *args])}}}, cb_obj)"
    drag = CustomJS(args={"f": figure, **args}, code=function(script, call))
    for event in ("panstart", "pan", "panend"):
        figure.js_on_event(event, drag)
    return drag


def point_tip(*pairs: tuple[str, str]) -> Markup:
    """Return the tooltip of a point: words, and names of columns in the place of their values, which Bokeh escapes."""
    lines = joined(markup("<div>{}: <b>{}</b></div>", word, value) for word, value in pairs)
    return markup('<div class="point-tip"><style>{}</style>{}</div>', POINT_CSS, lines)


def dress_legends(f: figure, palette: Palette, ground: str | None = "surface") -> None:
    """Give the legends of a figure our font and colours, and a ground where one is named."""
    for legend in f.legend:
        legend.update(label_text_font=FONT, label_text_font_size="12px", border_line_color=None)
        palette.paint(legend, label_text_color="ink2")
        if ground is None:
            legend.background_fill_color = None
        else:
            palette.paint(legend, background_fill_color=ground)


def text_style(size: int = 12) -> dict[str, object]:
    """Return the properties of text glyphs in charts."""
    # as values: Bokeh would take a bare text for the name of a column
    return {"text_font": value(FONT), "text_font_size": value(f"{size}px")}


def line_style(name: str) -> dict[str, object]:
    """Return width and dash of a strategy's line, or of the pinned run's."""
    return {"line_width": line_width(name), "line_dash": DASHES[name]}


# a map asks for a few colours once for each of its cells
@cache
def ink_on(colour: str) -> str:
    """Return black or white, whichever contrasts more with a colour."""
    # at the geometric mean of both, the contrast ratio of WCAG 2.2 with each is the same
    return DARK_INK if _lightness(colour) ** 2 > _lightness(DARK_INK) * _lightness(WHITE) else WHITE


def _lightness(colour: str) -> float:
    """Return the relative luminance of WCAG 2.2, and what its contrast ratio adds for the light around a screen."""
    shares = (int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5))
    red, green, blue = (c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in shares)
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue + 0.05


def empty_figure(
    height: int,
    x_range: Range,
    y_range: Range,
    name: str,
    palette: Palette,
    ticks: int = 6,
    digits: int = 0,
    x_title: str = "",
    y_title: str = "",
) -> figure:
    """Return a figure with both axes; where the y axis has no title, the caption names it."""
    f = figure(height=height, x_range=x_range, y_range=y_range, tools="")
    f.xaxis.axis_label, f.yaxis.axis_label = x_title or None, y_title or None
    f.update(
        sizing_mode="stretch_width",
        # many figures share one WebGL surface, which a page does not need for so few marks
        output_backend="canvas",
        outline_line_color=None,
        min_border_left=LEFT_PX,
        min_border_right=RIGHT_BORDER_PX,
        min_border_top=2,
        min_border_bottom=24,
        html_attributes={"role": "figure", "aria-label": name},
    )
    dress(f, palette, ticks, digits)
    add_tools(f, name, palette)
    palette.paint(f.xaxis[0], axis_line_color="line2")
    return f
