"""The numbers of a scenario that a study may vary: their names, bounds, first ranges, and the table of its rows."""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache, partial
from typing import Any

import numpy as np

from railjoule.core.scenario import Scenario
from railjoule.core.studies.sweep import DEFAULT_COLUMNS, Study, SweepTable
from railjoule.core.units import J_PER_WH
from railjoule.dashboard.editor.fields_of import Field, parts_of, tables_in
from railjoule.dashboard.look import words
from railjoule.dashboard.pages.explore.compute import ENERGY
from railjoule.dashboard.work.run_table import Column, RunTable, digits_for

GROUPS = ("timetable", "vehicle", "drive", "line")
"""Tables of a file on whose numbers a plan depends, those within them included."""
MOST_VARIED = 8
TRAVEL_TIME = "timetable.travel_time_s"
LOAD_SHARE, LOAD_T = "vehicle.load_factor", "vehicle.load_t"
FIRST_VARIED = (
    TRAVEL_TIME,
    LOAD_SHARE,
    "drive.recuperation_factor",
    "vehicle.auxiliary_power_kw",
    "line.head_wind_kmh",
)
"""Fields that a new study varies."""
AROUND = 0.2
"""Initial range of a number, as a share of its value to both sides."""
FIRST_SPANS = {"vehicle.load_factor": (0.0, 1.0)}
FIRST_REACH = {"kW": 50.0, "km/h": 20.0}
"""Initial range of a number that is zero, by its unit; 1 for other units."""
TIME_SPAN = 1.02, 1.4
"""Initial range of the travel time, as multiples of the timetable's."""
MOST_OF_FRACTIONS = 1.5
"""Of a number with bounds up to this, the slider reaches from one to the other."""
RULER_STEPS = 400


@dataclass(frozen=True)
class StudyField:
    """A number that may vary.

    Parameters
    ----------
    path : str
        Its key in the file.
    group : str
        The table that it stands in, in words.
    declared : Field
        As the editor has it: label, unit, bounds.
    value : float
        The value in the scenario.
    """

    path: str
    group: str
    declared: Field
    value: float

    @property
    def label(self) -> str:
        """Quantity and unit, as on an axis; a dash where it has none. In an inner table with the name of that table."""
        name = self.declared.quantity
        inner = f"{self.group}: {name[:1].lower()}{name[1:]}" if self.path.count(".") > 1 else name
        return f"{inner}, {self.declared.unit or words.UNKNOWN}"

    @property
    def ends(self) -> tuple[float, float]:
        """The least and the greatest number of its slider."""
        least, most = self._bounds
        if self._is_fraction:
            return least, most
        low, high = self.first_range
        span = max(high - low, abs(self.value))
        return float(max(least, _rounded(low - span, span))), float(min(most, _rounded(high + span, span)))

    @property
    def first_range(self) -> tuple[float, float]:
        """The range that it begins with, within its bounds."""
        least, most = self._bounds
        if self.path in FIRST_SPANS:
            low, high = FIRST_SPANS[self.path]
        elif self.path == TRAVEL_TIME:
            low, high = (float(round(share * self.value)) for share in TIME_SPAN)
        elif self.declared.least is not None and self._is_fraction:
            low, high = least, min(most, 1.0)
        else:
            reach = AROUND * abs(self.value) or FIRST_REACH.get(self.declared.unit, 1.0)
            low, high = (_rounded(self.value + way * reach, reach) for way in (-1, 1))
        low, high = max(low, least), min(high, most)
        if self.is_whole:
            low, high = math.ceil(low), max(math.ceil(low), math.floor(high))
        return float(low), float(high)

    @property
    def is_whole(self) -> bool:
        """Whether it takes only whole numbers."""
        return self.declared.kind == "whole"

    @property
    def step(self) -> float:
        """The step of its slider."""
        if self.is_whole:
            return 1.0
        low, high = self.ends
        step: float = 10.0 ** math.floor(math.log10(max((high - low) / RULER_STEPS, 1e-9)))
        return step

    @property
    def _is_fraction(self) -> bool:
        least, most = self._bounds
        return math.isfinite(least) and most <= MOST_OF_FRACTIONS

    @property
    def _bounds(self) -> tuple[float, float]:
        field = self.declared
        low = field.least if field.least is not None else -math.inf
        high = field.most if field.most is not None else math.inf
        # a bound that is not reached itself is kept away from by a thousandth
        if field.above is not None:
            low = field.above + 1e-3 * max(abs(self.value), 1e-3)
        if field.below is not None:
            high = field.below - 1e-3 * max(abs(self.value), 1e-3)
        return low, high


def _rounded(number: float, span: float) -> float:
    """Return a number to about a hundredth of a span."""
    digits = 2 - math.floor(math.log10(span)) if span > 0 else 2
    return round(number, max(digits, 0)) if digits > 0 else float(round(number, digits))


@lru_cache(maxsize=16)
def fields_that_vary(scenario: Scenario) -> Mapping[str, StudyField]:
    """Return the numbers of a scenario that a study may vary, by their keys in the file."""
    model = str(scenario.vehicle.drive.model)
    return {field.path: field for group in GROUPS for field in _fields_in(scenario, group, model)}


def _fields_in(scenario: Scenario, table: str, model: str) -> Iterator[StudyField]:
    held = held_at(scenario, table)
    if held is None:
        return
    kind = model if table.startswith("drive") else ""
    for part in parts_of(table, kind):
        if isinstance(part, Field) and part.kind in {"number", "whole"}:
            # a timetable may name a mean speed instead, and be given a time all the same
            value = scenario.travel_time_s if part.key == TRAVEL_TIME else held_at(scenario, part.key)
            # one that is left out follows from others, and cannot vary beside them
            if isinstance(value, int | float) and not isinstance(value, bool):
                yield StudyField(part.key, _group_words(table), part, float(value))
    for inner in tables_in(table, kind):
        yield from _fields_in(scenario, inner, model)


def _group_words(table: str) -> str:
    name = table.rpartition(".")[2].replace("_", " ")
    return name[:1].upper() + name[1:]


def held_at(scenario: Scenario, path: str) -> Any:
    """Return the value of a scenario at a key of its file; None if it has none."""
    held: Any = scenario
    # in a file the drive is a table of its own
    for name in (f"vehicle.{path}" if path.startswith("drive") else path).split("."):
        held = getattr(held, name, None)
    return held


def first_ranges(scenario: Scenario) -> dict[str, list[float]]:
    """Return the first ranges of a study of a scenario, by the keys of the fields."""
    known = fields_that_vary(scenario)
    # of a load in tonnes there may be no share
    varied = (LOAD_T if path == LOAD_SHARE and LOAD_T in known else path for path in FIRST_VARIED)
    return {path: list(known[path].first_range) for path in varied if path in known}


# ---- the rows of a study

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
