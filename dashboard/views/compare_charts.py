"""The charts of Compare: speed, energy, difference and effort of all runs."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from bokeh.models import ColumnDataSource

from railjoule.core import Trajectory
from railjoule.core.arrays import FloatArray
from railjoule.core.motion.line_profile import limit_steps
from railjoule.core.strategies import STRATEGIES
from railjoule.core.units import J_PER_KWH, MS_PER_KMH
from railjoule.dashboard.look import words
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.tokens import PIN_DASHES
from railjoule.dashboard.models.contenders import Contender
from railjoule.dashboard.views.charts import Axis, add_zero, clear, nice_range, style_of, xy
from railjoule.dashboard.views.line_names import Name
from railjoule.dashboard.views.run_lines import RunLinesChart

PIN_WIDTH_PX = 1.8
MOST_TOLD = 6
"""The cursor writes the values of so many runs at most, the reference first."""
HEADROOM = 1.12
Line = tuple[FloatArray, FloatArray]
FASTEST = "fastest"


def strokes() -> Mapping[str, tuple[str, dict[str, Any]]]:
    """Return colour and stroke of each line: pins beneath strategies, the optimum on top."""
    pins = {key: (key, {"line_width": PIN_WIDTH_PX, "line_dash": dash}) for key, dash in PIN_DASHES.items()}
    return {**pins, **{name: (name, style_of(name)) for name in reversed(STRATEGIES)}}


class ComparedChart(RunLinesChart):
    """A quantity of all runs."""

    strokes = strokes()

    def __init__(self, name: str, title: str, height: int, axis: Axis, palette: Palette) -> None:
        super().__init__(name, title, height, axis, palette)
        self._drawn: Mapping[str, tuple[Trajectory, bool, Trajectory | None]] = {}

    def fill_all(
        self, among: Sequence[Contender], reference: Contender, over_time: bool, against: Trajectory | None = None
    ) -> tuple[float, float]:
        """Fill the lines of all runs, and empty those of others; return the least and the greatest value.

        Lines that stay as they are, as those of pinned runs do while a slider moves, are not sent to the browser again.
        """
        drawn = {contender.key: (contender.run, over_time, against) for contender in among}
        for key in self.strokes:
            if key not in drawn:
                clear(self.sources[key])
        changed = {key: state for key, state in drawn.items() if self._drawn.get(key) != state}
        for key, (run, _, _) in changed.items():
            self.sources[key].data = xy(run.time_s if over_time else run.position_m, self.values(run))
        self._drawn = drawn
        first = [reference, *(contender for contender in among if contender is not reference)][:MOST_TOLD]
        self.told["sources"] = [[f"{contender.sign}:", self.sources[contender.key]] for contender in first]
        ends = [end for contender in among for end in self._ends(contender.run)]
        return min(ends), max(ends)

    def _ends(self, run: Trajectory) -> tuple[float, float]:
        values = self.values(run)
        return float(values.min()), float(values.max())

    def tell_left_out(self, among: Sequence[Contender], drawn: Sequence[Contender]) -> None:
        """Say in the caption which runs would need another scale."""
        left_out = [contender.name for contender in among if contender not in drawn]
        told = f"{self.words}; {' and '.join(left_out)} needs more than this scale shows" if left_out else self.words
        self.told["words"] = self.told["caption"].text = told

    def name_lines(
        self,
        among: Sequence[Contender],
        over_time: bool,
        texts: Sequence[str],
        at_end: bool = False,
        more: Mapping[str, Line] | None = None,
    ) -> None:
        """Write the names of the runs where there is room; `more` are lines without a name."""
        lines = {c.key: (c.run.time_s if over_time else c.run.position_m, self.values(c.run)) for c in among}
        colours = [self.palette.tokens[contender.key] for contender in among]
        names = [
            Name(contender.key, text, colour, at_end)
            for contender, text, colour in zip(among, texts, colours, strict=True)
        ]
        self.place_names({**lines, **(more or {})}, names)

    def name_ends(
        self,
        among: Sequence[Contender],
        over_time: bool,
        narrow: bool,
        show: Callable[[float], str],
        more: Mapping[str, Line] | None = None,
    ) -> None:
        """Write sign and last value at the ends of the lines."""
        if narrow:
            clear(self.sources["names"])
            return
        texts = [f"{contender.sign} {show(float(self.values(contender.run)[-1]))}" for contender in among]
        self.name_lines(among, over_time, texts, True, more)

    def draw(self, among: Sequence[Contender], reference: Contender, over_time: bool, narrow: bool) -> None:
        """Draw all runs."""
        raise NotImplementedError


def without_fastest(among: Sequence[Contender], reference: Contender) -> list[Contender]:
    """Return the runs whose energies can share an axis: the fastest run needs far more than all others."""
    slower = [contender for contender in among if contender.key != FASTEST or contender is reference]
    return slower or list(among)


def end_of(run: Trajectory, over_time: bool) -> float:
    """Return where a run ends on the axis."""
    return float((run.time_s if over_time else run.position_m)[-1])


class ComparedSpeedChart(ComparedChart):
    """Speeds of all runs, under the limits of the scenario."""

    unit, digits = "km/h", 1

    def __init__(self, height: int, axis: Axis, palette: Palette) -> None:
        super().__init__("compared_speed", "Speed of all runs, km/h", height, axis, palette)

    def build(self) -> None:
        """Make the figure."""
        f = self.frame(ticks=5)
        self.sources["limit"] = ColumnDataSource({"x": [], "y": []})
        limit = f.line("x", "y", source=self.sources["limit"], line_width=1.2)
        self.palette.paint(limit.glyph, line_color="limit")
        self.add_lines()
        self.add_names()

    def values(self, run: Trajectory) -> FloatArray:
        """Speed [km/h]."""
        return run.speed_ms / MS_PER_KMH

    def draw(self, among: Sequence[Contender], reference: Contender, over_time: bool, narrow: bool) -> None:
        """Draw all runs; the limits are those of the first one's line."""
        _, high = self.fill_all(among, reference, over_time)
        first = among[0].run
        vehicle, line = first.scenario.vehicle, first.scenario.line.in_running_order()
        places, limits = limit_steps(line, vehicle.traction.max_speed_kmh)
        x = np.interp(places, first.position_m, first.time_s) if over_time else np.asarray(places)
        self.sources["limit"].data = xy(np.repeat(x, 2)[1:-1], np.repeat(limits, 2))
        self.set_range(0, HEADROOM * max(high, float(np.max(limits))))
        self.name_lines(
            among, over_time, [c.sign for c in among], more={"limit": (np.repeat(x, 2)[1:-1], np.repeat(limits, 2))}
        )


