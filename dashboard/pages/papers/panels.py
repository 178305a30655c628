"""One panel of a rebuilt figure, drawn by HoloViews."""

from collections.abc import Sequence
from typing import Any

import holoviews as hv
from bokeh.models import Legend
from bokeh.plotting import figure

from railjoule.core.validation.table import Line, Panel
from railjoule.dashboard.charts.dress import check_complete, dress_single, lighten
from railjoule.dashboard.charts.elements import dress_legends, render_figure
from railjoule.dashboard.look.paint import Palette

COLOURS = ("accent", "eoc", "phases", "bellman", "pin_1", "pin_2", "pin_4", "pin_6")
"""Of the lines, in their order; printed points have the colour of the line with their label."""
DASHES = ("solid", "dashed", "dotdash", "dotted")
HEIGHT_PX = 260
LEGEND_COLUMNS = 4


def draw_panel(panel: Panel, place: str, palette: Palette) -> figure:
    """Return the figure of a panel; it stands in no document yet, so any thread may make it."""
    f = render_figure(lambda: _overlay(panel))
    name = f"{place}: {panel.y_title} over {panel.x_title}"
    dress_single(f, name, palette, keeps_hover=True)
    f.update(height=HEIGHT_PX, y_range=f.y_range)
    f.xaxis.axis_label, f.yaxis.axis_label = panel.x_title, panel.y_title
    looks = _looks(panel.lines)
    for renderer, line in zip(f.renderers, panel.lines, strict=True):
        token, dash = looks[line.label]
        if line.is_printed:
            palette.paint(renderer.glyph, line_color=token, fill_color="surface")
        else:
            palette.paint(renderer.glyph, line_color=token)
            renderer.glyph.line_dash = dash
    _dress_legend(f, palette)
    lighten(f)
    check_complete(f)
    return f


def _overlay(panel: Panel) -> hv.Overlay:
    return hv.Overlay([_element(line, panel) for line in panel.lines]).opts(
        backend="bokeh",
        responsive=True,
        min_height=100,
        padding=0.04,
        # of a single line, HoloViews would make the label a title
        title="",
        legend_position="top",
        legend_cols=LEGEND_COLUMNS,
        show_legend=len(panel.lines) > 1,
    )


def _element(line: Line, panel: Panel) -> hv.Element:
    label = f"{line.label}, printed" if line.is_printed and "printed" not in line.label else line.label
    columns = hv.Dimension("x", label=panel.x_title), hv.Dimension("y", label=panel.y_title)
    if line.is_printed:
        points = hv.Scatter((line.x, line.y), *columns, label=label)
        return points.opts(backend="bokeh", size=8, line_width=2, tools=["hover"], default_tools=[])
    return hv.Curve((line.x, line.y), *columns, label=label).opts(backend="bokeh", line_width=2, default_tools=[])


def _looks(lines: Sequence[Line]) -> dict[str, tuple[str, str]]:
    labels = dict.fromkeys(line.label for line in lines)
    return {
        label: (COLOURS[k % len(COLOURS)], DASHES[k // len(COLOURS) % len(DASHES)]) for k, label in enumerate(labels)
    }


def _dress_legend(f: figure, palette: Palette) -> None:
    legends: Any = f.select({"type": Legend})
    for legend in legends:
        legend.update(spacing=4, padding=2, margin=0)
    dress_legends(f, palette, None)
