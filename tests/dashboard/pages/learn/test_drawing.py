"""The lesson that is drawn: what drawings may be, and what is said of them."""

import re

import pytest

from railjoule.core import ScenarioError, TimetableError
from railjoule.dashboard.pages.learn.drawing import (
    POINTS,
    DrawingRequest,
    drawing_lesson,
    judge_drawing,
    read_drawing,
    run_of,
    verdict_on,
)
from railjoule.dashboard.pages.learn.work import Learn
from railjoule.dashboard.state.workbench import Workbench

EVEN = ",".join(["60"] * POINTS)


@pytest.mark.parametrize(
    "text", ["", "60", "60,", EVEN + ",60", EVEN.replace("60", "4"), EVEN.replace("60", "81"), "x"]
)
def test_a_text_that_is_no_drawing_is_refused(text: str) -> None:
    with pytest.raises(ScenarioError, match="35 whole numbers from 5 to 80"):
        read_drawing(text)


def test_nothing_of_the_best_is_told_before_it_is_asked_for() -> None:
    found = judge_drawing(DrawingRequest())
    assert found.verdict is None
    # the drawing to begin with is the fastest run
    assert run_of(found.begun).travel_time_s == pytest.approx(found.shortest_s, rel=1e-9)


def test_a_drawing_without_time_to_spend_is_refused() -> None:
    with pytest.raises(TimetableError, match="shorter than the shortest possible"):
        judge_drawing(DrawingRequest(",".join(["80"] * POINTS)))


@pytest.mark.parametrize("speeds", [(60,) * POINTS, (5,) * POINTS, (40,) * 17 + (70,) * 10 + (30,) * 8])
def test_a_drawing_is_compared_with_the_best_in_its_own_time(speeds: tuple[int, ...]) -> None:
    verdict = verdict_on(speeds)
    assert verdict["proven"]
    assert verdict["kwh"] > verdict["bound_kwh"]
    nodes = drawing_lesson()[1].cell_count + 1
    assert len(verdict["best_ms"]) == len(verdict["above_kwh"]) == nodes
    more = verdict["kwh"] - verdict["best_kwh"]
    assert verdict["above_kwh"][-1] == pytest.approx(more, abs=1e-6)
    assert sum(energy for _, energy in verdict["rows"]) == pytest.approx(more, abs=1e-4)


def test_each_stretch_has_a_sentence_and_they_follow_one_another() -> None:
    sentences = verdict_on((60,) * POINTS)["stretches"]
    assert [re.search(r"m, ([a-z ]+):", one)[1] for one in sentences] == ["full power", "hold", "coast", "brake"]  # type: ignore[index]
    ends = [re.match(r"([\d\u202f]+)\u2013([\d\u202f]+) m", one).groups() for one in sentences]  # type: ignore[union-attr]
    assert ends[0][0] == "0"
    assert ends[-1][1] == "1\u202f700"
    assert [end for _, end in ends[:-1]] == [begin for begin, _ in ends[1:]]
    # what one used beyond the best on all stretches is what one used beyond it at all
    told = [re.search(r"used (\d+\.\d\d) kWh (more|less)", one) for one in sentences]
    sum_ = sum(float(one[1]) * (1 if one[2] == "more" else -1) for one in told if one)
    verdict = verdict_on((60,) * POINTS)
    assert sum_ == pytest.approx(verdict["kwh"] - verdict["best_kwh"], abs=0.1)


def test_a_wrong_link_is_told_and_the_lesson_begins_all_the_same() -> None:
    state = Workbench()
    Learn(state)
    state.learn.drawn = "1,2,3"
    state.page = "Learn"
    assert "35 whole numbers" in str(state.learn.failure)
    assert state.learn.drawing.begun == (80,) * POINTS
    state.learn.sketched = EVEN
    assert state.learn.failure is None
    assert state.learn.drawn == EVEN
