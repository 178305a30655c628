"""The price of force along the line, which proves the bound of a run."""

from railjoule.core import Trajectory
from railjoule.dashboard.charts.chart import Axis, add_zero, xy
from railjoule.dashboard.charts.scene import RunScene, SceneChart, draw_borders
from railjoule.dashboard.look.paint import Palette

LOWEST, HIGHEST = -0.5, 2.5
"""Ends of the axis [J/J]: next to a stop the price grows without limit, elsewhere it stays near 0 to 1.5."""


class PriceChart(SceneChart):
    """The energy from the supply that a joule of work at the wheels is worth, at each place."""

    unit, digits = "J/J", 2

    def __init__(self, height: int, axis: Axis, palette: Palette) -> None:
        words = "Price of force, J from the supply per J at the wheels"
        super().__init__("price", words, height, axis, palette)

    @staticmethod
    def is_known(run: Trajectory) -> bool:
        """Return whether one price along the whole line proves the bound of a run."""
        return run.bound is not None and run.bound.costate is not None

    def build(self) -> None:
        """Make the figure."""
        f = self.frame(ticks=3, digits=0)
        add_zero(f, self.palette)
        self.hairlines("borders", "line2", line_alpha=0.55, level="underlay")
        self.line("price", "accent", line_width=1.8)
        self.set_range(LOWEST, HIGHEST)

    def alternative(self, scene: RunScene) -> str:
        """Return a text alternative."""
        return "Price of force over distance: high where the train drives, low where it brakes."

    def draw(self, scene: RunScene) -> None:
        """Draw the price beside the phases of the chosen run."""
        bound = scene.run.bound
        if bound is None or bound.costate is None:
            self.clear()
            return
        costate = bound.costate
        self.put("price", **xy(scene.x_of_place(costate.position_m), costate.force_price))
        self.follow_line("price")
        draw_borders(self, scene)
