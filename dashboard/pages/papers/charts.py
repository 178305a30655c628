"""The figures of Papers: all differences from printed numbers, and the panels of figures that are computed again."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from bokeh.models import BoxAnnotation, DataRange1d, FixedTicker, HoverTool
from bokeh.plotting import figure

from railjoule.core.validation import Row, Validation
from railjoule.core.validation.table import CLOSE_PERCENT, Line, Panel
from railjoule.dashboard.charts.chart import zero_line
from railjoule.dashboard.charts.dress import check_complete, dress_legends, empty_figure, lighten, point_tip
from railjoule.dashboard.charts.figures import LoneChart
from railjoule.dashboard.charts.plot import Plot
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.pages.papers.compute import AUTHORS
from railjoule.dashboard.pages.papers.tables import typeset_plain

STYLES = {
    "ftorek": ("accent", "circle"),
    "liashenko": ("eoc", "triangle"),
    "rawicki": ("phases", "square"),
    "shtompel": ("bellman", "diamond"),
}
"""Colour and shape of each paper's dots, so that they differ without colour, too."""
TIP_COLUMNS = ("Paper", "Table", "Case", "Quantity", "Printed", "railjoule", "Difference")
"""The text of a dot under the mouse."""
TICKS_PERCENT = (-100, -30, -10, -3, -1, 0, 1, 3, 10, 30, 100)
CAPTION = "railjoule minus paper, in % of the printed number; percentages in percentage points, %"
COLOURS = ("accent", "eoc", "phases", "bellman", "pin_1", "pin_2", "pin_4", "pin_6")
"""Of the lines of a panel, in their order; printed points have the colour of the line with their label."""
DASHES = ("solid", "dashed", "dotdash", "dotted")
PANEL_HEIGHT_PX = 260
LEGEND_COLUMNS = 4


def scaled(percent: float) -> float:
    """Return the height of a difference: linear as long as a number counts as close, logarithmic from there on."""
    return float(np.arcsinh(percent / CLOSE_PERCENT))


def differences(papers: Sequence[Validation]) -> dict[str, dict[str, list[Any]]]:
    """Return the columns of each paper's dots: the rows that have a difference, in the order of the tables, from 1."""
    columns: dict[str, dict[str, list[Any]]] = {}
    count = 0
    for paper in papers:
        rows = [
            (table.title, row)
            for table in paper.tables
            for row in table.rows
            if row.source and row.difference is not None
        ]
        tips = [(AUTHORS[paper.paper], title, row.case, *_numbers(row)) for title, row in rows]
        columns[paper.paper] = {
            "x": list(range(count + 1, count + len(rows) + 1)),
            "y": [scaled(row.difference or 0.0) for _, row in rows],
            **{word: [texts[k] for texts in tips] for k, word in enumerate(TIP_COLUMNS)},
        }
        count += len(rows)
    return {name: of for name, of in columns.items() if of["x"]}


def _numbers(row: Row) -> tuple[str, ...]:
    unit = f" {row.unit}" if row.unit else ""
    digits = words.decimals(row.printed)
    printed = words.number(row.printed or 0.0, digits)
    difference = comparisons.printed_difference(row.difference_percent, row.difference_points)
    return row.quantity, f"{printed}{unit}", f"{words.number(row.value, digits + 1)}{unit}", difference


class DifferencesChart(LoneChart):
    """A dot for each row of the tables with a printed number."""

    kind = "map"
    title = "Differences of railjoule from the printed numbers"

    def build(self) -> None:
        """Make the figure."""
        f = self.frame(x_title="Printed number, in the order of the tables")
        f.yaxis.ticker = f.ygrid.ticker = FixedTicker(ticks=[scaled(tick) for tick in TICKS_PERCENT])
        f.yaxis.major_label_overrides = {scaled(tick): words.signed(tick, 0) for tick in TICKS_PERCENT}
        close = scaled(CLOSE_PERCENT)
        band = BoxAnnotation(bottom=-close, top=close, line_color=None, level="underlay")
        self.palette.paint(band, fill_color="tint")
        f.add_layout(band)
        zero_line(self)

    def draw(self, papers: Sequence[Validation]) -> None:
        """Draw the differences of some papers."""
        f, found = self.figure, differences(papers)
        assert f is not None
        for name, columns in found.items():
            token, marker = STYLES[name]
            style = {"size": 7, "marker": marker, "fill_alpha": 0.55, "line_width": 0.8, "legend_label": AUTHORS[name]}
            self.source(name, *columns).data = columns
            self.dots(name, token, token, **style)
        # one tooltip for all: Bokeh takes the columns of the dot under the mouse
        f.add_tools(HoverTool(tooltips=point_tip(*((word, f"@{word}") for word in TIP_COLUMNS)), visible=False))
        _place_legend(f, self.palette, len(STYLES))
        most = max((abs(height) for columns in found.values() for height in columns["y"]), default=1.0)
        self.set_ranges((0, 1 + sum(len(columns["x"]) for columns in found.values())), (-1.06 * most, 1.06 * most))


DIFFERENCES = Plot(
    "differences",
    CAPTION,
    heights=(330, 420, 320),
    chart=lambda height, palette: DifferencesChart("differences", CAPTION, height, palette),
)


def draw_panel(panel: Panel, place: str, palette: Palette) -> figure:
    """Return the figure of a panel of a printed figure."""
    x_title, y_title = typeset_plain(panel.x_title), typeset_plain(panel.y_title)
    name = f"{place}: {y_title} over {x_title}"
    x_range, y_range = (DataRange1d(range_padding=0.08) for _ in "xy")
    f = empty_figure(PANEL_HEIGHT_PX, x_range, y_range, name, palette, x_title=x_title, y_title=y_title)
    labels = dict.fromkeys(line.label for line in panel.lines)
    looks = {
        label: (COLOURS[k % len(COLOURS)], DASHES[k // len(COLOURS) % len(DASHES)]) for k, label in enumerate(labels)
    }
    for line in panel.lines:
        token, dash = looks[line.label]
        more = {} if len(panel.lines) == 1 else {"legend_label": _label(line)}
        if line.is_printed:
            points = f.scatter(line.x, line.y, size=8, line_width=2, **more)
            palette.paint(points.glyph, line_color=token, fill_color="surface")
            columns = (x_title, "@x{0,0.00}"), (y_title, "@y{0,0.00}")
            f.add_tools(HoverTool(renderers=[points], tooltips=point_tip(*columns), visible=False))
        else:
            drawn = f.line(line.x, line.y, line_width=2, line_dash=dash, **more)
            palette.paint(drawn.glyph, line_color=token)
    _place_legend(f, palette, LEGEND_COLUMNS)
    lighten(f)
    check_complete(f)
    return f


def _label(line: Line) -> str:
    label = typeset_plain(line.label)
    return f"{label}, printed" if line.is_printed and "printed" not in label else label


def _place_legend(f: figure, palette: Palette, columns: int) -> None:
    """Put the legend above the frame, where it hides no data."""
    for legend in list(f.legend):
        legend.update(location="center", ncols=columns, spacing=4, padding=2, margin=0)
        f.center.remove(legend)
        f.add_layout(legend, "above")
    dress_legends(f, palette, None)
