"""The units of a table's columns, and questions about them: what headings leave open, and sizes that no railway has."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from railjoule.core.errors import UnitError
from railjoule.core.imports.cells import Cell
from railjoule.core.imports.columns import ALL_POSITION_UNITS, VALUE_UNITS, ColumnMap, ResolvedColumns
from railjoule.core.imports.numbers import is_zero_in_words, names_unit, text_of_cell
from railjoule.core.imports.table import Interval
from railjoule.core.imports.units import NOTHING, ColumnUnit, Heading, Quantity, TableKind, unit_words

SHORTEST_LINE_M = 50.0
"""Of a run that a train can be driven over; below it the unit was another."""
SHORTEST_RUN_S = 20.0
"""For which no line is long enough that a train may run over at its highest limit."""
STEEPEST_PERMILLE, LEVELLEST_PERMILLE, MIN_RADIUS_M = 60.0, 0.3, 50.0
"""Limits of railways with usual wheels and tracks; beyond it another unit is likely, though none is certain."""
HIGHEST_M = 5500.0
"""No railway is as high."""
UnitKey = Literal["position_unit", "value_unit"]


@dataclass(frozen=True)
class TableUnits:
    """The units of a table, and questions about them."""

    source: str
    kind: TableKind
    found: ResolvedColumns
    wanted: ColumnMap

    def unit(self, key: UnitKey, cells: Mapping[int, Cell]) -> ColumnUnit:
        """Find the unit of positions or values, empty if there are none; UnitError if it is in doubt."""
        column, heading, quantity, units = self._role(key)
        if not column or not units:
            return NOTHING
        if key == "value_unit" and self.wanted.value_unit:
            # of the cells that name no unit
            return ColumnUnit(self.wanted.value_unit, None, False)
        if heading.doubt:
            raise self._question(key, heading.doubt)
        if heading.unit is not None:
            return ColumnUnit(heading.unit, heading.unit, False)
        named = {row for row, cell in cells.items() if names_unit(cell, quantity)}
        bare = [row for row, cell in cells.items() if row not in named and not _is_nothing(cell, quantity)]
        if named and bare:
            words = f"row {min(named)} names a unit under {column!r}, and row {bare[0]} does not"
            raise self._question(key, words)
        return ColumnUnit(units[0], None, not named)

    def size_doubts(self, intervals: Sequence[Interval], position: ColumnUnit, value: ColumnUnit) -> list[str]:
        """List sizes that suggest another unit than the heading names; UnitError if nothing names the unit."""
        sentences = []
        keys: tuple[tuple[UnitKey, ColumnUnit], ...] = (("position_unit", position), ("value_unit", value))
        for key, unit in keys:
            sentence, likely = self._doubt(key, intervals)
            if not sentence or getattr(self.wanted, key) is not None:
                continue
            if unit.is_assumed:
                likely = (*likely, unit.unit) if likely else ()
                words = f"no unit is named for {self._role(key)[0]!r}, and in {unit_words(unit.unit)} {sentence}"
                raise self._question(key, words, likely)
            sentences.append(f"{sentence}: is the unit right?")
        return sentences

    def _role(self, key: UnitKey) -> tuple[str | None, Heading, Quantity, tuple[str, ...]]:
        """Return the column of positions or values, its heading, its quantity and the units of that."""
        if key == "position_unit":
            return self.found.begin, self.found.position, "positions", ALL_POSITION_UNITS
        return self.found.value, self.found.amount, self.kind, VALUE_UNITS[self.kind]

    def _question(self, key: UnitKey, doubt: str, likely: tuple[str, ...] = ()) -> UnitError:
        return UnitError(self.source, doubt, (self.kind, key), self._role(key)[3], likely)

    def _doubt(self, key: UnitKey, intervals: Sequence[Interval]) -> tuple[str, tuple[str, ...]]:
        """Describe sizes that suggest another unit, and the likely units; an empty text if none do."""
        amounts = [abs(one.value) for one in intervals if one.value]
        if key == "position_unit":
            ends = [end for one in intervals for end in (one.from_m, one.to_m) if end < float("inf")]
            length_m = max(ends) - min(one.from_m for one in intervals)
            likely = ("mi",) if "mph" in {self.found.amount.unit, self.wanted.value_unit} else ("km",)
            fastest_kmh = max(amounts, default=0.0) if self.kind == "limits" else 0.0
            if 0 < length_m < SHORTEST_LINE_M:
                return f"it covers {length_m:g} m in all", likely
            if 0 < length_m * 3.6 < SHORTEST_RUN_S * fastest_kmh:
                return f"it covers {length_m:g} m in all, with limits to {fastest_kmh:.4g} km/h", likely
        elif self.kind == "gradients" and amounts:
            steepest = max(amounts)
            if steepest > STEEPEST_PERMILLE:
                return f"gradients reach {steepest:.4g} per mille", ("ratio",) if min(amounts) > 1 else ()
            if steepest < LEVELLEST_PERMILLE:
                # a fraction of 0.06 is the steepest, and a line in per cent is rarely as level
                return f"no gradient exceeds {steepest:.4g} per mille", ("fraction",) if steepest < 0.06 else ()
        elif self.kind == "heights" and amounts and max(amounts) > HIGHEST_M:
            return f"heights reach {max(amounts):.4g} m", ("ft",)
        elif self.kind == "curves" and amounts and min(amounts) < MIN_RADIUS_M:
            return f"radii go down to {min(amounts):.4g} m", ("km",) if max(amounts) < MIN_RADIUS_M else ()
        return "", ()


def _is_nothing(cell: Cell, quantity: Quantity) -> bool:
    """Tell whether a cell is empty or, in any unit, 0."""
    text = text_of_cell(cell)
    return not text.strip("-+0.,") or is_zero_in_words(text, quantity)
