"""Charts with a line of its own colour and stroke for each of a few runs."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from bokeh.models import ColumnDataSource

from railjoule.core import Trajectory
from railjoule.core.arrays import FloatArray
from railjoule.dashboard.views.charts import DistanceChart, xy

DRIVEN_DASH = [6, 3]


class RunLinesChart(DistanceChart):
    """A quantity of several runs."""

    strokes: Mapping[str, tuple[str, dict[str, Any]]] = {}
    """Colour and stroke of each run by the name of its line, in the order of drawing."""

    def add_lines(self) -> None:
        """Add a line for each run."""
        assert self.figure is not None
        draw, mode = (self.figure.step, {"mode": "before"}) if self.stepped else (self.figure.line, {})
        for name, (token, stroke) in self.strokes.items():
            self.sources[name] = ColumnDataSource({"x": [], "y": []})
            line = draw("x", "y", source=self.sources[name], **stroke, **mode)
            self.palette.paint(line.glyph, line_color=token)

    def values(self, run: Trajectory) -> FloatArray:
        """Return what is drawn of a run, at its nodes."""
        raise NotImplementedError

    def fill(self, runs: Mapping[str, Trajectory], over_time: bool = False) -> tuple[float, float]:
        """Fill the lines; return the least and the greatest value."""
        low, high = np.inf, -np.inf
        for name, run in runs.items():
            values = self.values(run)
            self.sources[name].data = xy(run.time_s if over_time else run.position_m, values)
            low, high = min(low, float(values.min())), max(high, float(values.max()))
        self.told["sources"] = [[name, self.sources[name]] for name in runs]
        return low, high
