"""What the charts of Drive draw, and the bones of those that draw a line for each run."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from bokeh.models import ColumnDataSource

from railjoule.core import Trajectory
from railjoule.core.arrays import FloatArray
from railjoule.core.scenario import StrategyName
from railjoule.core.simulate.actual_run import ActualRun
from railjoule.dashboard.look import words
from railjoule.dashboard.views.charts import DistanceChart, add_zero, clear, columns, nice_range, style_of, xy

PINNED, ACTUAL = "pinned", "actual"


@dataclass(frozen=True, eq=False)
class Scene:
    """What the charts of Drive draw.

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
        The fastest run, drawn or not: the cursor tells its speed.
    """

    chosen: StrategyName
    runs: Mapping[StrategyName, Trajectory]
    pinned: Trajectory | None
    over_time: bool
    narrow: bool
    width_px: float
    actual: ActualRun | None = None
    fastest: Trajectory | None = None

    @property
    def run(self) -> Trajectory:
        """The run whose numbers are shown."""
        return self.runs[self.chosen]

    def x(self, run: Trajectory) -> FloatArray:
        """Return where a run's nodes lie on the axis."""
        return run.time_s if self.over_time else run.position_m

    def x_of_place(self, place_m: FloatArray) -> FloatArray:
        """Return where places [m] lie on the axis, as the chosen run passes them."""
        return np.interp(place_m, self.run.position_m, self.run.time_s) if self.over_time else np.asarray(place_m)

    @property
    def end(self) -> float:
        """Where the longest run ends on the axis."""
        drawn = [*self.runs.values(), *([self.pinned] if self.pinned else [])]
        drawn += [self.actual.actual] if self.actual else []
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
        """Where the actual run makes unplanned stops on the axis, and how long it stands there [s]."""
        if self.actual is None or self.actual.disturbed is None:
            return []
        run = self.actual.actual
        events = self.actual.scenario.disturbance.stops
        places = np.array([stop.position_m for stop in events])
        arrivals = np.searchsorted(run.position_m, places - 1e-6)
        x = self.x(run)[np.minimum(arrivals, len(run.position_m) - 1)]
        return [(float(place), stop.duration_s) for place, stop in zip(x, events, strict=True)]


class SceneChart(DistanceChart):
    """A chart of Drive."""

    def draw(self, scene: Scene) -> None:
        """Draw a scene."""
        raise NotImplementedError


class RunChart(SceneChart):
    """A chart with a line for each run."""

    lines: tuple[str, ...] = ()

    def add_lines(self) -> None:
        """Add a line for each strategy and the pinned run, each from a source of its own."""
        assert self.figure is not None
        for name in (PINNED, *reversed(self.lines), ACTUAL):
            draw = self.figure.step if self.stepped else self.figure.line
            mode = {"mode": "before"} if self.stepped else {}
            line = draw("x", "y", source=self.sources[name], **style_of(name), **mode)
            self.palette.paint(line.glyph, line_color=name)

    def make_sources(self) -> None:
        """Make the sources: one a line, and those that the cursor reads."""
        for name in (PINNED, *self.lines, ACTUAL):
            self.sources[name] = ColumnDataSource({"x": [], "y": []})

    def draw_lines(self, scene: Scene) -> None:
        """Fill the lines of all runs; what is not drawn is emptied."""
        named = scene.named()
        for name in (PINNED, *self.lines, ACTUAL):
            if name in named:
                self.sources[name].data = xy(scene.x(named[name]), self.values(named[name]))
            else:
                clear(self.sources[name])
        self.told["sources"] = [["planned" if scene.actual else "", self.sources[scene.chosen]]]
        if scene.actual is not None:
            self.told["sources"].append(["actual", self.sources[ACTUAL]])
        if scene.pinned is not None:
            self.told["sources"].append(["pinned", self.sources[PINNED]])

    def values(self, run: Trajectory) -> FloatArray:
        """Return what is drawn of a run, at its nodes."""
        raise NotImplementedError

    def name_colour(self, name: str) -> str:
        """Return the colour in which a line's name is written."""
        return self.palette.tokens["ink3" if name == PINNED else name]

    def add_borders(self) -> None:
        """Add the hairlines of the phases."""
        assert self.figure is not None
        self.sources["borders"] = ColumnDataSource({"x": []})
        line = self.figure.vspan("x", source=self.sources["borders"], line_width=1, line_alpha=0.55, level="underlay")
        self.palette.paint(line.glyph, line_color="line2")

    def draw_borders(self, scene: Scene) -> None:
        """Draw the hairlines of the phases."""
        ends = np.array([phase.end_s if scene.over_time else phase.end_m for phase in scene.run.phases[:-1]])
        self.sources["borders"].data = columns(x=ends)

    def add_zero(self) -> None:
        """Add the zero line."""
        assert self.figure is not None
        add_zero(self.figure, self.palette)


class CellChart(RunChart):
    """A quantity that is constant in each cell."""

    stepped = True

    def build(self) -> None:
        """Make the figure."""
        self.make_sources()
        self.frame(with_axis=self.with_axis, ticks=3, digits=self.axis_digits)
        self.add_zero()
        self.add_borders()
        self.add_lines()

    with_axis = False
    axis_digits = 0

    def of_cells(self, run: Trajectory) -> FloatArray:
        """Return what is drawn, in each cell."""
        raise NotImplementedError

    def values(self, run: Trajectory) -> FloatArray:
        """Give each node the value of the cell before it."""
        cells = self.of_cells(run)
        return np.append(cells[:1], cells)

    def draw(self, scene: Scene) -> None:
        """Draw the runs; the fastest one only where its numbers are shown."""
        self.draw_lines(scene)
        if scene.chosen != "fastest":
            clear(self.sources["fastest"])
        named = [run for name, run in scene.named().items() if name != "fastest" or scene.chosen == "fastest"]
        values = [self.values(run) for run in named]
        self.set_range(*nice_range(min(v.min() for v in values), max(v.max() for v in values), 0.08))
        self.draw_borders(scene)


def line_words(name: str, scene: Scene) -> str:
    """Return what a line is called in a chart."""
    if name == PINNED:
        assert scene.pinned is not None
        return f"pinned: {words.STRATEGY_WORDS[scene.pinned.strategy].lower()}"  # type: ignore[index]
    if name == ACTUAL:
        return "actual"
    if name == scene.chosen and scene.actual is not None:
        return "planned"
    if name == "fastest":
        return "fastest possible"
    word = words.STRATEGY_WORDS[name]  # type: ignore[index]
    return word if word.isupper() or name == "bellman" else word.lower()
