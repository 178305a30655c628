"""The figures of two scenarios side by side: speed, power, energy and effort in two columns over one axis."""

from collections.abc import Mapping
from functools import partial
from operator import methodcaller
from typing import Any

import numpy as np

from railjoule.core import Trajectory
from railjoule.dashboard.charts.axis import xy
from railjoule.dashboard.charts.quantities import EFFORT, ENERGY, POWER, SPEED, Quantity
from railjoule.dashboard.charts.run_lines import Line, RunLines, RunPlot, data_range
from railjoule.dashboard.charts.track import as_steps, limits_of
from railjoule.dashboard.pages.compare.charts import HEADROOM

AXIS = "pair"
FIRST, SECOND = "first", "second"
TOKENS: Mapping[str, str] = {FIRST: "accent", SECOND: "driven"}
OWN: Mapping[str, Any] = {"line_width": 2.4}
OTHER: Mapping[str, Any] = {"line_width": 1.2, "line_dash": [5, 3]}
"""Strokes of the column's own run and of the other one, which is drawn below it."""
LIMIT = methodcaller("line", "limit", "limit", line_width=1.2)


def draw_speeds(chart: RunLines, runs: Mapping[str, Trajectory], over_time: bool, own: str) -> None:
    """Draw both speeds, and over distance the limits of the column's own line."""
    curves = chart.fill(runs, over_time)
    borders = {name: limits_of(run.scenario) for name, run in runs.items()}
    # the same axis in both columns, whichever has the greater limits
    most = max(data_range(curves.values())[1], *(float(np.max(limits)) for _, limits in borders.values()))
    chart.set_range(0, HEADROOM * most)
    if over_time:
        chart.clear("limit")
    else:
        chart.put("limit", **xy(*as_steps(*borders[own])))


def _plot(own: str, quantity: Quantity, words: str, heights: tuple[int, int, int], **more: Any) -> RunPlot:
    other = SECOND if own == FIRST else FIRST
    lines = {name: Line(TOKENS[name], stroke) for name, stroke in ((other, OTHER), (own, OWN))}
    return RunPlot(
        f"{own}_{quantity.name}", quantity, lines, heights, caption=f"{own.capitalize()}: {words}", axis=AXIS, **more
    )


PAIR_PLOTS = tuple(
    plot
    for row in zip(
        *(
            (
                _plot(
                    *(own, SPEED, "speed, km/h", (240, 280, 200)),
                    ticks=5,
                    below=(LIMIT,),
                    draws=partial(draw_speeds, own=own),
                ),
                _plot(own, POWER, "power, MW", (140, 170, 120), digits=1, zero=True),
                _plot(own, ENERGY, "energy so far, kWh", (150, 180, 130), digits=1),
                _plot(
                    *(own, EFFORT, "traction (+), braking (\u2212), kN", (140, 170, 130)),
                    ticks=3,
                    last=True,
                    zero=True,
                    room=0.08,
                ),
            )
            for own in (FIRST, SECOND)
        ),
        strict=True,
    )
    for plot in row
)
"""Row by row: where there is one column, each figure of the first scenario stands above that of the second."""
