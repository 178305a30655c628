"""The lesson that is drawn, as a part of the page: what the browser is told, and what it tells."""

from typing import Any

import param

from railjoule.core import RailjouleError
from railjoule.core.scenario import format_scenario
from railjoule.dashboard.editor.forms import Form
from railjoule.dashboard.look.scripts import module
from railjoule.dashboard.look.theme import played_css
from railjoule.dashboard.pages.learn.drawing import LEAST_KMH, MOST_KMH, in_time_of, read_drawing, run_of
from railjoule.dashboard.state.workbench import Workbench


class DrawSpeed(Form):
    """A speed drawn over the distance in the browser; the server tells the best run in the time that it takes.

    Parameters
    ----------
    state : Workbench
    """

    course = param.Dict(default={}, doc="What the train obeys.")
    shortest_s = param.Number(default=0.0, doc="Shortest possible time [s].")
    begun = param.List(default=[], doc="The drawing to begin with [km/h].")
    linked = param.Boolean(default=False, doc="Whether that drawing is one of a link.")
    ends_kmh = param.List(default=[LEAST_KMH, MOST_KMH], doc="The least and the greatest speed that can be drawn.")
    verdict = param.Dict(default={}, doc="How the last drawing compares with the best; empty before the first one.")
    refusals = param.Integer(default=0, doc="Counts the drawings that could not be judged.")

    _esm = module("draw_speed")

    def __init__(self, state: Workbench) -> None:
        super().__init__(self._take, stylesheets=[played_css()])
        self.state, self._shown, self._count = state, state.learn.drawing, 0

    def show(self) -> None:
        """Show what the server has found."""
        found = self.state.learn.drawing
        if found is None:
            return
        # counted, as the same drawing may be judged twice and the browser hears of what differs alone
        self._count += found is not self._shown
        self._shown = found
        verdict = {**found.verdict, "count": self._count} if found.verdict else {}
        self.param.update(
            course=dict(found.course),
            shortest_s=found.shortest_s,
            begun=list(found.begun),
            linked=bool(found.request.begun),
            verdict=verdict,
        )

    def refuse(self) -> None:
        """Let a drawing be changed that could not be judged."""
        self.refusals += 1

    def _take(self, message: dict[str, Any]) -> None:
        drawn = str(message.get("drawn", ""))
        if message.get("what") == "open":
            try:
                # as a file: an edit of the time would be rounded to what its slider shows
                text = format_scenario(in_time_of(run_of(read_drawing(drawn))))
                self.state.scenario.open(text, "Draw the speed")
            except RailjouleError as error:
                self.state.learn.failure = error
                return
            self.state.page = "Drive"
        elif message.get("what") == "done":
            self.state.learn.sketched = drawn
