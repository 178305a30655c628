"""Charts that only Drive has: speeds with a train that plays, the price of force, and Bellman's law."""

from collections.abc import Callable, Mapping
from operator import methodcaller
from typing import Any

import numpy as np
from bokeh.models import LinearColorMapper, Span
from bokeh.palettes import interp_palette

from railjoule.core import Trajectory
from railjoule.core.arrays import FloatArray
from railjoule.core.strategies.bellman import ControlLaw
from railjoule.core.units import MS_PER_KMH
from railjoule.dashboard.charts.axis import Axis, xy
from railjoule.dashboard.charts.chart import no_grid, zero_line
from railjoule.dashboard.charts.quantities import POSITION, SPEED
from railjoule.dashboard.charts.run_charts import LineStrip
from railjoule.dashboard.charts.run_lines import Curve
from railjoule.dashboard.charts.scene import BORDERS, VARIANT, RunScene, SceneChart, draw_borders
from railjoule.dashboard.charts.speed import SpeedChart
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.words import MINUS

# pixels of the picture along the line and the speed
COLUMNS, ROWS = 180, 64
COLOURS = 21
"""From full braking over coasting to full effort."""
LOWEST, HIGHEST = -0.5, 2.5
"""Ends of the axis of the price [J/J]: next to a stop it grows without limit, elsewhere it stays near 0 to 1.5."""
TRAIN = "train"
"""The source of the train that assets/scripts/player.js moves."""


class DriveSpeedChart(SpeedChart):
    """Speeds, with a variant of the run, the train that plays, and a line that moves the begin of an instruction."""

    above = (
        methodcaller("line", VARIANT, "accent", line_width=1.6, line_dash=[7, 4]),
        *SpeedChart.above,
        methodcaller("dots", TRAIN, "surface", "accent", size=11, line_width=3),
    )

    def __init__(self, height: int, axis: Axis, palette: Palette) -> None:
        super().__init__(height, axis, palette)
        self.moved: Callable[[float], None] = lambda _: None
        """Called with the place where the line is dragged to."""
        self.switch: Span | None = None
        self.variant: dict[str, Curve] = {}

    def draw(self, scene: RunScene) -> None:
        """Draw limits, runs and names."""
        run = None if scene.variant is None else scene.variant[1]
        self.variant = {} if run is None else {VARIANT: (scene.x(run), self.values(run))}
        self.put(VARIANT, **xy(*self.variant.get(VARIANT, (np.empty(0), np.empty(0)))))
        super().draw(scene)

    def _draw_names(self, scene: RunScene, lines: Mapping[str, Curve]) -> None:
        super()._draw_names(scene, {**self.variant, **lines})

    def place_switch(self, place: float | None) -> None:
        """Put the line that is dragged at a place of the axis, or hide it."""
        if self.switch is None:
            if place is None or self.figure is None:
                return
            self.switch = Span(
                dimension="height", line_width=3, line_dash=[4, 4], hover_line_width=5, editable=True, name="switch"
            )
            self.palette.paint(self.switch, line_color="accent", hover_line_color="accent")
            self.figure.add_layout(self.switch)
            self.switch.on_change("location", lambda _name, _old, to: self.moved(float(to)))
        # a move by the server was not dragged
        moved, self.moved = self.moved, lambda _: None
        self.switch.update(visible=place is not None, location=place or 0.0)
        self.moved = moved


class TrackStrip(LineStrip):
    """The line, with the train that plays."""

    layers = (*LineStrip.layers, methodcaller("dots", TRAIN, "surface", "accent", size=9, line_width=3))


class PriceChart(SceneChart):
    """The energy from the supply that a joule of work at the wheels is worth at each place, which proves the bound."""

    called, unit, digits = ("price", "Price of force, J from the supply per J at the wheels"), "J/J", 2
    look: Mapping[str, Any] = {"ticks": 3}
    layers = (
        zero_line,
        BORDERS,
        methodcaller("line", "price", "accent", line_width=1.8),
        methodcaller("set_range", LOWEST, HIGHEST),
    )

    @staticmethod
    def is_known(run: Trajectory) -> bool:
        """Return whether one price along the whole line proves the bound of a run."""
        return run.bound is not None and run.bound.costate is not None

    def alternative(self, scene: RunScene) -> str:
        """Return a text alternative."""
        return "Price of force over distance: high where the train drives, low where it brakes."

    def draw(self, scene: RunScene) -> None:
        """Draw the price beside the phases of the chosen run."""
        costate = None if scene.run.bound is None else scene.run.bound.costate
        if costate is None:
            self.clear()
            return
        self.put("price", **xy(scene.x_of_place(costate.position_m), costate.force_price))
        self.follow_line("price")
        draw_borders(self, scene)


class LawChart(SceneChart):
    """Traction blue, braking warm, coasting neutral, empty where the end cannot be reached."""

    called = "law", f"Bellman\u2019s law at each speed, km/h: blue traction, warm braking ({MINUS}), pale coasting"
    kind, unit, digits = "map", "km/h", 1

    def build(self) -> None:
        """Make the figure."""
        self.frame(ticks=4)
        self.mapper = LinearColorMapper(palette=diverging(self.palette), low=-1, high=1, nan_color="rgba(0, 0, 0, 0)")
        no_grid(self)
        sides = ("image", "x", "y", "dw", "dh")
        self.glyphs("image", "map", *sides, paint={}, color_mapper=self.mapper, level="underlay")
        self.line("run", "ink", line_width=2)

    def draw(self, scene: RunScene, law: ControlLaw | None = None) -> None:
        """Draw the law and the run that follows it."""
        assert law is not None
        image, top = sampled(law)
        self.mapper.palette = diverging(self.palette)
        self.put(
            "map",
            image=[image],
            x=[float(law.position_m[0])],
            y=[0.0],
            dw=[float(law.position_m[-1] - law.position_m[0])],
            dh=[top / MS_PER_KMH],
        )
        run = scene.runs["bellman"]
        self.put("run", **xy(POSITION.values(run), SPEED.values(run)))
        self.set_cursor_sources("run")
        self.set_range(0, top / MS_PER_KMH)


def sampled(law: ControlLaw) -> tuple[FloatArray, float]:
    """Return the control on an even grid of shape (speeds, places), and the greatest speed [m/s]."""
    top = float(law.speed_ms.max())
    places = np.linspace(law.position_m[0], law.position_m[-1], COLUMNS, endpoint=False)
    # a pixel has the law at its middle
    places += 0.5 * (law.position_m[-1] - law.position_m[0]) / COLUMNS
    speeds = (np.arange(ROWS) + 0.5) * top / ROWS
    image = np.full((ROWS, COLUMNS), np.nan)
    cells = np.searchsorted(law.position_m, places, side="right") - 1
    for column, cell in enumerate(cells):
        # above the last speed of a cell there is no law: empty, and not that of the last speed
        image[:, column] = np.interp(speeds, law.speed_ms[cell], law.control[cell], right=np.nan)
    return image, top


def diverging(palette: Palette) -> tuple[str, ...]:
    """Return colours from full braking over coasting to full traction."""
    colours: tuple[str, ...] = interp_palette([palette.tokens[name] for name in ("driven", "coast", "accent")], COLOURS)
    return colours
