"""One of the five lessons with live figures: first a question, then the optimum with the run to compare."""

from typing import TYPE_CHECKING, Any

import panel_material_ui as pmui

from railjoule.core.scenario import format_scenario
from railjoule.dashboard.charts.chart import Chart
from railjoule.dashboard.charts.run_lines import RunLines
from railjoule.dashboard.look import words
from railjoule.dashboard.look.markup import Markup, joined, markup
from railjoule.dashboard.look.theme import lesson_css, parts_css
from railjoule.dashboard.look.words import PHASE_WORDS
from railjoule.dashboard.pages.learn.answers import (
    Answer,
    StretchWords,
    cells,
    compared_cells,
    energy_table,
    find_answer,
    stretch_words,
)
from railjoule.dashboard.pages.learn.charts import FIGURES, PRICE, price_curves
from railjoule.dashboard.pages.learn.compute import LessonResult
from railjoule.dashboard.pages.learn.lessons import LESSONS, Lesson
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.parts.choices import radios
from railjoule.dashboard.parts.number_field import NumberField

if TYPE_CHECKING:
    from railjoule.dashboard.pages.learn.page import Learn

PLAYED = 3
"""So many lessons are played, before the others."""
PLANNED_NOTE = (
    "These plans keep to the controller\u2019s braking curve; the optimum on Drive may brake harder, and needs less."
)
HIDDEN_YET = "The best run is hidden until you have guessed."
GUESS, AGAIN = "This is my guess", "Guess again"
# -16 px, as number_field.css keeps 16 px at both sides, which the text around has not
SLIDER: dict[str, Any] = {"margin": (10, 0, 0, -16), "max_width": 430}


class GuessedLesson:
    """The parts of one lesson.

    Parameters
    ----------
    lesson : Lesson
    page : Learn
        Its host has the figures.
    """

    def __init__(self, lesson: Lesson, page: "Learn") -> None:
        self.lesson, self.page = lesson, page
        self.result: LessonResult | None = None
        self._drawn: tuple[Any, ...] = ()
        sheets = [parts_css(), lesson_css()]
        self.charts: list[Chart] = [page.host.plots[plot.name] for plot in FIGURES[lesson.name]]
        hosts = [chart.host for chart in self.charts]
        panes = (parts.html_pane(stylesheets=sheets) for _ in range(8))
        self.question, self.outcome, self.text, self.attempt, self.figures, self.energies, self.stretches, note = panes
        number = LESSONS.index(lesson) + 1 + PLAYED
        heading = parts.html_pane(markup("<h2>{}. {}</h2>", number, lesson.title), stylesheets=sheets)
        note.object = markup("<p class=note>{}</p>", PLANNED_NOTE) if lesson.planned else ""
        choices = {f"{words.number(one, 0)} {lesson.guess_unit}": one for one in lesson.choices}
        self.control = (
            radios(page, lesson.draft, "Your guess", choices) if choices else NumberField(page, lesson.draft, **SLIDER)
        )
        self.button = pmui.Button(label=GUESS, variant="contained", size="small", margin=(8, 0), on_click=self._press)
        open_it = pmui.Button(label="Open on Drive", size="small", margin=(14, 0, 0, 0), on_click=self._open)
        self.place = NumberField(page, "place_percent", **{**SLIDER, "margin": (10, 0, 0, 34)})
        # a field has no say in whether it is seen, but the place that it stands in has
        self.asked = parts.stack(self.control)
        self.explored = parts.stack(self.text, NumberField(page, lesson.name, **SLIDER), self.attempt, note, open_it)
        self.along = parts.stack(self.place, self.energies)
        # the answer appears below the button that was pressed
        left = parts.stack(heading, self.question, self.asked, self.button, self.outcome, self.explored)
        # two further charts are side by side below: one column of three would leave half of the page empty
        beside, lower = (hosts, []) if len(hosts) < 3 else (hosts[:1], hosts[1:])
        right = parts.stack(self.figures, beside[0], self.along, *beside[1:], self.stretches)
        self.view = parts.stack(
            left, right, *map(parts.stack, lower), css=lesson_css(), css_classes=[f"rj-lesson-{lesson.name}", "lesson"]
        )

    def show(self) -> None:
        """Show the question, and with a guess the answer; before it nothing of the optimum is on the page."""
        lesson, page = self.lesson, self.page
        result, guess = (page.lessons or {}).get(lesson.name), getattr(page, lesson.guess)
        # results are compared by identity; charts have colours of the theme in their columns
        wanted = (result, guess, page.place_percent if lesson.bars else 0.0, page.desk.dark)
        if wanted == self._drawn:
            return
        self._drawn, self.result = wanted, result
        self.question.object = markup("<p class=ask>{}</p>", lesson.ask(float(getattr(page, lesson.name))))
        self.button.label = GUESS if guess is None else AGAIN
        self.asked.visible = guess is None
        self._explain(guess is not None)
        if result is None:
            return
        best, compared, *_ = result.runs
        runs = result.runs if guess is not None else {compared: result.runs[compared]} if lesson.compared else {}
        self.outcome.object = "" if guess is None else guess_html(lesson, guess, find_answer(lesson, result))
        shown = cells(lesson, result) if guess is not None else compared_cells(lesson, result) if runs else ()
        self.figures.object = parts.figures(shown) if shown else ""
        self.along.visible = bool(lesson.bars and runs)
        if lesson.bars:
            place_m = page.place_percent / 100 * result.runs[best].distance_m
            self.energies.object = energy_table(lesson, runs, place_m) if runs else ""
        self.stretches.object = (
            stretch_list(stretch_words(result.runs[best]))
            if guess is not None
            else markup("<p class=hidden-yet>{}</p>", HIDDEN_YET)
        )
        if runs:
            page.host.draw(FIGURES[lesson.name][:1], result, guess is not None)
        if guess is not None:
            self._draw_more(result)

    def _draw_more(self, result: LessonResult) -> None:
        for plot in FIGURES[self.lesson.name][1:]:
            if plot is not PRICE:
                self.page.host.draw([plot], result)
            elif result.frontier is not None:
                curves, x_ends, y_ends = price_curves(result, result.frontier)
                self.page.host.draw([plot], curves, x_ends=x_ends, y_ends=y_ends)

    def _explain(self, revealed: bool) -> None:
        """Add the explanation to the page, or remove it completely instead of hiding it."""
        lesson = self.lesson
        self.text.object = markup("<p>{}</p>", lesson.text) if revealed else ""
        tried = "<p class=try>Try: {}</p><details><summary>Answer</summary><p>{}</p></details>"
        self.attempt.object = markup(tried, lesson.attempt, lesson.answer) if revealed else ""
        self.explored.visible = revealed
        for chart in self.charts:
            chart.host.visible = revealed or (lesson.compared and chart is self.charts[0])
            if not revealed:
                forget(chart)

    def _press(self, *_: Any) -> None:
        """Take the number of the field as the guess, or take the guess back."""
        lesson, page = self.lesson, self.page
        setattr(page, lesson.guess, getattr(page, lesson.draft) if getattr(page, lesson.guess) is None else None)

    def _open(self, *_: Any) -> None:
        """Open the scenario of the optimum that is shown."""
        if self.result is not None:
            run, title = next(iter(self.result.runs.values())), self.lesson.title
            self.page.desk.scenario.open(format_scenario(run.scenario.model_copy(update={"title": title})), title)
            self.page.desk.page = "Drive"


