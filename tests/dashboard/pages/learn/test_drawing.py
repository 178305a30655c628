"""The lesson that is drawn: what drawings may be, and what is said of them."""

import re

import pytest

from railjoule.core import ScenarioError
from railjoule.core.strategies import prepare_task
from railjoule.dashboard.pages.learn.drawn import (
    POINTS,
    TARGET_S,
    begin,
    drawing_lesson,
    drive_drawing,
    judge,
    opened,
    read_drawing,
)

EVEN = ",".join(["60"] * POINTS)


@pytest.mark.parametrize(
    "text", ["", "60", "60,", EVEN + ",60", EVEN.replace("60", "4"), EVEN.replace("60", "81"), "x"]
)
def test_a_text_that_is_no_drawing_is_refused(text: str) -> None:
    with pytest.raises(ScenarioError, match="35 whole numbers from 5 to 80"):
        read_drawing(text)


def text_of(speeds: tuple[int, ...]) -> str:
    return ",".join(map(str, speeds))


def test_nothing_of_the_best_is_sent_before_it_is_asked_for() -> None:
    begun = begin("")
    assert set(begun) == {"points"}
    # the drawing to begin with is the fastest run
    shortest = prepare_task(drawing_lesson()[0]).shortest_travel_time_s
    assert drive_drawing(begun["points"]).travel_time_s == pytest.approx(shortest, rel=1e-9)
    assert shortest < TARGET_S


@pytest.mark.parametrize("speeds", [(60,) * POINTS, (5,) * POINTS, (80,) * POINTS, (40,) * 17 + (70,) * 10 + (30,) * 8])
def test_a_drawing_is_compared_with_the_best_that_arrives_in_time(speeds: tuple[int, ...]) -> None:
    verdict, run = judge(text_of(speeds)), drive_drawing(speeds)
    assert verdict.proven
    assert verdict.kwh > verdict.bound_kwh
    assert verdict.late_s == pytest.approx(run.travel_time_s - TARGET_S)
    # a late drawing is compared with the best in its own time, which needs less
    assert verdict.allowed_s == pytest.approx(max(TARGET_S, run.travel_time_s))
    assert verdict.counts == (run.travel_time_s <= TARGET_S + 0.05)
    nodes = drawing_lesson()[1].cell_count + 1
    curves = verdict.curves
    assert len(curves["best_ms"]) == len(curves["best_s"]) == len(curves["above_kwh"]) == nodes
    assert curves["best_s"][-1] == pytest.approx(verdict.allowed_s, abs=0.05)
    more = curves["above_kwh"][-1]
    assert sum(energy for _, energy in verdict.rows) == pytest.approx(more, abs=1e-4)
    assert opened(text_of(speeds)).travel_time_s == pytest.approx(verdict.allowed_s)


def test_each_stretch_has_a_sentence_and_they_follow_one_another() -> None:
    sentences = judge(EVEN).sentences
    assert [re.search(r"m, ([a-z ]+):", one)[1] for one in sentences] == ["full power", "hold", "coast"]  # type: ignore[index]
    ends = [re.match(r"([\d\u202f]+)\u2013([\d\u202f]+) m", one).groups() for one in sentences]  # type: ignore[union-attr]
    assert ends[0][0] == "0"
    assert ends[-1][1] == "1\u202f700"
    assert [end for _, end in ends[:-1]] == [begin for begin, _ in ends[1:]]
    # what one used beyond the best on all stretches is what one used beyond it at all
    told = [re.search(r"used (\d+\.\d\d) kWh (more|less)", one) for one in sentences]
    sum_ = sum(float(one[1]) * (1 if one[2] == "more" else -1) for one in told if one)
    assert sum_ == pytest.approx(judge(EVEN).curves["above_kwh"][-1], abs=0.1)
