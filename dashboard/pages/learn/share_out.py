"""The lesson on slack, as a part of the page: what the browser is told, and what it tells."""

from typing import Any

import param

from railjoule.core import RailjouleError
from railjoule.core.scenario import format_scenario
from railjoule.dashboard.editor.forms import Form
from railjoule.dashboard.look.scripts import module
from railjoule.dashboard.look.theme import played_css
from railjoule.dashboard.pages.learn.slack import read_sharing, scenario_of
from railjoule.dashboard.state.workbench import Workbench


class ShareOut(Form):
    """Seconds dragged between legs in the browser; the server tells the best sharing once it is asked for.

    Parameters
    ----------
    state : Workbench
    """

    lines = param.Dict(default={}, doc="The legs of each line with their tables.")
    begun = param.Dict(default={}, doc="The line and the seconds to begin with.")
    verdict = param.Dict(default={}, doc="How the last sharing compares with the best; empty before the first one.")
    refusals = param.Integer(default=0, doc="Counts the sharings that could not be judged.")

    _esm = module("share_out")

    def __init__(self, state: Workbench) -> None:
        super().__init__(self._take, stylesheets=[played_css()])
        self.state, self._shown, self._count = state, state.learn.slack, 0

    def show(self) -> None:
        """Show what the server has found."""
        found = self.state.learn.slack
        if found is None:
            return
        # counted, as the same sharing may be judged twice and the browser hears of what differs alone
        self._count += found is not self._shown
        self._shown = found
        verdict = {**found.verdict, "count": self._count} if found.verdict else {}
        self.param.update(lines=dict(found.lines), begun=dict(found.begun), verdict=verdict)

    def refuse(self) -> None:
        """Let a sharing be changed that could not be judged."""
        self.refusals += 1

    def _take(self, message: dict[str, Any]) -> None:
        sharing = str(message.get("sharing", ""))
        if message.get("what") == "open":
            try:
                text = format_scenario(scenario_of(*read_sharing(sharing)))
                self.state.scenario.open(text, "Share out the slack")
            except RailjouleError as error:
                self.state.learn.failure = error
                return
            self.state.page = "Line"
        elif message.get("what") == "done":
            self.state.learn.sharing = sharing
