"""The work behind the button Report: what is asked for, and where the file goes."""

from collections.abc import Iterator
from dataclasses import dataclass
from datetime import datetime
from typing import Any

from railjoule.core import RailjouleError
from railjoule.dashboard.look.words import slug
from railjoule.dashboard.report.document import report_html
from railjoule.dashboard.report.findings import ReportRequest, compute_findings
from railjoule.dashboard.report.model import ReportingModel
from railjoule.dashboard.state.page_work import PageWork
from railjoule.dashboard.state.programs import page_recipe
from railjoule.dashboard.state.recipes import Recipe
from railjoule.dashboard.state.workbench import Workbench

FINDINGS_SHARE = 0.9
"""How much of the work is done once all is found; the rest is writing it down."""


@dataclass(frozen=True)
class Draft:
    """A report on its way: how much is done, and the whole file at the end."""

    share: float
    text: str = ""


def draft_report(request: ReportRequest) -> Iterator[Draft]:
    """Yield how far a report is, and at last the report; errors as `compute_findings`."""
    findings = None
    for findings in compute_findings(request):
        yield Draft(FINDINGS_SHARE * findings.share)
    assert findings is not None
    yield Draft(1.0, report_html(findings, datetime.now().astimezone()))


def file_name(title: str) -> str:
    """Return what a report of a scenario is called: letters and digits of its title, and a hyphen between words."""
    return f"railjoule-{slug(title) or 'report'}.html"


def _note(recipe: Recipe) -> str:
    """Return what a report says of a page whose numbers no scenario gives."""
    told = recipe.untold and recipe.program.of_scenario
    return f"{recipe.untold} The numbers of this report are those of its scenario." if told else ""


class Reporting(PageWork[ReportingModel]):
    """Makes the report of one page when it is asked for."""

    at_rest = {"busy": False}  # noqa: RUF012

    def __init__(self, state: Workbench) -> None:
        super().__init__(state, ReportingModel())
        self.report = self.study(draft_report, self._take)
        self.model.param.watch(self._ask, "wanted")
        self.model.param.watch(self.end, "unwanted")
        state.param.watch(self._forgive, "runs")

    def end(self, *_: Any) -> None:
        """End the work under way; there will be no report."""
        super().end()
        self.model.busy = False

    def _forgive(self, *_: Any) -> None:
        """Say no more why there was no report, as there are new runs."""
        self.model.failure = None

    def _ask(self, *_: Any) -> None:
        try:
            recipe = page_recipe(self.state)
            scenario = recipe.scenario
            # what Drive has proven by now need not be proven once more
            known = self.state.proof.of(scenario)
            request = ReportRequest(
                scenario,
                bound=known.bound if known is not None else None,
                note=_note(recipe),
                pinned=tuple((pin.name, pin.trajectory) for pin in self.state.pins),
                contents=self.model.contents,
            )
        except RailjouleError as error:
            self.take_failure(error)
            return
        # before it is asked for: without a page around it, the report is there when `ask` returns
        self.model.param.update(
            busy=True, share=0.0, failure=None, name_of_file=file_name(scenario.title or self.state.scenario.preset)
        )
        self.report.ask(request)

    def _take(self, draft: Draft, last: bool) -> None:
        self.model.share = draft.share
        if last:
            self.model.param.update(busy=False, text=draft.text)
