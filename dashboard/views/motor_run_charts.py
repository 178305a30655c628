"""A run through the control loop: quantities over time with its limits, speed over position, switched currents."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from bokeh.models import ColumnDataSource, Range1d

from railjoule.core.arrays import FloatArray
from railjoule.core.energy import share_above
from railjoule.core.simulate.field_oriented import FieldOrientedRun, Ripple
from railjoule.core.studies.detuning import DetuningTable
from railjoule.core.units import J_PER_KWH, MS_PER_KMH
from railjoule.dashboard.look import words
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.tokens import DASHES
from railjoule.dashboard.views import parts
from railjoule.dashboard.views.charts import Axis, Chart, DistanceChart, add_zero, clear, nice_range, text_style, xy
from railjoule.dashboard.views.figures import captioned, empty_figure
from railjoule.dashboard.views.run_lines import DRIVEN_DASH

NAMES_PX, BORDERS_PX = 22, 9
"""Room above the lines for their names; what a figure takes above and below its frame."""
BAND_ALPHA = 0.16
BEYOND_END = 0.02
"""Share of the way beyond its end, for the last number of the axis."""
MS_PER_S = 1e3
SMALL_LENGTH_M = 0.1

Values = Callable[[FieldOrientedRun], tuple[FloatArray, FloatArray]]


@dataclass(frozen=True)
class Line:
    """One line of a chart.

    Parameters
    ----------
    word : str
        Its name in the chart.
    token : str
        Its colour.
    values : callable
        Time [s] and quantity of a run.
    of : str
        Which of the runs.
    stroke : mapping
        Width and dash.
    """

    word: str
    token: str
    values: Values
    of: str = "run"
    stroke: Mapping[str, Any] = field(default_factory=lambda: {"line_width": 1.8})


@dataclass(frozen=True)
class Quantity:
    """What a chart over time shows.

    Parameters
    ----------
    name, words, unit, digits
        As in `Chart`.
    lines : tuple of Line
        From back to front.
    ticks : int
        Requested on the y axis.
    tick_digits : int
        Decimals of the ticks.
    """

    name: str
    words: str
    unit: str
    digits: int
    lines: tuple[Line, ...]
    ticks: int = 4
    tick_digits: int = 0


def over_time(name: str, factor: float = 1.0) -> Values:
    """Return what reads a quantity of a run over time, times a factor."""

    def values(run: FieldOrientedRun) -> tuple[FloatArray, FloatArray]:
        quantity = np.asarray(getattr(run, name), dtype=float)
        return run.time_s, factor * np.broadcast_to(quantity, run.time_s.shape)

    return values


def planned_speed(run: FieldOrientedRun) -> tuple[FloatArray, FloatArray]:
    """Time [s] and speed [km/h] of the plan."""
    return run.planned.time_s, run.planned.speed_ms / MS_PER_KMH


DASHED: Mapping[str, Any] = {"line_width": 1.7, "line_dash": DRIVEN_DASH}
LIMIT: Mapping[str, Any] = {"line_width": 1.2}
EOC: Mapping[str, Any] = {"line_width": 1.8, "line_dash": DASHES["eoc"]}
ENOC: Mapping[str, Any] = {"line_width": 1.8, "line_dash": DASHES["enoc"]}


def rival_lines(name: str, factor: float = 1.0) -> tuple[Line, ...]:
    """Return a line for each of the paper's two strategies."""
    values = over_time(name, factor)
    return Line("EOC", "eoc", values, "eoc", EOC), Line("ENOC", "enoc", values, "enoc", ENOC)


