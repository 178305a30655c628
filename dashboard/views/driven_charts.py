"""The plan and what was driven: speed, effort, the last metres before the stop, the estimated position."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from bokeh.models import ColumnDataSource, Range1d

from railjoule.core import Trajectory
from railjoule.core.arrays import FloatArray
from railjoule.core.simulate.following import Following, stops_of
from railjoule.core.units import MS_PER_KMH
from railjoule.dashboard.look import words
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.views.charts import Axis, Chart, add_zero, nice_range, text_style, xy
from railjoule.dashboard.views.figures import captioned, empty_figure
from railjoule.dashboard.views.line_names import Name
from railjoule.dashboard.views.run_lines import DRIVEN_DASH, RunLinesChart

BEFORE_SENSOR_M, BEYOND_STOP_M = 60.0, 20.0
"""How much of the way is drawn before the first sensor and beyond the stop [m]."""
HEADROOM = 1.22
SENSOR_ROW_PX = 15.0
SENSOR_WORDS = {"D1": "D1 resets position", "D2": "D2 calibrates", "D3": "D3 resets position"}


STROKES: Mapping[str, tuple[str, dict[str, Any]]] = {
    "planned": ("accent", {"line_width": 2.2}),
    "driven": ("driven", {"line_width": 1.7, "line_dash": DRIVEN_DASH}),
}


class DrivenChart(RunLinesChart):
    """A quantity of both runs: the plan solid, what was driven dashed."""

    strokes = STROKES

    def fill_both(self, following: Following) -> tuple[float, float]:
        """Fill both lines; return the least and the greatest value."""
        return self.fill({"planned": following.planned, "driven": following.actual})


class DrivenSpeedChart(DrivenChart):
    """Speeds, with what was driven in words."""

    unit, digits = "km/h", 1

    def __init__(self, height: int, axis: Axis, palette: Palette) -> None:
        super().__init__("driven_speed", "Speed, km/h", height, axis, palette)

    def build(self) -> None:
        """Make the figure."""
        self.frame(ticks=5)
        self.add_lines()
        self.add_names()

    def values(self, run: Trajectory) -> FloatArray:
        """Speed [km/h]."""
        return run.speed_ms / MS_PER_KMH

    def draw(self, following: Following, name: str) -> None:
        """Draw both runs; `name` says what was driven."""
        _, high = self.fill_both(following)
        self.set_range(0, HEADROOM * high)
        runs = {"planned": following.planned, "driven": following.actual}
        lines = {key: (run.position_m, self.values(run)) for key, run in runs.items()}
        tokens = self.palette.tokens
        names = [
            Name("planned", "planned", tokens["accent"], preferred=0.25),
            Name("driven", f"driven: {name}", tokens["driven"], preferred=0.7),
        ]
        self.place_names(lines, names)


class DrivenEffortChart(DrivenChart):
    """Efforts in the cells."""

    unit, digits, stepped = "kN", 0, True

    def __init__(self, height: int, axis: Axis, palette: Palette) -> None:
        super().__init__("driven_effort", "Effort, kN", height, axis, palette)

    def build(self) -> None:
        """Make the figure."""
        f = self.frame(with_axis=True, ticks=3)
        add_zero(f, self.palette)
        f.xaxis.axis_label = "Distance, m"
        self.add_lines()

    def values(self, run: Trajectory) -> FloatArray:
        """Effort [kN]; each node has that of the cell before it."""
        return np.append(run.effort_n[:1], run.effort_n) / 1e3

    def draw(self, following: Following) -> None:
        """Draw both runs."""
        self.set_range(*nice_range(*self.fill_both(following), 0.08))


class BrakingChart(Chart):
    """The last metres before the stop, with the sensors and the target curve."""

    def __init__(self, height: int, palette: Palette) -> None:
        super().__init__("braking", "Precision braking: speed, km/h, before the stop", height)
        self.palette, self.x_range, self.y_range = palette, Range1d(-1, 1), Range1d(0, 1)

    def build(self) -> None:
        """Make the figure."""
        f = empty_figure(
            self.height,
            self.x_range,
            self.y_range,
            self.words,
            self.palette,
            ticks=4,
            x_title="Distance from the stop, m",
        )
        self.figure = f
        self.sources = {name: ColumnDataSource({"x": [], "y": []}) for name in ("target", "planned", "driven")}
        for name, token, style in (
            ("target", "ink3", {"line_width": 1.2, "line_dash": [2, 3]}),
            ("planned", "accent", {"line_width": 2.2}),
            ("driven", "driven", {"line_width": 1.7, "line_dash": DRIVEN_DASH}),
        ):
            line = f.line("x", "y", source=self.sources[name], **style)
            self.palette.paint(line.glyph, line_color=token)
        self.sensors = sensor_marks(f, self.palette)
        self.content = captioned(self.words, f)

    def draw(self, following: Following) -> None:
        """Draw both runs near the last stop."""
        scenario, way = following.actual.scenario, following.courses[-1]
        stop = following.planned.position_m[-1]
        options = scenario.simulation
        zone = max([options.reset_sensor_m or 0.0, *(stop - stretch.from_m for stretch in way[1:])])
        first = -min((zone or stop) + BEFORE_SENSOR_M, stop)
        last = max(BEYOND_STOP_M, following.stop_error_m * 1.2)
        top = 1.0
        for name, run in (("planned", following.planned), ("driven", following.actual)):
            near = run.position_m - stop >= first
            speed = run.speed_ms[near] / MS_PER_KMH
            self.sources[name].data = xy(run.position_m[near] - stop, speed)
            top = max(top, float(speed.max()))
        before = np.linspace(-zone, 0, 80) if options.target_braking and zone else np.zeros(0)
        target = np.sqrt(-2 * options.target_deceleration_ms2 * before) / MS_PER_KMH
        self.sources["target"].data = xy(before, target)
        self.x_range.update(start=first, end=last)
        self.y_range.update(start=0, end=1.3 * top)
        mark_sensors(self.sensors, [(s.from_m - stop, s.sensor) for s in way[1:]], 1.3 * top, 0.13 * top)


class PlaceErrorChart(Chart):
    """By how much the train assumes to be farther on than it is, over time."""

    def __init__(self, height: int, palette: Palette) -> None:
        super().__init__("place", "Position error: assumed less actual position, m", height)
        self.palette, self.x_range, self.y_range = palette, Range1d(0, 1), Range1d(0, 1)

    def build(self) -> None:
        """Make the figure."""
        f = empty_figure(self.height, self.x_range, self.y_range, self.words, self.palette, ticks=3, x_title="Time, s")
        self.figure = f
        add_zero(f, self.palette)
        self.source = ColumnDataSource({"x": [], "y": []})
        line = f.line("x", "y", source=self.source, line_width=1.7)
        self.palette.paint(line.glyph, line_color="driven")
        self.sensors = sensor_marks(f, self.palette)
        self.content = captioned(self.words, f)

    def draw(self, following: Following) -> None:
        """Draw the error of the place; at a sensor it jumps."""
        run, places, errors, marks = following.actual, [], [], []
        ends = np.add(stops_of(run.scenario), following.stop_errors_m)
        for way, end in zip(following.courses, ends, strict=True):
            borders = [stretch.from_m for stretch in way[1:]]
            for stretch, until in zip(way, [*borders, float(end)], strict=True):
                places += [stretch.from_m, until]
                errors += [stretch.estimated_m - stretch.from_m, stretch.estimated(until) - until]
            marks += [(stretch.from_m, stretch.sensor) for stretch in way[1:]]
        time = np.interp(places, run.position_m, run.time_s)
        self.source.data = xy(time, np.array(errors))
        size = max(1.0, float(np.max(np.abs(errors))))
        self.x_range.update(start=0, end=run.travel_time_s)
        self.y_range.update(start=-1.3 * size, end=1.6 * size)
        passed = [(float(np.interp(place, run.position_m, run.time_s)), sensor) for place, sensor in marks]
        frame = self.frame_over((0.0, run.travel_time_s), (-1.3 * size, 1.6 * size))
        row = SENSOR_ROW_PX * 2.9 * size / frame.height_px
        mark_sensors(self.sensors, passed, 1.6 * size, row, short=True)


def sensor_marks(f: Any, palette: Palette) -> ColumnDataSource:
    """Add a hairline and a name for each sensor to a figure."""
    source = ColumnDataSource({"x": [], "y": [], "text": [], "align": [], "offset": []})
    line = f.vspan("x", source=source, line_width=1)
    palette.paint(line.glyph, line_color="line2")
    sign = f.text(
        "x",
        "y",
        "text",
        text_align="align",
        x_offset="offset",
        source=source,
        text_baseline="top",
        **text_style(11),
    )
    palette.paint(sign.glyph, text_color="ink2")
    return source


def mark_sensors(
    source: ColumnDataSource, marks: list[tuple[float, str]], top: float, row: float, short: bool = False
) -> None:
    """Put the hairlines where the sensors are, their names one below the other; the last ones left of their lines."""
    left = [sensor == "D3" for _, sensor in marks]
    source.data = {
        "x": [place for place, _ in marks],
        "y": [0.98 * top - row * (k % 3) for k in range(len(marks))],
        "text": [sensor if short else SENSOR_WORDS[sensor] for _, sensor in marks],
        "align": ["right" if aside else "left" for aside in left],
        "offset": [-4 if aside else 4 for aside in left],
    }


def reality_words(load_factor: float, error_m: float) -> str:
    """Return the actual load and position error, such as 'load 100 %, +10 m'."""
    return f"load {words.setting(load_factor)}\u00a0%, {words.signed(error_m, 0)}\u00a0m"
