"""Steps over the distance whose levels and ends can be dragged: limits of the line, or set speeds of sections."""

from collections.abc import Sequence
from typing import Any

from bokeh.models import ColumnDataSource, CustomJS

from railjoule.dashboard.charts.chart import Chart
from railjoule.dashboard.charts.dress import dragged

STEPS, MOVED = "steps", "moved"
"""Sources of what is drawn, and of what the browser has moved."""
END_PX = 9


def add_steps(chart: Chart, token: str, **bounds: Any) -> tuple[ColumnDataSource, CustomJS]:
    """Let a chart draw steps that can be dragged; return the source of what was moved, and the callback.

    Parameters
    ----------
    chart : Chart
    token : str
        Their colour.
    **bounds
        As `drag_steps` of assets/scripts/drag.js has them.
    """
    assert chart.figure is not None
    steps = chart.source(STEPS, "left", "right", "limit", "middle", "text", "movable")
    moved = chart.source(MOVED, "left", "right", "limit")
    edge, grip = {"line_color": token}, {"line_color": token, "fill_color": "surface"}
    if bounds["shared"]:
        chart.glyphs("step", STEPS, "left", "limit", paint=edge, line_width=2, mode="after")
    chart.glyphs("segment", STEPS, "left", "limit", "right", "limit", paint=edge, line_width=2)
    chart.glyphs("scatter", STEPS, "middle", "limit", paint=grip, size=10, line_width=2)
    for end in ("right",) if bounds["shared"] else ("left", "right"):
        chart.glyphs("scatter", STEPS, end, "limit", paint=grip, size="movable", line_width=2, marker="square")
    chart.grounded_signs(STEPS, token, at=("middle", "limit"), text_align="center", y_offset=-9)
    return moved, dragged(chart.figure, "drag", "drag_steps", steps=steps, moved=moved, **bounds)


def draw_steps(chart: Chart, steps: Sequence[tuple[float, float, float, bool]]) -> None:
    """Draw steps: beginning and end, level, and whether ends can be moved.

    They are sent whatever stands there: the browser moves them before the server does.
    """
    left, right, limit, movable = (list(column) for column in zip(*steps, strict=True)) if steps else ([], [], [], [])
    chart.sources[STEPS].data = {
        "left": left,
        "right": right,
        "limit": limit,
        "middle": [0.5 * (start + end) for start, end in zip(left, right, strict=True)],
        "text": [f"{round(level, 1):g}" for level in limit],
        "movable": [END_PX * moves for moves in movable],
    }
