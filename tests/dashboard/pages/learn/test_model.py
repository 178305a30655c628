"""The texts of the lessons: short, and true of what their figures show."""

import re

import pytest

from railjoule.dashboard.pages.learn.compute import LESSONS as COMPUTED
from railjoule.dashboard.pages.learn.compute import LessonRequest, compute_lesson
from railjoule.dashboard.pages.learn.model import LESSONS, LearnModel, Lesson

MOST_WORDS = 150


@pytest.mark.parametrize("lesson", LESSONS, ids=lambda lesson: lesson.name)
def test_a_text_is_short_and_asks_one_question(lesson: Lesson) -> None:
    assert 40 < len(re.findall(r"\S+", lesson.text)) <= MOST_WORDS
    for text in (lesson.question, lesson.answer):
        assert 5 < len(re.findall(r"\S+", text)) <= MOST_WORDS
    assert lesson.question.count("?") == 1


def test_each_lesson_has_a_slider_and_a_figure() -> None:
    model = LearnModel()
    assert [lesson.name for lesson in LESSONS] == list(COMPUTED)
    for lesson in LESSONS:
        assert getattr(model, lesson.name) == lesson.number.default
        with pytest.raises(ValueError, match="At most"):
            model.parse(lesson.name, str(lesson.ends[1] + 1))


def saved(lesson: str, value: float) -> float:
    """Return what the first run saves [%]."""
    return 100 * compute_lesson(LessonRequest(lesson, value)).saved_share


def test_the_answers_say_what_comes_out() -> None:
    answers = {lesson.name: lesson.answer for lesson in LESSONS}
    for time in (95, 160):
        assert f"{saved('coasting', time):.1f} % at {time} s" in answers["coasting"]
    for time in (200, 170, 160):
        steady = compute_lesson(LessonRequest("multiplier", time)).steady
        assert f"{steady.price_of_time_w / 3600:.0f}" in answers["multiplier"]
    assert f"{saved('recuperation', 100):.1f} %" in answers["recuperation"]
    assert f"saves {saved('gradient', 20):.0f} %" in answers["gradient"]
    assert f"per mille {saved('gradient', 30):.0f} %" in answers["gradient"]
    assert saved("gradient", 22) < 50 < saved("gradient", 23)
    for load, text in ((0, "needs 3.3 % more"), (100, "full one 3.5 % more")):
        share = saved("load", load)
        assert f"{100 * share / (100 - share):.1f}" in text
        assert text in answers["load"]
    late = compute_lesson(LessonRequest("load", 100)).runs["planned for 30 %"]
    assert f"{late.travel_time_s - 125:.1f} s late" in answers["load"]
