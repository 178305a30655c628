import json
import re
from datetime import UTC, datetime

import pytest

from railjoule.core import load_scenario
from railjoule.dashboard.pages.learn.answers import answer_of
from railjoule.dashboard.pages.learn.guesses import GUESSES
from railjoule.dashboard.report.contents import Contents
from railjoule.dashboard.report.document import report_html
from railjoule.dashboard.report.figures import Figures
from railjoule.dashboard.report.findings import Findings, ReportRequest, compute_findings
from railjoule.dashboard.report.lessons import lessons_data, possible

MADE_AT = datetime(2026, 3, 9, 14, 5, tzinfo=UTC)
LARGEST_BYTES = 5_000_000
"""The issue's bar, for a report of all sections."""


@pytest.fixture(scope="module")
def findings() -> Findings:
    contents = Contents((*Contents().sections, "lessons"))
    *_, found = compute_findings(ReportRequest(load_scenario("metro-with-limit"), contents=contents))
    return found


@pytest.fixture(scope="module")
def page(findings: Findings) -> str:
    return report_html(findings, MADE_AT)


@pytest.fixture(scope="module")
def data(page: str) -> dict:
    return json.loads(re.findall(r'id="lessons-data">(.*?)</script>', page, re.DOTALL)[0])


def test_a_report_with_all_sections_stays_below_the_bar(page: str) -> None:
    assert len(page.encode()) < LARGEST_BYTES


@pytest.mark.parametrize("name", list(GUESSES))
def test_each_guess_has_the_answer_of_the_page(findings: Findings, data: dict, name: str) -> None:
    guess, told = GUESSES[name], data["guessed"][name]
    assert findings.lessons is not None
    answer = answer_of(findings.lessons.guessed[name])
    guesses = possible(guess)
    assert len(told["verdicts"]) == len(guesses)
    # the keys are what a browser makes of a number
    for value, key in ((guesses[0], f"{guesses[0]:.0f}"), (guesses[-1], f"{guesses[-1]:.0f}")):
        assert told["verdicts"][key] == guess.told(value, *answer)


def test_nothing_of_an_optimum_is_there_before_a_guess(page: str, data: dict) -> None:
    shown = re.sub(r"<(script|style)\b.*?</\1>", "", page, flags=re.DOTALL)
    for told in data["guessed"].values():
        assert told["after"]["told"] not in shown
        assert told["after"]["text"] not in shown
        assert len(told["before"]["bars"]["runs"]) == (1 if told["later"] else 0)
        assert len(told["after"]["bars"]["runs"]) == 2


def test_the_figures_of_the_speeds_begin_with_the_run_to_compare_with_alone(findings: Findings) -> None:
    figures = Figures(findings)
    assert findings.lessons is not None
    for name, lesson in figures.lessons.items():
        best, other, *_ = findings.lessons.guessed[name].runs.values()
        axis = lesson.speed.axis
        if not lesson.compared:
            assert lesson.later == {}
            continue
        assert max(axis.columns("second").source.data["speed"]) == pytest.approx(other.max_speed_kmh, rel=1e-5)
        assert all(len(column) == 0 for column in axis.columns("first").source.data.values())
        later = lessons_data(findings, figures)["guessed"][name]["later"]
        assert max(later["columns"]["speed"]) == pytest.approx(best.max_speed_kmh, abs=1e-3)
        assert later["ends"][0] <= later["ends"][1]


def test_it_asks_for_nothing_and_its_script_is_its_own(page: str) -> None:
    policy = re.search(r'Content-Security-Policy" content="([^"]+)"', page)
    assert policy is not None
    scripts = re.findall(r"<script>(.*?)</script>", page, re.DOTALL)
    # Bokeh's, the figures', the surfaces', the lessons'
    assert len(scripts) == policy[1].count("'sha256-") == 4
    assert "components.drive_it" in scripts[-1]
    assert not re.search(r"\b(import|export) ", scripts[-1])


def test_a_report_without_them_has_none_of_their_data() -> None:
    *_, found = compute_findings(ReportRequest(load_scenario("liashenko-0"), contents=Contents(("proof",))))
    made = report_html(found, MADE_AT)
    assert "lessons-data" not in made
    assert "data-played" not in made
