"""The lesson that is driven: its figures, and the component that drives the train in the browser."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache, partial
from typing import TYPE_CHECKING, Any

import numpy as np
import param

from railjoule.dashboard.charts.plot import Plot
from railjoule.dashboard.editor.forms import Form
from railjoule.dashboard.look import words
from railjoule.dashboard.look.markup import Markup, joined, markup
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.scripts import module
from railjoule.dashboard.look.templates import template
from railjoule.dashboard.look.theme import played_css
from railjoule.dashboard.look.tokens import variable
from railjoule.dashboard.pages.learn.by_hand import TRIES, lesson
from railjoule.dashboard.pages.learn.charts import STRIP_KMH, LessonSpeedChart
from railjoule.dashboard.pages.learn.drawn import ABOVE as DRAWN_ABOVE
from railjoule.dashboard.pages.learn.drawn import HEIGHT as DRAWN_HEIGHT
from railjoule.dashboard.pages.learn.drawn import add_ground, draw_ground
from railjoule.dashboard.pages.learn.verdict import PLAYED_TEXTS, ROOM, Verdict, best_try, details, outcome
from railjoule.dashboard.parts import html as parts

if TYPE_CHECKING:
    from railjoule.dashboard.pages.learn.page import Learn

COMMANDS = (
    ("\u2191 Power", "\u2191", "full_power"),
    ("Coast", "\u2192 or space", "coast"),
    ("\u2193 Brake", "\u2193", "brake"),
)
"""Label, key and colour of each command; their numbers in the script are their places here."""
GRID = """
:host { display: grid; grid-template: "task task" "head head" "figures clocks" "figures account" 1fr
  "keys keys" "rates rates" "details details" / minmax(0, 1.3fr) minmax(0, 1fr); gap: 4px 40px; }
@media (max-width: 899px) { :host { display: flex; gap: 4px; } }
"""
"""In narrow windows all stands below each other."""
ENERGIES = (
    ("motion", "Kinetic", "accent"),
    ("height", "Potential", "ink3"),
    ("resistance", "Resistance", "groundline"),
    ("losses", "Losses", "costbar"),
    ("returned", "Regenerated", "good"),
    ("drawn", "Drawn from the supply", "ink"),
)
"""Name, label and colour of the parts of a run's energy."""
ROOM_SHARE = 0.012
"""Of the line, beyond its ends."""


class ByHandChart(LessonSpeedChart):
    """Speeds over the distance while a train is driven: the browser fills in all but the limits."""

    def __init__(self, height: int, palette: Palette) -> None:
        super().__init__("by_hand_speed", "Speed, km/h", lesson()[0], height, palette)
        # room for the mark of a train that stands at an end
        self.set_ranges(x_ends(), (-STRIP_KMH, float(self.y_range.end)))

    def build(self) -> None:
        """Make the figure."""
        super().build()
        assert self.figure is not None
        # the track below has the numbers
        self.figure.xaxis[0].visible = False
        self.figure.min_border_bottom = 4
        for _, _, token in COMMANDS:
            self.add_strip(token, token)
        for name, token, width in (("best", "accent", 2.6), ("run", "ink", 1.8)):
            self.line(name, token, line_width=width)
        self.dots("parting", "accent", size=10)
        self.hairlines("parting", "accent", line_dash=[2, 3])
        self.dots("ghost", "accent", size=8)
        self.source("train", "x", "y", "text", "align", "offset")
        self.dots("train", "ink", size=10)
        self.grounded_signs("train", "ink", 11, text_align="align", x_offset="offset", y_offset=-8)

    def draw(self, tell: Callable[..., None]) -> None:
        """Draw the limits, and name the sources that the browser fills in."""
        self.draw_limits()
        tell(**{name: source.id for name, source in self.sources.items()})


def x_ends() -> tuple[float, float]:
    """Return the ends of the axis of places [m], with room for the mark of a train."""
    length = lesson()[0].line.length_m
    return -ROOM_SHARE * length, (1 + ROOM_SHARE) * length


def draw_height(chart: Any, tell: Callable[..., None]) -> None:
    """Draw the height of the track, and name the sources of the trains on it."""
    draw_ground(chart, lesson()[0].line, x_ends())
    tell(**{name: chart.sources[name].id for name in ("on_track", "ghost_on_track")})


