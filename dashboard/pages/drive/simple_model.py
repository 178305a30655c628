"""The state of the simple advice on Drive: what was asked for, what came of it, which of its runs is chosen."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import param

from railjoule.core import Scenario
from railjoule.dashboard.state.page_model import PageModel, result
from railjoule.dashboard.work.simple_advice import by_changes

if TYPE_CHECKING:
    from collections.abc import Mapping

    from railjoule.core.studies.simple_advice import SimpleAdvice, SimpleRun


@dataclass(frozen=True, eq=False)
class SimpleOrders:
    """Simple advice, and the scenario that it is for."""

    scenario: Scenario
    advice: "SimpleAdvice"

    @property
    def runs(self) -> "Mapping[int, SimpleRun]":
        """The runs by how often they change the regime, the fewest changes first."""
        return by_changes(self.advice)


class SimpleModel(PageModel):
    """The simple advice of one page, which is computed only when it is asked for."""

    open = param.Boolean(default=False, doc="Whether it is in sight.")
    ask = param.Event(doc="The user asks for it.")
    computing = param.Boolean(default=False, doc="Whether it is under way.")
    found = result(SimpleOrders, "The last one.")
    stale = param.Boolean(default=False, doc="Whether that is of the scenario before the last change.")
    changes = param.Integer(default=None, allow_None=True, doc="Changes of regime of the run whose orders are shown.")

    @property
    def chosen(self) -> "SimpleRun | None":
        """The run whose orders are shown."""
        return None if self.found is None or self.changes is None else self.found.runs.get(self.changes)
