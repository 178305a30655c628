"""What few orders cost: the energy above the optimum over how often the regime changes."""

from typing import TYPE_CHECKING, Any

from bokeh.events import Tap
from bokeh.models import SingleIntervalTicker

from railjoule.dashboard.charts.chart import add_zero, points
from railjoule.dashboard.charts.figures import LoneChart
from railjoule.dashboard.look import comparisons
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.pages.drive.simple_model import SimpleModel

if TYPE_CHECKING:
    from railjoule.core.studies.simple_advice import SimpleAdvice

BEFORE, BEYOND = 0.5, 0.95
"""What is shown beside the fewest and the most changes, beyond which stands a number; less than the next tick."""
ROOM_SHARE = 0.22
"""Of the dearest run, above it: for its number."""
LEAST_KWH = 0.05
"""Where every run is as good as the optimum, the axis must still have a height, with ticks of two decimals."""


class OrdersChart(LoneChart):
    """A dot for each number of changes, joined by steps; a click chooses one."""

    def __init__(self, height: int, model: SimpleModel, palette: Palette) -> None:
        super().__init__("orders", "Energy above the optimum, kWh, over changes of regime", height, palette)
        self.model = model

    def build(self) -> None:
        """Make the figure."""
        f = self.frame(ticks=4, digits=2, x_title="Changes of regime between two stops")
        f.xaxis[0].ticker = SingleIntervalTicker(interval=1, num_minor_ticks=0)
        add_zero(f, self.palette)
        self.glyphs("step", "runs", "x", "y", paint={"line_color": "ink3"}, mode="after", line_width=1.5)
        self.dots("runs", "ink3", size=9, line_width=1.5)
        self.dots("chosen", size=13, line_width=2)
        # above the step that begins at the dot: what leads to it comes from the left and from above
        self.signs("signs", "ink2", x_offset=8, y_offset=-4, text_baseline="bottom")
        f.on_event(Tap, self._press)

    def _press(self, event: Any) -> None:
        found = self.model.found
        if event.x is not None and found is not None:
            self.model.changes = min(found.runs, key=lambda changes: abs(changes - event.x))

    def draw(self, advice: "SimpleAdvice", prices_kwh: dict[int, float], chosen: int | None) -> None:
        """Draw what each number of changes costs [kWh], and mark the chosen one."""
        assert advice.optimum is not None
        optimum_kwh = advice.optimum.energy_kwh
        top = max(LEAST_KWH, *prices_kwh.values())
        low = min(0.0, *prices_kwh.values())
        self.set_ranges(
            (min(prices_kwh) - BEFORE, max(prices_kwh) + BEYOND),
            (low - 0.5 * ROOM_SHARE * top, top * (1 + ROOM_SHARE)),
        )
        self.put("runs", **points([*prices_kwh.items()]))
        marked = [(changes, price) for changes, price in prices_kwh.items() if changes == chosen]
        self.put("chosen", **points(marked))
        signs = [str(comparisons.above(optimum_kwh + price, optimum_kwh)) for price in prices_kwh.values()]
        self.put("signs", **points([*prices_kwh.items()]), text=signs)
