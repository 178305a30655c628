"""The rows of a study as a table of runs."""

from collections.abc import Callable, Mapping
from functools import partial

import numpy as np

from railjoule.core.studies.sweep import DEFAULT_COLUMNS, Study, SweepTable
from railjoule.core.units import J_PER_WH
from railjoule.dashboard.look import words
from railjoule.dashboard.pages.explore.compute import ENERGY
from railjoule.dashboard.pages.explore.fields import fields_that_vary
from railjoule.dashboard.work.run_table import Column, RunTable, digits_for

COLUMNS = (*DEFAULT_COLUMNS, "max_speed_kmh")
"""The results of each run of a study of this page."""
RESULTS: Mapping[str, tuple[str, Callable[[float], str]]] = {
    ENERGY: ("Energy, kWh", words.energy),
    "lower_bound_kwh": ("Lower bound, kWh", words.energy),
    "travel_time_s": ("Time of the run, s", words.time),
    "price_of_time_w": ("Extra second saves, Wh/s", partial(words.number, digits=1)),
    "max_speed_kmh": ("Highest speed, km/h", partial(words.number, digits=1)),
    "traction_energy_kwh": ("Energy for traction, kWh", words.energy),
    "recuperated_kwh": ("Recuperated, kWh", words.energy),
    "auxiliary_kwh": ("Auxiliaries, kWh", words.energy),
    "running_resistance_kwh": ("Running resistance, kWh", words.energy),
    "curve_resistance_kwh": ("Curves, kWh", words.energy),
    "kinetic_kwh": ("Kinetic energy, kWh", words.energy),
    "potential_kwh": ("Potential energy, kWh", words.energy),
    "losses_kwh": ("Losses, kWh", words.energy),
    "brake_resistors_kwh": ("Brake resistors, kWh", words.energy),
    "friction_brakes_kwh": ("Friction brakes, kWh", words.energy),
}
"""Quantity and unit of the results of a sweep, and how a number of them is written."""
SCALES = {"price_of_time_w": 1 / J_PER_WH}
"""A number in the unit above over that of the sweep."""


def study_columns(study: Study) -> dict[str, Column]:
    """Return the columns of a study: the inputs, then the results."""
    known, found = fields_that_vary(study.scenario), {}
    for field in study.fields:
        label = known[field.name].label if field.name in known else f"{field.name}, {words.UNKNOWN}"
        digits = 0 if field.whole else digits_for(field.high - field.low)
        found[field.name] = Column(label, partial(words.number, digits=digits), (field.low, field.high))
    return found | {name: Column(*RESULTS[name]) for name in study.columns}


def study_table(table: SweepTable) -> RunTable:
    """Return the rows of a study as a table of runs."""
    feasible = np.isfinite(table.columns[ENERGY])
    values = {name: SCALES.get(name, 1.0) * of[feasible] for name, of in {**table.samples, **table.columns}.items()}
    reason = next(iter(table.reasons.values()), "")
    return RunTable("Study", study_columns(table.study), values, table.index[feasible], table.rows, ENERGY, reason)
