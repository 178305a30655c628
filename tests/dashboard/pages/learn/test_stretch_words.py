"""The sentences on the stretches of an optimum: one for each, with the run's own numbers and price."""

import pytest

from railjoule.dashboard.look import words
from railjoule.dashboard.pages.learn.compute import LessonRequest, compute_lesson
from railjoule.dashboard.pages.learn.lessons import LESSONS, Lesson
from railjoule.dashboard.pages.learn.stretch_words import stretch_words


@pytest.mark.parametrize("lesson", LESSONS, ids=lambda lesson: lesson.name)
def test_each_stretch_has_one_sentence_with_the_price_or_the_worth(lesson: Lesson) -> None:
    for at in (*lesson.ends, lesson.first):
        run = next(iter(compute_lesson(LessonRequest(lesson.name, float(at))).runs.values()))
        told = stretch_words(run)
        assert [one.phase for one in told] == [
            phase.phase
            for k, phase in enumerate(run.phases)
            if k in (0, len(run.phases) - 1) or phase.end_s - phase.start_s >= 5.0
        ]
        assert run.price_of_time_w is not None
        price = f"{words.price(run.price_of_time_w)} Wh a second"
        for one in told:
            assert one.sentence.endswith(".")
            assert one.sentence.count(". ") <= 1
            assert price in one.sentence or (one.phase == "coast" and "1.18 J" in one.sentence)


def test_what_recuperation_returns_is_told() -> None:
    run = compute_lesson(LessonRequest("recuperation", 70.0)).runs["optimum"]
    power, hold, coast, brake = stretch_words(run)
    # 0.7 of 0.85, as the drive of liashenko-0 has it
    assert "more than the 0.59 J that braking returns" in coast.sentence.replace("0.60", "0.59")
    assert f"{words.energy(run.energy.recuperated_j / 3.6e6)} kWh of the " in brake.sentence
    assert hold.sentence.startswith("Hold 56.5 km/h for ")
    assert "faster would cost just what it saves" in hold.sentence
    assert power.where.startswith("0\u2013")


def test_a_hold_at_the_limit_says_so() -> None:
    run = compute_lesson(LessonRequest("multiplier", 158.0)).runs["optimum"]
    hold = next(one for one in stretch_words(run) if one.phase == "hold")
    assert "faster is not permitted" in hold.sentence


def test_a_descent_adds_its_height_to_a_train_that_coasts() -> None:
    steep, level = (compute_lesson(LessonRequest("gradient", at)).runs["planned with gradients"] for at in (30.0, 0.0))
    coast = next(one for one in stretch_words(steep) if one.phase == "coast")
    # 250 m of 30 per mille are 7.5 m: m g h of the train
    height = steep.scenario.vehicle.total_mass_kg * 9.81 * 7.5 / 3.6e6
    assert f"the descent adds {words.energy(height)} kWh" in coast.sentence
    assert all("descent" not in one.sentence for one in stretch_words(level))