def add_trains(chart: Any) -> None:
    """Add the ground, and the marks of the train and of the run to race."""
    add_ground(chart)
    chart.dots("ghost_on_track", "accent", size=9, marker="square")
    chart.dots("on_track", "ink", size=9, marker="square")


SPEED = Plot("by_hand_speed", heights=(230, 250, 190), chart=ByHandChart)
HEIGHT = replace(DRAWN_HEIGHT, name="by_hand_height", ticks=2, layers=(add_trains,), draws=draw_height)
ABOVE = replace(DRAWN_ABOVE, name="by_hand_above", heights=(90, 100, 80), ticks=2)
BY_HAND_PLOTS = (SPEED, HEIGHT, ABOVE)


@cache
def lesson_html() -> str:
    """Return the lesson as the browser begins with it."""
    texts = PLAYED_TEXTS["driven"]
    return template("drive_it").render(
        title=texts["title"], text=texts["text"], energies=ENERGIES, commands=COMMANDS, variable=variable
    )


class DriveIt(Form):
    """The lesson, driven in the browser and judged by the server.

    Parameters
    ----------
    field : str
        The field of the page that holds what was driven last.
    page : Learn
        Its host has the figures.
    """

    html = param.String(default="", doc="The lesson as HTML.")
    sources = param.Dict(default={}, doc="The sources that the browser fills in: their ids.")
    given = param.Dict(default={}, doc="Initial data of the lesson.")
    verdict = param.Dict(default={}, doc="How the run compares with the best; empty before the first time.")
    refusals = param.Integer(default=0, doc="Counts what could not be judged.")
    lead = param.String(default="", doc="The lesson that a link leads to.")

    _esm = module("drive_it")

    def __init__(self, field: str, page: "Learn") -> None:
        hear = partial(page.hear, field)
        super().__init__(
            lambda message: hear(str(message.get("what", "")), str(message.get("text", ""))),
            html=lesson_html(),
            css_classes=[f"rj-lesson-{field}"],
            stylesheets=[played_css(), ":host { display: contents; }"],
        )
        self._draw = page.host.draw
        hosts = [page.host.plots[plot.name].host for plot in BY_HAND_PLOTS]
        # of no use before there is a best run to compare with
        self.above = hosts[-1]
        self.above.visible = False
        self.view = parts.stack(
            parts.stack(*hosts, styles={"grid-area": "figures", "order": "3"}), self, css=ROOM + GRID
        )

    def begin(self, given: dict[str, Any]) -> None:
        """Begin with what `by_hand.begin` returns."""
        self.given = given
        self._draw([SPEED, HEIGHT], self._tell)

    def _tell(self, **ids: str) -> None:
        self.sources = {**self.sources, **ids}

    def refuse(self) -> None:
        """Accept input again after a failed verdict."""
        self.refusals += 1

    def show(self, verdict: Verdict, tries: Sequence[Verdict]) -> None:
        """Show a verdict beside the tries so far."""
        best = best_try(tries)
        self.above.visible = True
        place, above = np.asarray(self.given["mesh"]["position"]), np.asarray(verdict.curves["above_kwh"])
        self._draw([ABOVE], {"above": (place, above)}, x_ends=x_ends())
        self.verdict = {
            **verdict.curves,
            "head": str(outcome(verdict) + buttons(verdict, tries)),
            "details": str(details(verdict, tries)),
            "tried": len(tries),
            "note": f"best of your tries {words.energy(best.kwh)}" if best else "",
            # the same may be judged twice, and only a difference is sent to the browser
            "count": self.verdict.get("count", 0) + 1,
        }


def buttons(verdict: Verdict, tries: Sequence[Verdict]) -> Markup:
    """Return the buttons that lead on from a verdict."""
    plain, left = Markup(""), TRIES - len(tries)
    again = f"Drive again ({left} left)" if left else "Begin again with three tries"
    open_it = PLAYED_TEXTS[verdict.field]["open"]
    made = (("again", again, plain), ("watch", "Watch your run", plain), ("open", open_it, Markup(" class=main")))
    pieces = (markup("<button type=button data-what={}{}>{}</button>", what, kind, label) for what, label, kind in made)
    return markup("<div class=row>{}</div>", joined(pieces))
