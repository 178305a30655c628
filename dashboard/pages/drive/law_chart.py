"""What dynamic programming would do at any speed and place, with the run on it."""

import numpy as np
from bokeh.models import LinearColorMapper

from railjoule.core.arrays import FloatArray
from railjoule.core.strategies.bellman import ControlLaw
from railjoule.core.units import MS_PER_KMH
from railjoule.dashboard.charts.chart import Axis, DistanceChart, xy
from railjoule.dashboard.charts.quantities import POSITION, SPEED
from railjoule.dashboard.charts.scene import RunScene
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.words import MINUS

# pixels of the picture along the line and the speed
COLUMNS, ROWS = 180, 64
STEPS = 10
"""Colours from coasting to full effort, each way."""


class LawChart(DistanceChart):
    """Traction blue, braking warm, coasting neutral, empty where the end cannot be reached."""

    kind = "map"
    unit, digits = "km/h", 1

    def __init__(self, height: int, axis: Axis, palette: Palette) -> None:
        words = f"Bellman\u2019s law at each speed, km/h: blue traction, warm braking ({MINUS}), pale coasting"
        super().__init__("law", words, height, axis, palette)

    def build(self) -> None:
        """Make the figure."""
        f = self.frame(ticks=4)
        f.ygrid.visible = False
        self.mapper = LinearColorMapper(palette=diverging(self.palette), low=-1, high=1, nan_color="rgba(0, 0, 0, 0)")
        sides = ("image", "x", "y", "dw", "dh")
        self.glyphs("image", "map", *sides, paint={}, color_mapper=self.mapper, level="underlay")
        self.line("run", "ink", line_width=2)

    def draw(self, scene: RunScene, law: ControlLaw) -> None:
        """Draw the law and the run that follows it."""
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
        self.told["sources"] = [["run", self.sources["run"], "x", "y"]]
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


def diverging(palette: Palette) -> list[str]:
    """Return colours from full braking over coasting to full traction."""
    brake, coast, traction = (rgb(palette.tokens[name]) for name in ("driven", "coast", "accent"))
    shares = np.linspace(1, 0, STEPS, endpoint=False)
    warm = [coast + share * (brake - coast) for share in shares]
    cold = [coast + share * (traction - coast) for share in shares[::-1]]
    return ["#" + "".join(f"{round(part):02X}" for part in colour) for colour in (*warm, coast, *cold)]


def rgb(colour: str) -> FloatArray:
    """Return red, green and blue of a colour such as #0B5BD3, 0 to 255."""
    return np.array([int(colour[k : k + 2], 16) for k in (1, 3, 5)], dtype=float)
