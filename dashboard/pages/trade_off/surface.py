"""ENOC's energy as a surface that can be turned."""

from typing import Any

import numpy as np
import panel as pn

from railjoule.dashboard.charts.chart import Chart
from railjoule.dashboard.charts.surface import (
    CIVIDIS,
    LIGHTING,
    NARROW_DISTANCE,
    NARROW_PX,
    TALLEST,
    Scene,
    round_step,
    scene_layout,
)
from railjoule.dashboard.look import words
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.tokens import FONT
from railjoule.dashboard.pages.trade_off.compute import EnocMap, EnocPoint, Points, TradeOff
from railjoule.dashboard.parts import html as parts

POINT_LIFT = 0.012
"""Points and valley float this share of the height above the surface, or it would hide them."""


class SurfacePane(Chart):
    """The surface with its valley, the present point and the printed ones."""

    kind = "map"

    def __init__(self, height: int, palette: Palette) -> None:
        super().__init__("surface", "ENOC: energy, kWh, as a surface (drag to turn)", height)
        self.palette = palette
        self.scene: Scene | None = None

    def build(self) -> None:
        """Make the pane."""
        self.scene = Scene(self.height, self.caption)
        style = f"font:12px {FONT};color:var(--rj-ink2);padding:2px 0 0 6px"
        title = parts.markup('<div style="{1}">{0}</div>', self.caption, style)
        # as plain text: the library escapes what it sends, and pieces of HTML would refuse
        self.content = parts.stack(pn.pane.HTML(str(title), margin=0, css_classes=["rj-caption"]), self.scene)
        self.figure = self.scene

    def draw(self, trade_off: TradeOff, now: EnocPoint | None) -> None:
        """Draw the surface, its valley, the present run and the printed ones."""
        enoc_map = trade_off.enoc_map
        if self.scene is None or enoc_map is None:
            return
        printed = trade_off.printed_points(everywhere=True)
        present = [(now.travel_time_s, now.acceleration_time_s, now.energy_kwh)] if now is not None else []
        bottom = float(np.nanmin(enoc_map.energy_kwh))
        top = min(float(np.nanmax(enoc_map.energy_kwh)), TALLEST * bottom)
        self.scene.draw(
            [
                self._surface(enoc_map, bottom, top),
                self._valley(enoc_map, bottom, top),
                # above the cut it would float in the air
                self._points(
                    [point for point in present if point[2] < top], "present run", "accent", "circle", top - bottom
                ),
                self._printed(enoc_map, printed, bottom, top),
            ],
            scene_layout(self.palette, ("Travel time, s", "Acceleration time, s"), bottom, top, self.camera_distance),
        )

    @property
    def camera_distance(self) -> float:
        """How far away the camera stands, that the titles of the axes lie within narrow places too."""
        return NARROW_DISTANCE if self.width_px < NARROW_PX else 1.0

    def _surface(self, enoc_map: EnocMap, bottom: float, top: float) -> dict[str, Any]:
        heights = np.where(enoc_map.energy_kwh > top, np.nan, enoc_map.energy_kwh)
        step = round_step((top - bottom) / 10)
        return {
            "type": "surface",
            "x": enoc_map.travel_time_s,
            "y": enoc_map.acceleration_time_s,
            "z": heights,
            "colorscale": [[k / (len(CIVIDIS) - 1), colour] for k, colour in enumerate(CIVIDIS)],
            "showscale": False,
            "cmin": bottom,
            "cmax": top,
            "lighting": LIGHTING,
            "contours": {
                "z": {
                    "show": True,
                    "start": float(step * np.ceil(bottom / step)),
                    "end": top,
                    "size": step,
                    "color": "rgba(255,255,255,0.45)",
                    "width": 1,
                }
            },
            "hovertemplate": "%{x:.0f} s, %{y:.0f} s: %{z:.3f} kWh<extra></extra>",
        }

    def _valley(self, enoc_map: EnocMap, bottom: float, top: float) -> dict[str, Any]:
        shown = enoc_map.best_energy_kwh < top
        lift = POINT_LIFT * (top - bottom)
        return {
            "type": "scatter3d",
            "mode": "lines",
            "x": enoc_map.travel_time_s[shown],
            "y": enoc_map.best_acceleration_s[shown],
            "z": enoc_map.best_energy_kwh[shown] + lift,
            "line": {"color": "#FFFFFF", "width": 6},
            "hoverinfo": "skip",
        }

    def _printed(self, enoc_map: EnocMap, printed: Points, bottom: float, top: float) -> dict[str, Any]:
        time, ramp, energy = printed
        inside = (time >= enoc_map.travel_time_s[0]) & (time <= enoc_map.travel_time_s[-1])
        inside &= (
            (ramp >= enoc_map.acceleration_time_s[0]) & (ramp <= enoc_map.acceleration_time_s[-1]) & (energy < top)
        )
        points = list(zip(time[inside], ramp[inside], energy[inside], strict=True))
        return self._points(points, "printed", "enoc", "diamond", top - bottom)

    def _points(self, points: list[Any], name: str, token: str, symbol: str, height: float) -> dict[str, Any]:
        return {
            "type": "scatter3d",
            "mode": "markers",
            "x": [point[0] for point in points],
            "y": [point[1] for point in points],
            "z": [point[2] + POINT_LIFT * height for point in points],
            # not z, which is lifted above the surface
            "customdata": [words.energy(point[2]) for point in points],
            "marker": {
                "size": 7,
                "symbol": symbol,
                "color": self.palette.tokens[token],
                "line": {"color": "#FFFFFF", "width": 2},
            },
            "hovertemplate": name + ": %{x:.1f} s, %{y:.1f} s: %{customdata} kWh<extra></extra>",
        }
