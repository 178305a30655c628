"""One of the five lessons with live figures: a question first, then the optimum over what it is compared with."""

from functools import partial
from typing import Any

import panel_material_ui as pmui

from railjoule.core.scenario import format_scenario
from railjoule.dashboard.charts.chart import Chart
from railjoule.dashboard.look.markup import Markup, joined
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.theme import lesson_css, parts_css
from railjoule.dashboard.look.words import PHASE_WORDS
from railjoule.dashboard.pages.learn.cells import CELLS, compared_cells
from railjoule.dashboard.pages.learn.charts import LessonSpeedChart, PhasePlaneChart, PriceChart
from railjoule.dashboard.pages.learn.compute import LessonResult
from railjoule.dashboard.pages.learn.guess_form import EnergyBars, GuessForm
from railjoule.dashboard.pages.learn.guesses import GUESSES
from railjoule.dashboard.pages.learn.model import LESSONS, Lesson, guess_field
from railjoule.dashboard.pages.learn.stretch_words import ToldStretch, stretch_words
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.parts.number_field import NumberField
from railjoule.dashboard.state.workbench import Workbench

SPEED_HEIGHTS, PLANE_HEIGHTS, PRICE_HEIGHTS = (200, 250, 190), (250, 300, 240), (200, 240, 190)
LINES = {
    "coasting": "Speed, km/h: blue the optimum, dashed one constant speed",
    "multiplier": "Speed, km/h: blue the optimum, dashed the optimum with one more second",
    "recuperation": "Speed, km/h: blue the optimum, dashed without recuperation",
    "gradient": "Speed, km/h: blue planned with gradients, dashed planned for level track",
    "load": "Speed, km/h: blue planned for the actual load, dashed planned for 30 %",
}
WITH_PLANE = ("multiplier", "recuperation")
HEIGHTS = {
    **{f"lesson_{lesson.name}": SPEED_HEIGHTS for lesson in LESSONS},
    **{f"plane_{name}": PLANE_HEIGHTS for name in WITH_PLANE},
    "lesson_price": PRICE_HEIGHTS,
}
"""Of each chart [px]: in usual, wide and narrow windows."""
PLAYED = 3
"""So many lessons are played, before the others."""
PLANNED = ("gradient", "load")
"""Lessons whose plans are followed by a controller, and so keep to its braking curve."""
PLANNED_NOTE = (
    "These plans keep to the controller\u2019s braking curve; "
    "the workbench\u2019s optimum may brake harder, and needs less."
)
HIDDEN_YET = "The best run is hidden until you have guessed."
LESSON_CSS = """
:host { display: grid; grid-template-columns: minmax(300px, 430px) minmax(0, 1400px); column-gap: 36px;
  padding: 18px 20px 20px; align-items: start; border-top: 1px solid var(--rj-line); }
@media (min-width: 1100px) and (max-width: 1599px) {
  :host { grid-template-columns: minmax(300px, 0.8fr) minmax(0, 1fr); }
}
@media (max-width: 1099px) { :host { grid-template-columns: minmax(0, 1fr); padding: 14px 14px 16px; } }
"""
TEXT_CSS = """
h2 { font-size: 15px; }
p { max-width: 60ch; margin-top: 8px; font-size: 13.5px; line-height: 1.5; }
p.try { font-weight: 600; margin-top: 12px; }
details { margin: 6px 0 4px; font-size: 13.5px; }
details p { margin-top: 2px; }
summary { cursor: pointer; color: var(--rj-accent); width: fit-content; min-height: 24px; line-height: 24px; }
"""
# 50 px, as the charts beneath have left of their frames
FIGURES_CSS = """
.figures { margin: 0 0 4px 50px; grid-template-columns: 1.15fr; }
.figure { display: grid; grid-template-rows: subgrid; grid-row: span 3; align-items: end; align-content: start; }
.figure .label { white-space: normal; line-height: 1.25; }
.figure .detail { align-self: start; }
@media (min-width: 900px) and (max-width: 1599px) {
  .figure .value { font-size: 18px; } .figure.main .value { font-size: 24px; }
}
@media (max-width: 899px) { .figures { margin-left: 0; } }
"""
# -16 px, as number_field.css keeps 16 px at both sides, which the text around has not
SLIDER: dict[str, Any] = {"margin": (10, 0, 0, -16), "max_width": 430}


def more_charts(lesson: str, palette: Palette) -> tuple[PriceChart | PhasePlaneChart, ...]:
    """Return the charts that a lesson has beside that of the speeds, which are for after the guess."""
    prices = (PriceChart(PRICE_HEIGHTS[0], palette),) if lesson == "multiplier" else ()
    planes = (PhasePlaneChart(lesson, PLANE_HEIGHTS[0], palette),) if lesson in WITH_PLANE else ()
    return (*prices, *planes)


def numbered_title(lesson: Lesson) -> str:
    """Return the title of a lesson, with its number among all of the page."""
    return f"{LESSONS.index(lesson) + 1 + PLAYED}. {lesson.title}"


