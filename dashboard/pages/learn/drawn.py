"""The lesson that is drawn: a speed over the distance, the run below it, and later the best run in its time."""

import re
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
import panel as pn

from railjoule.core import Scenario, ScenarioError, Trajectory, load_scenario, solve
from railjoule.core.motion import MeshedLine, build_meshed_line
from railjoule.core.motion.line_profile import height_profile, section_borders
from railjoule.core.phases import PhaseName
from railjoule.core.scenario import Line
from railjoule.core.simulation.manual import drive_drawn
from railjoule.core.units import J_PER_KWH, MS_PER_KMH
from railjoule.dashboard.charts.axis import columns, xy
from railjoule.dashboard.charts.dress import dragged
from railjoule.dashboard.charts.plot import DASHED, Plot, Stroke
from railjoule.dashboard.look import words
from railjoule.dashboard.look.markup import joined, markup
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.typed import clock
from railjoule.dashboard.pages.learn.charts import DISTANCE, LessonSpeedChart
from railjoule.dashboard.pages.learn.lessons import TEXTS
from railjoule.dashboard.pages.learn.verdict import FASTER, MORE, PLAYED_TEXTS, ROOM, SMALL, Judged, Verdict, compare
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.parts.choices import button
from railjoule.dashboard.parts.number_field import NumberField
from railjoule.dashboard.state.numbers import TypedNumber, TypedParameters

if TYPE_CHECKING:
    from railjoule.dashboard.pages.learn.page import Learn

# ---- the judge

PRESET = "liashenko-iii"
"""A metro with a constant efficiency on a long climb, whose optimum has all four phases."""
POINTS = 35
"""A drawing has a point every 50 m."""
LEAST_KMH, MOST_KMH = 5, 80
TARGET_S = 130.0
"""The train is to arrive by then."""
DRAWN = re.compile(r"\d{1,2}(,\d{1,2})*")
REASONS: Mapping[PhaseName, str] = TEXTS["reason"]
# of the line: what is shorter nobody sees in the figure
SHORT_SHARE = 0.01
# below both of these one did as the optimum does
ALIKE_KMH, ALIKE_KWH = 1.0, 0.05
STRETCH = "{start}\u2013{end} m, {phase}: {reason}."
DID_ALIKE = "{stretch} You did much the same."
DID = "{stretch} You were {pace} and used {energy} kWh {more} here."
PACE, SAME_PACE = "{speed} km/h {faster} on average", "as fast on average"


def begin(text: str) -> dict[str, Any]:
    """Return the initial data of the browser: the line, and a drawing at the limit or from a link.

    Raises
    ------
    ScenarioError
        If the text is no drawing.
    """
    points = read_drawing(text) if text else (MOST_KMH,) * POINTS
    return {"points": list(points)}


@cache
def drawing_lesson() -> tuple[Scenario, MeshedLine]:
    """Return the scenario of the lesson, and its meshed line."""
    scenario = load_scenario(PRESET)
    return scenario, build_meshed_line(scenario)


def read_drawing(text: str) -> tuple[int, ...]:
    """Return the speeds of a drawing [km/h].

    Raises
    ------
    ScenarioError
        If there is not one whole number within the bounds for each point.
    """
    speeds = tuple(int(one) for one in text.split(",")) if DRAWN.fullmatch(text) else ()
    if len(speeds) != POINTS or not all(LEAST_KMH <= one <= MOST_KMH for one in speeds):
        raise ScenarioError(
            f"drawn must be {POINTS} whole numbers from {LEAST_KMH} to {MOST_KMH}, with commas between."
        )
    return speeds


def drive_drawing(speeds_kmh: Sequence[int]) -> Trajectory:
    """Return the run below a drawing."""
    scenario, mesh = drawing_lesson()
    places = np.linspace(0.0, float(mesh.position_m[-1]), len(speeds_kmh))
    return drive_drawn(scenario, mesh, np.interp(mesh.position_m, places, speeds_kmh) * MS_PER_KMH)


def judge(text: str) -> Verdict:
    """Compare a drawing with the best run that arrives in time, or as late as the drawing.

    Raises
    ------
    ScenarioError
        If the text is no drawing.
    """
    run = drive_drawing(read_drawing(text))
    best = solve(compared_scenario(run))
    return compare(("drawn", text), run, best, TARGET_S, tuple(stretches(run, best)))


def opened(text: str) -> Scenario:
    """Return the scenario in which the best run beside a drawing is found; errors as `judge`."""
    return compared_scenario(drive_drawing(read_drawing(text)))


def compared_scenario(run: Trajectory) -> Scenario:
    """Return the scenario of the lesson in the time that a run is allowed: its own, if it is late."""
    return drawing_lesson()[0].replace(**{"timetable.travel_time_s": max(TARGET_S, run.travel_time_s)})


def stretches(run: Trajectory, best: Trajectory) -> list[str]:
    """Return a sentence on each stretch of the best run: its action, the reason, and the action of the drawing."""
    joined: list[tuple[PhaseName, float, float]] = []
    for phase in best.phases:
        if joined and (phase.phase == joined[-1][0] or phase.end_m - phase.start_m < SHORT_SHARE * best.distance_m):
            joined[-1] = (*joined[-1][:2], phase.end_m)
        else:
            joined.append((phase.phase, phase.start_m, phase.end_m))
    return [_on_stretch(run, best, *stretch) for stretch in joined]


