"""The part of the page with the class: its link and results, or for a student the name."""

from functools import partial
from typing import TYPE_CHECKING, Any
from urllib.parse import urlencode, urlsplit

import numpy as np
import panel as pn
import panel_material_ui as pmui
import segno
from panel.viewable import Viewable

from railjoule.core.units import MS_PER_KMH
from railjoule.dashboard.browser import one_message
from railjoule.dashboard.charts.plot import CurveChart, Plot, Stroke
from railjoule.dashboard.charts.quantities import POSITION
from railjoule.dashboard.charts.run_lines import Curve
from railjoule.dashboard.charts.track import as_steps
from railjoule.dashboard.limits import LONGEST_NAME, MOST_STUDENTS
from railjoule.dashboard.look import words
from railjoule.dashboard.look.markup import Markup, markup
from railjoule.dashboard.look.theme import lesson_css, parts_css
from railjoule.dashboard.pages.learn.answers import find_answer
from railjoule.dashboard.pages.learn.by_hand import best_run
from railjoule.dashboard.pages.learn.classroom import Classroom, Student
from railjoule.dashboard.pages.learn.lessons import LESSONS, Lesson
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.parts.choices import box, menu

if TYPE_CHECKING:
    from railjoule.dashboard.pages.learn.page import Learn

NODE_STEP, BINS, LEAST_HEIGHT = 10, 20, 5
"""Every tenth node of a run is drawn, that is every 20 m; bins of the histogram, and the least end of its axis."""
HIGHEST_KMH = 85.0
LOCAL_NAMES = ("localhost", "127.0.0.1")
CLASS_RUNS = Plot(
    "class_runs",
    "Speed, km/h: thin the runs of the class, blue the best run",
    {"class": Stroke("driven", {"line_width": 0.8, "line_alpha": 0.6}), "best": Stroke("optimal", {"line_width": 2.6})},
    (260, 320, 220),
    x_title=POSITION.words,
)
CLASS_GUESSES = Plot(
    "class_guesses",
    "Guesses of the class; blue: the answer",
    {"guesses": Stroke("driven", {"line_width": 1.8})},
    (200, 240, 190),
    x_title="Guess, %",
    y_title="Students",
    uprights={"answer": "optimal"},
)
INVITATION = "Students join with their phones; their runs and guesses appear here, beside the best."
ONLY_HERE = "This address works only on this computer: start the server for others, and open its page by that address."
MEMBER = "You are in a class: your runs of lesson 1 and your first guesses appear on the lecturer\u2019s screen."
HEADER = ("Student", "Tries", "Best, kWh", "Arrival", "Above the bound, %")


class ClassView:
    """The class on the page.

    Parameters
    ----------
    page : Learn
    """

    def __init__(self, page: "Learn") -> None:
        self.page = page
        self.notice, self.link, self.table = (
            parts.html_pane(stylesheets=[parts_css(), lesson_css()]) for _ in range(3)
        )
        self.open = pmui.Button(label="Open a class", size="small", margin=(6, 16, 6, 0), on_click=page.open_class)
        self.close = pmui.Button(label="Close the class", size="small", margin=(6, 16, 6, 0), on_click=page.close_class)
        # most pages belong to no class: its parts are made where they are needed
        self.name = parts.stack(*([self._name_field()] if page.class_token else ()))
        self.results = parts.stack(visible=False)
        head = pn.Row(self.open, self.close, self.notice, margin=0, sizing_mode="stretch_width")
        self.view = parts.stack(head, self.name, self.link, self.results, css=lesson_css(), css_classes=["classroom"])

    def _name_field(self) -> Viewable:
        page = self.page
        field = pmui.TextInput(
            label="Your name (optional)", value=page.class_name, max_length=LONGEST_NAME, size="small", margin=(6, 0)
        )
        field.param.watch(lambda event: page.param.update(class_name=event.new), "value")
        return field

    def _results(self) -> list[Viewable]:
        page = self.page
        lessons = {f"Lesson {number}: {lesson.title}": lesson.name for number, lesson in enumerate(LESSONS, 4)}
        runs, guesses = (page.host.plots[plot.name].host for plot in (CLASS_RUNS, CLASS_GUESSES))
        figures = parts.stack(
            parts.stack(box(page, "class_best", "Show the best run and the answer", margin=0), runs),
            parts.stack(menu(page, "class_lesson", "Guesses", lessons, margin=(0, 0, 6, 0)), guesses),
            css=lesson_css(),
            css_classes=["class"],
        )
        return [figures, self.table]

    def show(self) -> None:
        """Show the class that is taught, the one that was joined, or how to open one."""
        page = self.page
        taught, joined = page.taught, bool(page.class_token)
        sentence = MEMBER if joined and not page.class_refusal else "" if taught or joined else INVITATION
        self.notice.object = markup("<p class=class role=status>{} {}</p>", sentence, page.class_refusal)
        self.open.visible = not taught and not joined
        self.close.visible = self.results.visible = taught is not None
        self.link.object = "" if taught is None else invitation(class_link(page, taught), taught)
        if taught is not None and not list(self.results):
            with one_message():
                self.results[:] = self._results()
        if taught is not None:
            self.table.object = students_table(taught)
            self._draw_guesses(taught)
        # the best run is solved here, which takes minutes as long as the kernels are not compiled
        if taught is not None and page.begun is not None:
            self._draw_runs(taught)

    def _draw_runs(self, classroom: Classroom) -> None:
        best = best_run()
        curves = {"class": class_curve(classroom)}
        if self.page.class_best:
            curves["best"] = best.position_m, best.speed_ms / MS_PER_KMH
        self.page.host.draw([CLASS_RUNS], curves, x_ends=(0.0, best.distance_m), y_ends=(0.0, HIGHEST_KMH))

    def _draw_guesses(self, classroom: Classroom) -> None:
        page = self.page
        lesson = next(one for one in LESSONS if one.name == page.class_lesson)
        result = (page.lessons or {}).get(lesson.name)
        answer = find_answer(lesson, result).number if result is not None and page.class_best else np.nan
        guesses = list_guesses(classroom, lesson, float(getattr(page, lesson.name)))
        chart = page.host.plots[CLASS_GUESSES.name]
        chart.show(partial(draw_histogram, chart, lesson, guesses, answer))


