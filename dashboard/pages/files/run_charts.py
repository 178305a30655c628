"""A measured run beside the model's and the optimum: speeds under the limits, and energy so far."""

from collections.abc import Mapping
from dataclasses import dataclass
from operator import methodcaller

import numpy as np

from railjoule.core import Trajectory
from railjoule.core.arrays import FloatArray
from railjoule.core.measured import MeasuredRun, Saving
from railjoule.core.units import J_PER_KWH, MS_PER_KMH
from railjoule.dashboard.charts.axis import columns, xy
from railjoule.dashboard.charts.chart import Layer
from railjoule.dashboard.charts.names import Box, Name, text_width_px
from railjoule.dashboard.charts.plot import AxisPlot
from railjoule.dashboard.charts.quantities import ENERGY, SPEED, along
from railjoule.dashboard.charts.run_charts import LineStrip
from railjoule.dashboard.charts.run_lines import NAMES, Curve, Line, RunLines, RunPlot, data_range
from railjoule.dashboard.charts.track import add_limits, draw_limits, limits_of
from railjoule.dashboard.look import words
from railjoule.dashboard.pages.files.measured import energy_so_far

LINES: Mapping[str, Line] = {
    "modelled": Line("pinned", {"line_width": 1.8}),
    "optimal": Line("accent", {"line_width": 2.4}),
}
"""Colour and stroke of the computed lines, in the order of drawing."""
NAME_TOKENS = {"measured": "ink", "modelled": "ink3", "optimal": "accent"}
MOST_DOTS, NARROW_DOTS = 160, 50
"""Numbers of dots in wide and in narrow windows; more would touch and look like a line."""
HEADROOM, SIGN_PX, SIGN_LIFT_PX = 1.16, 11, 2
MEASURED = "measured"


@dataclass(frozen=True, eq=False)
class RunsScene:
    """Data of the charts.

    Parameters
    ----------
    run : MeasuredRun
    saving : Saving or None
        None while the optimum is not known.
    over_time : bool
    dot_count : int
        How many dots are drawn of what was measured, about.
    """

    run: MeasuredRun
    saving: Saving | None
    over_time: bool
    dot_count: int = MOST_DOTS

    @property
    def lines(self) -> dict[str, Trajectory]:
        """The computed runs by the names of their lines."""
        optimum = {} if self.saving is None else {"optimal": self.saving.optimum}
        return {"modelled": self.run.modelled, **optimum}

    @property
    def end(self) -> float:
        """The end of the axis."""
        return max(float(along(self.over_time).values(run)[-1]) for run in self.lines.values())

    def dots(self, time_s: FloatArray, place_m: FloatArray, values: FloatArray) -> Curve:
        """Return some of the measured values, over the axis."""
        every = max(1, -(-len(values) // self.dot_count))
        # the last one too, at which the energy of the run is read
        chosen = np.unique(np.append(np.arange(0, len(values), every), len(values) - 1))
        return (time_s if self.over_time else place_m)[chosen], values[chosen]


def fill_all(chart: RunLines, scene: RunsScene, dots: Curve | None) -> dict[str, Curve]:
    """Draw computed lines and measured dots; return all of them as lines."""
    lines = chart.fill(scene.lines, scene.over_time)
    if dots is None:
        chart.clear(MEASURED)
        return lines
    chart.put(MEASURED, **xy(*dots))
    chart.cursor_data["sources"] = [[MEASURED, chart.sources[MEASURED], "x", "y"], *chart.cursor_data["sources"]]
    return {MEASURED: dots, **lines}


def line_names(
    chart: RunLines, lines: Mapping[str, Curve], texts: Mapping[str, str], at_end: bool = False
) -> list[Name]:
    """Return the names of lines and dots, the optimum's first."""
    tokens = chart.palette.tokens
    return [Name(name, texts.get(name, name), tokens[NAME_TOKENS[name]], at_end) for name in reversed(list(lines))]


def draw_speeds(chart: RunLines, scene: RunsScene) -> None:
    """Draw speeds under the limits."""
    run = scene.run
    speeds = run.recording.speed_ms * run.placement.scale / MS_PER_KMH
    lines = fill_all(chart, scene, scene.dots(run.recording.time_s, run.position_m, speeds))
    limits = limits_of(run.scenario)
    chart.set_range(0, HEADROOM * max(float(limits[1].max()), data_range(lines.values())[1]))
    # over time, a limit holds while the measured train is on its stretch
    modelled = run.modelled
    x = np.interp(limits[0], modelled.position_m, modelled.time_s) if scene.over_time else limits[0]
    steps = draw_limits(chart, x, limits[1])
    signs = _draw_signs(chart, x, limits[1])
    chart.place_names({**lines, "limit": steps}, line_names(chart, lines, {}), signs)


def _draw_signs(chart: RunLines, borders: FloatArray, limits: FloatArray) -> list[Box]:
    """Write the limits where there is space, and return their boxes."""
    frame, texts = chart.frame_now, [f"limit {words.number(limit, 0)}" for limit in limits]
    room = np.diff(frame.x_px(borders))
    signs = [
        (float(x), float(y), text)
        for x, y, text, px in zip(borders[:-1], limits, texts, room, strict=True)
        if text_width_px(text, SIGN_PX) + 8 < px
    ]
    x, y, shown = (list(column) for column in zip(*signs, strict=True)) if signs else ([], [], [])
    chart.put("signs", x=x, y=y, text=shown)
    return [frame.box(*sign, SIGN_PX, lift_px=SIGN_LIFT_PX) for sign in signs]


def draw_energies(chart: RunLines, scene: RunsScene) -> None:
    """Draw the energy so far; the potential saving lies between the model's line and the optimum's."""
    known = energy_so_far(scene.run)
    dots = None
    if known is not None:
        time, place, energy = known
        dots = scene.dots(time, place, energy / J_PER_KWH)
    lines = fill_all(chart, scene, dots)
    _tint(chart, lines)
    chart.fit(lines)
    texts = {name: f"{name} {words.energy(float(y[-1]))}" for name, (_, y) in lines.items()}
    chart.place_names(lines, line_names(chart, lines, texts, at_end=True))


def _tint(chart: RunLines, lines: Mapping[str, Curve]) -> None:
    if "optimal" not in lines:
        chart.clear("extra")
        return
    (x, high), (places, low) = lines["modelled"], lines["optimal"]
    chart.put("extra", **columns(x=x, low=np.interp(x, places, low), high=high))


DOTS: Layer = methodcaller(
    *("glyphs", "scatter", MEASURED, "x", "y"), paint={"fill_color": "ink"}, size=3.6, line_color=None
)
SPEEDS = RunPlot(
    *("measured_speed", SPEED, LINES, (270, 340, 220)),
    ticks=5,
    axis="runs",
    below=(add_limits,),
    above=(methodcaller("signs", "signs", "limit", SIGN_PX, x_offset=4, y_offset=-SIGN_LIFT_PX), DOTS, NAMES),
    draws=draw_speeds,
)
TRACK = AxisPlot("line", LineStrip, (88, 96, 80), "runs")
ENERGIES = RunPlot(
    *("measured_energy", ENERGY, LINES, (200, 240, 180)),
    digits=1,
    last=True,
    axis="runs",
    below=(methodcaller("glyphs", "varea", "extra", "x", "low", "high", paint={"fill_color": "over"}),),
    above=(DOTS, NAMES),
    draws=draw_energies,
)
RUN_PLOTS = (SPEEDS, TRACK, ENERGIES)
