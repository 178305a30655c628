"""The answers: what the lessons compute, and the numbers beside them."""

import pytest

from railjoule.core.units import J_PER_KWH
from railjoule.dashboard.pages.learn.answers import ANSWERS, answer_of, braked_away_kwh, motors_off_m
from railjoule.dashboard.pages.learn.compute import LessonRequest, LessonResult, compute_lesson
from railjoule.dashboard.pages.learn.guesses import GUESSES
from railjoule.dashboard.pages.learn.model import LESSONS


def result(lesson: str, at: float) -> LessonResult:
    return compute_lesson(LessonRequest(lesson, at))


def test_each_lesson_has_a_question_and_an_answer() -> None:
    assert list(ANSWERS) == list(GUESSES) == [lesson.name for lesson in LESSONS]


def test_the_answers_agree_with_what_the_lessons_say() -> None:
    # the same numbers as in the texts of model.py, which its test computes by other ways
    assert answer_of(result("coasting", 95.0)).number == pytest.approx(9.8, abs=0.05)
    assert answer_of(result("gradient", 20.0)).number == pytest.approx(46, abs=0.5)
    assert answer_of(result("load", 0.0)).number == pytest.approx(3.3, abs=0.05)
    assert answer_of(result("load", 100.0)).number == pytest.approx(3.5, abs=0.05)
    assert answer_of(result("recuperation", 100.0)).number == pytest.approx(3900, abs=50)


def test_a_second_more_saves_about_the_multiplier() -> None:
    found = result("multiplier", 200.0)
    price = found.runs["optimum"].price_of_time_w
    assert price is not None
    # the curve is convex: a whole second saves a little less than its slope says
    assert 0.97 * price / 3600 < answer_of(found).number < price / 3600


def test_motors_are_switched_off_later_with_more_recuperation() -> None:
    # a moment of coasting at the speed that is then held is no switching off
    places = [motors_off_m(result("recuperation", at).runs["optimum"]) for at in (0.0, 20.0, 50.0, 70.0, 90.0, 100.0)]
    assert all(place is not None for place in places)
    assert places == sorted(places, key=float)
    assert places[0] == pytest.approx(2600, abs=50)


def test_without_recuperation_the_answer_is_the_dashed_run() -> None:
    assert answer_of(result("recuperation", 0.0)).because == "without recuperation it is the dashed run itself."


def test_what_brakes_waste_closes_the_account() -> None:
    run = result("coasting", 115.0).runs["optimum"]
    energy = run.energy
    rest = energy.running_resistance_j + energy.curve_resistance_j + energy.losses_j["drive"]
    assert braked_away_kwh(run) == pytest.approx((energy.traction_j - rest) / J_PER_KWH, rel=1e-6)
