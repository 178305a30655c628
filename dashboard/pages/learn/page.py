"""Learn: lessons that are played, five that ask for a guess, and the class that a lecturer opens."""

import secrets
from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import Any

import panel as pn
import param
from panel.viewable import Viewable

from railjoule.core import RailjouleError, Trajectory
from railjoule.core.scenario import format_scenario
from railjoule.dashboard.page import Page, Request, shows, study, work
from railjoule.dashboard.pages.learn import by_hand, drawn, shared
from railjoule.dashboard.pages.learn.by_hand import LESSON_CHANGES, PRESET, TRIES, best_run, driven_run
from railjoule.dashboard.pages.learn.charts import FIGURES
from railjoule.dashboard.pages.learn.class_view import CLASS_GUESSES, CLASS_RUNS, ClassView
from railjoule.dashboard.pages.learn.classroom import CLASSES, ClassError, Classroom, Watcher
from railjoule.dashboard.pages.learn.compute import compute_lessons
from railjoule.dashboard.pages.learn.drawn import DRAWN_PLOTS, POINTS, DrawSpeed, drive_drawing
from railjoule.dashboard.pages.learn.driven import BY_HAND_PLOTS, DriveIt
from railjoule.dashboard.pages.learn.guessed import GuessedLesson
from railjoule.dashboard.pages.learn.lessons import LESSONS, NAMES
from railjoule.dashboard.pages.learn.shared import ShareOut
from railjoule.dashboard.pages.learn.verdict import PLAYED_TEXTS, Verdict
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.state.kept import result
from railjoule.dashboard.state.numbers import TypedNumber
from railjoule.dashboard.state.recipes import PageRun, Program, Recipe
from railjoule.dashboard.workbench import Workbench

GUESSES, DRAFTS = (tuple(getattr(lesson, name) for lesson in LESSONS) for name in ("guess", "draft"))
LAST_POSITION = "Shown: the last slider position that could be computed."
MODULE = "railjoule.dashboard.pages.learn.compute"
PLAYED: Mapping[str, Any] = {"driven": by_hand, "drawn": drawn, "shared": shared}
"""The modules that begin and judge, by the field of the page that holds the last play; the slowest is last."""


def begin_all(texts: Mapping[str, str]) -> Iterator[dict[str, Any]]:
    """Yield the initial data of the lessons, one more at each step; `refused` has errors in a link's text."""
    begun: dict[str, Any] = {"refused": None}
    for field, lesson in PLAYED.items():
        try:
            begun = {**begun, field: lesson.begin(texts[field])}
        except RailjouleError as error:
            begun = {**begun, "refused": error, field: lesson.begin("")}
        yield begun


def judge(field: str, text: str, _count: int) -> Verdict:
    """Return the verdict on a try in a lesson; the count makes equal requests differ."""
    verdict: Verdict = PLAYED[field].judge(text)
    return verdict


