"""A run through the control loop: quantities over time with its limits, speed over position, switched currents."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.energy import share_above
from railjoule.core.simulation.field_oriented import FieldOrientedRun, Ripple
from railjoule.core.studies.flux_sweep import FluxSweep
from railjoule.core.studies.table import StudyTable
from railjoule.core.units import J_PER_KWH, MS_PER_KMH
from railjoule.dashboard.charts import quantities
from railjoule.dashboard.charts.chart import Axis, add_zero, nice_range, xy
from railjoule.dashboard.charts.figures import LoneChart
from railjoule.dashboard.charts.line_names import Name
from railjoule.dashboard.charts.quantities import POSITION, Quantity, read
from railjoule.dashboard.charts.run_lines import DRIVEN_DASH, Form, Line, RunLines, ends_of
from railjoule.dashboard.look import words
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.tokens import DASHES
from railjoule.dashboard.parts import html as parts

NAMES_PX, BORDERS_PX = 22, 9
"""Room above the lines for their names; what a figure takes above and below its frame."""
BAND_ALPHA = 0.16
FLUX_LINES = {"efficiency": "accent", "power factor": "phases", "loss": "ink2", "voltage": "limit"}
"""Lines of the chart over the flux current, and their colours."""
BEYOND_END = 0.02
"""Share of the way beyond its end, for the last number of the axis."""
MS_PER_S = MM_PER_M = 1e3
SMALL_LENGTH_M = 0.1

DASHED: Mapping[str, Any] = {"line_width": 1.7, "line_dash": DRIVEN_DASH}
SOLID: Mapping[str, Any] = {"line_width": 1.8}
LIMIT: Mapping[str, Any] = {"line_width": 1.2}
PLANNED: Mapping[str, Any] = {"line_width": 2.4}


@dataclass(frozen=True)
class Loop:
    """What a chart over time shows of runs in closed loop.

    Parameters
    ----------
    quantity : Quantity
        That of its lines, where they have none of their own; its name is also the chart's.
    lines : mapping of str to Line
        From back to front, by their names in the chart; one without a name is alone.
    ticks, tick_digits : int
        As in `Form`.
    """

    quantity: Quantity
    lines: Mapping[str, Line]
    ticks: int = 4
    tick_digits: int = 0

    @property
    def name(self) -> str:
        """The chart's name."""
        return self.quantity.name


def column(name: str, attribute: str, divisor: float = 1.0) -> Quantity:
    """Return one of several quantities of a chart: caption, unit and digits are the chart's."""
    return Quantity(name, "", "", 0, read(attribute, divisor))


TORQUE_CURRENT = column("torque_current", "torque_current_a")
INPUT_ENERGY = column("input_energy", "energy_by_input_power_j", J_PER_KWH)


def of_rivals(quantity: Quantity) -> dict[str, Line]:
    """Return a line for each of the paper's two strategies."""
    rivals: tuple[str, ...] = ("eoc", "enoc")
    return {of.upper(): Line(of, {"line_width": 1.8, "line_dash": DASHES[of]}, of, quantity) for of in rivals}


SPEED = Loop(
    replace(quantities.SPEED, name="loop_speed", words="Speed over time, km/h", digits=2),
    {
        "planned": Line("accent", PLANNED, "planned", quantities.SPEED),
        "actual": Line("driven", DASHED, "run", quantities.SPEED),
    },
    ticks=5,
)
TRACKING = Loop(
    Quantity("tracking", "Tracking error, m", "m", 3, read("tracking_error_m")),
    {"without pre-compensator": Line("driven", DASHED, "without"), "with": Line("accent", SOLID, "with")},
)
# beside the error without a pre-compensator, that with one is a line at zero
TRACKING_FINE = Loop(
    Quantity(
        "tracking_fine", "Tracking error with pre-compensator, mm", "mm", 3, read("tracking_error_m", 1 / MM_PER_M)
    ),
    {"": Line("accent", SOLID, "with")},
    ticks=3,
)
CURRENTS = Loop(
    Quantity("loop_currents", "Currents of one motor, A", "A", 1, read("torque_current_a")),
    {
        "flux current": Line("phases", DASHED, "run", column("flux_current", "flux_current_a")),
        "torque current": Line("accent", SOLID, "run", TORQUE_CURRENT),
    },
)
VOLTAGE = Loop(
    Quantity("loop_voltage", "Phase voltage of one motor, V", "V", 0, read("phase_voltage_v")),
    {
        "limit": Line("limit", LIMIT, "run", column("voltage_limit", "voltage_limit_v")),
        "voltage": Line("accent", SOLID, "run", column("phase_voltage", "phase_voltage_v")),
    },
)
FLUX = Loop(
    Quantity("loop_flux", "Rotor flux, V s", "V s", 3, read("rotor_flux_vs")),
    {"": Line("accent", SOLID, "run")},
    ticks=3,
    tick_digits=1,
)
ENERGY = Loop(
    Quantity("loop_energy", "Energy at the motors so far, kWh", "kWh", 3, read("energy_by_input_power_j", J_PER_KWH)),
    {
        # wide, as the dashed line of the parts lies on it
        "input power": Line("accent", {"line_width": 3}, "run", INPUT_ENERGY),
        "parts": Line("driven", DASHED, "run", column("energy_of_parts", "energy_by_parts_j", J_PER_KWH)),
    },
    tick_digits=1,
)
RIVAL_SPEED = Loop(
    replace(quantities.SPEED, name="rival_speed", words="EOC and ENOC: speed, km/h", digits=2),
    of_rivals(quantities.SPEED),
    ticks=5,
)
RIVAL_CURRENT = Loop(
    Quantity("rival_current", "Torque current of one motor, A", "A", 1, read("torque_current_a")),
    of_rivals(TORQUE_CURRENT),
)
RIVAL_ENERGY = Loop(replace(ENERGY.quantity, name="rival_energy"), of_rivals(INPUT_ENERGY), tick_digits=1)


