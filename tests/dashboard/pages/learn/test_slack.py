"""The lesson on slack: what sharings may be, and what is said of them."""

import pytest

from railjoule.core import ScenarioError
from railjoule.core.scenario import format_scenario
from railjoule.dashboard.pages.learn.slack import begin, judge, line_tables, opened, read_sharing
from railjoule.dashboard.workbench import Workbench

WRONG = ("", "uneven", "uneven:20,20,21", "uneven:0,30,30", "odd:20,20,20", "even:20,20,20,0", "even:-1,31,30")


@pytest.mark.parametrize("text", WRONG)
def test_a_text_that_is_no_sharing_is_refused(text: str) -> None:
    with pytest.raises(ScenarioError, match="sum to 60"):
        read_sharing(text)


def test_nothing_of_the_best_is_sent_before_it_is_asked_for() -> None:
    begun = begin("")
    assert set(begun["lines"]["uneven"]) == {"legs", "standing_kwh", "min_s", "slack_s"}
    assert (begun["line"], begun["seconds"]) == ("uneven", [20, 20, 20])


def test_distributing_pays_on_one_line_and_not_on_the_other() -> None:
    pays, idle = (judge(f"{name}:20,20,20") for name in ("uneven", "even"))
    assert pays.share > 0.04
    last = pays.sentences[-1]
    assert (
        last == "An equal supplement costs 4.46 % more than the best distribution: on this line, distributing it pays."
    )
    assert idle.share < 0.001
    assert "it does not pay" in idle.sentences[-1]
    assert "too many" in pays.sentences[0]
    assert "too few" in pays.sentences[1]
    assert all("within a second" in sentence for sentence in idle.sentences[:3])
    assert sum(pays.curves["best_s"]) == pytest.approx(60, abs=0.1)


def test_a_distribution_opens_as_the_given_timetable() -> None:
    state = Workbench()
    state.scenario.open(format_scenario(opened("uneven:12,30,18")), "lesson")
    first, second = state.scenario.edited.line.inner_stations
    shortest = [leg["shortest_s"] for leg in line_tables("uneven")["legs"]]
    assert first.arrival_s == pytest.approx(shortest[0] + 12)
    assert second.arrival_s == pytest.approx(shortest[0] + 12 + 25 + shortest[1] + 30)
