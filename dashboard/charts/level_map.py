"""Values over two axes as bands of colour between levels, with a scale beside them: efficiencies of a motor."""

from collections.abc import Mapping, Sequence
from operator import methodcaller
from typing import Any

import numpy as np
from bokeh.models import ColorBar, ContourRenderer, FixedTicker, HoverTool, LinearColorMapper
from bokeh.plotting.contour import contour_data

from railjoule.core.arrays import FloatArray
from railjoule.core.studies.motor_map import MotorMap, OperatingPoints
from railjoule.dashboard.charts.axis import xy
from railjoule.dashboard.charts.chart import no_grid, zero_line
from railjoule.dashboard.charts.dress import point_tip
from railjoule.dashboard.charts.figures import LoneChart
from railjoule.dashboard.charts.surface import CIVIDIS
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.tokens import FONT

EFFICIENCIES = (0.5, 0.6, 0.7, 0.8, 0.85, 0.9, 0.92, 0.94, 0.95, 0.96, 0.97, 0.98)
"""Levels of an efficiency map, of which it has the MAX_LEVELS highest below its highest efficiency."""
MAX_LEVELS = 9
SCALE_PX = 8


class LevelMap(LoneChart):
    """Values over two axes as bands between levels; the scale shows each band equally high."""

    kind = "map"
    tip: tuple[tuple[str, str], ...] = ()
    """Words and formats of the value and of both axes under the mouse, as in `point_tip`."""

    def build(self) -> None:
        """Make the figure."""
        super().build()
        f = self.figure
        assert f is not None
        # invisible: the mouse and saved tables read the values here, as bands are no glyphs
        mapper, sides = LinearColorMapper(palette=CIVIDIS), ("image", "x", "y", "dw", "dh")
        cells = self.glyphs("image", "map", *sides, paint={}, color_mapper=mapper, global_alpha=0, level="underlay")
        f.add_tools(HoverTool(renderers=[cells], tooltips=point_tip(*self.tip), visible=False))
        self.scale = ColorBar(
            color_mapper=LinearColorMapper(low=0),
            ticker=FixedTicker(),
            width=SCALE_PX,
            padding=5,
            margin=6,
            background_fill_color=None,
            major_label_text_font=FONT,
            major_label_text_font_size="11px",
            major_tick_line_color=None,
        )
        self.palette.paint(self.scale, major_label_text_color="ink3")
        f.add_layout(self.scale, "right")
        self.bands: ContourRenderer | None = None
        self._drawn: FloatArray | None = None

    def draw_map(
        self, x: FloatArray, y: FloatArray, values: FloatArray, levels: Sequence[float], texts: Sequence[str]
    ) -> None:
        """Draw values over places of both axes, unless they are drawn already.

        Parameters
        ----------
        x, y : array of shape (m,), (n,)
        values : array of shape (n, m)
            NaN where there is nothing to draw.
        levels : sequence of float
            Ends of the bands, rising; the first and the last one lie beyond all values.
        texts : sequence of str
            The levels between the first and the last one, as the scale writes them.
        """
        # by identity, as a map never changes
        if values is self._drawn:
            return
        f, step_x, step_y = self.figure, float(x[1] - x[0]), float(y[1] - y[0])
        assert f is not None
        # a pixel stands around the place for which it was computed
        corner = {"x": [float(x[0]) - 0.5 * step_x], "y": [float(y[0]) - 0.5 * step_y]}
        size = {"dw": [float(np.ptp(x)) + step_x], "dh": [float(np.ptp(y)) + step_y]}
        self.put("map", image=[values.astype(np.float32)], **corner, **size)
        self.set_ranges((float(x[0]), float(x[-1])), (float(y[0]), float(y[-1])))
        count = len(levels) - 1
        colours = [CIVIDIS[round(k * (len(CIVIDIS) - 1) / max(count - 1, 1))] for k in range(count)]
        # with as many levels as before only the data change, which is far cheaper
        if self.bands is not None and len(self.bands.levels) == len(levels):
            self.bands.set_data(contour_data(x, y, values, levels))
        else:
            if self.bands is not None:
                f.renderers.remove(self.bands)
            look = {"fill_color": colours, "line_color": "#FFFFFF", "line_alpha": 0.35, "line_width": 0.8}
            self.bands = f.contour(x, y, values, levels, **look)
            self.bands.level = "underlay"
        self.scale.color_mapper.update(palette=colours, high=count)
        self.scale.update(
            ticker=FixedTicker(ticks=list(range(1, count))), major_label_overrides=dict(enumerate(texts, 1))
        )
        self._drawn = values


class MotorMapChart(LevelMap):
    """Efficiency over speed and torque of one motor, with the run's cells as points."""

    look: Mapping[str, Any] = {"ticks": 5, "x_title": "Speed, rad/s", "y_title": "Torque, N m"}
    layers = (no_grid, zero_line, methodcaller("dots", "points", "speed_limits", size=6, line_width=1))
    tip = (("Efficiency", "@image{0.0 %}"), ("Speed", "$x{0} rad/s"), ("Torque", "$y{0} N m"))

    def __init__(self, height: int, palette: Palette, name: str = "motor_map") -> None:
        caption = "Efficiency, %, over torque and speed of one motor; points: the run"
        super().__init__(name, caption, height, palette)

    def draw(self, found: MotorMap, whose: str, operated: OperatingPoints | None) -> None:
        """Draw the map of motor or drive, and where the run works."""
        efficiency = found.motor if whose == "motor" and found.motor is not None else found.drive
        inner = [level for level in EFFICIENCIES if level < np.nanmax(efficiency)][-MAX_LEVELS:]
        texts = [f"{100 * level:.0f}" for level in inner]
        self.draw_map(found.speed_rads, found.torque_nm, efficiency, [-1.0, *inner, 1.0 + 1e-9], texts)
        if operated is None:
            self.clear("points")
        else:
            self.put("points", **xy(operated.speed_rads, operated.torque_nm))
