"""The figures of Set speeds; the set speeds of the sections can be dragged."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from bokeh.events import PanEnd

from railjoule.core import Trajectory
from railjoule.core.strategies.set_speed_run import MIN_LIMIT_KMH
from railjoule.dashboard.charts import quantities
from railjoule.dashboard.charts.axis import Axis
from railjoule.dashboard.charts.level_map import MotorMapChart
from railjoule.dashboard.charts.names import Name
from railjoule.dashboard.charts.plot import AxisPlot, Plot, Stroke
from railjoule.dashboard.charts.quantities import EFFORT, ENERGY, POSITION
from railjoule.dashboard.charts.run_charts import LineStrip
from railjoule.dashboard.charts.run_lines import DRIVEN_DASH, Curve, Line, RunLines, RunPlot
from railjoule.dashboard.charts.track import END_PX, STEPS, add_limits, add_steps, draw_limits, draw_steps, limits_of
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.pages.set_speeds.compute import LimitRun, LimitTrip

WITH_SET_SPEEDS = "with the set speeds"
LINES: Mapping[str, Line] = {
    "optimal in the same time": Line("optimal", {"line_width": 1.8, "line_dash": DRIVEN_DASH}, "optimum"),
    WITH_SET_SPEEDS: Line("speed_limits", {"line_width": 2.4}, "run"),
}
"""By the names at the lines and under the cursor."""
TRIP = "trip"
"""The run of the chart of speeds, the only one to show the trip while a step is dragged."""
HEADROOM = 1.09
SIGN_RISE_PX = 8.0
"""Distance of the text of a set speed above its step."""
MIN_SECTION_M = 10
"""No section end can be dragged closer to the next one."""
STEPS_A_KMH = 2
"""Set speeds are dragged in multiples of 0.5 km/h."""


class SetSpeedChart(RunLines):
    """Speeds, with the set speeds of the sections as steps that can be dragged."""

    move: Callable[[Sequence[float], Sequence[float]], None]
    """Receives set speeds [km/h] and section ends [m] while a step is dragged."""
    release: Callable[[], None]
    """Called when the step is released."""

    def __init__(self, height: int, axis: Axis, palette: Palette) -> None:
        lines = {**LINES, WITH_SET_SPEEDS: replace(LINES[WITH_SET_SPEEDS], of=TRIP)}
        caption, heights = "Speed, km/h; drag a set speed or its end", (height, height, height)
        # it has no zoom, as a drag moves a step
        look: dict[str, Any] = {"ticks": 5, "zoom": False, "below": (add_limits,), "above": (self.add_steps,)}
        super().__init__(RunPlot("limit_speed", quantities.SPEED, lines, heights, caption, **look), axis, palette)

    def add_steps(self, _: Any) -> None:
        """Draw the steps, and let the browser drag them."""
        # `most` is set with each drawing
        bounds = {"least": MIN_LIMIT_KMH, "most": 600.0, "per": STEPS_A_KMH, "shortest": MIN_SECTION_M}
        moved, self._drag = add_steps(self, "speed_limits", shared=True, live=True, **bounds)
        moved.on_change("data", self._take)
        assert self.figure is not None
        self.figure.on_event(PanEnd, lambda _: self.release())
        self.add_names()

    def _take(self, _attribute: str, _old: Any, new: Mapping[str, Any]) -> None:
        """Take the steps that the browser has moved; the last of them ends with the line."""
        if len(new["limit"]):
            self.move([float(limit) for limit in new["limit"]], [float(place) for place in new["right"]][:-1])

    def draw(self, shown: LimitRun, limits_kmh: Sequence[float], borders_m: Sequence[float]) -> None:
        """Draw both runs, and the set speeds that stand now."""
        scenario = shown.run.scenario
        runs = both(shown)
        curves = self.fill({TRIP if name == "run" else name: run for name, run in runs.items()})
        most = scenario.vehicle.traction.max_speed_kmh
        self.set_range(0, HEADROOM * most)
        if self._drag.args["most"] != most:
            self._drag.args = {**self._drag.args, "most": most}
        line = draw_limits(self, *limits_of(scenario))
        last = len(limits_kmh) - 1
        ends = [0.0, *borders_m, scenario.line.length_m]
        draw_steps(self, [(ends[k], ends[k + 1], float(limit), k < last) for k, limit in enumerate(limits_kmh)])
        self._draw_names(curves, line)

    def _draw_names(self, curves: Mapping[str, Curve], line: Curve) -> None:
        """Name the runs clear of the steps with their handles and signs, and of the limits of the line."""
        steps, frame = self.sources[STEPS].data, self.frame_now
        # by columns ("F"): left and right end of one section after the other, each at its set speed
        ends = np.ravel([steps["left"], steps["right"]], order="F"), np.repeat(steps["limit"], 2)
        taken = []
        for x, end, level, text in zip(*(steps[name] for name in ("middle", "right", "limit", "text")), strict=True):
            taken.append(frame.box(x, level, text, 12, "center", SIGN_RISE_PX))
            taken += [frame.dot(place, level, END_PX - 2) for place in (x, end)]
        names = [Name(name, name, self.palette.tokens[LINES[name].token]) for name in reversed(list(curves))]
        self.place_names({**curves, STEPS: ends, "line": line}, names, taken)

    def draw_trip(self, trip: LimitTrip) -> None:
        """Draw the trip of the step as it is being moved."""
        self.axis.columns(TRIP).take(
            trip, {POSITION.name: trip.position_m, quantities.SPEED.name: quantities.SPEED.values(trip)}
        )


def both(shown: LimitRun) -> dict[str, Trajectory]:
    """Return the runs to draw by the names of their lines: the optimum only where there is one."""
    optimum = {} if shown.optimum is None else {"optimum": shown.optimum}
    return {**optimum, "run": shown.run}


# ---- all figures of the page

SPEED = AxisPlot("limit_speed", SetSpeedChart, (290, 360, 240))
TRACK = AxisPlot("line", LineStrip, (104, 112, 98))
OTHERS = (
    RunPlot("limit_effort", EFFORT, LINES, (104, 120, 96), ticks=3, zero=True, room=0.08),
    RunPlot("limit_energy", ENERGY, LINES, (130, 150, 120), ticks=3, zero=True, room=0.08, last=True),
)
MAP = Plot("motor_map", "", heights=(300, 360, 280), chart=MotorMapChart)
SAVED = Plot(
    "storage",
    "Saved by storage instead of brake resistors, kWh",
    {
        "receptive": Stroke("good", {"line_width": 1.2, "line_dash": [4, 3]}, "fully receptive supply"),
        "curve": Stroke("accent", {"line_width": 2.2}),
        "chosen": Stroke("accent", word="this storage", marks=True, line=False),
    },
    (220, 260, 200),
    x_title="Size, kWh",
    digits=1,
    x_digits=1,
    from_zero=True,
    uprights={"needed": "line2"},
    room=0.2,
)
