"""What is asked before each lesson: short, answerable between its ends, and told side by side with the answer."""

import re

import pytest

from railjoule.dashboard.pages.learn.answers import answer_of
from railjoule.dashboard.pages.learn.compute import LessonRequest, compute_lesson
from railjoule.dashboard.pages.learn.guesses import GUESSES
from railjoule.dashboard.pages.learn.model import LESSONS, LearnModel, Lesson, guess_field

MOST_WORDS = 40
"""So that the first action needs no reading of more than a few seconds."""


@pytest.mark.parametrize("lesson", LESSONS, ids=lambda lesson: lesson.name)
def test_a_question_is_short_and_does_not_tell_its_answer(lesson: Lesson) -> None:
    guess = GUESSES[lesson.name]
    at = float(lesson.number.default)
    question = guess.asked(at)["question"]
    assert len(question.split()) <= MOST_WORDS
    assert question.count("?") == 1
    answer = answer_of(compute_lesson(LessonRequest(lesson.name, at))).number
    assert f"{answer:.0f}" not in re.findall(r"\d+", question)


@pytest.mark.parametrize("lesson", LESSONS, ids=lambda lesson: lesson.name)
def test_every_answer_can_be_guessed(lesson: Lesson) -> None:
    guess = GUESSES[lesson.name]
    low, high = guess.ends
    for at in (*lesson.ends, lesson.number.default):
        answer = answer_of(compute_lesson(LessonRequest(lesson.name, float(at)))).number
        # an answer of zero may be a little less by rounding
        assert low - 1e-6 <= answer <= high
    # where the lesson begins, a guess can be close
    middle = answer_of(compute_lesson(LessonRequest(lesson.name, float(lesson.number.default)))).number
    offered = guess.choices or [low + k * guess.step for k in range(round((high - low) / guess.step) + 1)]
    assert min(abs(middle - one) for one in offered) <= guess.close


@pytest.mark.parametrize("lesson", LESSONS, ids=lambda lesson: lesson.name)
def test_choices_and_first_guess_lie_between_the_ends_that_the_model_holds(lesson: Lesson) -> None:
    guess, field = GUESSES[lesson.name], guess_field(lesson.name)
    model = LearnModel()
    assert getattr(model, field) is None
    for one in (*guess.ends, *guess.choices):
        assert model.checked(field, one) == one
    with pytest.raises(ValueError, match="at most"):
        model.checked(field, guess.ends[1] + 1)


def test_the_difference_is_told_with_its_sign_and_unit() -> None:
    share, metres = GUESSES["coasting"], GUESSES["recuperation"]
    assert share.told(20.0, 11.9, "so.")["sentence"] == "8.1 points too high: so."
    assert share.told(10.0, 11.9, "so.")["sentence"] == "Close: so."
    told = metres.told(3000.0, 3385.0, "so.")
    assert told["sentence"] == "385 m too low: so."
    assert (told["guess"], told["answer"]) == ("3\u202f000 m", "3\u202f385 m")
    assert (told["guess_at"], told["answer_at"]) == pytest.approx((3000 / 6000, 3385 / 6000))


def test_an_answer_beyond_the_ends_is_marked_at_the_end() -> None:
    assert GUESSES["gradient"].told(2.0, -0.1, "so.")["answer_at"] == 0.0