def length(metres: float) -> tuple[str, str]:
    """Return a length as number and unit, a small one in millimetres."""
    if abs(metres) < SMALL_LENGTH_M:
        return words.number(1e3 * metres, 2), "mm"
    return words.number(metres, 2), "m"


class LoopChart(RunLines):
    """A quantity of one or more runs over time, with bands where a limit held the drive."""

    def __init__(self, loop: Loop, height: int, axis: Axis, palette: Palette, last: bool = False) -> None:
        form = Form(loop.ticks, loop.tick_digits, zero=True, last=last, over_time=True)
        super().__init__(loop.name, loop.quantity, loop.lines, height, axis, palette, form=form)

    def beneath(self) -> None:
        """Draw the bands beneath the lines."""
        self.glyphs(
            "vstrip", "bands", "from", "to", paint={"fill_color": "limit"}, fill_alpha=BAND_ALPHA, line_color=None
        )

    def above(self) -> None:
        """Write the names of the lines."""
        self.coloured_signs("names", 12, text_baseline="top", y_offset=2)

    def draw(self, runs: Mapping[str, FieldOrientedRun]) -> None:
        """Draw the runs that there are."""
        run = runs.get("run")
        drawn = self.fill(runs if run is None else {"planned": run.planned, **runs}, over_time=True)
        self.told["sources"] = [self.read(word, word) for word in drawn]
        low, high = ends_of([*drawn.values(), (np.zeros(1), np.zeros(1))])
        bottom, top = nice_range(low, high)
        bottom = bottom if low < 0 else 0.0
        if any(drawn):
            frame_px = self.height - BORDERS_PX
            # the lines get the frame less the row of names, NAMES_PX of it
            top = high + (high - bottom) * NAMES_PX / (frame_px - NAMES_PX)
        self.set_range(bottom, top)
        self._name([word for word in drawn if word], top)
        spans = () if run is None else run.saturated
        self.put("bands", **{"from": [s.start_s for s in spans], "to": [s.end_s for s in spans]})

    def _name(self, names: list[str], height: float) -> None:
        """Write the names side by side above the lines."""
        self.put(
            "names",
            x=[(0.02 + 0.98 * k / len(names)) * self.axis.end for k in range(len(names))],
            y=[height] * len(names),
            text=names,
            colour=[self.palette.tokens[self.lines[word].token] for word in names],
        )


class LoopDistanceChart(LoneChart):
    """Speed over distance, planned and actual."""

    def __init__(self, height: int, palette: Palette) -> None:
        super().__init__("loop_place", "Speed, km/h, over distance; dashed: actual", height, palette)

    def build(self) -> None:
        """Make the figure."""
        self.frame(ticks=5, x_title=POSITION.words)
        for name, line in SPEED.lines.items():
            self.line(name, line.token, **line.stroke)

    def draw(self, run: FieldOrientedRun) -> None:
        """Draw plan and run."""
        curves = {
            name: (POSITION.values(one), quantities.SPEED.values(one))
            for name, one in (("planned", run.planned), ("actual", run))
        }
        for name, curve in curves.items():
            self.put(name, **xy(*curve))
        end = max(float(x[-1]) for x, _ in curves.values())
        self.set_ranges((0.0, (1 + BEYOND_END) * end), (0.0, 1.08 * ends_of(curves.values())[1]))


class RippleChart(LoneChart):
    """Current of one phase under switched voltage, and its average."""

    def __init__(self, height: int, palette: Palette) -> None:
        super().__init__("ripple", "Switched current of one phase, A; dashed: averaged", height, palette)

    def build(self) -> None:
        """Make the figure."""
        add_zero(self.frame(ticks=4, x_title="Time, ms"), self.palette)
        self.line("switched", "accent", line_width=1.6)
        self.line("averaged", "driven", **DASHED)

    def draw(self, ripple: Ripple) -> None:
        """Draw both currents."""
        time = MS_PER_S * (ripple.time_s - ripple.time_s[0])
        curves = {"switched": (time, ripple.phase_current_a), "averaged": (time, ripple.average_current_a)}
        for name, curve in curves.items():
            self.put(name, **xy(*curve))
        self.set_ranges((0.0, float(time[-1])), nice_range(*ends_of(curves.values()), 0.1))


