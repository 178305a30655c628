"""The plan and what was driven: speed, effort, the last metres before the stop, the estimated position."""

import numpy as np

from railjoule.core import Trajectory
from railjoule.core.simulation.following import Following, stop_positions_m
from railjoule.core.units import MS_PER_KMH
from railjoule.dashboard.charts.axis import xy
from railjoule.dashboard.charts.chart import Chart
from railjoule.dashboard.charts.names import Name
from railjoule.dashboard.charts.plot import CurveChart, Plot, Stroke
from railjoule.dashboard.charts.quantities import EFFORT, SPEED
from railjoule.dashboard.charts.run_lines import DRIVEN_DASH, NAMES, Line, RunLines, RunPlot, data_range
from railjoule.dashboard.look import words

BEFORE_SENSOR_M, BEYOND_STOP_M = 60.0, 20.0
"""How much of the way is drawn before the first sensor and beyond the stop [m]."""
HEADROOM = 1.22
SENSOR_ROW_PX = 15.0
SENSOR_WORDS = {"D1": "D1 resets position", "D2": "D2 calibrates", "D3": "D3 resets position"}

LOAD = "load"
"""The axis that both figures over the distance share."""
LINES = {
    "planned": Line("accent", {"line_width": 2.2}),
    "driven": Line("driven", {"line_width": 1.7, "line_dash": DRIVEN_DASH}),
}
"""The plan solid, what was driven dashed."""


def both(following: Following) -> dict[str, Trajectory]:
    """Return both runs by the names of their lines."""
    return {"planned": following.planned, "driven": following.actual}


def draw_speeds(chart: RunLines, following: Following, name: str) -> None:
    """Draw both runs; `name` is the name of the driven run."""
    lines = chart.fill(both(following))
    chart.set_range(0, HEADROOM * data_range(lines.values())[1])
    tokens = chart.palette.tokens
    names = [
        Name("planned", "planned", tokens["accent"], preferred=0.25),
        Name("driven", f"driven: {name}", tokens["driven"], preferred=0.7),
    ]
    chart.place_names(lines, names)


def add_sensors(chart: Chart) -> None:
    """Add a hairline and a name for each sensor."""
    chart.source("sensors", "x", "y", "text", "align", "offset")
    chart.hairlines("sensors", "line2")
    chart.signs("sensors", "ink2", text_align="align", x_offset="offset", text_baseline="top")


def draw_braking(chart: CurveChart, following: Following) -> None:
    """Draw the last metres of both runs before the last stop, with the sensors and the target curve."""
    scenario, stretches = following.actual.scenario, following.stretches[-1]
    stop = following.planned.position_m[-1]
    options = scenario.simulation
    zone = max([options.reset_sensor_m or 0.0, *(stop - stretch.from_m for stretch in stretches[1:])])
    first = -min((zone or stop) + BEFORE_SENSOR_M, stop)
    last = max(BEYOND_STOP_M, following.stop_error_m * 1.2)
    # at least, so that the axis of a train that stands has a height
    top = 1.0
    for name, run in both(following).items():
        near = run.position_m - stop >= first
        speed = SPEED.values(run)[near]
        chart.put(name, **xy(run.position_m[near] - stop, speed))
        top = max(top, float(speed.max()))
    before = np.linspace(-zone, 0, 80) if options.target_braking and zone else np.zeros(0)
    # v^2 = 2 a s, with s counted back from the stop
    target = np.sqrt(-2 * options.target_deceleration_ms2 * before) / MS_PER_KMH
    chart.put("target", **xy(before, target))
    chart.set_ranges((first, last), (0.0, 1.3 * top))
    draw_sensors(chart, [(s.from_m - stop, s.sensor) for s in stretches[1:]], 1.3 * top, 0.13 * top)


def draw_position_error(chart: CurveChart, following: Following) -> None:
    """Draw by how much the train assumes to be farther on than it is, over time; at a sensor that jumps."""
    run, places, errors, marks = following.actual, [], [], []
    ends = np.add(stop_positions_m(run.scenario), following.stop_errors_m)
    for stretches, end in zip(following.stretches, ends, strict=True):
        borders = [stretch.from_m for stretch in stretches[1:]]
        for stretch, until in zip(stretches, [*borders, float(end)], strict=True):
            places += [stretch.from_m, until]
            errors += [stretch.estimated_m - stretch.from_m, stretch.estimated(until) - until]
        marks += [(stretch.from_m, stretch.sensor) for stretch in stretches[1:]]
    time = np.interp(places, run.position_m, run.time_s)
    chart.put("error", **xy(time, np.array(errors)))
    # at least a metre, so that millimetres do not fill the chart
    size = max(1.0, float(np.max(np.abs(errors))))
    # more room above, where the names of the sensors stand
    chart.set_ranges((0.0, run.travel_time_s), (-1.3 * size, 1.6 * size))
    passed = [(float(np.interp(place, run.position_m, run.time_s)), sensor) for place, sensor in marks]
    # the axis is 1.3 + 1.6 = 2.9 sizes high
    row = SENSOR_ROW_PX * 2.9 * size / chart.frame_now.height_px
    draw_sensors(chart, passed, 1.6 * size, row, short=True)


def draw_sensors(chart: Chart, marks: list[tuple[float, str]], top: float, row: float, short: bool = False) -> None:
    """Put the hairlines where the sensors are, their names one below the other; the last ones left of their lines."""
    left = [sensor == "D3" for _, sensor in marks]
    chart.put(
        "sensors",
        x=[place for place, _ in marks],
        y=[0.98 * top - row * (k % 3) for k in range(len(marks))],
        text=[sensor if short else SENSOR_WORDS[sensor] for _, sensor in marks],
        align=["right" if aside else "left" for aside in left],
        offset=[-4 if aside else 4 for aside in left],
    )


def reality_words(load_factor: float, error_m: float) -> str:
    """Return the actual load and position error, such as 'load 100 %, +10 m'."""
    return f"load {words.setting(load_factor)}\u00a0%, {words.signed(error_m, 0)}\u00a0m"


SPEEDS = RunPlot(
    *("driven_speed", SPEED, LINES, (250, 310, 220)), ticks=5, axis=LOAD, above=(NAMES,), draws=draw_speeds
)
EFFORTS = RunPlot(
    *("driven_effort", EFFORT, LINES, (134, 150, 120), "Effort, kN", 3),
    zero=True,
    room=0.08,
    last=True,
    axis=LOAD,
    draws=lambda chart, following: chart.draw_fitted(both(following)),
)
BRAKING = Plot(
    "braking",
    "Precision braking: speed, km/h, before the stop",
    {"target": Stroke("ink3", {"line_width": 1.2, "line_dash": [2, 3]})}
    | {name: Stroke(line.token, line.stroke) for name, line in LINES.items()},
    (240, 280, 220),
    "Distance from the stop, m",
    layers=(add_sensors,),
    draws=draw_braking,
)
PLACE = Plot(
    "place",
    "Position error: assumed less actual position, m",
    {"error": Stroke("driven", {"line_width": 1.7})},
    (150, 170, 140),
    "Time, s",
    ticks=3,
    zero=True,
    layers=(add_sensors,),
    draws=draw_position_error,
)
