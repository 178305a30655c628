"""The lesson on slack: what sharings may be, and what is said of them."""

import pytest

from railjoule.core import ScenarioError
from railjoule.core.scenario import format_scenario
from railjoule.core.units import J_PER_WH
from railjoule.dashboard.pages.learn.shared import (
    ShareOut,
    begin,
    driven_line,
    find_prices,
    judge,
    line_tables,
    opened,
    read_sharing,
    total_kwh,
)
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


@pytest.mark.parametrize("name", ["uneven", "even"])
def test_tables_have_the_numbers_of_the_library(name: str) -> None:
    """Total energy and each leg's price, at seconds far from equal ones too."""
    table = line_tables(name)
    for seconds in ((12, 28, 20), (12, 38, 10), (12, 1, 47)):
        line = driven_line(name, seconds)
        assert total_kwh(table, seconds) == pytest.approx(line.run.energy_kwh, rel=1e-6)
        wanted = [leg.price_of_time_w / J_PER_WH for leg in line.legs]
        assert find_prices(table, seconds) == pytest.approx(wanted, rel=1e-5)


def test_borders_leave_each_leg_a_second_and_a_verdict_belongs_to_its_distribution() -> None:
    messages: list[tuple[str, str, str]] = []
    lesson = ShareOut("shared", lambda *message: messages.append(message))
    lesson.begin(begin(""))
    assert "16.267 kWh" in str(lesson.stage.object)
    for borders, seconds in (((12, 40), (12, 28, 20)), ((0, 40), (1, 39, 20)), ((60, 60), (58, 1, 1))):
        lesson.borders.value = borders
        assert lesson.seconds == seconds
        first, middle, _ = seconds
        assert lesson.borders.value == (first, first + middle)
    lesson.borders.value = (12, 40)
    lesson.ask()
    assert messages == [("shared", "done", "uneven:12,28,20")]
    verdict = judge("uneven:12,28,20")
    lesson.borders.value = (13, 40)
    lesson.show(verdict, ())
    assert "outcome" not in str(lesson.outcome.object)
    lesson.borders.value = (12, 40)
    lesson.show(verdict, ())
    assert "class=outcome" in str(lesson.outcome.object)
    assert str(lesson.split.object).count("class=best") == 2
    lesson.other.param.trigger("clicks")
    assert (lesson.text, lesson.after.visible) == ("even:20,20,20", False)
