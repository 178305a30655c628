"""The lesson on slack: what sharings may be, and what is said of them."""

import pytest

from railjoule.core import ScenarioError
from railjoule.core.scenario import format_scenario
from railjoule.dashboard.pages.learn.slack import (
    SlackRequest,
    judge_slack,
    line_tables,
    read_sharing,
    scenario_of,
    verdict_on,
)
from railjoule.dashboard.pages.learn.work import Learn
from railjoule.dashboard.state.workbench import Workbench

WRONG = ("", "uneven", "uneven:20,20,21", "uneven:0,30,30", "odd:20,20,20", "even:20,20,20,0", "even:-1,31,30")


@pytest.mark.parametrize("text", WRONG)
def test_a_text_that_is_no_sharing_is_refused(text: str) -> None:
    with pytest.raises(ScenarioError, match="sum to 60"):
        read_sharing(text)


def test_nothing_of_the_best_is_told_before_it_is_asked_for() -> None:
    found = judge_slack(SlackRequest())
    assert found.verdict is None
    assert set(found.lines["uneven"]) == {"legs", "standing_kwh", "min_s", "slack_s"}
    assert found.begun == {"line": "uneven", "seconds": (20, 20, 20), "linked": False}


def test_sharing_out_pays_on_one_line_and_not_on_the_other() -> None:
    pays, idle = (verdict_on(name, (20, 20, 20)) for name in ("uneven", "even"))
    assert pays["kwh"] > 1.04 * pays["bound_kwh"]
    assert pays["worth"] == "Equal slack costs 4.46 % more than the best sharing: on this line, sharing out pays."
    assert idle["kwh"] < 1.001 * idle["bound_kwh"]
    assert "it does not pay" in idle["worth"]
    assert "too many" in pays["sentences"][0]
    assert "too few" in pays["sentences"][1]
    assert all("within a second" in sentence for sentence in idle["sentences"])


def test_the_workbench_opens_the_sharing_as_the_given_timetable() -> None:
    state = Workbench()
    state.scenario.open(format_scenario(scenario_of("uneven", (12, 30, 18))), "lesson")
    first, second = state.scenario.edited.line.inner_stations
    shortest = [leg["shortest_s"] for leg in line_tables("uneven")["legs"]]
    assert first.arrival_s == pytest.approx(shortest[0] + 12)
    assert second.arrival_s == pytest.approx(shortest[0] + 12 + 25 + shortest[1] + 30)


def test_a_wrong_link_is_told_and_the_lesson_begins_all_the_same() -> None:
    state = Workbench()
    Learn(state)
    state.learn.shared = "uneven:1,1,1"
    state.page = "Learn"
    assert "sum to 60" in str(state.learn.failure)
    assert state.learn.slack.begun["seconds"] == (20, 20, 20)
    state.learn.sharing = "even:19,21,20"
    assert state.learn.failure is None
    assert state.learn.shared == "even:19,21,20"