class LessonView:
    """One lesson."""

    def __init__(self, lesson: Lesson, state: Workbench, palette: Palette) -> None:
        self.lesson, self.state, self.guess = lesson, state, GUESSES[lesson.name]
        self._result: LessonResult | None = None
        name = lesson.name
        self.speed = LessonSpeedChart(name, LINES[name], SPEED_HEIGHTS[0], palette)
        self.more = more_charts(name, palette)
        styles = [parts_css(), TEXT_CSS]
        heading = parts.html_pane(parts.markup("<h2>{}</h2>", numbered_title(lesson)), stylesheets=styles)
        at = float(getattr(state.learn, name))
        self.form = GuessForm(name, lesson.title, self.guess, at, self._take)
        self.text, self.question = (parts.html_pane(stylesheets=styles) for _ in range(2))
        self.field = NumberField(state.learn, name, **SLIDER)
        self.figures = parts.html_pane(stylesheets=[parts_css(), FIGURES_CSS])
        self.hint, self.stretches = (parts.html_pane(stylesheets=[parts_css(), lesson_css()]) for _ in range(2))
        self.bars = EnergyBars()
        self.open = pmui.Button(
            label="Open in the workbench", variant="contained", size="small", margin=(14, 0, 0, 0), on_click=self._open
        )
        # a field has no say in whether it is seen, but the place that it stands in has
        self.explore = parts.stack(self.text, self.field, self.question)
        left = parts.stack(heading, self.form, self.explore)
        note = [parts.html_pane(parts.markup("<p class=note>{}</p>", PLANNED_NOTE))] if name in PLANNED else []
        self.end = parts.stack(*note, self.open)
        # two charts more are side by side beneath: one column of three would leave half of the page empty
        beside = (self.speed, *self.more) if len(self.more) < 2 else (self.speed,)
        charts = [chart.host for chart in beside]
        right = parts.stack(self.figures, charts[0], self.hint, self.bars, self.stretches, *charts[1:])
        lower = [parts.stack(chart.host) for chart in self.more if chart not in beside]
        self.view = parts.stack(left, right, *lower, self.end, css=LESSON_CSS)
        self._reveal(False)

    @property
    def charts(self) -> tuple[Chart, ...]:
        """The charts of the lesson."""
        return self.speed, *self.more

    def ask(self, result: LessonResult | None) -> None:
        """Show the question and, where there is a guess, the answer."""
        learn = self.state.learn
        self.form.opened = learn.lesson == self.lesson.name
        at = result.request.value if result is not None else float(getattr(learn, self.lesson.name))
        self.form.show(at, getattr(learn, guess_field(self.lesson.name)), result)

    def show(self, result: LessonResult, revealed: bool) -> None:
        """Show what the slider asks for: before the guess what the optimum is compared with, and nothing of itself."""
        self._result = result
        self._reveal(revealed)
        best, other, *_ = result.runs
        compared = {other: result.runs[other]} if self.guess.compared else {}
        if revealed:
            self.figures.object = parts.figures(CELLS[self.lesson.name](result))
            self.bars.show(result.runs, best)
            self.stretches.object = stretch_list(stretch_words(result.runs[best]))
        else:
            self.figures.object = parts.figures(compared_cells(result, other)) if compared else ""
            self.bars.show(compared, best)
        if revealed or compared:
            self.speed.show(partial(self.speed.draw, result, revealed))
        for chart in self.more if revealed else ():
            chart.show(partial(chart.draw, result))

    def _reveal(self, revealed: bool) -> None:
        """Have what tells of the optimum on the page, or nothing of it: not only out of sight."""
        lesson = self.lesson
        self.text.object = parts.markup("<p>{}</p>", lesson.text) if revealed else ""
        self.question.object = (
            parts.markup(
                '<p class="try">Try: {}</p><details><summary>Answer</summary><p>{}</p></details>',
                lesson.question,
                lesson.answer,
            )
            if revealed
            else ""
        )
        # by its text: a pane that has not been drawn yet cannot be shown in the browser
        self.hint.object = "" if revealed else parts.markup("<p class=hidden-yet>{}</p>", HIDDEN_YET)
        self.speed.host.visible = revealed or self.guess.compared
        for part in (self.explore, self.end, *(chart.host for chart in self.more)):
            part.visible = revealed
        if not revealed:
            self.stretches.object = ""
            for chart in self.charts:
                chart.waiting = None
                forget(chart)

    def _take(self, guess: float | None) -> None:
        setattr(self.state.learn, guess_field(self.lesson.name), guess)

    def _open(self, _: Any) -> None:
        """Open the scenario of the optimum that is shown."""
        if self._result is None:
            return
        run = next(iter(self._result.runs.values()))
        titled = run.scenario.model_copy(update={"title": self.lesson.title})
        self.state.scenario.open(format_scenario(titled), self.lesson.title)
        self.state.page = "Drive"


def forget(chart: Chart) -> None:
    """Empty all that a chart draws, on the page too."""
    for name, source in chart.sources.items():
        chart.put(name, **{column: [] for column in source.data})
    if isinstance(chart, LessonSpeedChart):
        chart.forget()


def stretch_list(told: tuple[ToldStretch, ...]) -> Markup:
    """Return the stretches of the best run as a list."""
    items = (
        parts.markup(
            "<li><b>{}{}<br>{}</b><span>{}</span></li>",
            parts.patch(stretch.phase),
            PHASE_WORDS[stretch.phase],
            stretch.where,
            stretch.sentence,
        )
        for stretch in told
    )
    return parts.markup("<ol class=stretches aria-label='The best run, stretch by stretch'>{}</ol>", joined(items))
