"""Where a table of intervals says nothing, and where two of its rows say something."""

from collections.abc import Sequence
from typing import Protocol

from railjoule.core.imports.findings import Finding
from railjoule.core.imports.units import IntervalKind

# a millimetre less or more is how positions were rounded
LEAST_STRETCH_M = 0.001
WHOLE = {"gradients": "level", "limits": "without a limit"}
"""Kinds of tables that tell of the whole line, and what a stretch without a row is taken to be."""
RULES = {
    "gradients": "that which begins later counts",
    "limits": "the lower counts",
    "curves": "the smaller radius counts",
    "tunnels": "that which begins later counts",
    "neutral": "both count",
}
"""Which of two rows over one stretch counts."""


class Stretch(Protocol):
    """Part of a line with a value, from a row of a file."""

    @property
    def from_m(self) -> float:
        """Where it begins [m]."""

    @property
    def to_m(self) -> float:
        """Where it ends [m]."""

    @property
    def value(self) -> float | None:
        """Its value."""

    @property
    def row(self) -> int:
        """The row."""


def continuity_findings(kind: IntervalKind, ordered: Sequence[Stretch]) -> list[Finding]:
    """Return where rows in rising chainage leave a gap, overlap or repeat each other.

    Parameters
    ----------
    kind : str
        What the table tells of; only gradients and limits have gaps.
    ordered : sequence
        The stretches by where they begin.
    """
    found = []
    furthest = ordered[0]
    for stretch in ordered[1:]:
        rows = (furthest.row, stretch.row)
        gap = stretch.from_m - furthest.to_m
        if gap > LEAST_STRETCH_M and kind in WHOLE:
            sentence = (
                f"nothing from {place(furthest.to_m)} to {place(stretch.from_m)} m, between rows {rows[0]} and "
                f"{rows[1]}: a gap of the table, taken as {WHOLE[kind]}, or a jump of the chainage."
            )
            found.append(Finding("gap", sentence, rows, furthest.to_m, stretch.from_m))
        elif gap < -LEAST_STRETCH_M:
            end = min(furthest.to_m, stretch.to_m)
            same = (furthest.from_m, furthest.to_m, furthest.value) == (stretch.from_m, stretch.to_m, stretch.value)
            where = f"from {place(stretch.from_m)} to {place(end)} m"
            rule = "they agree" if furthest.value == stretch.value else RULES[kind]
            sentence = f"rows {rows[0]} and {rows[1]} overlap {where}; {rule}."
            if same:
                sentence = f"row {rows[1]} repeats row {rows[0]}."
            found.append(Finding("overlap", sentence, rows, stretch.from_m, end))
        if stretch.to_m >= furthest.to_m:
            furthest = stretch
    return found


def place(position_m: float) -> str:
    """Return a position [m] in words of at most millimetres."""
    return f"{position_m:,.3f}".rstrip("0").rstrip(".")
