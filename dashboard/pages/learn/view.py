"""Learn: lessons that are played, and five short ones with live figures, each with a question to try."""

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from panel.viewable import Viewable

from railjoule.core.units import J_PER_KWH
from railjoule.dashboard.charts.chart import Chart
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.theme import parts_css
from railjoule.dashboard.pages.learn.charts import LessonSpeedChart, PhasePlaneChart, PriceChart
from railjoule.dashboard.pages.learn.compute import LessonResult
from railjoule.dashboard.pages.learn.draw_speed import DrawSpeed
from railjoule.dashboard.pages.learn.drive_it import DriveIt
from railjoule.dashboard.pages.learn.model import LESSONS, Lesson
from railjoule.dashboard.pages.learn.share_out import ShareOut
from railjoule.dashboard.pages.learn.work import Learn
from railjoule.dashboard.pages.page import PageView
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.parts.number_field import NumberField
from railjoule.dashboard.state.workbench import Workbench

PAGE = "Learn"
PLAYED = 3
"""So many lessons are played, before the others."""
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


class LessonView:
    """One lesson."""

    def __init__(self, lesson: Lesson, state: Workbench, palette: Palette) -> None:
        self.lesson = lesson
        name = lesson.name
        self.speed = LessonSpeedChart(name, LINES[name], SPEED_HEIGHTS[0], palette)
        self.more: tuple[PriceChart | PhasePlaneChart, ...] = ()
        if name == "multiplier":
            self.more = (PriceChart(PRICE_HEIGHTS[0], palette),)
        if name in WITH_PLANE:
            self.more = (*self.more, PhasePlaneChart(name, PLANE_HEIGHTS[0], palette))
        self.figures = parts.html_pane(stylesheets=[parts_css(), FIGURES_CSS])
        field = NumberField(state.learn, name, **SLIDER)
        number = [known.name for known in LESSONS].index(name) + 1 + PLAYED
        styles = [parts_css(), TEXT_CSS]
        text = parts.markup("<h2>{}. {}</h2><p>{}</p>", number, lesson.title, lesson.text)
        question = parts.markup(
            '<p class="try">Try: {}</p><details><summary>Answer</summary><p>{}</p></details>',
            lesson.question,
            lesson.answer,
        )
        left = parts.stack(
            parts.html_pane(text, stylesheets=styles), field, parts.html_pane(question, stylesheets=styles)
        )
        # two charts more are side by side beneath: one column of three would leave half of the page empty
        beside = (self.speed, *self.more) if len(self.more) < 2 else (self.speed,)
        right = parts.stack(self.figures, *(chart.host for chart in beside))
        lower = [parts.stack(chart.host) for chart in self.more if chart not in beside]
        self.view = parts.stack(left, right, *lower, css=LESSON_CSS)

    @property
    def charts(self) -> tuple[Chart, ...]:
        """The charts of the lesson."""
        return self.speed, *self.more

    def show(self, result: LessonResult) -> None:
        """Show what the slider asks for."""
        self.figures.object = parts.figures(CELLS[self.lesson.name](result))
        self.speed.show(partial(self.speed.draw, result))
        for chart in self.more:
            chart.show(partial(chart.draw, result))


class LearnView(PageView):
    """The page of lessons."""

    page = PAGE
    works = (Learn,)
    heights = HEIGHTS

    def make(self) -> Viewable:
        """Make the pieces of the page, and return them laid out."""
        self.lessons = {lesson.name: LessonView(lesson, self.state, self.palette) for lesson in LESSONS}
        self._shown: dict[str, LessonResult] = {}
        heading = parts.html_pane(
            parts.heading(
                self.page, "Eight lessons", "three to play, five with live figures: move a slider and they follow", ""
            )
        )
        self.drive_it, self.share_out = DriveIt(self.state), ShareOut(self.state)
        self.draw_speed = DrawSpeed(self.state)
        self.shows(self._show, (self.state.learn, ["shown", "failure"]))
        self.shows(self._show_drive, (self.state.learn, ["tried", "driven", "failure"]))
        self.shows(self._show_slack, (self.state.learn, ["slack", "failure"]))
        self.shows(self._show_drawing, (self.state.learn, ["drawing", "failure"]))
        played = (self.drive_it, self.share_out, self.draw_speed)
        return parts.stack(heading, self.message, *played, *(lesson.view for lesson in self.lessons.values()))

    @property
    def charts(self) -> tuple[Chart, ...]:
        """All charts of the page."""
        return tuple(chart for lesson in self.lessons.values() for chart in lesson.charts)

    def redraw(self) -> None:
        """Draw everything again, also the lessons whose sliders have not moved."""
        self._shown = {}
        super().redraw()

    def _show_drive(self) -> None:
        if self.state.learn.failure is not None:
            self.drive_it.refuse()
        self.drive_it.show()

    def _show_slack(self) -> None:
        if self.state.learn.failure is not None:
            self.share_out.refuse()
        self.share_out.show()

    def _show_drawing(self) -> None:
        if self.state.learn.failure is not None:
            self.draw_speed.refuse()
        self.draw_speed.show()

    def _show(self) -> None:
        learn = self.state.learn
        self.tell(learn.failure, "Shown: the last slider position that could be computed.")
        for name, result in learn.shown.items():
            if self._shown.get(name) is not result:
                self._shown[name] = result
                self.lessons[name].show(result)


