from railjoule.core import load_scenario
from railjoule.dashboard.pages.learn.compute import LESSONS
from railjoule.dashboard.pages.learn.model import LESSONS as TOLD
from railjoule.dashboard.report.contents import Contents
from railjoule.dashboard.report.findings import ReportRequest, compute_findings
from railjoule.dashboard.report.lesson_findings import PLAYED, compute_lessons


def test_the_lessons_come_one_by_one() -> None:
    steps = list(compute_lessons())
    assert [share for _, share in steps] == [k / 8 for k in range(1, 9)]
    found = steps[-1][0]
    assert list(found.played) == list(PLAYED)
    assert list(found.guessed) == list(LESSONS)
    # as on the page, where nobody has moved a slider
    assert [result.request.value for result in found.guessed.values()] == [one.number.default for one in TOLD]


def test_a_report_has_them_where_they_are_chosen() -> None:
    request = ReportRequest(load_scenario("liashenko-0"), contents=Contents(("lessons",)))
    steps = list(compute_findings(request))
    assert steps[-1].lessons is not None
    assert len(steps[-1].lessons.guessed) == len(LESSONS)
    shares = [step.share for step in steps]
    assert shares == sorted(shares)
    assert shares[-1] == 1.0
