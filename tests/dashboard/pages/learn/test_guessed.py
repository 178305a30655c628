"""A lesson before and after the guess: nothing of its optimum is on the page before."""

import html
from typing import Any

import pytest

from railjoule.dashboard.app import Session
from railjoule.dashboard.look import words
from railjoule.dashboard.pages.learn.answers import find_answer
from railjoule.dashboard.pages.learn.guessed import AGAIN, GUESS, GuessedLesson
from railjoule.dashboard.pages.learn.lessons import LESSONS


@pytest.fixture(scope="module")
def learn() -> Any:
    session = Session()
    session.state.page = "Learn"
    return session.state.pages["Learn"]


def shown(view: GuessedLesson) -> str:
    """Return all texts that a lesson holds, its hidden parts included."""
    texts = (part.object for part in view.view.select() if isinstance(getattr(part, "object", None), str))
    return html.unescape("\n".join(texts))


def points(view: GuessedLesson) -> int:
    """Return how many points of the optimum the charts of a lesson have."""
    first, *more = view.charts
    drawn = first.axis.columns("first").source.data.values()
    sources = [source for chart in more for source in chart.sources.values()]
    return sum(map(len, drawn)) + sum(len(column) for source in sources for column in source.data.values())


@pytest.mark.parametrize("number", range(len(LESSONS)), ids=[lesson.name for lesson in LESSONS])
def test_nothing_of_the_optimum_is_on_the_page_before_a_guess(learn: Any, number: int) -> None:
    view, lesson = learn.guessed[number], LESSONS[number]
    result = learn.lessons[lesson.name]
    best = next(iter(result.runs.values()))
    hidden = (f">{words.energy(best.energy_kwh)}<", find_answer(lesson, result).because, lesson.answer, lesson.text)
    for _ in range(2):
        assert not any(one in shown(view) for one in hidden)
        assert points(view) == 0
        assert view.button.label == GUESS
        view._press()
        assert getattr(learn, lesson.guess) == getattr(learn, lesson.draft)
        assert all(one in shown(view) for one in hidden)
        assert points(view) > 0
        assert view.button.label == AGAIN
        view._press()
        assert getattr(learn, lesson.guess) is None


def test_a_slider_computes_its_lesson_again(learn: Any) -> None:
    learn.gradient = 30.0
    # 57 % in the text of the answer
    assert learn.lessons["gradient"].saved_share == pytest.approx(0.571, abs=5e-4)


def test_the_optimum_opens_on_drive(learn: Any) -> None:
    learn.guessed[0]._open()
    assert (learn.desk.page, learn.desk.scenario.edited.title) == ("Drive", "Why coasting saves")
    learn.desk.page = "Learn"
