"""The numbers of a chart as a table."""

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from bokeh.models import GlyphRenderer, Image, Line, Step, Text
from bokeh.plotting import figure

from railjoule.dashboard.charts.chart import Chart
from railjoule.dashboard.charts.surface import Scene

if TYPE_CHECKING:
    import pandas

DECORATIONS = frozenset({"fill", "ink", "colour", "align", "offset", "base", "middle", "index"})
"""Columns that only style glyphs."""
NOT_DATA = frozenset({"forbidden", "borders"})
"""Sources of background glyphs."""
ENDS = {"left": "x", "right": "x", "low": "y", "high": "y", "bottom": "y", "top": "y"}
"""The axes of columns that are ends of areas."""
X_WORDS = {"s": "Time, s", "m": "Distance, m"}
"""Names of shared axes by their unit, which is the second tag of their range: `Axis.settle`."""

Series = Mapping[str, Any]
"""Columns of one line or set of points."""


def series(chart: Chart) -> tuple[list[tuple[str, Series]], dict[str, str]]:
    """Return the named series of a drawn chart, and the headings of its columns `x`, `y` and `z`.

    The columns are those of the chart and no copies: charts replace columns and do not change them.
    """
    drawn: Any = chart.figure
    if isinstance(drawn, figure):
        return list(_bokeh_series(drawn)), _bokeh_headings(drawn, chart.caption or chart.title)
    if isinstance(drawn, Scene) and drawn.traces:
        axes = drawn.frame["scene"]
        headings = {axis: axes[f"{axis}axis"]["title"]["text"] for axis in "xy"}
        return list(_scene_series(drawn.traces)), {**headings, "z": chart.caption or chart.title}
    return [], {}


def table(found: Sequence[tuple[str, Series]], headings: Mapping[str, str]) -> "pandas.DataFrame":
    """Return series below each other as one table, whose first column names the series."""
    # the page opens without it
    import pandas  # noqa: PLC0415

    tables = [pandas.DataFrame({"series": name, **columns}) for name, columns in found]
    return pandas.concat(tables, ignore_index=True).rename(columns=headings)


def _bokeh_headings(f: figure, caption: str) -> dict[str, str]:
    tags = f.x_range.tags
    x = f.xaxis[0].axis_label or (X_WORDS.get(tags[1], "") if tags else "")
    words = {"x": x or "x", "y": f.yaxis[0].axis_label or caption or "y"}
    return words | {end: f"{end}: {words[axis]}" for end, axis in ENDS.items()}


def _bokeh_series(f: figure) -> Iterator[tuple[str, Series]]:
    seen: set[str] = set()
    for renderer in f.renderers:
        if not isinstance(renderer, GlyphRenderer) or not renderer.visible:
            continue
        source, glyph = renderer.data_source, renderer.glyph
        if source.name in NOT_DATA or isinstance(glyph, Text):
            continue
        columns: Series = source.data
        if isinstance(glyph, Line | Step) and glyph.y not in ("y", None):
            # a line that draws two of the columns of its run
            columns = {"x": columns[glyph.x], "y": columns[glyph.y]}
        elif source.id in seen:
            continue
        else:
            seen.add(source.id)
            columns = _cells(columns) if isinstance(glyph, Image) else _numbers(columns)
        if any(len(column) for column in columns.values()):
            yield renderer.name or source.name or "points", columns


def _numbers(columns: Series) -> Series:
    """Return the columns of numbers and texts, without styles and without columns of lists."""
    return {
        name: column
        for name, column in columns.items()
        if name not in DECORATIONS and not (len(column) and isinstance(column[0], list | tuple | np.ndarray))
    }


def _cells(columns: Series) -> Series:
    """Return the middles of the cells of a picture, and their values."""
    if not len(columns["image"]):
        return {}
    values = np.asarray(columns["image"][0], dtype=float)
    rows, wide = values.shape
    x = columns["x"][0] + (np.arange(wide) + 0.5) * columns["dw"][0] / wide
    y = columns["y"][0] + (np.arange(rows) + 0.5) * columns["dh"][0] / rows
    return {"x": np.tile(x, rows), "y": np.repeat(y, wide), "value": values.ravel()}


def _scene_series(traces: Sequence[Mapping[str, Any]]) -> Iterator[tuple[str, Series]]:
    for number, trace in enumerate(traces, 1):
        x, y, z = (np.asarray(trace[axis], dtype=float) for axis in "xyz")
        if trace["type"] == "surface":
            yield "surface", {"x": np.tile(x, len(y)), "y": np.repeat(y, len(x)), "z": z.ravel()}
        elif len(x):
            yield str(trace.get("name", f"series {number}")), {"x": x, "y": y, "z": z}
