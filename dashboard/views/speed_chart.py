"""Speed of all runs under the limits."""

import numpy as np
from bokeh.models import ColumnDataSource
from bokeh.plotting import figure

from railjoule.core import Trajectory
from railjoule.core.arrays import FloatArray
from railjoule.core.motion.line_profile import limit_steps, section_borders
from railjoule.core.units import MS_PER_KMH
from railjoule.dashboard.look import words
from railjoule.dashboard.look.comparisons import OTHER_TIME_S
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.views.charts import Axis, clear, columns, text_style, xy
from railjoule.dashboard.views.label_places import Box, text_width_px
from railjoule.dashboard.views.line_names import Name
from railjoule.dashboard.views.scene import ACTUAL, RunChart, Scene, line_words

SIGN_PX = 11
HEADROOM = 1.16
FAR_ABOVE = 9e3


class SpeedChart(RunChart):
    """Speed of all runs under the limits."""

    unit, digits = "km/h", 1

    def __init__(self, height: int, axis: Axis, palette: Palette, lines: tuple[str, ...]) -> None:
        super().__init__("speed", "Speed, km/h", height, axis, palette)
        self.lines = lines
        self._limits: tuple[FloatArray, FloatArray] = np.zeros(0), np.zeros(0)

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
        signs = f.text("x", "y", "text", source=self.sources["signs"], x_offset=4, y_offset=-2, **text_style(SIGN_PX))
        self.palette.paint(signs.glyph, text_color="limit")
        for name in ("clock", "gradient", "fastest_speed"):
            self.sources[name] = ColumnDataSource({"x": [], "y": []})
        self.add_names()
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
        self._tell_cursor(scene)
        self.draw_borders(scene)
        self._draw_day(scene)
        self._draw_names(scene)

    def _tell_cursor(self, scene: Scene) -> None:
        """Let the cursor write when or where it stands, the limit, the gradient and the fastest run's speed too."""
        run, fastest, line = scene.run, scene.fastest, scene.run.scenario.line.in_running_order()
        other = run.position_m if scene.over_time else run.time_s
        gradients = np.array([section.gradient_permille for section in line.sections])
        self.sources["clock"].data = xy(scene.x(run), other)
        self.sources["gradient"].data = xy(
            np.repeat(scene.x_of_place(section_borders(line)), 2)[1:-1], np.repeat(gradients, 2)
        )
        clear(self.sources["fastest_speed"])
        if fastest is not None and scene.chosen != "fastest":
            self.sources["fastest_speed"].data = xy(scene.x(fastest), self.values(fastest))
        self.told["sources"] += [
            ["", self.sources["clock"], *(("m", 0) if scene.over_time else ("s", 1))],
            ["limit", self.sources["limit"], self.unit, 0],
            ["gradient", self.sources["gradient"], words.PER_MILLE, 1],
            ["fastest", self.sources["fastest_speed"]],
        ]

    def _draw_limits(self, scene: Scene) -> float:
        scenario = scene.run.scenario
        places, limits = limit_steps(scenario.line.in_running_order(), scenario.vehicle.traction.max_speed_kmh)
        x = scene.x_of_place(places)
        top = HEADROOM * max(float(np.max(limits)), *(run.max_speed_kmh for run in scene.named().values()))
        self.sources["forbidden"].data = columns(
            left=x[:-1], right=x[1:], bottom=limits, top=np.full(len(limits), FAR_ABOVE)
        )
        self.sources["limit"].data = xy(np.repeat(x, 2)[1:-1], np.repeat(limits, 2))
        self._limits = np.repeat(x, 2)[1:-1], np.repeat(limits, 2)
        texts = [f"limit {words.number(limit, 0)}" for limit in limits]
        frame = self.frame_over(self.axis.extent, (0.0, top))
        room = np.diff(frame.x_px(x))
        fits = np.array([text_width_px(text, SIGN_PX) + 8 < px for text, px in zip(texts, room, strict=True)])
        self.sources["signs"].data = {
            **xy(x[:-1][fits], limits[fits]),
            "text": [text for text, fit in zip(texts, fits, strict=True) if fit],
        }
        return top

    def _draw_names(self, scene: Scene) -> None:
        """Name the lines where nothing else is, the chosen one first."""
        named = scene.named()
        lines = {name: (scene.x(run), self.values(run)) for name, run in named.items()}
        taken = [*self._sign_boxes("signs", 2), *self._sign_boxes("stops", 5), *self._sign_boxes("late", 3)]
        names = [Name(name, line_words(name, scene), self.name_colour(name)) for name in reversed(named)]
        self.place_names({**lines, "limit": self._limits}, names, taken)

    def _sign_boxes(self, source: str, lift_px: float) -> list[Box]:
        """Return the boxes of the signs that are written from a source."""
        signs, frame = self.sources[source].data, self.frame_now
        return [
            frame.box(x, y, text, SIGN_PX, lift_px=lift_px)
            for x, y, text in zip(signs["x"], signs["y"], signs["text"], strict=True)
        ]