class ComparedEnergyChart(ComparedChart):
    """Energy drawn so far by all runs."""

    unit, digits = "kWh", 2

    def __init__(self, height: int, axis: Axis, palette: Palette) -> None:
        super().__init__("compared_energy", "Energy drawn so far by all runs, kWh", height, axis, palette)

    def build(self) -> None:
        """Make the figure."""
        self.frame()
        self.add_lines()
        self.add_names()

    def values(self, run: Trajectory) -> FloatArray:
        """Line energy so far [kWh]."""
        return run.line_energy_j / J_PER_KWH

    def draw(self, among: Sequence[Contender], reference: Contender, over_time: bool, narrow: bool) -> None:
        """Draw all runs."""
        drawn = without_fastest(among, reference)
        self.tell_left_out(among, drawn)
        self.set_range(*nice_range(*self.fill_all(drawn, reference, over_time)))
        self.name_ends(drawn, over_time, narrow, words.energy)


class ComparedDifferenceChart(ComparedChart):
    """Energy so far of all runs less that of the reference at the same place or time."""

    unit, digits = "kWh", 2

    def __init__(self, height: int, axis: Axis, palette: Palette) -> None:
        title = "Energy so far vs reference, kWh"
        super().__init__("compared_difference", title, height, axis, palette)
        self._reference: Trajectory | None = None
        self._over_time = False

    def build(self) -> None:
        """Make the figure."""
        f = self.frame(digits=1)
        add_zero(f, self.palette)
        self.add_lines()
        self.add_names()

    def values(self, run: Trajectory) -> FloatArray:
        """Energy so far less that of the reference [kWh]; beyond the end of the reference its last value counts."""
        other = self._reference
        assert other is not None
        x, x_other = (run.time_s, other.time_s) if self._over_time else (run.position_m, other.position_m)
        return (run.line_energy_j - np.interp(x, x_other, other.line_energy_j)) / J_PER_KWH

    def draw(self, among: Sequence[Contender], reference: Contender, over_time: bool, narrow: bool) -> None:
        """Draw all runs but the reference."""
        self._reference, self._over_time = reference.run, over_time
        others = [contender for contender in without_fastest(among, reference) if contender is not reference]
        drawn = others or [reference]
        self.tell_left_out(among, [*drawn, reference])
        self.set_range(*nice_range(*self.fill_all(drawn, drawn[0], over_time, reference.run), 0.1))
        zero = {"zero": (np.array([0.0, self.axis.end]), np.zeros(2))}
        self.name_ends(drawn, over_time, narrow, words.energy_difference, zero)


class ComparedEffortChart(ComparedChart):
    """Efforts of all runs."""

    unit, digits, stepped = "kN", 0, True

    def __init__(self, height: int, axis: Axis, palette: Palette) -> None:
        title = "Tractive (+) and braking (\u2212) effort of all runs, kN"
        super().__init__("compared_effort", title, height, axis, palette)

    def build(self) -> None:
        """Make the figure."""
        f = self.frame(with_axis=True, ticks=3)
        add_zero(f, self.palette)
        self.add_lines()

    def values(self, run: Trajectory) -> FloatArray:
        """Effort [kN]; each node has that of the cell before it."""
        return np.append(run.effort_n[:1], run.effort_n) / 1e3

    def draw(self, among: Sequence[Contender], reference: Contender, over_time: bool, narrow: bool) -> None:
        """Draw all runs and name the axis."""
        drawn = without_fastest(among, reference)
        self.tell_left_out(among, drawn)
        self.set_range(*nice_range(*self.fill_all(drawn, reference, over_time), 0.08))
        assert self.figure is not None
        self.figure.xaxis.axis_label = "Time, s" if over_time else "Distance, m"
