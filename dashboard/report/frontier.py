"""The least energy over travel time, with every strategy's run as a point."""

from collections.abc import Mapping, Sequence

import numpy as np
from bokeh.models import ColumnDataSource

from railjoule.core import Trajectory
from railjoule.core.scenario import StrategyName
from railjoule.dashboard.look import words
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.views.charts import Axis, DistanceChart, nice_range, spread, style_of, text_style, xy

STEEPEST_SHARE = 1.03
"""The scale ends with the optimum at this multiple of the first time: nearer to it, energy rises out of any scale."""
LABEL_RISE_PX, LABEL_GAP_PX = 14.0, 16.0


class TimeChart(DistanceChart):
    """Energy over travel time."""

    unit, digits = "kWh", 2

    def __init__(self, height: int, axis: Axis, palette: Palette) -> None:
        super().__init__("frontier", "Least energy, kWh, over travel time, s", height, axis, palette)

    def build(self) -> None:
        """Make the figure."""
        f = self.frame(with_axis=True, digits=1)
        f.xaxis.axis_label = "Travel time, s"
        self.palette.paint(f.xaxis[0], axis_line_color="line2")
        self.sources["optimal"] = ColumnDataSource({"x": [], "y": []})
        line = f.line("x", "y", source=self.sources["optimal"], **style_of("optimal"))
        self.palette.paint(line.glyph, line_color="optimal")
        columns: dict[str, list[object]] = {"x": [], "y": [], "text": [], "place": [], "colour": []}
        self.sources["runs"] = ColumnDataSource(columns)
        f.scatter("x", "y", source=self.sources["runs"], size=7, fill_color="colour", line_color="colour")
        f.text(
            "x",
            "place",
            "text",
            text_color="colour",
            source=self.sources["runs"],
            x_offset=14,
            text_baseline="middle",
            **text_style(),
        )
        self.sources["point"] = ColumnDataSource({"x": [], "y": []})
        point = f.scatter("x", "y", source=self.sources["point"], size=11, line_width=2)
        self.palette.paint(point.glyph, fill_color="accent", line_color="surface")

    def draw(self, optima: Sequence[Trajectory], runs: Mapping[StrategyName, Trajectory], shown: Trajectory) -> None:
        """Draw the optima as a line, the runs and the one that is shown as points."""
        times = np.array([run.travel_time_s for run in optima])
        energies = np.array([run.energy_kwh for run in optima])
        others = {name: run for name, run in runs.items() if name not in {"optimal", "fastest"}}
        start, end = float(times[0]), float(times[-1])
        room = 0.02 * (end - start)
        self.axis.range.update(
            bounds=(start - room, end + room),
            reset_start=start - room,
            reset_end=end + room,
            start=start - room,
            end=end + room,
        )
        steepest = float(np.interp(STEEPEST_SHARE * start, times, energies))
        levels = [steepest, float(energies.min()), *(run.energy_kwh for run in others.values())]
        low, high = nice_range(min(levels), max(levels))
        self.y_range.update(start=low, end=high)
        self.sources["optimal"].data = xy(times, energies)
        self.told["sources"] = [["", self.sources["optimal"]]]
        # the names stand a little above their points, as the line falls beneath them
        wished = [run.energy_kwh + LABEL_RISE_PX * (high - low) / self.height for run in others.values()]
        self.sources["runs"].data = {
            "x": [run.travel_time_s for run in others.values()],
            "y": [run.energy_kwh for run in others.values()],
            "place": spread(wished, LABEL_GAP_PX * (high - low) / self.height),
            "text": [words.STRATEGY_WORDS[name] for name in others],
            "colour": [self.palette.tokens[name] for name in others],
        }
        self.sources["point"].data = {"x": [shown.travel_time_s], "y": [shown.energy_kwh]}
