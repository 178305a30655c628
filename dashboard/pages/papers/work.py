"""The work behind the page Papers: what was computed for this release is shown; other code computes it when asked."""

from collections.abc import Mapping
from typing import Any, ClassVar

from railjoule.core.validation import COMPARISONS
from railjoule.core.validation.table import FigureData
from railjoule.dashboard.pages.papers.compute import PaperTables, compute_figures, compute_papers, shipped_tables
from railjoule.dashboard.pages.papers.model import PapersModel
from railjoule.dashboard.state.page_work import PageWork
from railjoule.dashboard.state.workbench import Workbench


class Papers(PageWork[PapersModel]):
    """Shows what is shipped; compares papers when it is asked to or the code is another, and stops when it is told."""

    page = "Papers"
    at_rest: ClassVar[Mapping[str, Any]] = {"asked": [], "drawing": ""}

    def __init__(self, state: Workbench) -> None:
        super().__init__(state, state.papers)
        self._begun, self._computed = False, set[str]()
        self.papers = self.study(compute_papers, self._take)
        self.figures = self.study(compute_figures, self._take_figures)
        self.model.param.watch(self._ask, "compare")
        self.model.param.watch(self._draw, "draw")
        self.model.param.watch(self._stop, "stop")
        state.param.watch(self._begin, "page")
        self._begin()

    def _begin(self, *_: Any) -> None:
        """Take the shipped comparisons, and compute them anew where the code is not the one that has made them."""
        if self.state.page != self.page or self._begun:
            return
        shipped = shipped_tables()
        # what the shipped tables lack is computed once the solver is compiled: then the page is asked again
        self._begun = shipped.is_current or self.in_sight
        self.model.param.update(results={**shipped.papers, **self.model.results}, is_current=shipped.is_current)
        if not shipped.is_current and self._begun:
            self.model.compare = list(COMPARISONS)

    def _ask(self, event: Any) -> None:
        if event.new:
            self.model.param.update(asked=event.new, compare=[], failure=None)
            self.papers.ask(tuple(event.new))

    def _draw(self, event: Any) -> None:
        if event.new:
            self.model.param.update(drawing=event.new, draw="", failure=None)
            self.figures.ask(event.new)

    def _take_figures(self, done: tuple[FigureData, ...], last: bool) -> None:
        name = self.model.drawing
        self.model.figures = {**self.model.figures, name: done}
        if last:
            self.model.drawing = ""

    def _stop(self, *_: Any) -> None:
        self.papers.stop()
        self.model.asked = []

    def _take(self, results: dict[str, PaperTables], last: bool) -> None:
        known = self.model.results
        # what was computed before stands until all of the paper is there
        whole = {name: paper for name, paper in results.items() if paper.complete or name not in known}
        partly = {name: paper for name, paper in results.items() if name in known and not known[name].complete}
        self.model.param.update(results={**known, **partly, **whole}, under_way=results)
        if last:
            self.model.asked = []
            self._computed |= {name for name, paper in results.items() if paper.complete}
            self.model.is_current |= self._computed == set(COMPARISONS)
