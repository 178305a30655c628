"""The lesson on slack, as a part of the page: what the browser is told, and what it tells."""

from typing import Any

import param

from railjoule.dashboard.look.scripts import module
from railjoule.dashboard.pages.learn.played_form import PlayedForm
from railjoule.dashboard.pages.learn.slack import SlackResult, read_sharing, scenario_of


class ShareOut(PlayedForm):
    """Seconds dragged between legs in the browser; the server tells the best sharing once it is asked for."""

    lines = param.Dict(default={}, doc="The legs of each line with their tables.")
    begun = param.Dict(default={}, doc="The line and the seconds to begin with.")

    _esm = module("share_out")
    result = "slack"

    def shown(self, found: SlackResult) -> dict[str, Any]:
        """Return the lines, and the sharing to begin with."""
        return {"lines": dict(found.lines), "begun": dict(found.begun)}

    def _take(self, message: dict[str, Any]) -> None:
        sharing = str(message.get("sharing", ""))
        if message.get("what") == "open":
            self.open_in_workbench(lambda: scenario_of(*read_sharing(sharing)), "Share out the slack", "Line")
        elif message.get("what") == "done":
            self.state.learn.sharing = sharing
