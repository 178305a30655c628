"""All differences from printed numbers in one figure of HoloViews: a dot for each row with a printed number."""

from collections.abc import Sequence
from typing import Any

import holoviews as hv
import numpy as np
from bokeh.models import FixedTicker
from bokeh.plotting import figure

from railjoule.core.validation import Row, Validation
from railjoule.core.validation.table import CLOSE_PERCENT
from railjoule.dashboard.charts.dress import add_zero, dress_single
from railjoule.dashboard.charts.elements import dress_legends, render_figure
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.look.markup import Markup, joined, markup
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.pages.papers.compute import AUTHORS

STYLES = {
    "ftorek": ("accent", "circle"),
    "liashenko": ("eoc", "triangle"),
    "rawicki": ("phases", "square"),
    "shtompel": ("bellman", "diamond"),
}
"""Colour and shape of each paper's dots, so that they differ without colour, too."""
TIP_COLUMNS = ("Paper", "Table", "Case", "Quantity", "Printed", "railjoule", "Difference")
"""The text of a dot under the mouse."""
TIP_CSS = (
    ":host { --tooltip-color: var(--rj-surface) !important; --tooltip-border: var(--rj-line2) !important; "
    "--tooltip-arrow-color: var(--rj-line2) !important; opacity: 1 !important; } "
    "div.point-tip { font: 12px/1.45 var(--rj-font); color: var(--rj-ink2); width: 200px; white-space: normal; } "
    "div.point-tip b { color: var(--rj-ink); font-weight: 600; }"
)
"""Of the text under the mouse, which the library draws within its own root."""
TICKS_PERCENT = (-100, -30, -10, -3, -1, 0, 1, 3, 10, 30, 100)
X_TITLE = "Printed number, in the order of the tables"
NAME = "Differences of railjoule from the printed numbers"


def scaled(percent: float) -> float:
    """Return the height of a difference: linear as long as a number counts as close, logarithmic from there on."""
    return float(np.arcsinh(percent / CLOSE_PERCENT))


def differences(papers: Sequence[Validation]) -> hv.Dataset:
    """Return all rows that have a difference from a printed number, in the order of the tables, numbered from 1."""
    rows = [
        (paper, table.title, row)
        for paper in papers
        for table in paper.tables
        for row in table.rows
        if row.source and row.difference is not None
    ]
    tips = [(AUTHORS[paper.paper], title, row.case, *_numbers(row)) for paper, title, row in rows]
    columns: dict[str, Any] = {
        "row": np.arange(1, len(rows) + 1),
        "name": np.array([paper.paper for paper, _, _ in rows], dtype=object),
        "height": np.array([scaled(row.difference or 0.0) for _, _, row in rows]),
        **{word: np.array([texts[k] for texts in tips], dtype=object) for k, word in enumerate(TIP_COLUMNS)},
    }
    return hv.Dataset(columns, ["row", "name"], ["height", *TIP_COLUMNS])


def _numbers(row: Row) -> tuple[str, ...]:
    unit = f" {row.unit}" if row.unit else ""
    digits = words.decimals(row.printed)
    printed = words.number(row.printed or 0.0, digits)
    difference = comparisons.printed_difference(row.difference_percent, row.difference_points)
    return row.quantity, f"{printed}{unit}", f"{words.number(row.value, digits + 1)}{unit}", difference


def difference_figure(papers: Sequence[Validation], dark: bool) -> tuple[figure, Palette]:
    """Return the figure and the colours that it wears; it stands in no document yet, so any thread may make it."""
    rows, palette = differences(papers), Palette(dark)
    most = max(map(abs, rows.range("height")), default=1.0)
    close = scaled(CLOSE_PERCENT)
    names = [name for name in STYLES if name in set(rows.dimension_values("name"))]

    def element() -> hv.Overlay:
        dots = [_dots(rows.select(name=name), name) for name in names]
        return hv.Overlay([hv.HSpan(-close, close).opts(backend="bokeh", line_color=None), *dots]).opts(
            backend="bokeh",
            responsive=True,
            min_height=100,
            xlim=(0, len(rows) + 1),
            # the legend stands within the frame, above all dots
            ylim=(-1.06 * most, 1.3 * most),
            xlabel=X_TITLE,
            ylabel="",
            show_legend=True,
            legend_position="top",
            legend_cols=len(names),
        )

    f = render_figure(element)
    _dress(f, names, palette)
    return f, palette


def tip() -> Markup:
    """Return the tooltip of a dot, with the names of columns in the place of their values, which Bokeh escapes."""
    lines = joined(markup("<div>{}: <b>@{}</b></div>", word, word) for word in TIP_COLUMNS)
    return markup('<div class="point-tip"><style>{}</style>{}</div>', Markup(TIP_CSS), lines)


def _dots(rows: hv.Dataset, name: str) -> hv.Scatter:
    dots = hv.Scatter(rows, "row", ["height", *TIP_COLUMNS], label=AUTHORS[name])
    return dots.opts(
        backend="bokeh",
        marker=STYLES[name][1],
        size=7,
        fill_alpha=0.55,
        line_width=0.8,
        default_tools=[],
        tools=["hover"],
        hover_tooltips=tip(),
    )


def _dress(f: figure, names: Sequence[str], palette: Palette) -> None:
    dress_single(f, NAME, palette, keeps_hover=True)
    f.yaxis.axis_label = None
    f.yaxis.formatter.args = {"digits": 0}
    f.yaxis.ticker = f.ygrid.ticker = FixedTicker(ticks=[scaled(tick) for tick in TICKS_PERCENT])
    f.yaxis.major_label_overrides = {scaled(tick): words.signed(tick, 0) for tick in TICKS_PERCENT}
    band, *dots = f.renderers
    palette.paint(band, fill_color="tint")
    band.level = "underlay"
    for layer, name in zip(dots, names, strict=True):
        palette.paint(layer.glyph, fill_color=STYLES[name][0], line_color=STYLES[name][0])
    add_zero(f, palette)
    dress_legends(f, palette, None)