def _on_stretch(run: Trajectory, best: Trajectory, phase: PhaseName, start_m: float, end_m: float) -> str:
    """Return the sentence on one stretch of the best run."""
    start, end = words.number(start_m, 0), words.number(end_m, 0)
    stretch = STRETCH.format(start=start, end=end, phase=words.PHASE_WORDS[phase], reason=REASONS[phase])
    mine, least = (_pace_and_energy(one, start_m, end_m) for one in (run, best))
    faster, more = (mine[0] - least[0]) / MS_PER_KMH, mine[1] - least[1]
    if abs(faster) < ALIKE_KMH and abs(more) < ALIKE_KWH:
        return DID_ALIKE.format(stretch=stretch)
    pace = PACE.format(speed=words.number(abs(faster), 0), faster=FASTER[faster < 0])
    return DID.format(
        stretch=stretch,
        pace=SAME_PACE if abs(faster) < ALIKE_KMH else pace,
        energy=f"{abs(more):.2f}",
        more=MORE[more < 0],
    )


def _pace_and_energy(run: Trajectory, start_m: float, end_m: float) -> tuple[float, float]:
    """Return mean speed [m/s] and energy [kWh] of a run over a stretch."""
    time_s, energy_j = (
        float(np.diff(np.interp([start_m, end_m], run.position_m, one))[0]) for one in (run.time_s, run.supply_energy_j)
    )
    return (end_m - start_m) / time_s, energy_j / J_PER_KWH


# ---- the figures

TYPED_CSS = ":host { display: flex; flex-flow: row wrap; gap: 4px 12px; } :host > * { flex: 0 1 170px; margin: 0; }"
SPEEDS: Mapping[str, Stroke] = {
    "drawn": Stroke("ink3", DASHED),
    "best": Stroke("accent", {"line_width": 2.6}),
    "run": Stroke("ink"),
}


def add_ground(chart: Any) -> None:
    """Add the area below the height of the track."""
    chart.glyphs("varea", "ground", "x", "low", "high", paint={"fill_color": "ground"}).level = "underlay"


def draw_ground(chart: Any, line: Line, x_ends: tuple[float, float] | None = None) -> None:
    """Draw the height of a line, and the area below it."""
    x, y = section_borders(line), height_profile(line)
    chart.draw_curves({"height": (x, y)}, x_ends=x_ends)
    chart.put("ground", **columns(x=x, low=np.full(len(x), chart.y_range.start), high=y))


HEIGHT = Plot(
    *("drawn_height", "Track: height, m", {"height": Stroke("groundline")}, (110, 120, 110), DISTANCE),
    layers=(add_ground,),
    draws=draw_ground,
)
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


class DrawSpeed(Judged):
    """The lesson; its page has the figures, and drives what is drawn."""

    busy = "The best run is being computed."

    def __init__(self, field: str, page: "Learn") -> None:
        super().__init__(field, page.hear, TARGET_S)
        self.page, self.points = page, Points()
        self.verdict: Verdict | None = None
        self.figures, self.account = self.pane(), self.pane()
        plots = page.host.plots
        plots["drawn_speed"].drop = self._set
        self.above = plots["drawn_above"].host
        self.above.visible = False
        self.stretch = Stretch(end_m=float(drawing_lesson()[1].position_m[-1]))
        numbers = [NumberField(self.stretch, name, narrow=True) for name in Stretch.passing]
        row = parts.stack(*numbers, button("Set this speed", self.type_speed, **SMALL), css=TYPED_CSS)
        buttons = pn.Row(
            button("Show the best run", self.ask, **{**SMALL, "variant": "contained"}),
            button("Clear the drawing", lambda _: self._set((MOST_KMH,) * POINTS), **SMALL),
            margin=0,
        )
        open_it = button(PLAYED_TEXTS[field]["open"], self.open, **{**SMALL, "variant": "contained"})
        self.after = parts.stack(self.details, open_it, visible=False)
        hosts = (plots[plot.name].host for plot in DRAWN_PLOTS)
        self.played = parts.stack(self.figures, *hosts, row, buttons, self.after, self.account, visible=False)
        self.view = parts.stack(self.head, self.outcome, self.played, css=ROOM, css_classes=[f"rj-lesson-{field}"])

    @property
    def text(self) -> str:  # type: ignore[override]
        """The drawing as a text that fits into a link."""
        return ",".join(map(str, self.points))

    def lay(self, given: dict[str, Any]) -> None:
        """Draw the points that it begins with."""
        self._set(tuple(given["points"]))

    def reveal(self, verdict: Verdict) -> None:
        """Draw the best run."""
        self.verdict = verdict
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
        draw([HEIGHT], line)
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
        self.tell("")
        self.page.sketch = points
        self.draw(None)

    def type_speed(self, *_: Any) -> None:
        """Draw the speed of the fields on their stretch."""
        start_m, end_m, speed = (getattr(self.stretch, name) for name in Stretch.passing)
        places = np.linspace(0, drawing_lesson()[1].position_m[-1], POINTS)
        inside = (places >= start_m) & (places <= end_m)
        self._set(tuple(round(speed) if within else kmh for within, kmh in zip(inside, self.points, strict=True)))
