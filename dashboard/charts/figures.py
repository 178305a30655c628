"""Figures that stand alone: with both axes, without a shared cursor."""

from functools import cache

import panel as pn
from bokeh.models import HoverTool, Range1d
from bokeh.plotting import figure

from railjoule.dashboard.charts.chart import RIGHT_BORDER_PX, Chart, check_complete, dress, lighten
from railjoule.dashboard.charts.line_names import Frame
from railjoule.dashboard.charts.tools import add_tools
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.tokens import LIGHT
from railjoule.dashboard.parts import html as parts

DARK_INK, WHITE = LIGHT["ink"], "#FFFFFF"


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


def captioned(text: str, f: figure) -> pn.Column:
    """Return a figure under its caption."""
    # 50 px, as `dress_alone` keeps left of the frame
    caption = parts.markup('<div style="font-size:12px;color:var(--rj-ink2);padding:2px 0 0 50px">{}</div>', text)
    return parts.stack(
        parts.html_pane(caption, css_classes=["rj-caption"]), pn.pane.Bokeh(f, margin=0, sizing_mode="stretch_width")
    )


def empty_figure(
    height: int,
    x_range: Range1d,
    y_range: Range1d,
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
    dress_alone(f, name, palette, ticks, digits)
    return f


def dress_alone(
    f: figure, name: str, palette: Palette, ticks: int = 6, digits: int = 0, keeps_hover: bool = False
) -> None:
    """Give a figure its name, the look of a figure with axes of its own, and its toolbar.

    Of the tools that the figure has, only hover tools can be kept.
    """
    f.update(
        sizing_mode="stretch_width",
        tools=[tool for tool in f.tools if keeps_hover and isinstance(tool, HoverTool)],
        # many figures share one WebGL surface, which a page does not need for so few marks
        output_backend="canvas",
        outline_line_color=None,
        min_border_left=50,
        min_border_right=RIGHT_BORDER_PX,
        min_border_top=2,
        min_border_bottom=24,
        html_attributes={"role": "figure", "aria-label": name},
    )
    dress(f, palette, ticks, digits)
    add_tools(f, name, palette)
    palette.paint(f.xaxis[0], axis_line_color="line2")


class LoneChart(Chart):
    """A chart with both axes of its own, for what does not lie over the page's shared axis.

    Parameters
    ----------
    name, caption, height
        As in `Chart`.
    palette : Palette
    x_range : Range1d or None
        That of another chart, where it shares it.
    """

    def __init__(self, name: str, caption: str, height: int, palette: Palette, x_range: Range1d | None = None) -> None:
        super().__init__(name, caption, height)
        self.palette, self.x_range, self.y_range = palette, x_range or Range1d(0, 1), Range1d(0, 1)

    def frame(self, ticks: int = 6, digits: int = 0, x_title: str = "", y_title: str = "") -> figure:
        """Return the empty figure, and put it under its caption."""
        f = empty_figure(
            self.height, self.x_range, self.y_range, self.spoken, self.palette, ticks, digits, x_title, y_title
        )
        self.figure, self.content = f, captioned(self.caption, f)
        return f

    def set_ranges(self, x: tuple[float, float], y: tuple[float, float]) -> None:
        """Set the ends of both axes."""
        self.x_range.update(start=x[0], end=x[1])
        self.y_range.update(start=y[0], end=y[1])

    @property
    def frame_now(self) -> Frame:
        """The part of the figure that is drawn in, with what its axes span."""
        x, y = ((float(ends.start), float(ends.end)) for ends in (self.x_range, self.y_range))
        return self.frame_over(x, y)


class FinishedChart(Chart):
    """A chart whose figures come finished, as from a thread; each takes the place of the one before."""

    def build(self) -> None:
        """Make nothing: `draw` takes a figure."""

    def draw(self, f: figure) -> None:
        """Take a figure that stands in no document yet."""
        f.height = self.height
        lighten(f)
        check_complete(f)
        self.figure, self.content = f, captioned(self.caption, f)
