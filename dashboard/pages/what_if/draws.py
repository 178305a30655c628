"""The random draws as a table of runs."""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.studies.table import StudyTable
from railjoule.dashboard.look import words
from railjoule.dashboard.pages.what_if.heat_map import MEASURES
from railjoule.dashboard.work.run_table import Column, RunTable

Values = Callable[[StudyTable], FloatArray]


def _drawn(name: str, title: str, show: Callable[[float], str], scale: float = 1.0) -> tuple[str, Values, Any]:
    return title, lambda table: scale * table[name], show


INPUTS = {
    "load": _drawn("load_factor", "Load, %", partial(words.number, digits=0), 100),
    "error": _drawn("coordinate_error_m", "Position error, m", words.signed),
    "resistance": _drawn("resistance_factor", "Running resistance, %", words.number, 100),
    "voltage": _drawn("line_voltage_factor", "Supply voltage, %", words.number, 100),
    "departure": _drawn("departure_delay_s", "Departure delay, s", words.time),
    "speed": _drawn("speed_error", "Speed error, %", partial(words.signed, digits=2), 100),
    **{name: _drawn(f"{name}_error_m", f"{name.upper()}'s place, m", words.stop_error) for name in ("d1", "d2", "d3")},
}
"""Quantity and unit, the values in that unit, and how a number of them is written."""
RESULTS: dict[str, tuple[str, Values, Any]] = {
    "energy": ("Energy, kWh", lambda table: table.energy_kwh, words.energy),
    **{name: (measure.words, measure.values, measure.show) for name, measure in MEASURES.items()},
}


def draws_table(table: StudyTable) -> RunTable | None:
    """Return the draws that reached the end, with the quantities in which they differ; None where none varies."""
    reached = np.flatnonzero(np.isfinite(table.energy_kwh))
    columns, values = {}, {}
    for name, (title, values_of, show) in {**INPUTS, **RESULTS}.items():
        found = values_of(table)[reached]
        if len(np.unique(found)) > 1 and np.all(np.isfinite(found)):
            ends = (float(found.min()), float(found.max())) if name in INPUTS else None
            columns[name], values[name] = Column(title, show, ends), found
    if not values.keys() & INPUTS.keys() or "energy" not in values:
        return None
    title = f"{words.number(table.done, 0)} random draws of What if"
    return RunTable(title, columns, values, reached, table.done, "energy", "The train comes to a stand.")
