"""A lecturer's page and those of students in one process: what is sent, and what is shown of it."""

from collections.abc import Iterator
from typing import Any
from urllib.parse import parse_qs, urlsplit

import numpy as np
import pytest

from railjoule.dashboard.app import Session
from railjoule.dashboard.keep.snapshot import snapshot_of
from railjoule.dashboard.limits import MOST_STUDENTS
from railjoule.dashboard.pages.learn import page as learn_page
from railjoule.dashboard.pages.learn.class_view import class_curve, class_link, histogram, list_guesses, students_table
from railjoule.dashboard.pages.learn.classroom import Classes, Classroom
from railjoule.dashboard.pages.learn.lessons import LESSONS

HOSTILE = "<img src=x onerror=alert(1)>"
COMMANDS, LATE = "p0c300p600", "p0c60"


class Clock:
    """A clock on which each look is two seconds later than the one before."""

    now_s = 0.0

    def __call__(self) -> float:
        self.now_s += 2.0
        return self.now_s


@pytest.fixture(autouse=True)
def classes(monkeypatch: pytest.MonkeyPatch) -> Classes:
    found = Classes(Clock())
    monkeypatch.setattr(learn_page, "CLASSES", found)
    return found


def opened(**fields: Any) -> Any:
    """Return the page of a new session whose link has some fields."""
    session = Session()
    learn = session.state.pages["Learn"]
    learn.param.update(**fields)
    session.state.page = "Learn"
    return learn


def joined(lecturer: Any, **fields: Any) -> Any:
    """Return the page of a student who has opened the link of a class."""
    query = parse_qs(urlsplit(class_link(lecturer, lecturer.taught)).query)
    assert query.pop("v") == ["1"]
    assert query.pop("page") == ["Learn"]
    given = {key.removeprefix("learn."): one[0] for key, one in query.items()}
    return opened(**{key: one if key.startswith("class") else float(one) for key, one in given.items()}, **fields)


@pytest.fixture
def lecturer() -> Iterator[Any]:
    learn = opened()
    learn.open_class()
    yield learn
    learn.close_class()


def taught(learn: Any) -> Classroom:
    assert learn.taught is not None
    found: Classroom = learn.taught
    return found


def test_a_class_is_opened_with_a_link_and_its_code(lecturer: Any) -> None:
    shown = lecturer.classroom.link.object
    assert taught(lecturer).token in shown
    assert "<svg" in shown
    assert f"0 of {MOST_STUDENTS} students" in shown
    # the key with which the lecturer's page finds its class is in no link
    assert lecturer.class_key not in shown
    assert lecturer.classroom.results.visible


def test_runs_and_guesses_come_to_the_page_of_the_lecturer(lecturer: Any) -> None:
    one, other = joined(lecturer, class_name="Ada"), joined(lecturer)
    assert f"2 of {MOST_STUDENTS} students" in lecturer.classroom.link.object
    one.hear("driven", "done", COMMANDS)
    other.hear("driven", "done", LATE)
    other.coasting_guess = 10.0
    table = lecturer.classroom.table.object
    assert table.index("Ada") < table.index(" late")
    assert f"{one.verdict.kwh:.2f}" in table
    # one line with a gap after each run
    places, speeds = class_curve(taught(lecturer))
    assert (np.isnan(places).sum(), np.isnan(speeds).sum()) == (2, 2)
    assert np.nanmax(speeds) == pytest.approx(one.verdict.driven[1].max(), abs=0.5)
    chart = lecturer.host.plots["class_runs"]
    assert len(chart.sources["class"].data["x"]) == len(places)
    # the screen that the class sees does not give the answer away
    assert len(chart.sources["best"].data["x"]) == 0
    lecturer.class_best = True
    assert len(chart.sources["best"].data["x"]) > 0
    assert list_guesses(taught(lecturer), LESSONS[0], 115.0) == [10.0]
    edges, counts = histogram([10.0, 10.5, 40.0], LESSONS[0])
    assert (counts.sum(), counts.max(), edges[0], edges[-1]) == (3, 2, 0.0, 40.0)


def test_students_begin_with_the_sliders_of_the_lecturer_and_none_of_the_results() -> None:
    learn = opened(gradient=20.0, driven=COMMANDS, coasting_guess=3.0)
    learn.open_class()
    student = joined(learn)
    assert (student.gradient, student.driven, student.coasting_guess) == (20.0, "", None)
    student.gradient_guess = 35.0
    # guesses for another slope would be those of another question
    assert list_guesses(taught(learn), LESSONS[3], 20.0) == [35.0]
    assert list_guesses(taught(learn), LESSONS[3], 15.0) == []


def test_a_hostile_name_is_text(lecturer: Any) -> None:
    student = joined(lecturer, class_name=HOSTILE)
    student.hear("driven", "done", COMMANDS)
    table = students_table(taught(lecturer))
    assert "<img" not in table
    assert "&lt;img src=x" in table


def test_a_name_that_is_typed_later_is_shown(lecturer: Any) -> None:
    student = joined(lecturer)
    student.hear("driven", "done", COMMANDS)
    student.classroom.name[0].value = "Ada"
    assert "Ada" in lecturer.classroom.table.object
    assert len(taught(lecturer).students) == 1


def test_a_student_who_loads_the_page_again_is_the_same_one(lecturer: Any) -> None:
    student = joined(lecturer)
    student.hear("driven", "done", COMMANDS)
    again = joined(lecturer, class_student=student.class_student)
    again.hear("driven", "done", COMMANDS)
    (found,) = taught(lecturer).students.values()
    assert len(found.runs) == 2


def test_a_closed_class_is_reported_in_a_sentence_and_the_lessons_go_on(lecturer: Any) -> None:
    token, student = taught(lecturer).token, joined(lecturer)
    lecturer.close_class()
    assert not lecturer.classroom.results.visible
    student.hear("driven", "done", COMMANDS)
    assert "There is no such class on this server" in student.classroom.notice.object
    assert student.played["driven"].verdict["tried"] == 1
    late = opened(class_token=token)
    assert "There is no such class on this server" in late.classroom.notice.object


def test_a_full_class_is_reported_in_a_sentence(lecturer: Any) -> None:
    for number in range(MOST_STUDENTS):
        taught(lecturer).join(str(number), "")
    student = joined(lecturer)
    assert f"This class is full: it has {MOST_STUDENTS} students." in student.classroom.notice.object
    student.hear("driven", "done", COMMANDS)
    assert student.played["driven"].verdict["tried"] == 1
    assert len(taught(lecturer).students) == MOST_STUDENTS


def test_a_lecturer_who_loads_the_page_again_has_the_class(lecturer: Any) -> None:
    again = opened(class_key=lecturer.class_key)
    assert again.taught is lecturer.taught
    joined(lecturer).hear("driven", "done", COMMANDS)
    assert again.classroom.table.object == lecturer.classroom.table.object != ""


def test_opening_and_joining_a_class_are_no_steps_of_undo() -> None:
    session = Session()
    learn = session.state.pages["Learn"]
    session.state.page = "Learn"
    learn.open_class()
    learn.param.update(class_token=taught(learn).token, class_name="Ada")
    assert not session.keeping.can_undo
    assert snapshot_of(session.state)["learn.class_key"] == learn.class_key != ""