SPEED = Quantity(
    "loop_speed",
    "Speed over time, km/h",
    "km/h",
    2,
    (
        Line("planned", "accent", planned_speed, stroke={"line_width": 2.4}),
        Line("actual", "driven", over_time("speed_ms", 1 / MS_PER_KMH), stroke=DASHED),
    ),
    ticks=5,
)
TRACKING = Quantity(
    "tracking",
    "Tracking error, m",
    "m",
    3,
    (
        Line("without pre-compensator", "driven", over_time("tracking_error_m"), "without", DASHED),
        Line("with", "accent", over_time("tracking_error_m"), "with"),
    ),
    tick_digits=0,
)
TRACKING_FINE = Quantity(
    "tracking_fine",
    "Tracking error with pre-compensator, mm",
    "mm",
    3,
    (Line("", "accent", over_time("tracking_error_m", 1e3), "with"),),
    ticks=3,
)
CURRENTS = Quantity(
    "loop_currents",
    "Currents of one motor, A",
    "A",
    1,
    (
        Line("flux current", "phases", over_time("flux_current_a"), stroke=DASHED),
        Line("torque current", "accent", over_time("torque_current_a")),
    ),
)
VOLTAGE = Quantity(
    "loop_voltage",
    "Phase voltage of one motor, V",
    "V",
    0,
    (
        Line("limit", "limit", over_time("voltage_limit_v"), stroke=LIMIT),
        Line("voltage", "accent", over_time("phase_voltage_v")),
    ),
)
FLUX = Quantity("loop_flux", "Rotor flux, V s", "V s", 3, (Line("", "accent", over_time("rotor_flux_vs")),), 3, 1)
ENERGY = Quantity(
    "loop_energy",
    "Energy so far, kWh",
    "kWh",
    3,
    (
        Line("input power", "accent", over_time("energy_by_input_power_j", 1 / J_PER_KWH), stroke={"line_width": 3}),
        Line("parts", "driven", over_time("energy_by_parts_j", 1 / J_PER_KWH), stroke=DASHED),
    ),
    tick_digits=1,
)
RIVAL_SPEED = Quantity(
    "rival_speed", "EOC and ENOC: speed, km/h", "km/h", 2, rival_lines("speed_ms", 1 / MS_PER_KMH), ticks=5
)
RIVAL_CURRENT = Quantity("rival_current", "Torque current of one motor, A", "A", 1, rival_lines("torque_current_a"))
RIVAL_ENERGY = Quantity(
    "rival_energy",
    "Energy so far, kWh",
    "kWh",
    3,
    rival_lines("energy_by_input_power_j", 1 / J_PER_KWH),
    tick_digits=1,
)


def length(metres: float) -> tuple[str, str]:
    """Return a length as number and unit, a small one in millimetres."""
    if abs(metres) < SMALL_LENGTH_M:
        return words.number(1e3 * metres, 2), "mm"
    return words.number(metres, 2), "m"