def forget(chart: Chart) -> None:
    """Clear all data of a chart, on the page too."""
    chart.waiting = None
    for name, source in chart.sources.items():
        chart.put(name, **{column: [] for column in source.data})
    if isinstance(chart, RunLines):
        chart.forget()


def guess_html(lesson: Lesson, guess: float, answer: Answer) -> Markup:
    """Return guess and answer side by side, with one sentence on their difference."""
    sides = (
        ("mine", "Your guess", words.tenths(guess), lesson.share(guess)),
        ("right", "The answer", words.number(answer.number, lesson.digits), lesson.share(answer.number)),
    )
    return markup(
        "<div class=sides>{}</div><div class=scale aria-hidden=true>{}</div><p role=status>{}: {}</p>",
        joined(
            markup("<div class={}><small>{}</small><b>{} {}</b></div>", kind, label, number, lesson.guess_unit)
            for kind, label, number, _ in sides
        ),
        joined(markup("<i class={} style='left:{}%'></i>", kind, f"{share:.1f}") for kind, _, _, share in sides),
        lesson.difference(guess, answer.number),
        answer.because,
    )


def stretch_list(stretches: tuple[StretchWords, ...]) -> Markup:
    """Return the stretches of the best run as a list that is opened."""
    items = (
        markup(
            "<li><b>{}{}<br>{}</b><span>{}</span></li>",
            parts.patch(stretch.phase),
            PHASE_WORDS[stretch.phase],
            stretch.where,
            stretch.sentence,
        )
        for stretch in stretches
    )
    list_ = "<details><summary>Why? The best run, stretch by stretch</summary><ol class=stretches>{}</ol></details>"
    return markup(list_, joined(items))
