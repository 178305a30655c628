"""Content of the charts of Drive, and of those that draw a line for each run."""

from collections.abc import Mapping
from dataclasses import dataclass
from operator import methodcaller
from typing import Any

import numpy as np

from railjoule.core import Trajectory
from railjoule.core.arrays import FloatArray
from railjoule.core.simulation.actual_run import ActualRun
from railjoule.core.strategies import STRATEGIES
from railjoule.dashboard.charts.axis import Axis, columns
from railjoule.dashboard.charts.chart import Chart, Layer
from railjoule.dashboard.charts.dress import line_style
from railjoule.dashboard.charts.figures import DistanceChart
from railjoule.dashboard.charts.quantities import Quantity, along
from railjoule.dashboard.charts.run_lines import Curve, Line, RunLines, RunPlot
from railjoule.dashboard.look import words
from railjoule.dashboard.look.paint import Palette

PINNED, ACTUAL, VARIANT = "pinned", "actual", "variant"


@dataclass(frozen=True, eq=False)
class RunScene:
    """Content of the charts of Drive.

    Parameters
    ----------
    chosen : str
        The strategy whose numbers are shown.
    runs : mapping
        The runs to draw, the chosen one among them.
    pinned : Trajectory or None
        The run to compare with.
    over_time : bool
        Over time instead of distance.
    narrow : bool
        On a narrow screen: no labels at the ends of lines.
    width_px : float
        How wide the charts are, about.
    actual : ActualRun or None
        The actual run, if it is drawn beside the plan.
    fastest : Trajectory or None
        The fastest run, drawn or not: the cursor shows its speed.
    variant : (str, Trajectory) or None
        A run beside the chosen one, and its name at its line: simple advice, or a moved instruction.
    with_power : bool
        Power from the supply instead of current.
    """

    chosen: str
    runs: Mapping[str, Trajectory]
    pinned: Trajectory | None
    over_time: bool
    narrow: bool
    width_px: float
    actual: ActualRun | None = None
    fastest: Trajectory | None = None
    variant: tuple[str, Trajectory] | None = None
    with_power: bool = False

    @property
    def run(self) -> Trajectory:
        """The run whose numbers are shown."""
        return self.runs[self.chosen]

    def x(self, run: Trajectory) -> FloatArray:
        """Return the positions of a run's nodes on the axis."""
        return along(self.over_time).values(run)

    def x_of_place(self, place_m: FloatArray) -> FloatArray:
        """Return the positions on the axis of places [m], as the chosen run passes them."""
        return np.interp(place_m, self.run.position_m, self.run.time_s) if self.over_time else np.asarray(place_m)

    @property
    def end(self) -> float:
        """End of the longest run on the axis."""
        drawn = [*self.runs.values(), *([self.pinned] if self.pinned else [])]
        drawn += [self.actual.actual] if self.actual else []
        drawn += [self.variant[1]] if self.variant else []
        return max(float(self.x(run)[-1]) for run in drawn)

    def named(self) -> dict[str, Trajectory]:
        """Return the runs by the names of their lines, the pinned one included; the chosen one last, on top."""
        named: dict[str, Trajectory] = {PINNED: self.pinned} if self.pinned else {}
        named.update({name: run for name, run in self.runs.items() if name != self.chosen})
        named[self.chosen] = self.run
        if self.actual is not None:
            named[ACTUAL] = self.actual.actual
        return named

    @property
    def stops(self) -> list[tuple[float, float]]:
        """Unplanned stops of the actual run on the axis, with their durations [s]."""
        if self.actual is None or self.actual.disturbed is None:
            return []
        run = self.actual.actual
        events = self.actual.scenario.disturbance.stops
        places = np.array([stop.position_m for stop in events])
        # the first of the nodes at a place is the arrival; it may lie before the place by rounding
        arrivals = np.searchsorted(run.position_m, places - 1e-6)
        x = self.x(run)[np.minimum(arrivals, len(run.position_m) - 1)]
        return [(float(place), stop.duration_s) for place, stop in zip(x, events, strict=True)]


def draw_borders(chart: Chart, scene: RunScene) -> None:
    """Draw the hairlines between the phases of the chosen run."""
    ends = np.array([phase.end_s if scene.over_time else phase.end_m for phase in scene.run.phases[:-1]])
    chart.put("borders", **columns(x=ends))


STROKES: Mapping[str, Line] = {name: Line(name, line_style(name)) for name in (PINNED, *reversed(STRATEGIES), ACTUAL)}
"""The pinned run below, the optimum above all other strategies, what was driven on top."""


BORDERS: Layer = methodcaller("hairlines", "borders", "line2", line_alpha=0.55, level="underlay")
"""The hairlines of the phases."""


class SceneChart(DistanceChart):
    """A chart of Drive."""

    called = "", ""
    """Its name and its caption."""

    def __init__(self, height: int, axis: Axis, palette: Palette) -> None:
        super().__init__(*self.called, height, axis, palette)

    def alternative(self, scene: RunScene) -> str:
        """Return in words what it shows, for who cannot see it."""
        names = ", ".join(words.STRATEGY_WORDS[name] for name in scene.runs)
        return f"{self.caption}, over distance, of {names}."

    def draw(self, scene: RunScene) -> None:
        """Draw a scene."""
        raise NotImplementedError


class RunChart(RunLines, SceneChart):
    """A chart of Drive with a line for each run."""

    quantity: Quantity
    look: Mapping[str, Any] = {}
    """How its plot differs from others."""
    with_fastest = False
    """Whether the fastest run is drawn where another one's numbers are shown: it needs more than all others."""
    below: tuple[Layer, ...] = (BORDERS,)
    above: tuple[Layer, ...] = ()

    def __init__(self, height: int, axis: Axis, palette: Palette) -> None:
        layers: dict[str, Any] = {"below": self.below, "above": self.above}
        plot = RunPlot(self.quantity.name, self.quantity, STROKES, (height, height, height), **layers, **self.look)
        RunLines.__init__(self, plot, axis, palette)

    def draw(self, scene: RunScene) -> None:
        """Draw a scene."""
        self.fit(self.draw_runs(scene))

    def draw_runs(self, scene: RunScene) -> dict[str, Curve]:
        """Draw the lines of all runs and the hairlines of the phases; return the lines, the chosen one last."""
        named = {
            name: run
            for name, run in scene.named().items()
            if name != "fastest" or self.with_fastest or scene.chosen == "fastest"
        }
        drawn = self.fill(named, scene.over_time)
        labels = {scene.chosen: "planned" if scene.actual else "", ACTUAL: "actual", PINNED: "pinned"}
        self.cursor_data["sources"] = [self.read(name, word) for name, word in labels.items() if name in named]
        draw_borders(self, scene)
        return {name: drawn[name] for name in named}

    def name_colour(self, name: str) -> str:
        """Return the colour in which a line's name is written."""
        return self.palette.tokens[{PINNED: "ink3", VARIANT: "accent"}.get(name, name)]


def line_words(name: str, scene: RunScene) -> str:
    """Return the name of a line in a chart."""
    if name == PINNED:
        assert scene.pinned is not None
        return f"pinned: {words.strategy(scene.pinned.strategy).lower()}"
    if name == VARIANT and scene.variant is not None:
        return scene.variant[0]
    if name == ACTUAL:
        return "actual"
    if name == scene.chosen and scene.actual is not None:
        return "planned"
    if name == "fastest":
        return "fastest possible"
    word = words.STRATEGY_WORDS[name]
    # abbreviations and the name of a person keep their capitals
    return word if word.isupper() or name == "bellman" else word.lower()
