"""The line as it can be dragged in the editor: its heights, and its speed limits."""

from collections.abc import Callable, Mapping
from typing import Any, ClassVar

import numpy as np

from railjoule.core.motion.line_profile import height_profile, section_borders
from railjoule.core.scenario import Line
from railjoule.dashboard.charts.axis import Axis
from railjoule.dashboard.charts.dress import dragged
from railjoule.dashboard.charts.figures import DistanceChart
from railjoule.dashboard.charts.track import add_steps, draw_steps
from railjoule.dashboard.look.paint import Palette

# the bound of `gradient_permille` in core/scenario/line.py
STEEPEST_PERMILLE = 200.0
MIN_SECTION_M = 1.0
"""No border can be dragged closer to the next one."""
# a limit of the file is above 0, and limits are dragged in whole km/h
MIN_LIMIT_KMH = 1.0
ROOM_SHARE, LEAST_RELIEF = 0.35, 0.01
"""Room above and below the line as a share of its relief, which counts as at least this share of its length."""
# over the highest limit: a limit can be dragged this much higher in one go
LIMIT_ROOM = 1.15


class DraggedChart(DistanceChart):
    """A chart of the line in which something can be dragged.

    Parameters
    ----------
    height, axis, palette
        As for every chart.
    drop : callable
        Called with the columns of all that can be dragged, once something has been.
    """

    name_and_caption: ClassVar[tuple[str, str]]
    """Its name and its caption."""
    columns: ClassVar[tuple[str, ...]]

    def __init__(self, height: int, axis: Axis, palette: Palette, drop: Callable[..., None]) -> None:
        super().__init__(*self.name_and_caption, height, axis, palette)
        self._drop = drop

    def _take(self, _attribute: str, _old: Any, new: Mapping[str, Any]) -> None:
        if len(new[self.columns[0]]):
            self._drop(*([float(value) for value in new[name]] for name in self.columns))


class ProfileChart(DraggedChart):
    """Heights of the line, with borders of sections that can be dragged; `drop` takes distances and heights [m]."""

    unit = "m"
    name_and_caption = ("edit_profile", "Height, m: drag a boundary between sections")
    columns = ("x", "y")

    def build(self) -> None:
        """Make the figure."""
        f = self.frame(zoom=False, ticks=3, digits=0)
        nodes, sign = self.source("nodes", "x", "y", "base"), self.source("sign", "x", "y", "text")
        self.glyphs("varea", "nodes", "x", "base", "y", paint={"fill_color": "ground"})
        self.line("nodes", "groundline", line_width=1.6)
        self.dots("nodes", "surface", "accent", size=10, line_width=2)
        self.grounded_signs("sign", "ink", text_align="center", y_offset=-12, padding=2)
        # only the browser moves a dragged item, and only its final place is sent here
        dropped = self.source("dropped", *self.columns)
        dropped.on_change("data", self._take)
        bounds: dict[str, Any] = {"shortest": MIN_SECTION_M, "steepest": STEEPEST_PERMILLE}
        dragged(f, "drag_heights", nodes=nodes, sign=sign, dropped=dropped, **bounds)

    def draw(self, line: Line) -> None:
        """Draw the line as its file describes it, not as it is run; heights count from where the run starts."""
        x, y = section_borders(line), height_profile(line)
        if line.reverse:
            y = y - y[-1]
        relief = max(float(np.ptp(y)), LEAST_RELIEF * float(x[-1]))
        low, high = float(y.min()) - ROOM_SHARE * relief, float(y.max()) + ROOM_SHARE * relief
        self.set_range(low, high)
        # not by `put`: the browser has moved these nodes unseen, and must be sent them even if they stand here
        self.sources["nodes"].data = {"x": x.tolist(), "y": y.tolist(), "base": [low - relief] * len(x)}


class LimitStepsChart(DraggedChart):
    """Speed limits of the line: those of sections can be dragged up and down, others by their ends too.

    `drop` takes beginnings and ends [m] and limits [km/h] of all steps.
    """

    unit = "km/h"
    name_and_caption = ("edit_limits", "Speed limits, km/h: drag a limit or its ends")
    columns = ("left", "right", "limit")

    def build(self) -> None:
        """Make the figure."""
        self.frame(zoom=False, ticks=3, x_title="Distance, m")
        # `most` and `end` are set with each drawing; limits are dragged in whole km/h
        bounds = {"least": MIN_LIMIT_KMH, "most": 600.0, "end": 1.0, "per": 1, "shortest": MIN_SECTION_M}
        moved, self._drag = add_steps(self, "limit", shared=False, live=False, **bounds)
        moved.on_change("data", self._take)

    def draw(self, line: Line, max_kmh: float) -> None:
        """Draw the limits of sections, then the others, as the line's file describes them."""
        borders = section_borders(line).tolist()
        # a section's limit ends with it
        steps = [
            (start, end, section.speed_limit_kmh, False)
            for start, end, section in zip(borders[:-1], borders[1:], line.sections, strict=True)
            if section.speed_limit_kmh is not None
        ]
        steps += [(limit.from_m, limit.to_m, limit.limit_kmh, True) for limit in line.speed_limits]
        top = LIMIT_ROOM * max([max_kmh, *(limit for _, _, limit, _ in steps)])
        self.set_range(0, top)
        self._drag.args = {**self._drag.args, "most": float(np.floor(top)), "end": borders[-1]}
        draw_steps(self, steps)