class FluxChart(LoneChart):
    """Cruise on level track over the flux current: efficiency, power factor, and voltage and loss as shares."""

    def __init__(self, height: int, palette: Palette) -> None:
        caption = "Cruise, %: efficiency, power factor, voltage / limit, loss / loss at rated flux"
        super().__init__("flux_sweep", caption, height, palette)

    def build(self) -> None:
        """Make the figure."""
        self.frame(ticks=5, x_title="Flux current of one motor, A")
        for name, token in FLUX_LINES.items():
            self.line(name, token, line_width=1.8)
        self.glyphs("segment", "least", "x", "from", "x", "to", paint={"line_color": "ink3"}, line_dash=DRIVEN_DASH)
        self.add_names(size=11)

    def draw(self, sweep: FluxSweep) -> None:
        """Draw the four lines, and the flux of minimum loss."""
        current = sweep.values("flux_current_a")
        lines = {
            "efficiency": 100 * sweep.values("efficiency"),
            "power factor": 100 * sweep.values("power_factor"),
            "loss": 100 * sweep.values("loss_w") / sweep.rated.loss_w,
            "voltage": 100 * sweep.values("phase_voltage_v") / sweep.max_phase_voltage_v,
        }
        for name, share in lines.items():
            self.put(name, **xy(current, share))
        top = nice_range(0.0, max(float(share.max()) for share in lines.values()))[1]
        best = sweep.min_loss.flux_current_a
        self.put("least", x=[best], **{"from": [0.0], "to": [top]})
        self.set_ranges((float(current[0]), float(current[-1])), (0.0, top))
        names = [Name(name, name, self.palette.tokens[token]) for name, token in FLUX_LINES.items()]
        self.place_names({name: (current, share) for name, share in lines.items()}, names, [], size=11)


def flux_table(sweep: FluxSweep) -> str:
    """Return the numbers of three fluxes."""
    points = {
        "minimum loss": sweep.min_loss,
        "maximum within the voltage": sweep.within_voltage,
        "rated": sweep.rated,
    }
    rows = [
        (
            (
                name,
                words.number(point.flux_current_a),
                words.number(point.phase_voltage_v, 0),
                words.number(point.loss_w, 0),
                words.number(100 * point.efficiency),
                words.number(point.power_factor, 3),
            ),
            point is sweep.min_loss,
        )
        for name, point in points.items()
    ]
    speed, limit = words.number(sweep.speed_ms / MS_PER_KMH), words.number(sweep.max_phase_voltage_v, 0)
    title = f"One motor at {speed} km/h on level track, limit {limit} V"
    return parts.inset(parts.table(title, ("Flux", "A", "V", "loss, W", "efficiency, %", "power factor"), rows))


class DetuningChart(LoneChart):
    """What a rotor resistance costs that is not the one that the controller assumes."""

    def __init__(self, height: int, palette: Palette) -> None:
        super().__init__("detuning", "Extra energy, %, over assumed / true rotor resistance", height, palette)

    def build(self) -> None:
        """Make the figure."""
        f = self.frame(ticks=4, digits=1, x_title="Assumed / true rotor resistance, \u2013")
        # factors have a decimal; `dress` writes the numbers of an x axis without
        f.xaxis[0].formatter.args = {"digits": 1}
        add_zero(f, self.palette)
        self.line("curve", "accent", line_width=1.8)
        self.dots("curve", size=8, line_width=1.5)

    def draw(self, table: StudyTable) -> None:
        """Draw what is known so far, against the controller that assumes the true resistance."""
        factors, more = detuning_cost(table)
        self.put("curve", **xy(factors, more))
        ends = table.rotor_resistance_factor
        low, high = float(np.min(more, initial=0.0)), float(np.max(more, initial=1e-3))
        self.set_ranges((min(ends), max(ends)), nice_range(low, high, 0.1))


def detuning_cost(table: StudyTable) -> tuple[FloatArray, FloatArray]:
    """Return the factors that are computed, rising, and how much more energy each takes than the right one [%]."""
    factors = np.array(table.rotor_resistance_factor)
    right = table.energy_kwh[np.argmin(np.abs(factors - 1))]
    # before the right one is there, nothing can be told against it
    known = np.flatnonzero(np.isfinite(table.energy_kwh) & np.isfinite(right))
    # they come in the order of NEAREST_FIRST
    known = known[np.argsort(factors[known])]
    return factors[known], 100 * share_above(table.energy_kwh[known], float(right))


def detuning_table(table: StudyTable) -> str:
    """Return what each factor that is computed makes of the run."""
    rows = []
    for factor, more in zip(*detuning_cost(table), strict=True):
        k = table.rotor_resistance_factor.index(factor)
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