class Learn(Page):
    """The page of lessons."""

    page = "Learn"
    kept = (*NAMES, *GUESSES, "lesson", *PLAYED, "class_token", "class_student", "class_name", "class_key")
    passing = (*DRAFTS, "asked", "sketch", "place_percent", "class_lesson", "class_best", "class_refusal")
    figures = (
        *BY_HAND_PLOTS,
        *(plot for plots in FIGURES.values() for plot in plots),
        CLASS_RUNS,
        CLASS_GUESSES,
        *DRAWN_PLOTS,
    )
    # lessons have scenarios of their own: their results hold whatever becomes of the one beside the pages
    follows_scenario = False

    coasting, multiplier, recuperation, gradient, load = (lesson.number() for lesson in LESSONS)
    coasting_guess, multiplier_guess, recuperation_guess, gradient_guess, load_guess = (
        lesson.guess_number() for lesson in LESSONS
    )
    coasting_draft, multiplier_draft, recuperation_draft, gradient_draft, load_draft = (
        lesson.draft_number() for lesson in LESSONS
    )
    place_percent = TypedNumber(
        "Place, % of the way", "%", default=50.0, bounds=(0, 100), softbounds=(0, 100), step=1.0
    )
    lesson = param.Selector(default="", objects=["", *NAMES], doc="The lesson that a link opens.")
    lessons = result(dict, "The results of the lessons with a guess, by their names.")
    driven = param.String(default="", doc="Commands of the last run that was driven by hand, such as p0c300b2200.")
    shared = param.String(default="", doc="The last distribution that was judged, such as uneven:20,20,20.")
    drawn = param.String(default="", doc="The last drawing that was judged: speeds in km/h with commas between.")
    begun = result(dict, "Initial data of the lessons that are played.")
    asked = param.Tuple(default=None, allow_None=True, length=3, doc="The try to be judged: field, text, count.")
    verdict = result(Verdict, "The last verdict.")
    sketch = param.Tuple(default=None, allow_None=True, length=POINTS, doc="The drawing: speeds at its points [km/h].")
    sketched = result(Trajectory, "The run below the drawing.")
    class_token = param.String(default="", doc="The class of the link that opened the page.")
    class_student = param.String(default="", doc="The name of this page in that class.")
    class_name = param.String(default="", doc="The name of the student.")
    class_key = param.String(default="", doc="The class that is taught from this page.")
    class_lesson = param.Selector(default=NAMES[0], objects=list(NAMES), doc="The lesson whose guesses are shown.")
    class_best = param.Boolean(default=False, doc="Whether the best run and the answer are shown to the class.")
    class_refusal = param.String(default="", doc="Why something of the class cannot be done.")
    class_news = param.Event(doc="Something has come to the class.")

    def __init__(self, desk: Workbench, **params: Any) -> None:
        super().__init__(desk, **params)
        self.tries: list[Verdict] = []
        self.param.watch(self._note, "verdict")
        self.param.watch(self._send_guess, list(GUESSES))
        self.param.watch(self._join, ["class_token", "class_name"])

    def page_run(self) -> PageRun:
        """Return the lessons as a program."""
        values = {name: float(getattr(self, name)) for name in NAMES}
        body = (
            f"for lesson, value in {values!r}.items():\n"
            "    for name, run in compute_lesson(lesson, value).runs.items():\n"
            '        print(f"{lesson}, {name}: {run.energy_kwh} kWh")\n'
        )
        program = Program({"compute_lesson": MODULE}, body, "", of_scenario=False)
        note = "The lessons have scenarios of their own, which no command runs."
        return PageRun(program, {"strategy": self.desk.chosen_now}, note)

    # ---- what it computes

    @work(*NAMES, into="lessons", only_last=False)
    def _lessons(self) -> Request:
        return compute_lessons, tuple(float(getattr(self, name)) for name in NAMES)

    @cached_property
    def linked(self) -> Mapping[str, str]:
        """The texts of a link for the lessons that are played, before anything is played here."""
        return {field: getattr(self, field) for field in PLAYED}

    # the page waits for the first runs: once kernels are compiled, they come
    @study("desk.runs", into="begun")
    def _begin(self) -> Request:
        return begin_all, self.linked

    @work("asked", into="verdict")
    def _judge(self) -> Request:
        return self.asked and (judge, *self.asked)

    @work("sketch", into="sketched")
    def _drive_sketch(self) -> Request:
        return self.sketch and (drive_drawing, self.sketch)

    def hear(self, field: str, what: str, text: str) -> None:
        """Take what the browser reports of a lesson that is played."""
        if what == "done":
            self.asked = (field, text, 1 + (self.asked[2] if self.asked else 0))
        elif what == "reset":
            self.tries = []
        elif what == "open":
            self._open(field, text)

    def _note(self, *_: Any) -> None:
        """Save a verdict, count the try, and send it to the class."""
        verdict = self.verdict
        if verdict is None:
            return
        if verdict.field == "driven":
            self.tries = [*(self.tries if len(self.tries) < TRIES else ()), verdict]
            self._send(lambda joined: joined.take_run(self.class_student, verdict))
        self.param.update(**{verdict.field: verdict.text})

    def _open(self, field: str, text: str) -> None:
        """Open a played run on the page that continues with it, or show the reason against it."""
        desk = self.desk
        try:
            if field == "driven":
                run = driven_run(text)
                desk.scenario.choose(PRESET)
                desk.pin_lesson(run, text, best_run(), Recipe(PRESET, None, dict(LESSON_CHANGES), "optimal"))
            else:
                # as a file: an edit of the time would be rounded to what its slider shows
                title = PLAYED_TEXTS[field]["title"].partition(". ")[2].partition(":")[0]
                desk.scenario.open(format_scenario(PLAYED[field].opened(text)), title)
        except RailjouleError as error:
            self.failure = error
            return
        desk.page = PLAYED_TEXTS[field]["page"]

    # ---- the class

    @property
    def taught(self) -> Classroom | None:
        """The class that is taught from this page."""
        return CLASSES.find_taught(self.class_key)

    def open_class(self, *_: Any) -> None:
        """Open a class, or show the reason against it."""
        try:
            self.param.update(class_key=CLASSES.open().key, class_refusal="")
        except ClassError as error:
            self.class_refusal = str(error)
        self._watch_class()

    def close_class(self, *_: Any) -> None:
        """Close the class: what has come to it is gone."""
        if self.taught is not None:
            CLASSES.close(self.taught)
        self.param.update(class_key="", class_refusal="")

    def _watch_class(self) -> None:
        taught = self.taught
        if taught is not None and all(watcher.act != self._hear_class for watcher in taught.watchers):
            taught.watchers.append(Watcher(pn.state.curdoc, self._hear_class))

    def _hear_class(self) -> None:
        self.param.trigger("class_news")

    def _join(self, *_: Any) -> None:
        if self.class_token:
            self.param.update(class_student=self.class_student or secrets.token_urlsafe(9))
            self._send(lambda joined: joined.join(self.class_student, self.class_name))

    def _send_guess(self, *events: param.parameterized.Event) -> None:
        for event in events:
            name = event.name.removesuffix("_guess")
            if event.new is not None:
                guess = name, float(getattr(self, name)), float(event.new)
                self._send(lambda joined, guess=guess: joined.take_guess(self.class_student, *guess))

    def _send(self, send: Any) -> None:
        """Send something to the class that was joined, or show the reason against it."""
        if not self.class_token:
            return
        try:
            send(CLASSES.find(self.class_token))
            self.class_refusal = ""
        except ClassError as error:
            self.class_refusal = str(error)

    # ---- what it shows

    def is_over_time(self, axis: str) -> bool:
        """Return that no axis is one of times: the axes of the lessons show positions."""
        return False

    def layout(self) -> Viewable:
        """Make the lessons and the class, and return them laid out."""
        self.played: Mapping[str, Any] = {
            "driven": DriveIt("driven", self),
            "shared": ShareOut("shared", self.hear),
            "drawn": DrawSpeed("drawn", self),
        }
        self.guessed = [GuessedLesson(lesson, self) for lesson in LESSONS]
        self.classroom = ClassView(self)
        self._watch_class()
        subtitle = "three to play, five to guess: then move a slider, the figures follow"
        self.host.heading.object = parts.heading(self.page, "Eight lessons", subtitle, "")
        return parts.stack(self.classroom.view, *(lesson.view for lesson in (*self.played.values(), *self.guessed)))

    @shows("begun", "failure")
    def _show_failure(self) -> None:
        self.host.tell(self.failure or (self.begun and self.begun["refused"]), LAST_POSITION if self.failure else "")
        for lesson in self.played.values() if self.failure else ():
            lesson.refuse()

    @shows("begun", "lesson")
    def _show_begun(self) -> None:
        for field, lesson in self.played.items():
            if self.begun is not None and field in self.begun and not lesson.given:
                lesson.begin(self.begun[field])
        linked = next((field for field, text in self.linked.items() if text), "")
        self.played["driven"].lead = self.lesson or linked

    @shows("verdict")
    def _show_verdict(self) -> None:
        if self.verdict is not None:
            self.played[self.verdict.field].show(self.verdict, self.tries if self.verdict.field == "driven" else ())

    @shows("sketched")
    def _show_sketched(self) -> None:
        self.played["drawn"].draw(self.sketched)

    @shows("lessons", "place_percent", *NAMES, *GUESSES)
    def _show_lessons(self) -> None:
        for lesson in self.guessed:
            lesson.show()

    @shows("begun", "class_news", "class_key", "class_token", "class_lesson", "class_best", "class_refusal", "lessons")
    def _show_class(self) -> None:
        self.classroom.show()
