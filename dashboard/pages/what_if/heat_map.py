"""The table of loads and position errors: as a map whose cells can be pressed, and beside the printed one."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from bokeh.core.properties import value
from bokeh.events import Tap
from bokeh.models import FixedTicker

from railjoule.core.arrays import FloatArray
from railjoule.core.scenario import load_scenario
from railjoule.core.studies.sensitivity_table import COORDINATE_ERRORS_M, LOAD_FACTORS
from railjoule.core.studies.table import StudyTable
from railjoule.core.validation.liashenko_runs import PAPER, rms
from railjoule.core.validation.table import CLOSE_PERCENT
from railjoule.dashboard.charts.dress import ink_on, text_style
from railjoule.dashboard.charts.figures import LoneChart
from railjoule.dashboard.charts.surface import NARROW_PX
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.parts import html as parts

CELL = 0.96


@dataclass(frozen=True)
class Measure:
    """A quantity of the table.

    Parameters
    ----------
    words : str
        Quantity and unit.
    values : callable
        Takes a table, gives an array of shape (loads, errors) in that unit.
    show : callable
        How a number of that array reads.
    reference_kwh : callable or None
        Takes a table, gives the energies that shares are of, in a shape that fits that of the array [kWh].
    """

    words: str
    values: Callable[[StudyTable], FloatArray]
    show: Callable[[float], str]
    reference_kwh: Callable[[StudyTable], FloatArray] | None = None

    @property
    def unit(self) -> str:
        """The unit, without the quantity."""
        return self.words.rpartition(", ")[2]

    def texts(self, table: StudyTable) -> list[str]:
        """Return the texts of the cells, row by row: shares, kWh if a share is meaningless, misses."""
        energies = table.energy_kwh
        if self.reference_kwh is None:
            shown = zip(self.values(table).ravel(), energies.ravel(), strict=True)
            return [self.show(float(value)) if np.isfinite(energy) else comparisons.STANDS for value, energy in shown]
        references = np.broadcast_to(self.reference_kwh(table), energies.shape)
        columns = energies, references, table.delay_s, table.stop_error_m
        return [comparisons.extra_cell(*map(float, cell)) for cell in zip(*map(np.ravel, columns), strict=True)]

    def drawn(self, table: StudyTable) -> FloatArray:
        """Return the values without those of runs that need less by a miss; shape (loads, errors)."""
        if self.reference_kwh is None:
            return self.values(table)
        reference = self.reference_kwh(table)
        missed = comparisons.is_false_saving(table.energy_kwh, reference, table.delay_s, table.stop_error_m)
        return np.where(missed, np.nan, self.values(table))


def percent_difference(percent: float) -> str:
    """Return a relative difference that is in percent already."""
    return words.share_difference(percent / 100)


MEASURES = {
    "over_replanned": Measure(
        "Above a plan for this load, %",
        lambda table: 100 * table.over_replanned,
        percent_difference,
        lambda table: table.replanned_kwh[:, None],
    ),
    "overconsumption": Measure(
        "Extra energy against the plan, %",
        lambda table: 100 * table.overconsumption,
        percent_difference,
        lambda table: np.array(table.planned_energy_kwh),
    ),
    "delay_s": Measure("Delay at the stop, s", lambda table: table.delay_s, words.delay),
    "stop_error_m": Measure("Overshoot, m", lambda table: table.stop_error_m, words.stop_error),
}


def cell_colour(number: float, most: float, palette: Palette) -> str:
    """Return the colour of a cell: the warmer the more it is above zero, the cooler the more it is below."""
    if not np.isfinite(number):
        return palette.tokens["ground"]
    share = min(abs(number) / most, 1.0) if most > 0 else 0.0
    scale = palette.costs if number >= 0 else palette.savings
    return scale[round(share * (len(scale) - 1))]


class HeatMapChart(LoneChart):
    """Loads upwards, errors to the right, one number a cell; a click selects the cell."""

    kind = "map"
    title = "Table of loads and position errors"

    def __init__(self, height: int, palette: Palette) -> None:
        super().__init__("heatmap", "", height, palette)
        self.choose: Callable[[float, float], None] = lambda *_: None
        """Called with the load and the position error of a pressed cell."""
        self._table: StudyTable | None = None

    def build(self) -> None:
        """Make the figure."""
        f = self.frame(x_title="Position error, m (+: the train assumes it is farther on)", y_title="Load, %")
        f.ygrid.visible, f.axis.axis_line_color = False, None
        # cells reach CELL / 2 = 0.48 to each side of whole numbers; 0.04 are left beyond the outermost
        self.set_ranges((-0.52, len(COORDINATE_ERRORS_M) - 0.48), (-0.52, len(LOAD_FACTORS) - 0.48))
        self.source("cells", "x", "y", "fill", "text", "ink")
        self.source("plan", "x", "y", "ink")
        cell = ("x", "y", CELL, CELL)
        self.glyphs("rect", "cells", *cell, paint={}, fill_color="fill", line_color=None)
        style: dict[str, Any] = {"text_align": "center", "text_baseline": "middle", "text_color": "ink"}
        self.numbers = self.glyphs("text", "cells", "x", "y", "text", paint={}, **style, **text_style(13)).glyph
        self.glyphs("text", "plan", "x", "y", value("plan"), paint={}, y_offset=16, **style, **text_style(11))
        self.glyphs("rect", "frame", *cell, paint={"line_color": "accent"}, fill_color=None, line_width=2.5)
        f.on_event(Tap, self._press)

    def _press(self, event: Any) -> None:
        table = self._table
        if table is None or event.x is None:
            return
        column, row = round(event.x), round(event.y)
        if 0 <= column < len(table.coordinate_error_m) and 0 <= row < len(table.load_factor):
            self.choose(table.load_factor[row], table.coordinate_error_m[column])

    def draw(self, table: StudyTable, measure: Measure, load_factor: float, error_m: float) -> None:
        """Draw the table so far, and the frame around a load and an error."""
        f, self._table = self.figure, table
        assert f is not None
        self.numbers.text_font_size = value("10px" if self.width_px < NARROW_PX else "13px")
        loads, errors, values = table.load_factor, table.coordinate_error_m, measure.drawn(table)
        most = float(np.nanmax(np.abs(values))) if np.any(np.isfinite(values)) else 0.0
        done = np.arange(values.size) < table.done
        y, x = (index.ravel() for index in np.indices(values.shape))
        fills = [
            cell_colour(number, most, self.palette) if known else self.palette.tokens["page"]
            for number, known in zip(values.ravel(), done, strict=True)
        ]
        texts = [text if known else "" for text, known in zip(measure.texts(table), done, strict=True)]
        self.put("cells", x=x.tolist(), y=y.tolist(), fill=fills, text=texts, ink=[ink_on(fill) for fill in fills])
        set_labels(f.xaxis[0], [words.signed(error, 0) for error in errors])
        set_labels(f.yaxis[0], [words.setting(load) for load in loads])
        # a place beyond the table has none in it
        row, column = (
            float(np.interp(value, places, np.arange(len(places)), left=np.nan, right=np.nan))
            for value, places in ((load_factor, loads), (error_m, errors))
        )
        self.put("frame", x=[column], y=[row])
        planned = [loads.index(load) for load in {table.scenario.vehicle.load_factor} & {*loads} if 0.0 in errors]
        plan = [(errors.index(0.0), row, ink_on(fills[row * len(errors) + errors.index(0.0)])) for row in planned]
        self.put("plan", **{name: [one[k] for one in plan] for k, name in enumerate(("x", "y", "ink"))})


def set_labels(axis: Any, labels: list[str]) -> None:
    """Write labels at the whole numbers of an axis."""
    places = dict(enumerate(labels))
    if axis.major_label_overrides != places:
        axis.update(ticker=FixedTicker(ticks=list(places)), major_label_overrides=places)


def printed_table(table: StudyTable, measure: Measure) -> str:
    """Return the paper's table beside that of railjoule, or nothing where the paper has none for this table's scenario.

    Parameters
    ----------
    table : StudyTable
        Complete.
    measure : Measure
        The measure of our numbers; (12) of the paper where it is no share of an energy.
    """
    scenario, paper = table.scenario, PAPER
    entry = next((entry for entry in paper["table"] if entry["scenario"] == scenario.line.preset), None)
    if entry is None or not table.both_directions or table.known != "nothing":
        return ""
    base = load_scenario(entry["scenario"])
    if scenario.vehicle != base.vehicle or scenario.timetable != base.timetable:
        return ""
    loads, errors = paper["load_factors"], paper["coordinate_errors_m"]
    places = np.ix_([table.load_factor.index(load) for load in loads], [*map(table.coordinate_error_m.index, errors)])
    printed = np.array(entry["overconsumption_percent"]).T
    differences = {key: MEASURES[key].values(table)[places] - printed for key in ("overconsumption", "over_replanned")}
    shown = "over_replanned" if measure is MEASURES["over_replanned"] else "overconsumption"
    header = ("Error, m", *(f"load {words.setting(load)} %" for load in loads))
    rows = []
    for m, error in enumerate(errors):
        cells = [words.signed(error, 0)]
        for number, difference in zip(printed[:, m], differences[shown][:, m], strict=True):
            kind = "open" if abs(difference) > CLOSE_PERCENT else "muted"
            cells.append(
                parts.markup(
                    '{} <span class="muted">{}</span> <span class="{}">{}</span>',
                    percent_difference(number + difference),
                    words.number(number),
                    kind,
                    percent_difference(difference),
                )
            )
        rows.append((cells, False))
    quantity = MEASURES[shown].words.partition(",")[0]
    title = f"{quantity}: railjoule, %, {entry['place']} of Liashenko 2025, %, difference in percentage points"
    by_plan, by_load = (words.number(rms(each)) for each in differences.values())
    note = (
        f"Root mean square of the differences: {by_plan} percentage points against the plan, which is (12) of the "
        f"paper, {by_load} above a plan for this load."
    )
    return parts.markup(
        '<div class="dense">{}</div>{}', parts.table(title, header, rows), parts.note_paragraphs([note])
    )
