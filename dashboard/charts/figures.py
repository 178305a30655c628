"""The kinds of charts: over an axis that figures share, or with axes of their own."""

from collections.abc import Callable
from typing import Any

import panel as pn
from bokeh.events import Tap
from bokeh.layouts import column
from bokeh.models import (
    BoxZoomTool,
    CrosshairTool,
    Div,
    PanTool,
    Range1d,
    ResetTool,
    WheelZoomTool,
)
from bokeh.plotting import figure

from railjoule.core.energy import SMALL_ENERGY_KWH
from railjoule.dashboard.charts.axis import Axis
from railjoule.dashboard.charts.chart import Chart
from railjoule.dashboard.charts.dress import LEFT_PX, RIGHT_BORDER_PX, add_tools, dress, empty_figure
from railjoule.dashboard.charts.names import Frame
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.theme import parts_css
from railjoule.dashboard.parts import html as parts


class DistanceChart(Chart):
    """A chart over the page's shared axis."""

    def __init__(self, name: str, caption: str, height: int, axis: Axis, palette: Palette) -> None:
        super().__init__(name, caption, height)
        self.axis, self.palette = axis, palette
        self.y_range = Range1d(0, 1)
        self.press: Callable[[float], None] = lambda _: None
        """Called with the place of a press [m]."""

    def frame(self, zoom: bool = True, ticks: int = 4, digits: int = 0, x_title: str = "") -> figure:
        """Return the empty figure, and put it under its caption; a title makes the x axis visible."""
        f = figure(
            height=self.height,
            sizing_mode="stretch_width",
            x_range=self.axis.range,
            y_range=self.y_range,
            tools="",
            outline_line_color=None,
            # the same for all charts of an axis, however long their numbers are: places stand above each other
            min_border_left=LEFT_PX,
            min_border_right=RIGHT_BORDER_PX,
            min_border_top=2,
            min_border_bottom=7,
            # Bokeh itself gives a canvas neither a role nor a name
            html_attributes={"role": "figure", "aria-label": self.spoken},
        )
        dress(f, self.palette, ticks, digits)
        f.xaxis.update(visible=bool(x_title), axis_label=x_title or None)
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
            "padding": f"4px 0 0 {LEFT_PX}px",
            "font-size": "12px",
            "color": "var(--rj-ink2)",
            "font-family": "var(--rj-font)",
        }
        self.content = pn.pane.Bokeh(
            column(caption, f, sizing_mode="stretch_width", spacing=0), margin=0, sizing_mode="stretch_width"
        )
        # assets/scripts/cursor.js reads these by their names
        self.cursor_data: dict[str, Any] = {
            "caption": caption,
            "words": self.caption,
            "sources": [],
            "stepped": self.stepped,
            "unit": self.unit,
            "digits": self.digits,
            # below it the cursor writes one decimal more, as `words.energy` does
            "small": SMALL_ENERGY_KWH if self.unit == "kWh" else 0,
        }
        self.axis.add(self.name, self.cursor_data)
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
        self.cursor_data["sources"] = [[name, self.sources[name], "x", "y"] for name in names]

    def follow_line(self, name: str) -> None:
        """Write the values of one line in the caption, at the place of the mouse."""
        self.cursor_data["sources"] = [["", self.sources[name], "x", "y"]]

    def rename(self, caption: str) -> None:
        """Give the chart another caption; its `title` names the figure for screen readers."""
        self.caption = self.cursor_data["words"] = caption
        above = self.cursor_data["caption"]
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


class LoneChart(Chart):
    """A chart with both axes of its own, for what does not lie over the page's shared axis.

    Parameters
    ----------
    name, caption, height
        As in `Chart`.
    palette : Palette
    """

    def __init__(self, name: str, caption: str, height: int, palette: Palette) -> None:
        super().__init__(name, caption, height)
        self.palette, self.x_range, self.y_range = palette, Range1d(0, 1), Range1d(0, 1)

    def frame(self, ticks: int = 6, digits: int = 0, x_title: str = "", y_title: str = "") -> figure:
        """Return the empty figure, and put it under its caption."""
        f = empty_figure(
            self.height, self.x_range, self.y_range, self.spoken, self.palette, ticks, digits, x_title, y_title
        )
        # 50 px, as `empty_figure` keeps left of the frame
        template = '<div style="font-size:12px;color:var(--rj-ink2);padding:2px 0 0 50px">{}</div>'
        caption = parts.html_pane(parts.markup(template, self.caption), css_classes=["rj-caption"])
        self.figure = f
        self.content = parts.stack(caption, pn.pane.Bokeh(f, margin=0, sizing_mode="stretch_width"))
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
