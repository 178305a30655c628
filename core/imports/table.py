"""A table of intervals over chainage as it is once it was read, and the bounds of its values."""

import math
import operator
from collections.abc import Mapping
from dataclasses import dataclass, field

from railjoule.core.errors import ScenarioError
from railjoule.core.imports.cells import Cell
from railjoule.core.imports.findings import Finding
from railjoule.core.imports.numbers import text_of_cell
from railjoule.core.imports.units import IntervalKind
from railjoule.core.scenario import Section
from railjoule.core.scenario._sentences import show

KEYS: Mapping[IntervalKind, str] = {
    "gradients": "gradient_permille",
    "limits": "speed_limit_kmh",
    "curves": "curve_radius_m",
    "tunnels": "tunnel_factor",
}
"""What the values of each kind are in a section of a scenario's line."""
BOUNDS = (("ge", "at least", operator.ge), ("gt", "above", operator.gt), ("le", "at most", operator.le))
DIGITS_M = 6
"""Positions are kept to the micrometre, so that the sum of two lengths has no tail of digits."""


@dataclass(frozen=True)
class Interval:
    """A stretch with one value; `to_m` is infinite where only the end of the line ends it."""

    from_m: float
    to_m: float
    value: float | None
    row: int


@dataclass(frozen=True)
class ImportedTable:
    """A table of intervals in rising chainage.

    Parameters
    ----------
    kind : str
        What it tells of.
    source : str
        The file.
    intervals : tuple of Interval
        Positions [m]; gradients [per mille], limits [km/h], radii [m], or as `value_unit` says.
    value_unit : str
        Of tunnels: 'factor', 'm2' (cross section), or empty.
    findings, unused
        See `Imported`.
    """

    kind: IntervalKind
    source: str
    intervals: tuple[Interval, ...]
    value_unit: str = ""
    findings: tuple[Finding, ...] = field(default=(), kw_only=True)
    unused: tuple[str, ...] = field(default=(), kw_only=True)

    @property
    def begin_m(self) -> float:
        """Where the first row begins [m]."""
        return self.intervals[0].from_m

    @property
    def end_m(self) -> float:
        """Where the last known end is [m]."""
        known = [interval.to_m for interval in self.intervals if math.isfinite(interval.to_m)]
        return max([*known, self.intervals[-1].from_m])


def bounded(place: str, column: str, cell: Cell, amount: float, kind: IntervalKind, value_unit: str) -> float:
    """Return a value that a section of a line can have.

    Raises
    ------
    ScenarioError
        If none can.
    """
    if kind == "tunnels" and value_unit != "factor":
        return amount
    broken = next(filter(None, (_broken(amount, bound) for bound in Section.model_fields[KEYS[kind]].metadata)), None)
    if broken:
        unit = {"gradients": " per mille", "limits": " km/h", "curves": " m"}.get(kind, "")
        told = "" if text_of_cell(cell) == f"{amount:g}" else f", which is {amount:g}{unit},"
        raise ScenarioError(f"{place}: {column} = {show(cell)}{told} must be {broken}{unit}.")
    return float(f"{amount:.10g}")


def _broken(amount: float, bound: object) -> str | None:
    """Return in words the bound of a section's key that a value does not keep."""
    for name, words, keeps in BOUNDS:
        limit = getattr(bound, name, None)
        if limit is not None and not keeps(amount, limit):
            return f"{words} {limit:g}"
    return None
