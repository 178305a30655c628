"""What is explored of the runs that chance draws: a column for each quantity drawn and for each result."""

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
    is_drawn : bool
        Whether chance draws it; else it is a result.
    """

    words: str
    values: Callable[[StudyTable], FloatArray]
    show: Callable[[float], str]
    is_drawn: bool = False

    @property
    def name(self) -> str:
        """The quantity, as within a sentence."""
        name = self.words.rpartition(", ")[0]
        return name[0].lower() + name[1:]

    @property
    def unit(self) -> str:
        """The unit."""
        return self.words.rpartition(", ")[2]

    def told(self, value: float) -> str:
        """Return a number with its unit."""
        return f"{self.show(value)} {self.unit}"


def _drawn(name: str, told: str, show: Callable[[float], str], scale: float = 1.0) -> Column:
    return Column(told, lambda table: scale * table[name], show, is_drawn=True)


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
"""What is drawn over which at first: the second over the first."""
OUTCOMES = "extra", "late", "overshoot"
"""Of these a brush tells the median."""


def histogram_name(column: str) -> str:
    """Return the name of the figure that shows how often a column's values came out."""
    return f"{POINTS}_{column}"


@dataclass(frozen=True, eq=False)
class Request:
    """What is to be drawn of a table: `y` over `x`, and histograms of all else, in light or dark colours."""

    table: StudyTable
    x: str
    y: str
    dark: bool


def varied(table: StudyTable) -> dict[str, FloatArray]:
    """Return the columns in which runs that reached the end differ, of these runs alone; shapes (reached,)."""
    reached = np.isfinite(table.energy_kwh)
    columns = {name: column.values(table)[reached] for name, column in COLUMNS.items()}
    return {
        name: values for name, values in columns.items() if np.all(np.isfinite(values)) and len(np.unique(values)) > 1
    }


def brushes_of(text: str) -> dict[str, Bounds]:
    """Return the brushes that a browser tells as JSON, by figure; whatever is none, or of no column, is left out."""
    try:
        told = json.loads(text)
    except (ValueError, RecursionError):
        return {}
    if not isinstance(told, Mapping):
        return {}
    found = {str(figure): _bounds_of(brush) for figure, brush in told.items()}
    return {figure: brush for figure, brush in found.items() if brush}


def _bounds_of(told: Any) -> Bounds:
    if not isinstance(told, Mapping):
        return {}
    return {name: (float(ends[0]), float(ends[1])) for name, ends in told.items() if name in COLUMNS and _is_span(ends)}


def _is_span(ends: Any) -> bool:
    numbers = isinstance(ends, list | tuple) and len(ends) == 2 and all(type(end) in {int, float} for end in ends)
    return numbers and all(map(math.isfinite, ends)) and ends[0] <= ends[1]


def common(brushes: Mapping[str, Bounds]) -> Bounds:
    """Return what lies within all brushes, which may be nothing: then an end lies before its start."""
    bounds: Bounds = {}
    for brush in brushes.values():
        for name, (low, high) in brush.items():
            lowest, highest = bounds.get(name, (-math.inf, math.inf))
            bounds[name] = max(low, lowest), min(high, highest)
    return bounds