class LoopChart(DistanceChart):
    """A quantity of one or more runs over time, with bands where a limit held the drive."""

    def __init__(self, quantity: Quantity, height: int, axis: Axis, palette: Palette, last: bool = False) -> None:
        self.quantity, self.last = quantity, last
        self.unit, self.digits = quantity.unit, quantity.digits
        super().__init__(quantity.name, quantity.words, height, axis, palette)

    def build(self) -> None:
        """Make the figure."""
        f = self.frame(with_axis=self.last, ticks=self.quantity.ticks, digits=self.quantity.tick_digits)
        self.sources["bands"] = ColumnDataSource({"from": [], "to": []})
        bands = f.vstrip("from", "to", source=self.sources["bands"], fill_alpha=BAND_ALPHA, line_color=None)
        self.palette.paint(bands.glyph, fill_color="limit")
        add_zero(f, self.palette)
        if self.last:
            f.xaxis.axis_label = "Time, s"
        for line in self.quantity.lines:
            self.sources[line.word] = ColumnDataSource({"x": [], "y": []})
            drawn = f.line("x", "y", source=self.sources[line.word], **line.stroke)
            self.palette.paint(drawn.glyph, line_color=line.token)
        self.sources["names"] = ColumnDataSource({"x": [], "y": [], "text": [], "colour": []})
        f.text(
            "x",
            "y",
            "text",
            text_color="colour",
            source=self.sources["names"],
            text_baseline="top",
            y_offset=2,
            **text_style(),
        )

    def draw(self, runs: Mapping[str, FieldOrientedRun]) -> None:
        """Draw the runs that there are; lines of others are cleared."""
        low, high, drawn = 0.0, 0.0, []
        for line in self.quantity.lines:
            run = runs.get(line.of)
            if run is None:
                clear(self.sources[line.word])
                continue
            time, values = line.values(run)
            self.sources[line.word].data = xy(time, values)
            low, high = min(low, float(values.min())), max(high, float(values.max()))
            drawn.append(line)
        self.told["sources"] = [[line.word, self.sources[line.word]] for line in drawn]
        bottom, top = nice_range(low, high)
        bottom = bottom if low < 0 else 0.0
        if any(line.word for line in drawn):
            frame_px = self.height - BORDERS_PX
            top = high + (high - bottom) * NAMES_PX / (frame_px - NAMES_PX)
        self.set_range(bottom, top)
        self._name(drawn, top)
        self._mark(runs.get("run"))

    def _name(self, lines: list[Line], height: float) -> None:
        """Write the names side by side above the lines."""
        named = [line for line in lines if line.word]
        self.sources["names"].data = {
            "x": [(0.02 + 0.98 * k / len(named)) * self.axis.end for k in range(len(named))],
            "y": [height] * len(named),
            "text": [line.word for line in named],
            "colour": [self.palette.tokens[line.token] for line in named],
        }

    def _mark(self, run: FieldOrientedRun | None) -> None:
        spans = () if run is None else run.saturated
        self.sources["bands"].data = {"from": [s.start_s for s in spans], "to": [s.end_s for s in spans]}


class PlaceChart(Chart):
    """Speed over position, planned and actual."""

    def __init__(self, height: int, palette: Palette) -> None:
        super().__init__("loop_place", "Speed, km/h, over distance; dashed: actual", height)
        self.palette, self.x_range, self.y_range = palette, Range1d(0, 1), Range1d(0, 1)

    def build(self) -> None:
        """Make the figure."""
        f = empty_figure(
            self.height, self.x_range, self.y_range, self.words, self.palette, ticks=5, x_title="Distance, m"
        )
        self.figure = f
        self.planned, self.actual = (ColumnDataSource({"x": [], "y": []}) for _ in range(2))
        planned = f.line("x", "y", source=self.planned, line_width=2.4)
        actual = f.line("x", "y", source=self.actual, **DASHED)
        self.palette.paint(planned.glyph, line_color="accent")
        self.palette.paint(actual.glyph, line_color="driven")
        self.content = captioned(self.words, f)

    def draw(self, run: FieldOrientedRun) -> None:
        """Draw plan and run."""
        self.planned.data = xy(run.planned.position_m, run.planned.speed_ms / MS_PER_KMH)
        self.actual.data = xy(run.position_m, run.speed_ms / MS_PER_KMH)
        top = max(float(run.planned.speed_ms.max()), float(run.speed_ms.max())) / MS_PER_KMH
        end = float(max(run.planned.position_m[-1], run.position_m[-1]))
        self.x_range.update(start=0, end=(1 + BEYOND_END) * end)
        self.y_range.update(start=0, end=1.08 * top)


