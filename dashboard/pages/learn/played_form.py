"""What the lessons that are played share: how they stand on the page, and how they learn what the server has found."""

from collections.abc import Callable
from typing import Any

import param

from railjoule.core import RailjouleError, Scenario
from railjoule.core.scenario import format_scenario
from railjoule.dashboard.editor.forms import Form
from railjoule.dashboard.look.theme import played_css
from railjoule.dashboard.state.workbench import Workbench


class PlayedForm(Form):
    """A lesson that is played in the browser, and judged by the server.

    Parameters
    ----------
    state : Workbench
    params
        What does not change.
    """

    verdict = param.Dict(default={}, doc="How what was done last compares with the best; empty before the first time.")
    refusals = param.Integer(default=0, doc="Counts what could not be judged.")

    result = ""
    """Which value of the page's model holds what the server has found."""

    def __init__(self, state: Workbench, **params: Any) -> None:
        super().__init__(self._take, stylesheets=[played_css()], **params)
        self.state, self._count = state, 0
        self._shown = self._found

    @property
    def _found(self) -> Any:
        return getattr(self.state.learn, self.result)

    def show(self) -> None:
        """Show what the server has found."""
        found = self._found
        if found is None:
            return
        # counted, as the same may be judged twice and the browser hears of what differs alone
        self._count += found is not self._shown
        self._shown = found
        verdict = {**found.verdict, "count": self._count} if found.verdict else {}
        self.param.update(verdict=verdict, **self.shown(found))

    def shown(self, found: Any) -> dict[str, Any]:
        """Return what the browser is told beside the verdict."""
        raise NotImplementedError

    def refuse(self) -> None:
        """Let go on with what could not be judged."""
        self.refusals += 1

    def open_in_workbench(self, make: Callable[[], Scenario], title: str, page: str) -> None:
        """Open a scenario as a file on a page, or tell why there is none."""
        try:
            self.state.scenario.open(format_scenario(make()), title)
        except RailjouleError as error:
            self.state.learn.failure = error
            return
        self.state.page = page

    def _take(self, message: dict[str, Any]) -> None:
        raise NotImplementedError
