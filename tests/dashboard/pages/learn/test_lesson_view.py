"""A lesson before and after the guess: nothing of its optimum is on the page before."""

import html
from collections.abc import Iterator

import pytest
from panel.viewable import Viewable

from railjoule.dashboard.look import words
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.pages.learn.answers import answer_of
from railjoule.dashboard.pages.learn.compute import LessonRequest, LessonResult, compute_lesson
from railjoule.dashboard.pages.learn.guess_form import EnergyBars, GuessForm
from railjoule.dashboard.pages.learn.guesses import GUESSES
from railjoule.dashboard.pages.learn.lesson_view import LessonView
from railjoule.dashboard.pages.learn.model import LESSONS, Lesson, guess_field
from railjoule.dashboard.pages.learn.work import Learn
from railjoule.dashboard.state.workbench import Workbench


def texts(view: Viewable) -> Iterator[str]:
    """Yield all texts that a view holds, its hidden parts included."""
    for part in view.select():
        if isinstance(part, GuessForm):
            yield str(part.verdict)
        elif isinstance(part, EnergyBars):
            yield str(part.runs)
        elif isinstance(getattr(part, "object", None), str):
            yield part.object


def told(view: LessonView, result: LessonResult, guess: float | None) -> str:
    """Return all that a lesson tells with a guess or without one."""
    setattr(view.state.learn, guess_field(view.lesson.name), guess)
    view.ask(result)
    view.show(result, guess is not None)
    return html.unescape("\n".join(texts(view.view)))


@pytest.mark.parametrize("lesson", LESSONS, ids=lambda lesson: lesson.name)
def test_nothing_of_the_optimum_is_on_the_page_before_a_guess(lesson: Lesson) -> None:
    view = LessonView(lesson, Workbench(), Palette(False))
    result = compute_lesson(LessonRequest(lesson.name, float(lesson.number.default)))
    best, guess = next(iter(result.runs.values())), GUESSES[lesson.name]
    because = answer_of(result).because
    kept = (f">{words.energy(best.energy_kwh)}<", because, lesson.answer, lesson.text)

    def curves() -> int:
        drawn = view.speed.axis.columns("first").source.data.values()
        return sum(len(column) for column in drawn) + sum(
            len(column) for chart in view.more for source in chart.sources.values() for column in source.data.values()
        )

    for _ in range(2):
        before = told(view, result, None)
        assert not any(one in before for one in kept)
        assert curves() == 0
        after = told(view, result, guess.ends[0])
        assert all(one in after for one in kept)
        assert curves() > 0


def test_a_slider_computes_its_lesson_again() -> None:
    state = Workbench()
    Learn(state)
    state.page = "Learn"
    state.learn.gradient = 30.0
    # 58 % in the text of the answer
    assert state.learn.shown["gradient"].saved_share == pytest.approx(0.5795, abs=5e-4)
