"""Classes: the runs and guesses of students while a class is open, in the memory of this process and nowhere else."""

import secrets
import time
from collections.abc import Callable
from dataclasses import dataclass, field

from bokeh.document import Document
from panel.io.state import set_curdoc

from railjoule.core import RailjouleError
from railjoule.dashboard.limits import (
    LONGEST_NAME,
    MOST_AWAY_S,
    MOST_CLASSES,
    MOST_STUDENTS,
    RESULT_REST_S,
    RUNS_KEPT,
)
from railjoule.dashboard.pages.learn.verdict import Verdict

REFRESH_MS = 500
"""The lecturer's page draws so long after the first new result, together with all that have come since."""
NO_CLASS = "There is no such class on this server: it is closed, or another server has it. Ask for a new link."
FULL = f"This class is full: it has {MOST_STUDENTS} students. You can play all lessons, but your results are not sent."
TOO_FAST = f"Not sent: the class takes one result in {RESULT_REST_S:g} s."
TOO_MANY = f"This server has {MOST_CLASSES} open classes already. Close one, or try again later."


class ClassError(RailjouleError):
    """A class that cannot be opened, joined or sent to."""


@dataclass
class Student:
    """The results of one student.

    Parameters
    ----------
    name : str
        Empty where none was typed.
    runs : list of Verdict
        The last runs.
    guesses : dict
        By lesson the value of its slider and the guess.
    sent_s : float
        When the last result came [s].
    """

    name: str = ""
    runs: list[Verdict] = field(default_factory=list)
    guesses: dict[str, tuple[float, float]] = field(default_factory=dict)
    sent_s: float = float("-inf")

    @property
    def best(self) -> Verdict | None:
        """The run of least energy on time; the last one where none is."""
        on_time = [run for run in self.runs if run.counts]
        return min(on_time, key=lambda run: run.kwh) if on_time else self.runs[-1] if self.runs else None


@dataclass(eq=False)
class Watcher:
    """A lecturer's page.

    Parameters
    ----------
    document : Document or None
        None where there is no session around it.
    act : callable
        Draws what has come.
    """

    document: Document | None
    act: Callable[[], None]
    is_due: bool = False

    @property
    def is_there(self) -> bool:
        """Whether the page is still open."""
        context = None if self.document is None else self.document.session_context
        return context is None or not context.destroyed

    def tell(self) -> None:
        """Schedule one drawing of the page for all results until then."""
        if self.document is None:
            self.act()
        elif not self.is_due:
            self.is_due = True
            self.document.add_timeout_callback(self._turn, REFRESH_MS)

    def _turn(self) -> None:
        self.is_due = False
        with set_curdoc(self.document):
            self.act()


class Classroom:
    """One open class.

    Parameters
    ----------
    now : callable
        Returns the time [s].
    """

    def __init__(self, now: Callable[[], float]) -> None:
        self.token = secrets.token_urlsafe(9)
        self.key = f"{self.token}.{secrets.token_urlsafe(18)}"
        self.students: dict[str, Student] = {}
        self.watchers: list[Watcher] = []
        self._now, self._seen_s = now, now()

    @property
    def is_left(self) -> bool:
        """Whether no lecturer's page has been open for hours."""
        self.watchers = [watcher for watcher in self.watchers if watcher.is_there]
        if self.watchers:
            self._seen_s = self._now()
        return self._now() - self._seen_s > MOST_AWAY_S

    def tell(self) -> None:
        """Notify all lecturers' pages of a new result."""
        for watcher in self.watchers:
            watcher.tell()

    def join(self, student: str, name: str) -> None:
        """Take a student in, or another name of one; raises ClassError where there is no room."""
        if student not in self.students and (len(self.students) >= MOST_STUDENTS or len(student) > LONGEST_NAME):
            raise ClassError(FULL)
        self.students.setdefault(student, Student()).name = clean_name(name)
        self.tell()

    def take_run(self, student: str, run: Verdict) -> None:
        """Take a run; raises ClassError where a student has no place or sends too fast."""
        sender = self._sender(student)
        sender.runs = [*sender.runs, run][-RUNS_KEPT:]
        self.tell()

    def take_guess(self, student: str, lesson: str, at: float, guess: float) -> None:
        """Take the first guess for a value of the lesson's slider; errors as `take_run`."""
        # a further one is made by a student who has seen the answer
        if student in self.students and self.students[student].guesses.get(lesson, (None,))[0] == at:
            return
        self._sender(student).guesses[lesson] = (at, guess)
        self.tell()

    def _sender(self, student: str) -> Student:
        sender = self.students.get(student)
        if sender is None:
            raise ClassError(FULL)
        if self._now() - sender.sent_s < RESULT_REST_S:
            raise ClassError(TOO_FAST)
        sender.sent_s = self._now()
        return sender


class Classes:
    """The open classes of a server.

    Parameters
    ----------
    now : callable, optional
        Returns the time [s].
    """

    def __init__(self, now: Callable[[], float] = time.monotonic) -> None:
        self._now, self._open = now, dict[str, Classroom]()

    def open(self) -> Classroom:
        """Open a class; raises ClassError where there are too many."""
        self._drop_left()
        if len(self._open) >= MOST_CLASSES:
            raise ClassError(TOO_MANY)
        made = Classroom(self._now)
        self._open[made.token] = made
        return made

    def find(self, token: str) -> Classroom:
        """Return the class of a link; raises ClassError where there is none."""
        self._drop_left()
        if token not in self._open:
            raise ClassError(NO_CLASS)
        return self._open[token]

    def find_taught(self, key: str) -> Classroom | None:
        """Return the class of a lecturer's page, if there is one."""
        self._drop_left()
        found = self._open.get(key.partition(".")[0])
        return found if found is not None and found.key == key else None

    def close(self, classroom: Classroom) -> None:
        """Close a class: all that was sent to it is gone."""
        self._open.pop(classroom.token, None)

    def _drop_left(self) -> None:
        self._open = {token: one for token, one in self._open.items() if not one.is_left}


CLASSES = Classes()
"""The classes of this server. All its pages take their turns in one thread, so that no lock is needed."""


def clean_name(name: str) -> str:
    """Return a name as it is shown: one line of printable characters, not too long."""
    return "".join(filter(str.isprintable, " ".join(name.split())))[:LONGEST_NAME]
