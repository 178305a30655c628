"""The lesson that is drawn: a speed over the distance, the run below it, and later the best run in its time."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
import panel as pn
import panel_material_ui as pmui

from railjoule.core import Trajectory
from railjoule.core.motion.line_profile import height_profile, section_borders
from railjoule.core.units import MS_PER_KMH
from railjoule.dashboard.charts.axis import columns, xy
from railjoule.dashboard.charts.dress import dragged
from railjoule.dashboard.charts.plot import DASHED, Plot, Stroke
from railjoule.dashboard.look import words
from railjoule.dashboard.look.markup import joined, markup
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.theme import padded, parts_css, played_css
from railjoule.dashboard.look.typed import clock
from railjoule.dashboard.pages.learn.charts import DISTANCE, LessonSpeedChart
from railjoule.dashboard.pages.learn.drawing import LEAST_KMH, MOST_KMH, POINTS, TARGET_S, drawing_lesson
from railjoule.dashboard.pages.learn.verdict import Verdict
from railjoule.dashboard.pages.learn.verdict_words import PLAYED_TEXTS, details, outcome
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.parts.number_field import NumberField
from railjoule.dashboard.state.numbers import TypedNumber, TypedParameters

if TYPE_CHECKING:
    from railjoule.dashboard.pages.learn.page import Learn

ASK, BUSY = "Show the best run", "The best run is being computed."
ROOM = padded("14px 20px 20px", "12px 14px 16px") + ":host { border-top: 1px solid var(--rj-line); }"
TYPED_CSS = ":host { display: flex; flex-flow: row wrap; gap: 4px 12px; } :host > * { flex: 0 1 170px; margin: 0; }"
SPEEDS: Mapping[str, Stroke] = {
    "drawn": Stroke("ink3", DASHED),
    "best": Stroke("accent", {"line_width": 2.6}),
    "run": Stroke("ink"),
}
HEIGHT = Plot("drawn_height", "Track: height, m", {"height": Stroke("groundline")}, (110, 120, 110), DISTANCE)
ABOVE = Plot(
    "drawn_above", "Energy above the best, kWh", {"above": Stroke("overline")}, (120, 130, 120), DISTANCE, zero=True
)
Points = tuple[int, ...]


class DrawnSpeedChart(LessonSpeedChart):
    """Speeds over the distance; a press or a drag draws one, and `drop` takes its points once the hand is away."""

    drop: Callable[[Points], None]

    def __init__(self, height: int, palette: Palette) -> None:
        super().__init__("drawn_speed", "Speed, km/h: press and draw", drawing_lesson()[0], height, palette)

    def build(self) -> None:
        """Make the figure."""
        super().build()
        f = self.figure
        assert f is not None
        self.source("phases", "left", "right", "fill")
        self.add_strip("phases", fill_color="fill")
        for name, stroke in SPEEDS.items():
            self.line(name, stroke.token, **stroke.style)
        dropped = self.source("dropped", "y")
        dropped.on_change("data", self._take)
        ends: dict[str, Any] = {"least": LEAST_KMH, "most": MOST_KMH}
        f.js_on_event("tap", dragged(f, "draw_line", drawn=self.sources["drawn"], dropped=dropped, **ends))

    def _take(self, _attribute: str, _old: Any, new: Mapping[str, Any]) -> None:
        if len(new["y"]):
            self.drop(tuple(round(one) for one in new["y"]))

    def draw(self, points: Points, run: Trajectory | None, best_ms: Sequence[float] = ()) -> None:
        """Draw a drawing, and the runs that there are."""
        places = drawing_lesson()[1].position_m
        self.draw_limits()
        # not by `put`: the browser has moved these points unseen
        self.sources["drawn"].data = {"x": np.linspace(0, places[-1], POINTS).tolist(), "y": list(points)}
        self.put("best", **xy(places[: len(best_ms)], np.asarray(best_ms) / MS_PER_KMH))
        if run is not None:
            self.put("run", **xy(run.position_m, run.speed_ms / MS_PER_KMH))
            left, right = (np.array([getattr(phase, end) for phase in run.phases]) for end in ("start_m", "end_m"))
            fill = [self.palette.tokens[phase.phase] for phase in run.phases]
            self.put("phases", **columns(left=left, right=right), fill=fill)


SPEED = Plot("drawn_speed", "", heights=(300, 330, 260), chart=DrawnSpeedChart)
DRAWN_PLOTS = (SPEED, HEIGHT, ABOVE)


class Stretch(TypedParameters):
    """A stretch on which a speed is set without a pointer."""

    passing = ("start_m", "end_m", "speed_kmh")

    start_m = TypedNumber("From, m", "m", default=0.0, bounds=(0, 10_000))
    end_m = TypedNumber("To, m", "m", default=10_000.0, bounds=(0, 10_000))
    speed_kmh = TypedNumber("Speed, km/h", "km/h", default=60.0, bounds=(LEAST_KMH, MOST_KMH))


class DrawSpeed:
    """The lesson, with the parts of a lesson that is played.

    Parameters
    ----------
    field : str
        The field of the page that holds what was judged last.
    page : Learn
        Its host has the figures; it drives what is drawn.
    """

    def __init__(self, field: str, page: "Learn") -> None:
        self.page, self._hear = page, partial(page.hear, field)
        self.given: dict[str, Any] = {}
        self.points: Points = ()
        self.verdict: Verdict | None = None
        sheets = [parts_css(), played_css()]
        self.head, self.outcome, self.figures, self.account, self.details = (
            parts.html_pane(stylesheets=sheets) for _ in range(5)
        )
        texts = PLAYED_TEXTS[field]
        text = texts["text"].replace("{target}", clock(TARGET_S))
        self.head.object = markup("<div class=played><h2>{}</h2><p>{}</p></div>", texts["title"], text)
        self._tell("Opening")
        plots = page.host.plots
        plots["drawn_speed"].drop = self._set
        self.above = plots["drawn_above"].host
        self.above.visible = False
        self.stretch = Stretch(end_m=float(drawing_lesson()[1].position_m[-1]))
        numbers = [NumberField(self.stretch, name, narrow=True) for name in Stretch.passing]
        small: dict[str, Any] = {"size": "small", "margin": (8, 8, 0, 0)}
        typed = pmui.Button(label="Set this speed", variant="outlined", on_click=self.type_speed, **small)
        clear = pmui.Button(
            label="Clear the drawing", variant="outlined", on_click=lambda _: self._set((MOST_KMH,) * POINTS), **small
        )
        self.ask = pmui.Button(label=ASK, variant="contained", on_click=self._ask, **small)
        open_it = pmui.Button(label=texts["open"], on_click=lambda _: self._hear("open", self.text), **small)
        self.after = parts.stack(self.details, open_it, visible=False)
        hosts = (plots[plot.name].host for plot in DRAWN_PLOTS)
        row = parts.stack(*numbers, typed, css=TYPED_CSS)
        self.played = parts.stack(
            self.figures, *hosts, row, pn.Row(self.ask, clear, margin=0), self.after, self.account, visible=False
        )
        self.view = parts.stack(self.head, self.outcome, self.played, css=ROOM, css_classes=[f"rj-lesson-{field}"])

    @property
    def text(self) -> str:
        """The drawing as a text that fits into a link."""
        return ",".join(map(str, self.points))

    def begin(self, given: dict[str, Any]) -> None:
        """Begin with what `drawing.begin` returns."""
        self.given = given
        self.played.visible = True
        self._set(tuple(given["points"]))

    def refuse(self) -> None:
        """Accept input again after a failed verdict."""
        self._tell("")

    def show(self, verdict: Verdict, tries: Sequence[Verdict]) -> None:
        """Show a verdict, unless something else has been drawn since it was asked for."""
        if verdict.text == self.text:
            self.verdict = verdict
            self.outcome.object = markup("<div class=played role=status>{}</div>", outcome(verdict))
            self.details.object = markup("<div class=played>{}</div>", details(verdict, tries))
            self.after.visible = True
            self.draw(self.page.sketched)

    def draw(self, run: Trajectory | None) -> None:
        """Draw what stands now: the drawing, the run below it, and the best one where there is a verdict."""
        if not self.points:
            return
        verdict, draw = self.verdict, self.page.host.draw
        draw([SPEED], self.points, run, verdict.curves["best_ms"] if verdict else ())
        self.above.visible = verdict is not None
        if run is None:
            return
        line = run.scenario.line
        draw([HEIGHT], {"height": (section_borders(line), height_profile(line))})
        if verdict:
            draw([ABOVE], {"above": (run.position_m, np.asarray(verdict.curves["above_kwh"]))})
        spare = TARGET_S - run.travel_time_s
        margin = f"{words.tenths(abs(spare))} s {'late' if spare < 0 else 'to spare'}"
        cells = (
            parts.figure("Travel time", clock(run.travel_time_s), "", margin, "main"),
            parts.figure("Energy", words.energy(run.energy_kwh), "kWh", ""),
        )
        kinds = dict.fromkeys(phase.phase for phase in run.phases)
        legend = joined(markup("{}{} ", parts.patch(kind), words.PHASE_WORDS[kind]) for kind in kinds)
        self.figures.object = markup("{}<p class=note>{}</p>", parts.figures(cells), legend)
        self.account.object = parts.account(run)

    def _set(self, points: Points) -> None:
        """Take a drawing, which the page drives."""
        self.points, self.verdict = points, None
        self.after.visible = False
        self._tell("")
        self.page.sketch = points
        self.draw(None)

    def type_speed(self, *_: Any) -> None:
        """Draw the speed of the fields on their stretch."""
        start_m, end_m, speed = (getattr(self.stretch, name) for name in Stretch.passing)
        places = np.linspace(0, drawing_lesson()[1].position_m[-1], POINTS)
        inside = (places >= start_m) & (places <= end_m)
        self._set(tuple(round(speed) if within else kmh for within, kmh in zip(inside, self.points, strict=True)))

    def _ask(self, _: Any) -> None:
        self._tell(BUSY)
        self._hear("done", self.text)

    def _tell(self, sentence: str) -> None:
        self.outcome.object = markup("<div class=played role=status><p>{}</p></div>", sentence)
