"""The figures of Compare: speed, energy, difference and effort of all runs."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from operator import methodcaller
from typing import Literal

import numpy as np

from railjoule.core import Trajectory
from railjoule.core.arrays import FloatArray
from railjoule.core.strategies import STRATEGIES
from railjoule.dashboard.charts.axis import Axis, xy
from railjoule.dashboard.charts.dress import line_style
from railjoule.dashboard.charts.names import Name
from railjoule.dashboard.charts.quantities import EFFORT, ENERGY, SPEED, along
from railjoule.dashboard.charts.run_lines import NAMES, Curve, Line, RunLines, RunPlot, data_range
from railjoule.dashboard.charts.track import as_steps, limits_of
from railjoule.dashboard.look import words
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.tokens import PIN_DASHES
from railjoule.dashboard.pages.compare.contenders import Contender

PIN_WIDTH_PX = 1.8
MAX_READ = 6
"""Maximum number of runs whose values the cursor writes, the reference first."""
HEADROOM = 1.12
OFF_SCALE = 1.5
"""Energies over this multiple of the smallest range would press the lines of the others together."""
LINES: Mapping[str, Line] = {
    **{key: Line(key, {"line_width": PIN_WIDTH_PX, "line_dash": dash}) for key, dash in PIN_DASHES.items()},
    **{name: Line(name, line_style(name)) for name in reversed(STRATEGIES)},
}
"""Pins below strategies, the optimum on top."""


@dataclass(frozen=True)
class ComparedPlot(RunPlot):
    """A figure with a line for each of all runs.

    Parameters
    ----------
    names : str
        Names of the runs `along` their lines, or with their last value at the `ends`.
    has_limits : bool
        Whether speed limits are drawn, and the axis begins at zero.
    is_difference : bool
        Whether the value of the reference at the same place or time is subtracted.
    """

    names: Literal["along", "ends", ""] = "ends"
    has_limits: bool = False
    is_difference: bool = False

    def made(self, axis: Axis, palette: Palette) -> "ComparedChart":
        """Return its chart."""
        return ComparedChart(self, axis, palette)


class ComparedChart(RunLines):
    """Draws a `ComparedPlot`."""

    plot: ComparedPlot

    def __init__(self, plot: ComparedPlot, axis: Axis, palette: Palette) -> None:
        limit = (methodcaller("line", "limit", "limit", line_width=1.2),) if plot.has_limits else ()
        super().__init__(replace(plot, below=limit, above=(NAMES,) if plot.names else ()), axis, palette)
        # the caption also names runs that are off the scale
        self.title = self.caption
        self._reference: Trajectory | None = None
        self._over_time = False

    def values(self, run: Trajectory) -> FloatArray:
        """Return the quantity at the nodes of a run; beyond the end of the reference its last value counts."""
        values = self.quantity.values(run)
        if self.plot.is_difference and self._reference is not None:
            other, x = self._reference, along(self._over_time)
            values = values - np.interp(x.values(run), x.values(other), self.quantity.values(other))
        return values

    def draw(self, among: Sequence[Contender], reference: Contender, over_time: bool, narrow: bool) -> None:
        """Draw all runs.

        Parameters
        ----------
        among : sequence of Contender
        reference : Contender
            One of them.
        over_time : bool
            Whether they are drawn over time instead of distance.
        narrow : bool
            Whether there is no room for names at the ends.
        """
        # before the lines are filled, as `values` depends on it
        self._reference, self._over_time = reference.run, over_time
        drawn = list(among) if self.plot.has_limits else sharing_an_axis(among, reference)
        off_scale = [contender.name for contender in among if contender not in drawn]
        caption = f"{self.title} ({' and '.join(off_scale)} off the scale)" if off_scale else self.title
        self.rename(caption)
        if self.plot.is_difference:
            drawn = [contender for contender in drawn if contender is not reference] or [reference]
        curves = self.fill({contender.key: contender.run for contender in drawn}, over_time)
        first = sorted(drawn, key=lambda contender: contender is not reference)[:MAX_READ]
        self.cursor_data["sources"] = [self.read(contender.key, f"{contender.sign}:") for contender in first]
        unnamed = self._fit_axis(curves, among[0].run)
        if self.plot.names == "along":
            self._name(curves, drawn, [contender.sign for contender in drawn], unnamed)
        elif self.plot.names and narrow:
            self.clear("names")
        elif self.plot.names:
            show = words.energy_difference if self.plot.is_difference else words.energy
            ends = [f"{contender.sign} {show(float(curves[contender.key][1][-1]))}" for contender in drawn]
            self._name(curves, drawn, ends, unnamed)

    def _fit_axis(self, curves: Mapping[str, Curve], run: Trajectory) -> Mapping[str, Curve]:
        """Fit the axis to lines; draw and return the lines that have no name."""
        if not self.plot.has_limits:
            self.fit(curves)
            return {"zero": (np.array([0.0, self.axis.end]), np.zeros(2))} if self.plot.is_difference else {}
        places, limits = limits_of(run.scenario)
        self.set_range(0, HEADROOM * max(data_range(curves.values())[1], float(np.max(limits))))
        if self._over_time:
            # each run passes a limit at a time of its own: the limits of one would be false for the others
            self.clear("limit")
            return {}
        steps = as_steps(places, limits)
        self.put("limit", **xy(*steps))
        return {"limit": steps}

    def _name(
        self, curves: Mapping[str, Curve], among: Sequence[Contender], texts: Sequence[str], more: Mapping[str, Curve]
    ) -> None:
        """Write the names of the runs where there is room; `more` are lines without a name."""
        names = [
            Name(contender.key, text, self.palette.tokens[contender.key], self.plot.names == "ends")
            for contender, text in zip(among, texts, strict=True)
        ]
        self.place_names({**{contender.key: curves[contender.key] for contender in among}, **more}, names)


def sharing_an_axis(among: Sequence[Contender], reference: Contender) -> list[Contender]:
    """Return the reference and the runs whose energies can share an axis with the one that varies least."""
    ranges_j = [float(np.ptp(contender.run.supply_energy_j)) for contender in among]
    most_j = max(OFF_SCALE * min(ranges_j), ranges_j[among.index(reference)])
    return [contender for contender, range_j in zip(among, ranges_j, strict=True) if range_j <= most_j]


def end_of_run(run: Trajectory, over_time: bool) -> float:
    """Return the end of a run on the axis."""
    return float(along(over_time).values(run)[-1])


# its own name, as the energy has the column of that name in the same source
DIFFERENCE = replace(ENERGY, name="difference", words="Energy from the supply vs reference, kWh")
PLOTS = (
    ComparedPlot(
        "compared_speed", SPEED, LINES, (290, 360, 240), ticks=5, caption="Speed, km/h", names="along", has_limits=True
    ),
    ComparedPlot("compared_energy", ENERGY, LINES, (170, 210, 150), caption="Energy from the supply, kWh"),
    ComparedPlot(
        "compared_difference",
        DIFFERENCE,
        LINES,
        (140, 180, 120),
        digits=1,
        is_difference=True,
        zero=True,
        room=0.1,
    ),
    ComparedPlot(
        "compared_effort",
        EFFORT,
        LINES,
        (124, 150, 110),
        ticks=3,
        last=True,
        caption="Traction (+), braking (\u2212), kN",
        names="",
        zero=True,
        room=0.08,
    ),
)
