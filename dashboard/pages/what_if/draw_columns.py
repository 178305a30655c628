"""The random draws as columns, one for each quantity drawn and for each result, and the rows within brushes."""

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.studies.table import StudyTable
from railjoule.dashboard.look import words

Bounds = dict[str, tuple[float, float]]
"""From where to where a brush reaches, by the names of columns."""


@dataclass(frozen=True)
class Column:
    """A quantity of each run.

    Parameters
    ----------
    words : str
        Quantity and unit, as on an axis.
    values : callable
        Takes a table, gives an array of shape (done,) in that unit.
    show : callable
        How a number of that array reads, without its unit.
    """

    words: str
    values: Callable[[StudyTable], FloatArray]
    show: Callable[[float], str]

    @property
    def name(self) -> str:
        """The quantity, as within a sentence."""
        name = self.words.rpartition(", ")[0]
        return name[0].lower() + name[1:]

    @property
    def unit(self) -> str:
        """The unit."""
        return self.words.rpartition(", ")[2]

    def with_unit(self, value: float) -> str:
        """Return a number with its unit."""
        return f"{self.show(value)} {self.unit}"


def _drawn(name: str, title: str, show: Callable[[float], str], scale: float = 1.0) -> Column:
    return Column(title, lambda table: scale * table[name], show)


def _percent(show: Callable[[float], str]) -> Callable[[float], str]:
    return lambda percent: show(percent / 100)


COLUMNS: Mapping[str, Column] = {
    "load": _drawn("load_factor", "Load, %", lambda value: words.number(value, 0), 100),
    "error": _drawn("coordinate_error_m", "Position error, m", words.signed),
    "resistance": _drawn("resistance_factor", "Running resistance, %", words.number, 100),
    "voltage": _drawn("line_voltage_factor", "Supply voltage, %", words.number, 100),
    "departure": _drawn("departure_delay_s", "Departure delay, s", words.time),
    "speed": _drawn("speed_error", "Speed error, %", lambda value: words.signed(value, 2), 100),
    **{name: _drawn(f"{name}_error_m", f"{name.upper()}'s place, m", words.stop_error) for name in ("d1", "d2", "d3")},
    "energy": Column("Energy, kWh", lambda table: table.energy_kwh, words.energy),
    "extra": Column("Extra energy, %", lambda table: 100 * table.over_replanned, _percent(words.share_difference)),
    "above_plan": Column(
        "Extra energy against the plan, %",
        lambda table: 100 * table.overconsumption,
        _percent(words.share_difference),
    ),
    "late": Column("Delay at the stop, s", lambda table: table.delay_s, words.delay),
    "overshoot": Column("Overshoot, m", lambda table: table.stop_error_m, words.stop_error),
}
POINTS = "draws"
"""The name of the figure of points; those of the histograms begin with it."""
FIRST = "load", "extra"
"""The quantities to the right and upwards at first."""
OUTCOMES = "extra", "late", "overshoot"
"""The results whose medians are written."""
HINT = "Drag over the points or along a histogram to brush; click in a figure to let go of its brush."


def histogram_name(column: str) -> str:
    """Return the name of the figure that shows how often a column's values came out."""
    return f"{POINTS}_{column}"


def varied(table: StudyTable) -> dict[str, FloatArray]:
    """Return the columns in which runs that reached the end differ, of these runs alone; shapes (reached,)."""
    reached = np.isfinite(table.energy_kwh)
    columns = {name: column.values(table)[reached] for name, column in COLUMNS.items()}
    return {
        name: values for name, values in columns.items() if np.all(np.isfinite(values)) and len(np.unique(values)) > 1
    }


def parse_brushes(text: str) -> dict[str, Bounds]:
    """Return the brushes in a browser's JSON, by figure; invalid ones, and those of unknown columns, are left out."""
    try:
        sent = json.loads(text)
    except (ValueError, RecursionError):
        return {}
    if not isinstance(sent, Mapping):
        return {}
    found = {str(figure): _parse_bounds(brush) for figure, brush in sent.items()}
    return {figure: brush for figure, brush in found.items() if brush}


def _parse_bounds(sent: Any) -> Bounds:
    if not isinstance(sent, Mapping):
        return {}
    return {name: (float(ends[0]), float(ends[1])) for name, ends in sent.items() if name in COLUMNS and _is_span(ends)}


def _is_span(ends: Any) -> bool:
    numbers = isinstance(ends, list | tuple) and len(ends) == 2 and all(type(end) in {int, float} for end in ends)
    return numbers and all(map(math.isfinite, ends)) and ends[0] <= ends[1]


def common(brushes: Mapping[str, Bounds]) -> Bounds:
    """Return the bounds common to all brushes; an end before its start holds no row."""
    bounds: Bounds = {}
    for brush in brushes.values():
        for name, (low, high) in brush.items():
            lowest, highest = bounds.get(name, (-math.inf, math.inf))
            bounds[name] = max(low, lowest), min(high, highest)
    return bounds


def held_rows(columns: Mapping[str, FloatArray], bounds: Bounds) -> Any:
    """Return for each row whether it lies within bounds: from the start, up to but not including the end."""
    count = len(next(iter(columns.values())))
    return np.logical_and.reduce(
        [
            np.ones(count, bool),
            *((columns[name] >= low) & (columns[name] < high) for name, (low, high) in bounds.items()),
        ]
    )


def brush_words(table: StudyTable, columns: Mapping[str, FloatArray], bounds: Bounds) -> list[str]:
    """Return in sentences the number of runs within bounds, and their medians beside those of all runs."""
    held = held_rows(columns, bounds)
    count, stuck = len(held), table.done - len(held)
    lost = f" In {words.number(stuck, 0)} more the train comes to a stand." if stuck else ""
    if not bounds:
        return [f"{words.number(count, 0)} draws that reached the end.{lost} {HINT}"]
    where = "; ".join(
        f"{COLUMNS[name].name} {COLUMNS[name].show(low)} to {COLUMNS[name].with_unit(high)}"
        for name, (low, high) in bounds.items()
    )
    within = f"{words.number(held.sum(), 0)} of {words.number(count, 0)} draws ({words.share(held.mean())} %)"
    counted = f"{within}: {where}.{lost}"
    if not held.any():
        return [counted]
    medians = ", ".join(
        f"{COLUMNS[name].name} {_median(name, columns[name][held])} (all: {_median(name, columns[name])})"
        for name in OUTCOMES
        if name in columns
    )
    return [counted, f"Medians of these: {medians}."]


def _median(name: str, values: FloatArray) -> str:
    return COLUMNS[name].with_unit(float(np.median(values)))
