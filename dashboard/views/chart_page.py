"""What pages of charts share: heights that suit the window, drawing only what is in sight, the message of a failure."""

from collections.abc import Mapping

import panel as pn

from railjoule.core import RailjouleError
from railjoule.dashboard.browser import Browser
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.models.workbench import Workbench
from railjoule.dashboard.views import parts
from railjoule.dashboard.views.charts import Chart, bring_into_sight
from railjoule.dashboard.views.failures import failure_words

WIDE_PX, NARROW_PX = 1600, 900


class ChartPage:
    """A page of charts."""

    heights: Mapping[str, tuple[int, int, int]] = {}
    """Height of each chart [px]: in usual, wide and narrow windows."""

    def __init__(self, state: Workbench, browser: Browser, palette: Palette) -> None:
        self.state, self.browser, self.palette = state, browser, palette
        self.message = parts.html_pane(visible=False)

    @property
    def charts(self) -> tuple[Chart, ...]:
        """All charts of the page."""
        raise NotImplementedError

    def redraw(self) -> None:
        """Draw everything again, as after a change of theme."""
        raise NotImplementedError

    def settle(self) -> None:
        """Tell a shared cursor of charts that were built or drawn; to be called last within a batch."""

    def begin(self) -> None:
        """Follow the window, and draw; to be called once all charts are made."""
        self.browser.follow(["window_width"], self._fit)
        self.browser.follow(["charts_in_sight"], self._sight)
        self._fit()
        self._sight()
        self.redraw()

    def tell(self, failure: RailjouleError | None, shown: str) -> None:
        """Show why a wish could not be met, and what is shown instead; or nothing."""
        self.message.visible = failure is not None
        if failure is not None:
            self.message.object = parts.failure(*failure_words(failure), shown)

    def _fit(self) -> None:
        width = self.browser.window_width
        size = 1 if width >= WIDE_PX else 2 if width < NARROW_PX else 0
        with pn.io.hold():
            for chart in self.charts:
                chart.resize(self.heights[chart.name][size])

    def _sight(self) -> None:
        with pn.io.hold():
            bring_into_sight(self.charts, self.browser.charts_in_sight)
            self.settle()
