"""Runs with events: speed and energy of all reactions on one axis, and energy over the delay at the end."""

from collections.abc import Mapping
from functools import partial
from operator import methodcaller

import numpy as np

from railjoule.core import Trajectory
from railjoule.core.units import J_PER_KWH
from railjoule.dashboard.charts.axis import nice_range
from railjoule.dashboard.charts.plot import Plot, Stroke
from railjoule.dashboard.charts.quantities import ENERGY, SPEED
from railjoule.dashboard.charts.run_lines import DRIVEN_DASH, NAMES, Curve, Line, RunLines, RunPlot, data_range
from railjoule.dashboard.charts.track import add_limits, add_tint, draw_limits, limits_of
from railjoule.dashboard.day import EventModel
from railjoule.dashboard.look import words
from railjoule.dashboard.pages.what_if.compute import Late, Rides

LINES: Mapping[str, Line] = {
    "undisturbed": Line("pinned", {"line_width": 1.8}),
    "driver": Line("driven", {"line_width": 1.8, "line_dash": DRIVEN_DASH}),
    "with advance notice": Line("phases", {"line_width": 2.0, "line_dash": [2, 2]}, "known"),
    "replanned": Line("accent", {"line_width": 2.2}, "computer"),
}
"""Colour and stroke of each ride by its name at the line and under the cursor, in the order of drawing."""
NAME_TOKENS = {"undisturbed": "ink3"}
"""Colours of names whose lines are too pale for text."""
HEADROOM = 1.28
"""The upper end of the axis over the highest speed: the signs of the events stand between."""
SAVED_OVER_S = 1.5
"""The saving of a second is that of the first delay which is so much later than the smallest one [s]."""
SIGN_DROP_PX = 15
"""The sign of an event hangs down so far from its place."""


def draw_rides(chart: RunLines, runs: Mapping[str, Trajectory], events: list[EventModel], over_time: bool) -> None:
    """Draw all rides, the events and where they become known."""
    lines = chart.fill(runs, over_time)
    top = HEADROOM * data_range(lines.values())[1]
    chart.set_range(0, top)
    # over time each run has borders of its own
    limits = (np.zeros(2), np.zeros(1)) if over_time else limits_of(runs["undisturbed"].scenario)
    border = draw_limits(chart, *limits)
    shown = [] if over_time else [event for event in events if event.kind in {"stop", "limit"}]
    chart.put(
        "events",
        x=[event.position_m for event in shown],
        # at three heights by turns, as events may be close to each other
        y=[top * (0.99 - 0.08 * (k % 3)) for k in range(len(shown))],
        text=[event.sign for event in shown],
    )
    lowered = [event for event in shown if event.kind == "limit"]
    chart.put(
        "limits",
        left=[event.position_m for event in lowered],
        right=[event.to_m for event in lowered],
        bottom=[event.limit_kmh for event in lowered],
    )
    chart.put("notices", x=[] if over_time else [event.noticed_at_m for event in events])
    _draw_names(chart, lines, {} if over_time else {"limit": border})


def _draw_names(chart: RunLines, lines: Mapping[str, Curve], limit: Mapping[str, Curve]) -> None:
    """Name the lines where nothing else is, and clear of the signs of the events."""
    events, frame = chart.sources["events"].data, chart.frame_now
    limits = chart.sources["limits"].data
    borders = {
        f"limit {k}": (np.array([left, right]), np.array([level, level]))
        for k, (left, right, level) in enumerate(zip(limits["left"], limits["right"], limits["bottom"], strict=True))
    }
    hairlines = [*events["x"], *chart.sources["notices"].data["x"]]
    upright = {f"hairline {k}": frame.upright(float(x)) for k, x in enumerate(hairlines)}
    # from the top downwards
    taken = [
        frame.box(x, y, text, lift_px=-SIGN_DROP_PX)
        for x, y, text in zip(events["x"], events["y"], events["text"], strict=True)
    ]
    chart.name_lines(lines, {**limit, **borders, **upright}, taken, NAME_TOKENS)


RIDES = "events"
SPEEDS = RunPlot(
    *("ride_speed", SPEED, LINES, (300, 380, 240)),
    ticks=5,
    axis=RIDES,
    below=(
        add_limits,
        methodcaller("source", "limits", "left", "right", "bottom"),
        partial(add_tint, name="limits"),
        methodcaller("source", "events", "x", "y", "text"),
        methodcaller("hairlines", "events", "limit", line_width=1.4),
        methodcaller("hairlines", "notices", "ink3", line_dash=[1, 3]),
        methodcaller("take_presses"),
    ),
    above=(methodcaller("signs", "events", "limit", x_offset=4, text_baseline="top"), NAMES),
    draws=draw_rides,
)
"""Speeds, with the events where they happen; a press drops a new one."""
ENERGIES = RunPlot("ride_energy", ENERGY, LINES, (170, 200, 150), digits=1, last=True, axis=RIDES)
LATE = Plot(
    "late_arrival",
    "Energy, kWh, over the delay at the end, s",
    {
        **{line.of or name: Stroke(line.token, line.stroke) for name, line in LINES.items() if name != "undisturbed"},
        "present": Stroke("accent", marks=True, line=False),
    },
    (240, 280, 210),
    x_title="Delay at the end, s",
    digits=1,
)


def late_curves(late: Late, rides: Rides) -> dict[str, Curve]:
    """Return energy over delay by reaction, and the present runs, by the names in `LATE`."""
    points = {reaction: (ride.delay_s, ride.actual.energy_kwh) for reaction, ride in rides.rides.items()}
    curves: dict[str, Curve] = {}
    for reaction, values in late.items():
        if np.any(np.isfinite(values)):
            # the present run is one more point of its curve, so that the curve leads through it
            delay, energy = np.column_stack([values[:, np.isfinite(values[1])], points[reaction]])
            # the delay at the end need not rise with the accepted one
            delays, chosen = np.unique(delay, return_index=True)
            curves[reaction] = delays, energy[chosen]
    present = np.array([*points.values()]).T
    return {**curves, "present": (present[0], present[1])}


def late_ends(curves: Mapping[str, Curve]) -> tuple[tuple[float, float], tuple[float, float]] | None:
    """Return the ends of both axes; None as long as no curve has a point."""
    if curves.keys() == {"present"}:
        return None
    delays, energies = (np.concatenate([curve[k] for curve in curves.values()]) for k in (0, 1))
    # where nothing is late, the axis must still have a length
    return (min(0.0, float(delays.min())), float(delays.max()) + 1e-6), nice_range(energies.min(), energies.max())


def saved_by(late: Late, reaction: str) -> str:
    """Return the saving by the first seconds of delay, in words."""
    delay, energy = late[reaction][:, np.isfinite(late[reaction][1])]  # type: ignore[index]
    # a train that cannot make up all of its delay arrives no later for the first delays that are accepted
    later = np.flatnonzero(delay >= delay[:1] + SAVED_OVER_S)
    if not len(later):
        return words.UNKNOWN
    return words.price((energy[0] - energy[later[0]]) / (delay[later[0]] - delay[0]) * J_PER_KWH)
