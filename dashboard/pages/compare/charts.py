"""The runs that Compare sets side by side, those of the strategies and the pinned ones, and their figures."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from operator import methodcaller
from typing import Any

import numpy as np

from railjoule.core import Trajectory
from railjoule.core.strategies import STRATEGIES
from railjoule.dashboard.charts.axis import xy
from railjoule.dashboard.charts.dress import line_style
from railjoule.dashboard.charts.names import Name
from railjoule.dashboard.charts.quantities import EFFORT, ENERGY, POWER, SPEED, Quantity, along
from railjoule.dashboard.charts.run_lines import NAMES, Curve, Line, RunLines, RunPlot, data_range
from railjoule.dashboard.charts.track import as_steps, limits_of
from railjoule.dashboard.look import words
from railjoule.dashboard.look.tokens import PIN_DASHES
from railjoule.dashboard.work.runs import Runs
from railjoule.dashboard.workbench import Workbench

PIN_WIDTH_PX = 1.8
MAX_READ = 6
"""Maximum number of runs whose values the cursor writes, the reference first."""
HEADROOM = 1.12
AXIS = "pair"
FIRST, SECOND = "first", "second"
TOKENS: Mapping[str, str] = {FIRST: "accent", SECOND: "driven"}
OWN: Mapping[str, Any] = {"line_width": 2.4}
OTHER: Mapping[str, Any] = {"line_width": 1.2, "line_dash": [5, 3]}
"""Strokes of the column's own run and of the other one, which is drawn below it."""
LIMIT = methodcaller("line", "limit", "limit", line_width=1.2)
OFF_SCALE = 1.5
"""Energies over this multiple of the range of the reference would press the other lines together."""
LINES: Mapping[str, Line] = {
    **{key: Line(key, {"line_width": PIN_WIDTH_PX, "line_dash": dash}) for key, dash in PIN_DASHES.items()},
    **{name: Line(name, line_style(name)) for name in reversed(STRATEGIES)},
}
"""Pins below strategies, the optimum on top."""
# its own name, as the energy has the column of that name in the same source
DIFFERENCE = replace(ENERGY, name="difference")


@dataclass(frozen=True, eq=False)
class Contender:
    """A run among others.

    Parameters
    ----------
    key : str
        Its strategy, or the colour of its pin: the style of its line.
    name : str
        Its name in tables.
    sign : str
        Its name at its lines.
    run : Trajectory
        The run.
    """

    key: str
    name: str
    sign: str
    run: Trajectory

    @property
    def is_pinned(self) -> bool:
        """Whether it is a pinned run, which may have a scenario of its own."""
        return self.key not in STRATEGIES


def contenders(desk: Workbench, compared: Runs | None = None, only_ticked: bool = False) -> tuple[Contender, ...]:
    """Return the runs to compare: strategies in their order, then pins in theirs.

    Parameters
    ----------
    desk : Workbench
    compared : Runs, optional
        The runs of all strategies, which may belong to an earlier scenario: then they are left out.
    only_ticked : bool
        Whether strategies that are not ticked are left out.
    """
    runs = {} if desk.runs is None else dict(desk.runs.runs)
    if only_ticked:
        runs = {name: run for name, run in runs.items() if name in desk.drawn}
    elif compared is not None and desk.runs is not None and compared.scenario == desk.runs.scenario:
        runs = {**compared.runs, **runs}
    named = [
        Contender(name, words.STRATEGY_WORDS[name], words.STRATEGY_WORDS[name], runs[name])
        for name in STRATEGIES
        if name in runs
    ]
    pinned = [Contender(pin.colour, f"{pin.number} {pin.name}", str(pin.number), pin.trajectory) for pin in desk.pins]
    return (*named, *pinned)


def find_reference(desk: Workbench, among: Sequence[Contender], chosen: str = "") -> Contender:
    """Return the run with which others are compared.

    It is the chosen one, else the run to which the list of strategies refers, else the first run.
    """
    best = None if desk.runs is None else desk.runs.best_known
    usual = next((contender for contender in among if contender.run is best), among[0])
    return next((contender for contender in among if contender.key == chosen), usual)


# ---- figures


def fill_runs(chart: RunLines, drawn: Sequence[Contender], reference: Contender, over_time: bool) -> dict[str, Curve]:
    """Draw the lines of runs, and let the cursor read the first of them."""
    curves = chart.fill({one.key: one.run for one in drawn}, over_time)
    first = sorted(drawn, key=lambda one: one is not reference)[:MAX_READ]
    chart.cursor_data["sources"] = [chart.read(one.key, f"{one.sign}:") for one in first]
    return curves


def name_runs(
    chart: RunLines, curves: Mapping[str, Curve], texts: Mapping[str, str], more: Mapping[str, Curve], at_end: bool
) -> None:
    """Write texts at lines where there is room; `more` are lines without a name."""
    names = [Name(key, text, chart.palette.tokens[key], at_end) for key, text in texts.items()]
    chart.place_names({**{key: curves[key] for key in texts}, **more}, names)


def draw_speeds(
    chart: RunLines, among: Sequence[Contender], reference: Contender, over_time: bool, narrow: bool
) -> None:
    """Draw the speeds, and over distance the limits: over time those of one run would be false for the others."""
    curves, steps = fill_runs(chart, among, reference, over_time), as_steps(*limits_of(among[0].run.scenario))
    chart.set_range(0, HEADROOM * max(data_range(curves.values())[1], float(np.max(steps[1]))))
    more = {} if over_time else {"limit": steps}
    chart.put("limit", **xy(*more.get("limit", (np.empty(0), np.empty(0)))))
    name_runs(chart, curves, {one.key: one.sign for one in among}, more, at_end=False)