def _energies(result: LessonResult, first: str, second: str) -> list[str]:
    one, other, *_ = result.runs.values()
    return [
        parts.figure(
            first,
            words.energy(one.energy_kwh),
            "kWh",
            f"in {words.time(one.travel_time_s)} s",
            term="Energy from the supply",
        ),
        parts.figure(
            second,
            words.energy(other.energy_kwh),
            "kWh",
            f"in {words.time(other.travel_time_s)} s",
            term="Energy from the supply",
        ),
    ]


def _saved(result: LessonResult, what: str) -> str:
    """Return what the first run saves of the second one's energy, or costs more."""
    one, other, *_ = result.runs.values()
    verb, amount = comparisons.saving(one.energy_kwh, other.energy_kwh)
    return parts.figure(f"{what} {verb}", *amount, "", "main", term="Saving")


def coasting_cells(result: LessonResult) -> list[str]:
    """Return the numbers of the first lesson."""
    run = result.runs["optimum"]
    coasts = sum(phase.end_m - phase.start_m for phase in run.phases if phase.phase == "coast")
    share = words.share(coasts / run.distance_m)
    return [
        _saved(result, "Coasting"),
        *_energies(result, "Optimum", "Constant speed"),
        parts.figure("Coasts", share, "%", "of the distance"),
    ]


def multiplier_cells(result: LessonResult) -> list[str]:
    """Return the numbers of the second lesson: the multiplier, and what a second more saves indeed."""
    run, later = result.runs["optimum"], result.runs["a second later"]
    price = run.price_of_time_w or 0.0
    saved = (run.energy_kwh - later.energy_kwh) * J_PER_KWH
    return [
        parts.figure("Extra second saves", words.price(price), "Wh/s", "the multiplier", "main"),
        parts.figure("Solved again", words.price(saved), "Wh", "saved by a second"),
        *_energies(result, "Optimum", "A second later"),
    ]


def recuperation_cells(result: LessonResult) -> list[str]:
    """Return the numbers of the third lesson."""
    run, steady = result.runs["optimum"], result.steady
    assert steady is not None
    cells = [_saved(result, "Recuperation"), *_energies(result, "Optimum", "Without")]
    off = next((phase.start_m for phase in run.phases if phase.phase == "coast"), None)
    where = "\u2013" if off is None else words.number(off, 0)
    cells.append(parts.figure("Motors off at", where, "m", f"brakes at {words.speed(steady.brake_ms)} km/h"))
    return cells


def gradient_cells(result: LessonResult) -> list[str]:
    """Return the numbers of the fourth lesson."""
    return [_saved(result, "Right plan"), *_energies(result, "Planned with gradients", "Planned for level track")]


def load_cells(result: LessonResult) -> list[str]:
    """Return the numbers of the fifth lesson."""
    driven = result.runs["planned for 30 %"]
    late = driven.travel_time_s - driven.scenario.travel_time_s
    return [
        _saved(result, "Right plan"),
        *_energies(result, "Planned for actual load", "Planned for 30 %"),
        parts.figure("Arrives", words.delay(late), "s", "late" if late >= 0.05 else "on time"),
    ]


CELLS: Mapping[str, Callable[[LessonResult], list[str]]] = {
    "coasting": coasting_cells,
    "multiplier": multiplier_cells,
    "recuperation": recuperation_cells,
    "gradient": gradient_cells,
    "load": load_cells,
}
"""The numbers of each lesson."""
