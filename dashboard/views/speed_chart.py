"""Speed of all runs under the limits."""

import numpy as np
from bokeh.models import ColumnDataSource
from bokeh.plotting import figure

from railjoule.core import Trajectory
from railjoule.core.arrays import FloatArray
from railjoule.core.motion.line_profile import limit_steps
from railjoule.core.units import MS_PER_KMH
from railjoule.dashboard.look import words
from railjoule.dashboard.look.comparisons import OTHER_TIME_S
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.views.charts import Axis, clear, columns, text_style, xy
from railjoule.dashboard.views.scene import ACTUAL, PINNED, RunChart, Scene, line_words

LABEL_PLACES = np.linspace(0.12, 0.88, 20)
HEADROOM = 1.16
FAR_ABOVE = 9e3


class SpeedChart(RunChart):
    """Speed of all runs under the limits."""

    unit, digits = "km/h", 1

    def __init__(self, height: int, axis: Axis, palette: Palette, lines: tuple[str, ...]) -> None:
        super().__init__("speed", "Speed, km/h", height, axis, palette)
        self.lines = lines

    def build(self) -> None:
        """Make the figure."""
        self.make_sources()
        f = self.frame(ticks=5)
        self.sources["forbidden"] = ColumnDataSource({"left": [], "right": [], "bottom": [], "top": []})
        area = f.quad(
            "left", "right", "bottom", "top", source=self.sources["forbidden"], fill_alpha=0.55, line_color=None
        )
        self.palette.paint(area.glyph, fill_color="ground")
        self.sources["limit"] = ColumnDataSource({"x": [], "y": []})
        limit = f.line("x", "y", source=self.sources["limit"], line_width=1.2)
        self.palette.paint(limit.glyph, line_color="limit")
        self.add_borders()
        self.add_lines()
        self.sources["signs"] = ColumnDataSource({"x": [], "y": [], "text": []})
        signs = f.text("x", "y", "text", source=self.sources["signs"], x_offset=4, y_offset=-2, **text_style(11))
        self.palette.paint(signs.glyph, text_color="limit")
        self.sources["names"] = ColumnDataSource({"x": [], "y": [], "text": [], "colour": [], "offset": []})
        names = f.text(
            "x",
            "y",
            "text",
            text_color="colour",
            source=self.sources["names"],
            text_align="center",
            text_baseline="middle",
            y_offset="offset",
            background_fill_alpha=0.8,
            padding=1,
            **text_style(),
        )
        self.palette.paint(names.glyph, background_fill_color="surface")
        self._add_day(f)

    def _add_day(self, f: figure) -> None:
        """Add the signs of the actual run: its unplanned stops, and how late it arrives."""
        self.sources["stops"] = ColumnDataSource({"x": [], "y": [], "text": []})
        dots = f.scatter("x", "y", source=self.sources["stops"], size=7, line_color=None)
        self.palette.paint(dots.glyph, fill_color=ACTUAL)
        spans = f.vspan("x", source=self.sources["stops"], line_width=1, line_dash=[1, 3])
        self.palette.paint(spans.glyph, line_color="ink3")
        signs = f.text("x", "y", "text", source=self.sources["stops"], x_offset=7, y_offset=-5, **text_style(11))
        self.palette.paint(signs.glyph, text_color=ACTUAL)
        self.sources["late"] = ColumnDataSource({"x": [], "y": [], "text": []})
        late = f.text("x", "y", "text", source=self.sources["late"], x_offset=6, y_offset=-3, **text_style())
        self.palette.paint(late.glyph, text_color="overline")

    def _draw_day(self, scene: Scene) -> None:
        """Draw the signs of the actual run; on a narrow screen its lateness stands in the numbers alone."""
        stops, actual = scene.stops, scene.actual
        self.sources["stops"].data = {
            **xy(np.array([x for x, _ in stops]), np.zeros(len(stops))),
            "text": [f"stop, {words.number(lasts, 0)} s" for _, lasts in stops],
        }
        if actual is None or scene.narrow or actual.delay_s < OTHER_TIME_S:
            clear(self.sources["late"])
            return
        end = float(scene.x(actual.actual)[-1])
        self.sources["late"].data = {"x": [end], "y": [0.0], "text": [f"{words.time(actual.delay_s)} s late"]}

    def values(self, run: Trajectory) -> FloatArray:
        """Speed [km/h]."""
        return run.speed_ms / MS_PER_KMH

    def draw(self, scene: Scene) -> None:
        """Draw limits, runs and names."""
        top = self._draw_limits(scene)
        self.set_range(0, top)
        self.draw_lines(scene)
        self.draw_borders(scene)
        self._draw_names(scene, top)
        self._draw_day(scene)

    def _draw_limits(self, scene: Scene) -> float:
        scenario = scene.run.scenario
        places, limits = limit_steps(scenario.line.in_running_order(), scenario.vehicle.traction.max_speed_kmh)
        x = scene.x_of_place(places)
        top = HEADROOM * max(float(np.max(limits)), *(run.max_speed_kmh for run in scene.named().values()))
        self.sources["forbidden"].data = columns(
            left=x[:-1], right=x[1:], bottom=limits, top=np.full(len(limits), FAR_ABOVE)
        )
        self.sources["limit"].data = xy(np.repeat(x, 2)[1:-1], np.repeat(limits, 2))
        wide = np.diff(x) > 0.05 * scene.end
        self.sources["signs"].data = {
            **xy(x[:-1][wide], limits[wide]),
            "text": [f"limit {words.number(limit, 0)}" for limit in limits[wide]],
        }
        return top

    def _draw_names(self, scene: Scene, top: float) -> None:
        """Put each name where its line is farthest from the others."""
        named, names = scene.named(), []
        grid = LABEL_PLACES * scene.end
        curves = {name: np.interp(grid, scene.x(run), self.values(run)) for name, run in named.items()}
        taken: list[tuple[float, float]] = []
        for name in reversed(list(named)):
            below = curves[name] - 0.055 * top
            distance = np.full(len(grid), top)
            for other, curve in curves.items():
                if other != name:
                    distance = np.minimum(distance, np.abs(curve - below))
            for x, y in taken:
                near = np.abs(grid - x) < 0.14 * scene.end
                distance = np.where(near, np.minimum(distance, np.abs(below - y)), distance)
            distance = np.where(below < 0.06 * top, -1.0, distance)
            steepness = np.abs(np.gradient(curves[name], LABEL_PLACES))
            wish = np.minimum(distance, 0.12 * top) - 0.05 * np.minimum(steepness, 3 * top)
            k = int(np.argmax(wish - 1e-3 * np.abs(LABEL_PLACES - 0.4)))
            taken.append((float(grid[k]), float(below[k])))
            names.append((name, float(grid[k]), float(curves[name][k])))
        self.sources["names"].data = {
            "x": [x for _, x, _ in names],
            "y": [y for _, _, y in names],
            "text": [line_words(name, scene) for name, _, _ in names],
            "colour": [self.palette.tokens["ink3" if name == PINNED else name] for name, _, _ in names],
            "offset": [13] * len(names),
        }
