"""The charts of Compare: speed, energy, difference and effort of all runs."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from railjoule.core import Trajectory
from railjoule.core.arrays import FloatArray
from railjoule.core.strategies import STRATEGIES
from railjoule.dashboard.charts.chart import Axis, nice_range, style_of, xy
from railjoule.dashboard.charts.line_names import Name
from railjoule.dashboard.charts.quantities import EFFORT, ENERGY, SPEED, Quantity, along
from railjoule.dashboard.charts.run_lines import PLAIN, Curve, Form, Line, RunLines, as_steps, ends_of, limits_of
from railjoule.dashboard.look import words
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.tokens import PIN_DASHES
from railjoule.dashboard.pages.compare.contenders import Contender

PIN_WIDTH_PX = 1.8
MOST_TOLD = 6
"""The cursor writes the values of so many runs at most, the reference first."""
HEADROOM = 1.12
FASTEST = "fastest"
LINES: Mapping[str, Line] = {
    **{key: Line(key, {"line_width": PIN_WIDTH_PX, "line_dash": dash}) for key, dash in PIN_DASHES.items()},
    **{name: Line(name, style_of(name)) for name in reversed(STRATEGIES)},
}
"""Pins beneath strategies, the optimum on top."""


class ComparedChart(RunLines):
    """A quantity of all runs."""

    def __init__(
        self, quantity: Quantity, caption: str, height: int, axis: Axis, palette: Palette, form: Form = PLAIN
    ) -> None:
        super().__init__(f"compared_{quantity.name}", quantity, LINES, height, axis, palette, caption, form)
        self._over_time = False

    def fill_all(self, among: Sequence[Contender], reference: Contender, over_time: bool) -> dict[str, Curve]:
        """Draw the lines of all runs and no other; return what they are."""
        # before the lines are filled: `values` of differences depends on it
        self._over_time = over_time
        curves = self.fill({contender.key: contender.run for contender in among}, over_time)
        first = [reference, *(contender for contender in among if contender is not reference)][:MOST_TOLD]
        self.told["sources"] = [self.read(contender.key, f"{contender.sign}:") for contender in first]
        return curves

    def tell_left_out(self, among: Sequence[Contender], drawn: Sequence[Contender]) -> None:
        """Say in the caption which runs would need another scale."""
        left_out = [contender.name for contender in among if contender not in drawn]
        told = (
            f"{self.caption}; {' and '.join(left_out)} needs more than this scale shows" if left_out else self.caption
        )
        self.told["words"] = self.told["caption"].text = told

    def name_lines(
        self,
        curves: Mapping[str, Curve],
        among: Sequence[Contender],
        texts: Sequence[str],
        at_end: bool = False,
        more: Mapping[str, Curve] | None = None,
    ) -> None:
        """Write the names of the runs where there is room; `more` are lines without a name."""
        names = [
            Name(contender.key, text, self.palette.tokens[contender.key], at_end)
            for contender, text in zip(among, texts, strict=True)
        ]
        self.place_names({**{c.key: curves[c.key] for c in among}, **(more or {})}, names)

    def name_ends(
        self,
        curves: Mapping[str, Curve],
        among: Sequence[Contender],
        narrow: bool,
        show: Callable[[float], str],
        more: Mapping[str, Curve] | None = None,
    ) -> None:
        """Write sign and last value at the ends of the lines."""
        if narrow:
            self.clear("names")
            return
        texts = [f"{contender.sign} {show(float(curves[contender.key][1][-1]))}" for contender in among]
        self.name_lines(curves, among, texts, True, more)

    def draw(self, among: Sequence[Contender], reference: Contender, over_time: bool, narrow: bool) -> None:
        """Draw all runs."""
        raise NotImplementedError


def without_fastest(among: Sequence[Contender], reference: Contender) -> list[Contender]:
    """Return the runs whose energies can share an axis: the fastest run needs far more than all others."""
    slower = [contender for contender in among if contender.key != FASTEST or contender is reference]
    return slower or list(among)


def end_of(run: Trajectory, over_time: bool) -> float:
    """Return where a run ends on the axis."""
    return float(along(over_time).values(run)[-1])


class ComparedSpeedChart(ComparedChart):
    """Speeds of all runs, under the limits of the scenario."""

    def __init__(self, height: int, axis: Axis, palette: Palette) -> None:
        super().__init__(SPEED, "Speed of all runs, km/h", height, axis, palette, Form(ticks=5))

    def beneath(self) -> None:
        """Draw the limits beneath the lines."""
        self.line("limit", "limit", line_width=1.2)

    def above(self) -> None:
        """Write the names of the lines."""
        self.add_names()

    def draw(self, among: Sequence[Contender], reference: Contender, over_time: bool, narrow: bool) -> None:
        """Draw all runs; the limits are those of the first one's line."""
        curves = self.fill_all(among, reference, over_time)
        first = among[0].run
        places, limits = limits_of(first.scenario)
        x = np.interp(places, first.position_m, first.time_s) if over_time else places
        steps = as_steps(x, limits)
        self.put("limit", **xy(*steps))
        self.set_range(0, HEADROOM * max(ends_of(curves.values())[1], float(np.max(limits))))
        self.name_lines(curves, among, [c.sign for c in among], more={"limit": steps})


