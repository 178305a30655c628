"""The answers: what the lessons compute, and the numbers beside them."""

import pytest

from railjoule.core.units import J_PER_KWH
from railjoule.dashboard.pages.learn.answers import (
    NUMBERS,
    WITHOUT,
    Answer,
    braked_away_kwh,
    cells,
    energies_at,
    energy_table,
    find_answer,
    motors_off_m,
)
from railjoule.dashboard.pages.learn.compute import LessonResult, compute_lesson
from railjoule.dashboard.pages.learn.lessons import LESSONS, NAMES

BY_NAME = {lesson.name: lesson for lesson in LESSONS}


def result(lesson: str, at: float) -> LessonResult:
    return compute_lesson(lesson, at)


def answer(lesson: str, at: float) -> Answer:
    return find_answer(BY_NAME[lesson], result(lesson, at))


def test_each_lesson_has_an_answer() -> None:
    assert tuple(NUMBERS) == NAMES


def test_the_answers_agree_with_what_the_lessons_say() -> None:
    # the same numbers as in the texts of lessons.toml, which another test computes by other ways
    assert answer("coasting", 95.0).number == pytest.approx(9.8, abs=0.05)
    assert answer("gradient", 20.0).number == pytest.approx(45, abs=0.5)
    assert answer("load", 0.0).number == pytest.approx(3.3, abs=0.05)
    assert answer("load", 100.0).number == pytest.approx(3.5, abs=0.05)
    assert answer("recuperation", 100.0).number == pytest.approx(3900, abs=50)


def test_a_second_more_saves_about_the_multiplier() -> None:
    price = result("multiplier", 200.0).runs["optimum"].price_of_time_w
    # the curve is convex: a whole second saves a little less than its slope says
    assert 0.97 * price / 3600 < answer("multiplier", 200.0).number < price / 3600


def test_motors_are_switched_off_later_with_more_recuperation() -> None:
    # a moment of coasting at the speed that is then held is no switching off
    places = [motors_off_m(result("recuperation", at).runs["optimum"]) for at in (0.0, 20.0, 50.0, 70.0, 90.0, 100.0)]
    assert all(place is not None for place in places)
    assert places == sorted(places, key=float)
    assert places[0] == pytest.approx(2600, abs=50)


def test_without_recuperation_the_answer_is_the_dashed_run() -> None:
    assert answer("recuperation", 0.0).because == WITHOUT


def test_what_brakes_waste_closes_the_account() -> None:
    run = result("coasting", 115.0).runs["optimum"]
    energy = run.energy
    rest = energy.running_resistance_j + energy.curve_resistance_j + energy.losses_j["drive"]
    assert braked_away_kwh(run) == pytest.approx((energy.traction_j - rest) / J_PER_KWH, rel=1e-6)


def test_the_first_number_is_the_answer_where_both_are_of_the_same() -> None:
    # not 3.4 % beside 3.5 %
    assert ">3.5<" in cells(BY_NAME["load"], result("load", 100.0))[0]
    assert ">9.8<" in cells(BY_NAME["coasting"], result("coasting", 95.0))[0]


def test_the_energies_close_at_every_place_and_are_those_of_the_run_at_its_end() -> None:
    for run in result("coasting", 115.0).runs.values():
        for place in (100.0, 700.0, 1450.0):
            at = energies_at(run, place)
            uses = sum(at[word] for word in ("Kinetic", "Potential", "Resistance", "Losses", "Regenerated"))
            assert uses == pytest.approx(at["Drawn from the supply"], abs=5e-4)
        at, energy = energies_at(run, run.distance_m), run.energy
        assert at["Drawn from the supply"] == pytest.approx(energy.traction_j / J_PER_KWH, abs=1e-6)
        assert at["Resistance"] == pytest.approx(energy.running_resistance_j / J_PER_KWH, abs=1e-6)
        assert at["Losses"] == pytest.approx(sum(energy.losses_j.values()) / J_PER_KWH, abs=1e-6)
        assert at["Kinetic"] == pytest.approx(0.0, abs=1e-6)


def test_energies_of_the_compared_run_stand_by_themselves_before_a_guess() -> None:
    runs = result("coasting", 115.0).runs
    table = energy_table(BY_NAME["coasting"], {"constant speed": runs["constant speed"]}, 750.0)
    assert ("optimum" in table, "constant speed" in table, table.count("<tr>")) == (False, True, 7)