def draw_histogram(chart: CurveChart, lesson: Lesson, guesses: list[float], answer: float) -> None:
    """Draw the histogram of the guesses, and the answer; NaN for none."""
    edges, counts = histogram(guesses, lesson)
    ends = (0.0, float(max(counts.max() + 1, LEAST_HEIGHT)))
    chart.draw({"guesses": as_steps(edges, counts)}, {"answer": answer}, lesson.guess_ends, ends)
    assert chart.figure is not None
    chart.figure.xaxis.axis_label = f"Guess, {lesson.guess_unit}"


def class_link(page: "Learn", classroom: Classroom) -> str:
    """Return the address that students open: the lessons as they stand on the lecturer's page, without results."""
    location = pn.state.location
    base = "" if location is None else str(location.href or "").partition("#")[0].partition("?")[0]
    moved = {f"learn.{one.name}": getattr(page, one.name) for one in LESSONS if getattr(page, one.name) != one.first}
    return f"{base}?{urlencode({'v': 1, 'page': 'Learn', 'learn.class_token': classroom.token, **moved})}"


def invitation(link: str, classroom: Classroom) -> Markup:
    """Return the link of a class with its QR code, and how many have come."""
    drawing = segno.make(link, micro=False).svg_inline(scale=4, border=2, light="#fff", title="QR code of the link")
    note = ONLY_HERE if urlsplit(link).hostname in LOCAL_NAMES else ""
    return markup(
        "<div class=invitation>{}<div><p>Students open this link:</p><p><a href='{}'>{}</a></p><p class=count>{} of {} "
        "students</p><p class=note>{} Results stay in memory until you close the class.</p></div></div>",
        Markup(drawing),
        link,
        link,
        len(classroom.students),
        MOST_STUDENTS,
        note,
    )


def students_table(classroom: Classroom) -> Markup:
    """Return the best runs, the least energy first and those late at the end."""
    drove = [(student, student.best) for student in classroom.students.values() if student.best is not None]
    drove.sort(key=lambda pair: (not pair[1].counts, pair[1].kwh) if pair[1] else (True, 0.0))
    return parts.plain_table(HEADER, ((_row(student), False) for student, _ in drove), "Runs of the class")


def _row(student: Student) -> list[str]:
    best = student.best
    assert best is not None
    arrival = f"{words.time(abs(best.late_s))} s {'early' if best.counts else 'late'}"
    above = words.share(best.share) if best.counts else words.UNKNOWN
    return [student.name or words.UNKNOWN, str(len(student.runs)), words.energy(best.kwh), arrival, above]


def class_curve(classroom: Classroom) -> Curve:
    """Return all runs of a class as one line with gaps."""
    runs = [run.driven for student in classroom.students.values() for run in student.runs if run.driven is not None]
    places, speeds = (
        np.concatenate([np.append(run[k][::NODE_STEP], np.nan) for run in runs]) if runs else np.empty(0)
        for k in (0, 1)
    )
    return places.astype(np.float32), speeds.astype(np.float32)


def list_guesses(classroom: Classroom, lesson: Lesson, at: float) -> list[float]:
    """Return the guesses that were made for a value of the lesson's slider."""
    given = (student.guesses.get(lesson.name) for student in classroom.students.values())
    return [one[1] for one in given if one is not None and one[0] == at]


def histogram(guesses: list[float], lesson: Lesson) -> tuple[Any, Any]:
    """Return the borders of classes between the ends of a guess, and how many guesses lie in each."""
    counts, edges = np.histogram(guesses, BINS, lesson.guess_ends)
    # down to zero at both ends
    return np.concatenate([edges[:1], edges, edges[-1:]]), np.concatenate([[0], counts, [0]])
