"""The lessons of a report: played and guessed as on the page Learn, with all that a server tells there in the file."""

from typing import Any

import numpy as np

from railjoule.dashboard.charts.chart import Chart
from railjoule.dashboard.look.markup import Markup, joined, markup
from railjoule.dashboard.look.theme import lesson_css, parts_css, played_css
from railjoule.dashboard.pages.learn.answers import answer_of
from railjoule.dashboard.pages.learn.cells import CELLS, compared_cells
from railjoule.dashboard.pages.learn.compute import LessonResult
from railjoule.dashboard.pages.learn.guess_form import bars_of
from railjoule.dashboard.pages.learn.guesses import GUESSES, Guess
from railjoule.dashboard.pages.learn.lesson_view import (
    FIGURES_CSS,
    HIDDEN_YET,
    PLANNED,
    PLANNED_NOTE,
    TEXT_CSS,
    numbered_title,
    stretch_list,
)
from railjoule.dashboard.pages.learn.model import LESSONS, Lesson
from railjoule.dashboard.pages.learn.stretch_words import stretch_words
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.report.figures import Figures
from railjoule.dashboard.report.findings import Findings
from railjoule.dashboard.report.lesson_charts import LessonCharts
from railjoule.dashboard.report.lesson_findings import PLAYED
from railjoule.dashboard.report.section_names import SECTION_TITLES
from railjoule.dashboard.report.sections import section

LESSON_COMPONENTS = (*PLAYED, "guess", "energy_bars")
"""What draws the lessons, on the page Learn and in a report."""
NO_INFO = ".info { display: none; }"
"""A report has no glossary that would explain a term."""
ON_PAPER = "Eight lessons stand here in the file: they are played on the screen."
INTRODUCTION = (
    "Three lessons to play and five to guess, whatever the scenario of this report. They need no network: the optima, "
    "and what is proven of them, were computed when the report was made."
)


def lessons_section(findings: Findings, figures: Figures) -> Markup:
    """Return the places of all lessons, which `report_lessons.js` fills; a sentence on paper."""
    if findings.lessons is None:
        return Markup()
    played = joined(markup('<div data-played="{}"></div>', name) for name in PLAYED)
    guessed = joined(_place(lesson, figures) for lesson in LESSONS)
    return section(
        "lessons",
        SECTION_TITLES["lessons"],
        markup('<p class="print">{}</p><p class="prose screen">{}</p>', ON_PAPER, INTRODUCTION),
        markup('<div class="screen">{}{}</div>', played, guessed),
    )


def _place(lesson: Lesson, figures: Figures) -> Markup:
    """Return the places of one lesson that asks for a guess."""
    charts = figures.lessons[lesson.name]
    speed, *more = (_figure(chart, charts, figures.places[chart]) for chart in charts.charts)
    return markup(
        '<article class="lesson" data-lesson="{name}" aria-label="{title}"><div><h3>{title}</h3>'
        '<div data-part="guess"></div><div data-part="text"></div></div>'
        '<div><div data-part="cells"></div>{speed}<div data-part="bars"></div><div data-part="told"></div>{more}</div>'
        "</article>",
        name=lesson.name,
        title=numbered_title(lesson),
        speed=speed,
        more=joined(more),
    )


def _figure(chart: Chart, charts: LessonCharts, place: str) -> Markup:
    """Return the place of a figure, which may be for after the guess alone."""
    of_speeds = chart is charts.speed
    return markup(
        '<figure class="plot"{hidden} style="min-height:{height}px">{caption}<div class="live" id="{place}"></div>'
        "</figure>",
        hidden=Markup() if of_speeds and charts.compared else Markup(" data-after hidden"),
        height=chart.height,
        # that of the speeds is drawn by the library, as the mouse writes values into it
        caption=Markup() if of_speeds else markup("<figcaption>{}</figcaption>", chart.caption),
        place=place,
    )


def lessons_data(findings: Findings, figures: Figures) -> dict[str, Any]:
    """Return all that `report_lessons.js` needs; nothing without lessons."""
    found = findings.lessons
    if found is None or not figures.lessons:
        return {}
    return {
        "played": found.played,
        "guessed": {
            lesson.name: {**_guessed(lesson, found.guessed[lesson.name]), "later": figures.lessons[lesson.name].later}
            for lesson in LESSONS
        },
        "sheets": {
            "played": played_css(),
            # those that the parts of a lesson have on the page Learn
            **dict.fromkeys(("guess", "bars"), lesson_css()),
            "text": parts_css() + TEXT_CSS,
            "cells": parts_css() + FIGURES_CSS + NO_INFO,
            "told": parts_css() + lesson_css(),
        },
    }


def _guessed(lesson: Lesson, result: LessonResult) -> dict[str, Any]:
    """Return what a lesson asks, what it answers to each guess, and what it shows before and after it."""
    guess = GUESSES[lesson.name]
    best, other, *_ = result.runs
    compared = {other: result.runs[other]} if guess.compared else {}
    note = parts.markup("<p class=note>{}</p>", PLANNED_NOTE) if lesson.name in PLANNED else Markup()
    answer = answer_of(result)
    return {
        "title": lesson.title,
        "asked": guess.asked(result.request.value),
        "verdicts": {f"{value:g}": guess.told(value, *answer) for value in possible(guess)},
        "before": {
            "cells": parts.figures(compared_cells(result, other)) if compared else "",
            "told": parts.markup("<p class=hidden-yet>{}</p>", HIDDEN_YET),
            "text": "",
            "bars": bars_of(compared, best),
        },
        "after": {
            "cells": parts.figures(CELLS[lesson.name](result)),
            "told": stretch_list(stretch_words(result.runs[best])) + note,
            "text": parts.markup("<p>{}</p>", lesson.text),
            "bars": bars_of(result.runs, best),
        },
    }


def possible(guess: Guess) -> list[float]:
    """Return all guesses that the browser can send."""
    low, high = guess.ends
    steps = round((high - low) / guess.step)
    return list(guess.choices) or np.linspace(low, high, steps + 1).tolist()
