"""The work behind the button Report: what is asked for, and where the file goes."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from datetime import datetime
from typing import Any

from railjoule.core import RailjouleError
from railjoule.dashboard.models.reporting import ReportingModel
from railjoule.dashboard.models.workbench import Workbench
from railjoule.dashboard.report.document import report_html
from railjoule.dashboard.store import Study
from railjoule.dashboard.store.report import ReportRequest, compute_findings

LONGEST_NAME = 60
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
    words = "-".join(re.findall(r"[a-z0-9]+", title.lower()))[:LONGEST_NAME].strip("-")
    return f"railjoule-{words}.html" if words else "railjoule-report.html"


class Reporting:
    """Makes the report of one page when it is asked for."""

    def __init__(self, state: Workbench) -> None:
        self.state, self.model = state, ReportingModel()
        self.study = Study(draft_report, self._take, self._fail)
        self.model.param.watch(self._ask, "wanted")
        self.model.param.watch(self.end, "unwanted")
        state.param.watch(self._forget, "runs")

    def end(self, *_: Any) -> None:
        """End the work under way."""
        self.study.stop()
        self.model.busy = False

    def _forget(self, *_: Any) -> None:
        """Say no more why there was no report, as there are new runs."""
        self.model.failure = None

    def _ask(self, *_: Any) -> None:
        try:
            scenario = self.state.scenario.scenario()
            known = self.state.proof.of(scenario)
            request = ReportRequest(
                scenario.with_(**self._in_sight()), self.state.chosen_now, known.bound if known is not None else None
            )
        except RailjouleError as error:
            self._fail(error)
            return
        self.model.param.update(
            busy=True, share=0.0, failure=None, name_of_file=file_name(scenario.title or self.state.scenario.preset)
        )
        self.study.ask(request)

    def _in_sight(self) -> Mapping[str, Any]:
        """Return what the page in sight lays over the scenario: events, or what is otherwise in reality."""
        models = {"Disturbances": self.state.disturbances, "Robustness": self.state.robustness}
        model = models.get(self.state.page)
        return {} if model is None else model.changes

    def _take(self, draft: Draft, last: bool) -> None:
        self.model.share = draft.share
        if last:
            self.model.param.update(busy=False, text=draft.text)

    def _fail(self, failure: RailjouleError) -> None:
        self.model.param.update(busy=False, failure=failure)
