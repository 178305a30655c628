"""A class: who may join, what is taken, and when it is gone."""

import re

import pytest

from railjoule.dashboard.limits import (
    LONGEST_NAME,
    MOST_AWAY_S,
    MOST_CLASSES,
    MOST_STUDENTS,
    RESULT_REST_S,
    RUNS_KEPT,
)
from railjoule.dashboard.pages.learn.classroom import (
    FULL,
    NO_CLASS,
    TOO_FAST,
    TOO_MANY,
    ClassError,
    Classes,
    Watcher,
    clean_name,
)
from railjoule.dashboard.pages.learn.verdict import Verdict


class Clock:
    """A clock that a test moves."""

    def __init__(self) -> None:
        self.now_s = 0.0

    def __call__(self) -> float:
        return self.now_s


@pytest.fixture
def clock() -> Clock:
    return Clock()


def run(kwh: float, late_s: float = -1.0) -> Verdict:
    return Verdict("driven", "p0", kwh, 7.8, proven=True, late_s=late_s)


def test_a_class_is_found_by_its_own_token_only(clock: Clock) -> None:
    classes = Classes(clock)
    one, other = classes.open(), classes.open()
    assert classes.find(one.token) is one
    assert classes.find_taught(other.key) is other
    # the link of the students opens nothing for a lecturer, and none is short enough to be guessed
    for wrong in ("", one.key, one.token[:-1], "\ud800"):
        with pytest.raises(ClassError, match="no such class"):
            classes.find(wrong)
    for wrong in ("", one.token, f"{one.token}.x", one.key + "x", "\ud800"):
        assert classes.find_taught(wrong) is None
    assert len({one.token, other.token, one.key, other.key}) == 4
    assert min(len(one.token), len(one.key)) >= 12


def test_a_closed_class_is_gone_with_all_that_it_had(clock: Clock) -> None:
    classes = Classes(clock)
    classroom = classes.open()
    classroom.join("a", "Ada")
    classes.close(classroom)
    classes.close(classroom)
    with pytest.raises(ClassError, match="^" + re.escape(NO_CLASS) + "$"):
        classes.find(classroom.token)


def test_a_class_goes_hours_after_its_lecturer_has_left(clock: Clock) -> None:
    classes = Classes(clock)
    left, taught = classes.open(), classes.open()
    taught.watchers.append(Watcher(None, lambda: None))
    clock.now_s = MOST_AWAY_S
    assert classes.find(left.token) is left
    clock.now_s += 1.0
    with pytest.raises(ClassError):
        classes.find(left.token)
    assert classes.find(taught.token) is taught


def test_a_full_class_takes_nobody_more_but_another_name_of_those_that_are_there(clock: Clock) -> None:
    classroom = Classes(clock).open()
    for number in range(MOST_STUDENTS):
        classroom.join(str(number), "")
    with pytest.raises(ClassError, match="^" + re.escape(FULL) + "$"):
        classroom.join("one more", "")
    # a name of one's own making that is as long as a book takes no memory
    with pytest.raises(ClassError):
        Classes(clock).open().join("x" * 1000, "")
    classroom.join("0", "Ada")
    assert (len(classroom.students), classroom.students["0"].name) == (MOST_STUDENTS, "Ada")


def test_a_server_has_so_many_classes_and_no_more(clock: Clock) -> None:
    classes = Classes(clock)
    opened = [classes.open() for _ in range(MOST_CLASSES)]
    with pytest.raises(ClassError, match="^" + re.escape(TOO_MANY) + "$"):
        classes.open()
    classes.close(opened[0])
    classes.open()


def test_a_student_sends_one_result_at_a_time_and_others_need_not_wait(clock: Clock) -> None:
    classroom = Classes(clock).open()
    for student in ("a", "b"):
        classroom.join(student, "")
    classroom.take_run("a", run(9.0))
    with pytest.raises(ClassError, match="^" + re.escape(TOO_FAST) + "$"):
        classroom.take_guess("a", "coasting", 115.0, 20.0)
    classroom.take_guess("b", "coasting", 115.0, 20.0)
    clock.now_s += RESULT_REST_S
    classroom.take_guess("a", "coasting", 115.0, 10.0)
    assert [student.guesses for student in classroom.students.values()] == [
        {"coasting": (115.0, 10.0)},
        {"coasting": (115.0, 20.0)},
    ]


def test_the_first_guess_counts_as_the_next_one_is_made_with_the_answer_in_sight(clock: Clock) -> None:
    classroom = Classes(clock).open()
    classroom.join("a", "")
    for at, guess in ((115.0, 20.0), (115.0, 11.9), (140.0, 14.0)):
        classroom.take_guess("a", "coasting", at, guess)
        assert classroom.students["a"].guesses["coasting"] == ((115.0, 20.0) if at == 115.0 else (140.0, 14.0))
        clock.now_s += RESULT_REST_S


def test_only_the_last_runs_are_kept_and_the_best_on_time_counts(clock: Clock) -> None:
    classroom = Classes(clock).open()
    classroom.join("a", "")
    student = classroom.students["a"]
    assert student.best is None
    energies = [(9.0, -1.0), (8.5, -1.0), (7.9, 3.0), (8.8, 0.0)]
    for kwh, late_s in energies:
        classroom.take_run("a", run(kwh, late_s))
        clock.now_s += RESULT_REST_S
    assert [one.kwh for one in student.runs] == [kwh for kwh, _ in energies[-RUNS_KEPT:]]
    # less energy, but late
    assert student.best.kwh == 8.5


@pytest.mark.parametrize(
    ("typed", "shown"),
    [
        ("Ada Lovelace", "Ada Lovelace"),
        ("  Ada\n\tLovelace ", "Ada Lovelace"),
        ("x" * 1000, "x" * LONGEST_NAME),
        ("\u202eevil\u0000\u200b", "evil"),
        ("J\u00f6rg \u5317\u4eac", "J\u00f6rg \u5317\u4eac"),
    ],
)
def test_a_name_is_one_short_line_of_printable_characters(typed: str, shown: str) -> None:
    assert clean_name(typed) == shown