def draw_energies(
    chart: RunLines,
    among: Sequence[Contender],
    reference: Contender,
    over_time: bool,
    narrow: bool,
    is_difference: bool = False,
) -> None:
    """Draw the energies of the runs that can share an axis with the reference, or their differences from it.

    Parameters
    ----------
    chart : RunLines
    among : sequence of Contender
    reference : Contender
        One of them.
    over_time : bool
        Whether they are drawn over time instead of distance.
    narrow : bool
        Whether there is no room for names at the ends.
    is_difference : bool
        Whether the value of the reference at the same place or time is subtracted.
    """
    most_j = OFF_SCALE * np.ptp(reference.run.supply_energy_j)
    drawn = [one for one in among if np.ptp(one.run.supply_energy_j) <= most_j]
    off_scale = ", ".join(one.name for one in among if one not in drawn)
    chart.rename("; off the scale: ".join(filter(None, (chart.plot.caption, off_scale))))
    show, more = words.energy, {}
    if is_difference:
        x, other = along(over_time), reference.run
        # beyond the end of the reference its last value counts
        chart.quantity = replace(
            DIFFERENCE,
            values=lambda run: ENERGY.values(run) - np.interp(x.values(run), x.values(other), ENERGY.values(other)),
        )
        drawn = [one for one in drawn if one is not reference] or [reference]
        show, more = words.energy_difference, {"zero": (np.array([0.0, chart.axis.end]), np.zeros(2))}
    curves = fill_runs(chart, drawn, reference, over_time)
    chart.fit(curves)
    chart.clear("names")
    if not narrow:
        texts = {one.key: f"{one.sign} {show(float(curves[one.key][1][-1]))}" for one in drawn}
        name_runs(chart, curves, texts, more, at_end=True)


def draw_efforts(
    chart: RunLines, among: Sequence[Contender], reference: Contender, over_time: bool, narrow: bool
) -> None:
    """Draw the efforts of all runs."""
    chart.fit(fill_runs(chart, among, reference, over_time))


PLOTS = (
    RunPlot(
        *("compared_speed", SPEED, LINES, (290, 360, 240), "Speed, km/h"),
        ticks=5,
        below=(LIMIT,),
        above=(NAMES,),
        draws=draw_speeds,
    ),
    RunPlot(
        *("compared_energy", ENERGY, LINES, (170, 210, 150), "Energy from the supply, kWh"),
        above=(NAMES,),
        draws=draw_energies,
    ),
    RunPlot(
        *("compared_difference", DIFFERENCE, LINES, (140, 180, 120), "Energy from the supply vs reference, kWh"),
        digits=1,
        zero=True,
        room=0.1,
        above=(NAMES,),
        draws=partial(draw_energies, is_difference=True),
    ),
    RunPlot(
        *("compared_effort", EFFORT, LINES, (124, 150, 110), "Traction (+), braking (\u2212), kN"),
        ticks=3,
        last=True,
        zero=True,
        room=0.08,
        draws=draw_efforts,
    ),
)


# ---- figures of two scenarios: speed, power, energy and effort in two columns over one axis


def draw_pair_speeds(chart: RunLines, runs: Mapping[str, Trajectory], over_time: bool, own: str) -> None:
    """Draw both speeds, and over distance the limits of the column's own line."""
    curves = chart.fill(runs, over_time)
    borders = {name: limits_of(run.scenario) for name, run in runs.items()}
    # the same axis in both columns, whichever has the greater limits
    most = max(data_range(curves.values())[1], *(float(np.max(limits)) for _, limits in borders.values()))
    chart.set_range(0, HEADROOM * most)
    if over_time:
        chart.clear("limit")
    else:
        chart.put("limit", **xy(*as_steps(*borders[own])))


def _plot(own: str, quantity: Quantity, words: str, heights: tuple[int, int, int], **more: Any) -> RunPlot:
    other = SECOND if own == FIRST else FIRST
    lines = {name: Line(TOKENS[name], stroke) for name, stroke in ((other, OTHER), (own, OWN))}
    return RunPlot(
        f"{own}_{quantity.name}", quantity, lines, heights, caption=f"{own.capitalize()}: {words}", axis=AXIS, **more
    )


PAIR_PLOTS = tuple(
    plot
    for row in zip(
        *(
            (
                _plot(
                    *(own, SPEED, "speed, km/h", (240, 280, 200)),
                    ticks=5,
                    below=(LIMIT,),
                    draws=partial(draw_pair_speeds, own=own),
                ),
                _plot(own, POWER, "power, MW", (140, 170, 120), digits=1, zero=True),
                _plot(own, ENERGY, "energy so far, kWh", (150, 180, 130), digits=1),
                _plot(
                    *(own, EFFORT, "traction (+), braking (\u2212), kN", (140, 170, 130)),
                    ticks=3,
                    last=True,
                    zero=True,
                    room=0.08,
                ),
            )
            for own in (FIRST, SECOND)
        ),
        strict=True,
    )
    for plot in row
)
"""Row by row: where there is one column, each figure of the first scenario stands above that of the second."""
