"""The work behind the button Report: the request, the progress and the file."""

from collections.abc import Iterator
from datetime import datetime
from typing import Any

import param

from railjoule.core import RailjouleError
from railjoule.dashboard.look.words import slug
from railjoule.dashboard.report.contents import Contents
from railjoule.dashboard.report.document import report_html
from railjoule.dashboard.report.findings import ReportRequest, compute_findings
from railjoule.dashboard.state.kept import result
from railjoule.dashboard.state.recipes import Recipe, page_recipe
from railjoule.dashboard.work.worker import Study
from railjoule.dashboard.workbench import Workbench

FINDINGS_SHARE = 0.9
"""Share of the work once all results are there; the rest is the file."""


class ReportingModel(param.Parameterized):
    """A report of one open page: whether it is requested, its progress, and the file."""

    failure = result(RailjouleError, "Why the last report failed.")
    wanted = param.Event(doc="The user requests a report.")
    unwanted = param.Event(doc="The user stops the report.")
    contents = param.ClassSelector(class_=Contents, default=Contents(), doc="Sections, author and note.")
    busy = param.Boolean(default=False, doc="Whether a report is being made.")
    share = param.Magnitude(default=0.0, doc="Share of the work that is done.")
    name_of_file = param.String(default="report.html", doc="Name of the file.")
    text = param.String(default="", doc="The report, until the browser has it.")


def draft_report(request: ReportRequest) -> Iterator[tuple[float, str]]:
    """Yield the share that is done, and at last the whole file with it; errors as `compute_findings`."""
    findings = None
    for findings in compute_findings(request):
        yield FINDINGS_SHARE * findings.share, ""
    assert findings is not None
    yield 1.0, report_html(findings, datetime.now().astimezone())


def file_name(title: str) -> str:
    """Return the file name of a report: letters and digits of the scenario's title, and hyphens between words."""
    return f"railjoule-{slug(title) or 'report'}.html"


def _note(recipe: Recipe) -> str:
    """Return the remark on a page whose numbers no scenario file gives."""
    differs = recipe.program_note and recipe.program.of_scenario
    return f"{recipe.program_note} The numbers of this report are those of its scenario." if differs else ""


class Reporting:
    """Makes the report of one page on request."""

    def __init__(self, state: Workbench) -> None:
        self.state, self.model = state, ReportingModel()
        self.report = Study(draft_report, self._take, self._fail)
        self.model.param.watch(self._ask, "wanted")
        self.model.param.watch(self.end, "unwanted")
        state.param.watch(self._forgive, "runs")

    def end(self, *_: Any) -> None:
        """End the work under way; there will be no report."""
        self.report.stop()
        self.model.busy = False

    def _fail(self, failure: RailjouleError) -> None:
        self.model.param.update(failure=failure, busy=False)

    def _forgive(self, *_: Any) -> None:
        """Forget the failure, as there are new runs."""
        self.model.failure = None

    def _ask(self, *_: Any) -> None:
        try:
            recipe = page_recipe(self.state)
            scenario = recipe.scenario
            # the bound that Drive has proven need not be proven once more
            known = self.state.proof.of(scenario)
            request = ReportRequest(
                scenario,
                bound=known.bound if known is not None else None,
                note=_note(recipe),
                pinned=tuple((pin.name, pin.trajectory) for pin in self.state.pins),
                second=self.state.pages["Compare"].second_scenario,
                contents=self.model.contents,
            )
        except RailjouleError as error:
            self._fail(error)
            return
        # before it is asked for: without a page around it, the report is there when `ask` returns
        self.model.param.update(
            busy=True, share=0.0, failure=None, name_of_file=file_name(scenario.title or self.state.scenario.preset)
        )
        self.report.ask(request)

    def _take(self, draft: tuple[float, str], last: bool) -> None:
        self.model.share, text = draft
        if last:
            self.model.param.update(busy=False, text=text)
