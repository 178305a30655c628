"""Efficiency of a motor over speed and torque, with the points of a run."""

import numpy as np
from bokeh.models import ContourRenderer, LinearColorMapper
from bokeh.plotting.contour import contour_data

from railjoule.core.arrays import FloatArray
from railjoule.core.studies.motor_map import MotorMap, OperatingPoints
from railjoule.dashboard.charts.axis import xy
from railjoule.dashboard.charts.dress import add_zero, ink_on
from railjoule.dashboard.charts.figures import LoneChart
from railjoule.dashboard.charts.surface import CIVIDIS
from railjoule.dashboard.look import words
from railjoule.dashboard.look.paint import Palette

POOR = 0.8
"""Efficiencies below this share the darkest colour."""
LEVELS = (0.8, 0.85, 0.9, 0.92, 0.94, 0.95, 0.96, 0.97, 0.98)
LABEL_PLACE = 0.6
"""Share of the speeds at which levels bear their numbers."""
# of the torques shown: numbers of levels that lie closer would overlap
NEAR_NM_SHARE = 0.06


class MotorMapChart(LoneChart):
    """Efficiency over speed and torque of one motor, with the run's cells as points."""

    kind = "map"

    def __init__(self, height: int, palette: Palette, name: str = "motor_map") -> None:
        caption = "Efficiency, %, over torque and speed of one motor; points: the run"
        super().__init__(name, caption, height, palette)
        self._drawn: FloatArray | None = None

    def build(self) -> None:
        """Make the figure."""
        f = self.frame(ticks=5, x_title="Speed, rad/s", y_title="Torque, N m")
        f.ygrid.visible = False
        self.mapper = LinearColorMapper(palette=list(CIVIDIS), low=POOR, high=1, nan_color="rgba(0, 0, 0, 0)")
        sides = ("image", "x", "y", "dw", "dh")
        self.glyphs("image", "map", *sides, paint={}, color_mapper=self.mapper, level="underlay")
        self.levels: ContourRenderer | None = None
        add_zero(f, self.palette)
        self.dots("points", "speed_limits", size=6, line_width=1)
        self.coloured_signs("signs", text_align="center", text_baseline="middle")
        self._drawn = None

    def draw(self, found: MotorMap, whose: str, operated: OperatingPoints | None) -> None:
        """Draw the map of motor or drive, and where the run works."""
        efficiency = found.motor if whose == "motor" and found.motor is not None else found.drive
        # by identity, as a map never changes: another run moves only its points
        if efficiency is not self._drawn:
            self._drawn = efficiency
            self._draw_map(found, efficiency)
        if operated is None:
            self.clear("points")
        else:
            self.put("points", **xy(operated.speed_rads, operated.torque_nm))

    def _draw_map(self, found: MotorMap, efficiency: FloatArray) -> None:
        f = self.figure
        assert f is not None
        speed, torque = found.speed_rads, found.torque_nm
        best = float(np.nanmax(efficiency))
        self.mapper.high = best
        step_x, step_y = speed[1] - speed[0], torque[1] - torque[0]
        # a pixel stands around the place for which it was computed
        self.put(
            "map",
            image=[efficiency.astype(np.float32)],
            x=[float(speed[0] - 0.5 * step_x)],
            y=[float(torque[0] - 0.5 * step_y)],
            dw=[float(speed[-1] - speed[0] + step_x)],
            dh=[float(torque[-1] - torque[0] + step_y)],
        )
        self.set_ranges((float(speed[0]), float(speed[-1])), (float(torque[0]), float(torque[-1])))
        if self.levels is None:
            self.levels = f.contour(speed, torque, efficiency, list(LEVELS), line_color="#FFFFFF", line_alpha=0.5)
        else:
            self.levels.set_data(contour_data(speed, torque, efficiency, list(LEVELS), want_fill=False))
        self._sign_levels(found, efficiency, best)

    def _sign_levels(self, found: MotorMap, efficiency: FloatArray, best: float) -> None:
        """Write each level where its line crosses one speed, with room between them."""
        column = int(LABEL_PLACE * (len(found.speed_rads) - 1))
        along, torque = efficiency[:, column], found.torque_nm
        taken: list[float] = []
        signs: dict[str, list[object]] = {"x": [], "y": [], "text": [], "colour": []}
        # where they would touch, the higher one is written
        for level in reversed(LEVELS):
            for k in np.flatnonzero(np.diff(np.sign(along - level)) != 0):
                # the border of what the motors can do is no crossing
                if not np.isfinite(along[k : k + 2]).all():
                    continue
                place = float(torque[k])
                if any(abs(place - other) < NEAR_NM_SHARE * np.ptp(torque) for other in taken):
                    continue
                taken.append(place)
                share = np.clip((level - POOR) / max(best - POOR, 1e-9), 0, 1)
                signs["x"].append(float(found.speed_rads[column]))
                signs["y"].append(place)
                signs["text"].append(words.number(100 * level, 0))
                signs["colour"].append(ink_on(CIVIDIS[round(share * (len(CIVIDIS) - 1))]))
        self.put("signs", **signs)