class ComparedEnergyChart(ComparedChart):
    """Energy drawn so far by all runs."""

    def __init__(self, height: int, axis: Axis, palette: Palette) -> None:
        super().__init__(ENERGY, "Energy drawn so far by all runs, kWh", height, axis, palette)

    def above(self) -> None:
        """Write the names of the lines."""
        self.add_names()

    def draw(self, among: Sequence[Contender], reference: Contender, over_time: bool, narrow: bool) -> None:
        """Draw all runs."""
        drawn = without_fastest(among, reference)
        self.tell_left_out(among, drawn)
        curves = self.fill_all(drawn, reference, over_time)
        self.set_range(*nice_range(*ends_of(curves.values())))
        self.name_ends(curves, drawn, narrow, words.energy)


class ComparedDifferenceChart(ComparedChart):
    """Energy so far of all runs less that of the reference at the same place or time."""

    def __init__(self, height: int, axis: Axis, palette: Palette) -> None:
        # a name of its own, as the energy has the column of that name in the same source
        quantity = replace(ENERGY, name="difference", words="Energy so far vs reference, kWh")
        super().__init__(quantity, quantity.words, height, axis, palette, Form(digits=1, zero=True))
        self._reference: Trajectory | None = None

    def above(self) -> None:
        """Write the names of the lines."""
        self.add_names()

    def values(self, run: Trajectory) -> FloatArray:
        """Energy so far less that of the reference [kWh]; beyond the end of the reference its last value counts."""
        other, x = self._reference, along(self._over_time)
        assert other is not None
        return ENERGY.values(run) - np.interp(x.values(run), x.values(other), ENERGY.values(other))

    def draw(self, among: Sequence[Contender], reference: Contender, over_time: bool, narrow: bool) -> None:
        """Draw all runs but the reference."""
        self._reference = reference.run
        others = [contender for contender in without_fastest(among, reference) if contender is not reference]
        drawn = others or [reference]
        # the reference is the line at zero, and not left out
        self.tell_left_out(among, [*drawn, reference])
        curves = self.fill_all(drawn, drawn[0], over_time)
        self.set_range(*nice_range(*ends_of(curves.values()), 0.1))
        # a line without a name, so that names keep clear of it
        zero = {"zero": (np.array([0.0, self.axis.end]), np.zeros(2))}
        self.name_ends(curves, drawn, narrow, words.energy_difference, zero)


class ComparedEffortChart(ComparedChart):
    """Efforts of all runs."""

    def __init__(self, height: int, axis: Axis, palette: Palette) -> None:
        title = "Tractive (+) and braking (\u2212) effort of all runs, kN"
        super().__init__(EFFORT, title, height, axis, palette, Form(ticks=3, zero=True, last=True, room=0.08))

    def draw(self, among: Sequence[Contender], reference: Contender, over_time: bool, narrow: bool) -> None:
        """Draw all runs."""
        drawn = without_fastest(among, reference)
        self.tell_left_out(among, drawn)
        curves = self.fill_all(drawn, reference, over_time)
        self.set_range(*nice_range(*ends_of(curves.values()), self.form.room))