class RippleChart(Chart):
    """Current of one phase under switched voltage, and its average."""

    def __init__(self, height: int, palette: Palette) -> None:
        super().__init__("ripple", "Switched current of one phase, A; dashed: averaged", height)
        self.palette, self.x_range, self.y_range = palette, Range1d(0, 1), Range1d(0, 1)

    def build(self) -> None:
        """Make the figure."""
        f = empty_figure(self.height, self.x_range, self.y_range, self.words, self.palette, ticks=4, x_title="Time, ms")
        self.figure = f
        add_zero(f, self.palette)
        self.switched, self.average = (ColumnDataSource({"x": [], "y": []}) for _ in range(2))
        switched = f.line("x", "y", source=self.switched, line_width=1.6)
        average = f.line("x", "y", source=self.average, **DASHED)
        self.palette.paint(switched.glyph, line_color="accent")
        self.palette.paint(average.glyph, line_color="driven")
        self.content = captioned(self.words, f)

    def draw(self, ripple: Ripple) -> None:
        """Draw both currents."""
        time = MS_PER_S * (ripple.time_s - ripple.time_s[0])
        self.switched.data = xy(time, ripple.phase_current_a)
        self.average.data = xy(time, ripple.average_current_a)
        self.x_range.update(start=0, end=float(time[-1]))
        both = np.concatenate([ripple.phase_current_a, ripple.average_current_a])
        low, high = nice_range(float(both.min()), float(both.max()), 0.1)
        self.y_range.update(start=low, end=high)


class DetuningChart(Chart):
    """What a rotor resistance costs that is not the one that the controller assumes."""

    def __init__(self, height: int, palette: Palette) -> None:
        words = "Extra energy, %, over assumed / true rotor resistance"
        super().__init__("detuning", words, height)
        self.palette, self.x_range, self.y_range = palette, Range1d(0, 1), Range1d(0, 1)

    def build(self) -> None:
        """Make the figure."""
        f = empty_figure(
            self.height,
            self.x_range,
            self.y_range,
            self.words,
            self.palette,
            ticks=4,
            digits=1,
            x_title="Assumed / true rotor resistance, \u2013",
        )
        self.figure = f
        f.xaxis[0].formatter.args = {"digits": 1}
        add_zero(f, self.palette)
        self.curve = ColumnDataSource({"x": [], "y": []})
        line = f.line("x", "y", source=self.curve, line_width=1.8)
        points = f.scatter("x", "y", source=self.curve, size=8, line_width=1.5)
        self.palette.paint(line.glyph, line_color="accent")
        self.palette.paint(points.glyph, fill_color="accent", line_color="surface")
        self.content = captioned(self.words, f)

    def draw(self, table: DetuningTable) -> None:
        """Draw what is known so far, against the controller that assumes the true resistance."""
        factors, more = detuning_cost(table)
        self.curve.data = xy(factors, more)
        ends = table.rotor_resistance_factors
        self.x_range.update(start=min(ends), end=max(ends))
        low, high = nice_range(float(np.min(more, initial=0.0)), float(np.max(more, initial=1e-3)), 0.1)
        self.y_range.update(start=low, end=high)


def detuning_cost(table: DetuningTable) -> tuple[FloatArray, FloatArray]:
    """Return the factors that are computed, rising, and how much more energy each takes than the right one [%]."""
    factors = np.array(table.rotor_resistance_factors)
    right = table.energy_kwh[np.argmin(np.abs(factors - 1))]
    known = np.flatnonzero(np.isfinite(table.energy_kwh) & np.isfinite(right))
    known = known[np.argsort(factors[known])]
    return factors[known], 100 * share_above(table.energy_kwh[known], float(right))


def detuning_table(table: DetuningTable) -> str:
    """Return what each factor that is computed makes of the run."""
    rows = []
    for factor, more in zip(*detuning_cost(table), strict=True):
        k = table.rotor_resistance_factors.index(factor)
        cells = (
            f"{words.number(factor, 2)} \u00d7",
            words.share_difference(more / 100),
            words.number(table.max_current_a[k], 0),
            words.number(table.max_phase_voltage_v[k], 0),
            " ".join(length(table.max_tracking_error_m[k])),
        )
        rows.append((cells, factor == 1))
    title = "Controller with a wrong rotor resistance"
    header = ("Assumed / true", "energy, %", "peak, A", "peak, V", "tracking error")
    return parts.inset(parts.table(title, header, rows))
