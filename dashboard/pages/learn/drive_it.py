"""The lesson that is driven, as a part of the page: what the browser is told, and what it tells."""

from typing import Any

import param

from railjoule.core import load_scenario
from railjoule.dashboard.editor.forms import Form
from railjoule.dashboard.look.scripts import module
from railjoule.dashboard.look.theme import played_css
from railjoule.dashboard.pages.learn.by_hand import PRESET
from railjoule.dashboard.state.workbench import Workbench


class DriveIt(Form):
    """Power, coast and brake in the browser; the server judges a try once it has arrived.

    Parameters
    ----------
    state : Workbench
    """

    timetable_s = param.Number(default=0.0, doc="Travel time of the timetable [s].")
    length_km = param.Number(default=0.0, doc="Length of the line [km].")
    course = param.Dict(default={}, doc="What the train obeys.")
    verdict = param.Dict(default={}, doc="How the last try compares with the optimum; empty before the first one.")
    driven = param.String(default="", doc="Commands of a run that may be replayed.")
    refusals = param.Integer(default=0, doc="Counts the tries that could not be judged.")

    _esm = module("drive_it")

    def __init__(self, state: Workbench) -> None:
        scenario = load_scenario(PRESET)
        super().__init__(
            self._take,
            stylesheets=[played_css()],
            timetable_s=scenario.travel_time_s,
            length_km=scenario.line.length_m / 1000,
        )
        self.state, self._shown, self._count = state, state.learn.tried, 0

    def show(self) -> None:
        """Show what the server has found."""
        tried, driven = self.state.learn.tried, self.state.learn.driven
        if tried is None:
            return
        # counted, as two tries may be alike and the browser hears of what differs alone
        self._count += tried is not self._shown
        self._shown = tried
        verdict = {**tried.verdict, "count": self._count} if tried.verdict else {}
        self.param.update(course=dict(tried.course), verdict=verdict, driven=driven)

    def refuse(self) -> None:
        """Let a try begin anew that could not be judged."""
        self.refusals += 1

    def _take(self, message: dict[str, Any]) -> None:
        if message.get("what") == "open":
            self.state.scenario.choose(PRESET)
            self.state.page = "Drive"
        elif message.get("what") == "done":
            self.state.learn.finished = str(message.get("commands", ""))
