"""The work behind the page Papers: one study at a time, table by table."""

from typing import Any

from railjoule.core import RailjouleError
from railjoule.dashboard.models.workbench import Workbench
from railjoule.dashboard.store import PaperTables, Study, compute_papers


class Papers:
    """Compares papers when it is asked to, and stops when it is told."""

    def __init__(self, state: Workbench) -> None:
        self.model = state.papers
        self.study = Study(compute_papers, self._take, self._take_failure)
        self.model.param.watch(self._ask, "compare")
        self.model.param.watch(self._stop, "stop")

    def end(self) -> None:
        """End what still runs: the page is gone."""
        self.study.stop()

    def _ask(self, event: Any) -> None:
        if event.new:
            self.model.param.update(asked=event.new, compare=[], failure=None)
            self.study.ask(tuple(event.new))

    def _stop(self, *_: Any) -> None:
        self.study.stop()
        self.model.asked = []

    def _take(self, results: dict[str, PaperTables], last: bool) -> None:
        self.model.results = {**self.model.results, **results}
        if last:
            self.model.asked = []

    def _take_failure(self, failure: RailjouleError) -> None:
        self.model.param.update(failure=failure, asked=[])
