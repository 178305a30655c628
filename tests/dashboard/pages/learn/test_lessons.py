"""The texts of the lessons: short, true of what their figures show, and their questions do not tell the answer."""

import re

import pytest

from railjoule.dashboard.pages.learn.answers import Answer, find_answer
from railjoule.dashboard.pages.learn.compute import LESSONS as COMPUTED
from railjoule.dashboard.pages.learn.compute import LessonResult, compute_lesson
from railjoule.dashboard.pages.learn.guessed import guess_html
from railjoule.dashboard.pages.learn.lessons import LESSONS, NAMES, Lesson
from railjoule.dashboard.workbench import Workbench

MOST_WORDS, MOST_WORDS_ASKED = 150, 40
"""The second so that the first action needs no reading of more than a few seconds."""
each_lesson = pytest.mark.parametrize("lesson", LESSONS, ids=lambda lesson: lesson.name)
BY_NAME = {lesson.name: lesson for lesson in LESSONS}


def result(lesson: str, at: float) -> LessonResult:
    return compute_lesson(lesson, at)


@each_lesson
def test_a_text_is_short_and_asks_one_question(lesson: Lesson) -> None:
    assert 40 < len(re.findall(r"\S+", lesson.text)) <= MOST_WORDS
    for text in (lesson.attempt, lesson.answer):
        assert 5 < len(re.findall(r"\S+", text)) <= MOST_WORDS
    assert lesson.attempt.count("?") == 1


def test_each_lesson_has_a_slider_and_a_figure() -> None:
    page = Workbench().pages["Learn"]
    assert list(NAMES) == list(COMPUTED)
    for lesson in LESSONS:
        assert getattr(page, lesson.name) == lesson.first
        with pytest.raises(ValueError, match="At most"):
            page.parse(lesson.name, str(lesson.ends[1] + 1))


def saved(lesson: str, value: float) -> float:
    """Return the share that the first run saves [%]."""
    return 100 * result(lesson, value).saved_share


def test_the_answers_say_what_comes_out() -> None:
    answers = {lesson.name: lesson.answer for lesson in LESSONS}
    for time in (95, 160):
        assert f"{saved('coasting', time):.1f} % at {time} s" in answers["coasting"]
    for time in (200, 170, 160):
        steady = result("multiplier", time).steady
        assert f"{steady.price_of_time_w / 3600:.0f}" in answers["multiplier"]
    assert f"{saved('recuperation', 100):.1f} %" in answers["recuperation"]
    assert f"saves {saved('gradient', 20):.0f} %" in answers["gradient"]
    assert f"per mille {saved('gradient', 30):.0f} %" in answers["gradient"]
    assert saved("gradient", 23) < 50 < saved("gradient", 24)
    for load, text in ((0, "needs 3.3 % more"), (100, "full one 3.5 % more")):
        share = saved("load", load)
        assert f"{100 * share / (100 - share):.1f}" in text
        assert text in answers["load"]
    late = result("load", 100).runs["planned for 30 %"]
    assert f"{late.travel_time_s - 125:.1f} s late" in answers["load"]


@each_lesson
def test_a_question_is_short_and_does_not_tell_its_answer(lesson: Lesson) -> None:
    question = lesson.ask(lesson.first)
    assert len(question.split()) <= MOST_WORDS_ASKED
    assert question.count("?") == 1
    answer = find_answer(lesson, result(lesson.name, lesson.first)).number
    assert f"{answer:.0f}" not in re.findall(r"\d+", question)
    # nor does the field in which one guesses
    assert abs(lesson.draft_number().default - answer) > lesson.close


@each_lesson
def test_every_answer_can_be_guessed(lesson: Lesson) -> None:
    low, high = lesson.guess_ends
    for at in (*lesson.ends, lesson.first):
        answer = find_answer(lesson, result(lesson.name, at)).number
        # an answer of zero may be a little less by rounding
        assert low - 1e-6 <= answer <= high
    # where the lesson begins, a guess can be close
    first = find_answer(lesson, result(lesson.name, lesson.first)).number
    steps = round((high - low) / lesson.guess_step)
    offered = lesson.choices or [low + k * lesson.guess_step for k in range(steps + 1)]
    assert min(abs(first - one) for one in offered) <= lesson.close


@each_lesson
def test_a_guess_has_the_bounds_of_its_field(lesson: Lesson) -> None:
    page = Workbench().pages["Learn"]
    assert getattr(page, lesson.guess) is None
    for one in (*lesson.guess_ends, *lesson.choices, getattr(page, lesson.draft)):
        assert page.checked(lesson.guess, one) == one
    with pytest.raises(ValueError, match="at most"):
        page.checked(lesson.guess, lesson.guess_ends[1] + 1)


def test_the_difference_has_its_sign_and_unit() -> None:
    share, metres = BY_NAME["coasting"], BY_NAME["recuperation"]
    assert share.difference(20.0, 11.9) == "8.1 points too high"
    assert share.difference(10.0, 11.9) == "Close"
    assert metres.difference(3000.0, 3385.0) == "385 m too low"
    html = guess_html(metres, 3000.0, Answer(3385.0, "so."))
    assert "<b>3\u202f000 m</b>" in html
    assert "<b>3\u202f385 m</b>" in html
    assert "left:50.0%" in html
    assert "left:56.4%" in html
    assert html.endswith("385 m too low: so.</p>")


def test_an_answer_beyond_the_ends_is_marked_at_the_end() -> None:
    assert BY_NAME["gradient"].share(-0.1) == 0.0
