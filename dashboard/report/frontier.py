"""The least energy over travel time, with every strategy's run as a point."""

from collections.abc import Mapping, Sequence

import numpy as np

from railjoule.core import Trajectory
from railjoule.dashboard.charts.chart import Axis, DistanceChart, nice_range, points, style_of, xy
from railjoule.dashboard.charts.line_names import Name, placed_names
from railjoule.dashboard.look import words
from railjoule.dashboard.look.paint import Palette

STEEPEST_SHARE = 1.03
"""The scale ends with the optimum at this multiple of the first time: nearer to it, energy rises out of any scale."""


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
        self.line("optimal", "optimal", **style_of("optimal"))
        self.source("runs", "x", "y", "colour")
        self.glyphs("scatter", "runs", "x", "y", paint={}, size=7, fill_color="colour", line_color="colour")
        self.add_names()
        self.dots("point", size=11, line_width=2)

    def draw(self, optima: Sequence[Trajectory], runs: Mapping[str, Trajectory], shown: Trajectory) -> None:
        """Draw the optima as a line, the runs and the one that is shown as points."""
        times = np.array([run.travel_time_s for run in optima])
        energies = np.array([run.energy_kwh for run in optima])
        # the optimum is on the line, and the fastest run needs more than the scale shows
        others = {name: run for name, run in runs.items() if name not in {"optimal", "fastest"}}
        start, end = float(times[0]), float(times[-1])
        room = 0.02 * (end - start)
        # not by `fit`, which begins at zero
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
        self.put("optimal", **xy(times, energies))
        self.follow_line("optimal")
        colours = {name: self.palette.tokens[name] for name in others}
        places = {name: (run.travel_time_s, run.energy_kwh) for name, run in others.items()}
        own = (shown.travel_time_s, shown.energy_kwh)
        self.put("runs", **points(places.values()), colour=list(colours.values()))
        frame = self.frame_over((start - room, end + room), (low, high))
        dots = [frame.dot(*place) for place in (*places.values(), own)]
        names = [Name(name, words.STRATEGY_WORDS[name], colours[name], point=places[name]) for name in others]
        self.put("names", **placed_names(frame, {"optimal": (times, energies)}, names, dots))
        self.put("point", **points([own]))
