"""The units of a table's columns: as the user, the heading or the cells name them, or in doubt and asked for."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from railjoule.core.errors import UnitError
from railjoule.core.imports.cells import Cell
from railjoule.core.imports.columns import ALL_POSITION_UNITS, VALUE_UNITS, ColumnMap, ResolvedColumns
from railjoule.core.imports.numbers import is_zero_in_words, names_unit, text_of_cell
from railjoule.core.imports.table import Interval
from railjoule.core.imports.units import IntervalKind, Quantity, unit_words

# of a run that a train can be driven over; below it the unit was another
SHORTEST_LINE_M = 50.0
SHORTEST_RUN_S = 20.0
"""For which no line is long enough that a train may run over at its highest limit."""
STEEPEST_PERMILLE, LEVELLEST_PERMILLE, SMALLEST_RADIUS_M = 60.0, 0.3, 50.0
"""What railways with usual wheels and tracks have; beyond it another unit is likely, though none is certain."""


@dataclass(frozen=True)
class ColumnUnit:
    """The unit of a column.

    Parameters
    ----------
    unit : str
        In which a cell counts that names none.
    stated : str or None
        As the heading or the user names it.
    is_assumed : bool
        Whether cells count in it that nothing says the unit of.
    """

    unit: str
    stated: str | None
    is_assumed: bool


NOTHING = ColumnUnit("", None, False)
"""Of a column that is not there, or whose cells have units of their own."""


@dataclass(frozen=True)
class TableUnits:
    """The units of a table, and its questions about them."""

    source: str
    kind: IntervalKind
    found: ResolvedColumns
    wanted: ColumnMap

    def position(self, cells: Mapping[int, Cell]) -> ColumnUnit:
        """Return the unit of positions.

        Raises
        ------
        UnitError
            If it is in doubt.
        """
        unit, doubt = self.found.position.unit, self.found.position.doubt
        return self._unit("position_unit", self.found.begin, unit, doubt, cells)

    def value(self, cells: Mapping[int, Cell]) -> ColumnUnit:
        """Return the unit of values; of tables without values, or in units of their own, an empty one.

        Raises
        ------
        UnitError
            If it is in doubt.
        """
        unit, doubt = self.found.amount.unit, self.found.amount.doubt
        if not self.found.value or not VALUE_UNITS[self.kind]:
            return NOTHING
        return self._unit("value_unit", self.found.value, unit, doubt, cells)

    def _unit(self, key: str, column: str, unit: str | None, doubt: str, cells: Mapping[int, Cell]) -> ColumnUnit:
        quantity: Quantity = "positions" if key == "position_unit" else self.kind
        if doubt:
            raise self._question(key, doubt)
        if unit is not None:
            return ColumnUnit(unit, unit, False)
        named = [row for row, cell in cells.items() if names_unit(cell, quantity)]
        bare = [row for row, cell in cells.items() if row not in set(named) and not _is_nothing(cell, quantity)]
        if named and bare:
            told = f"row {named[0]} names a unit under {column!r}, and row {bare[0]} does not"
            raise self._question(key, told)
        default = self._units(key)[0]
        return ColumnUnit(default, None, not named)

    def _units(self, key: str) -> tuple[str, ...]:
        return ALL_POSITION_UNITS if key == "position_unit" else VALUE_UNITS[self.kind]

    def _question(self, key: str, doubt: str, likely: tuple[str, ...] = ()) -> UnitError:
        return UnitError(self.source, doubt, (self.kind, key), self._units(key), likely)

    def size_doubts(self, intervals: Sequence[Interval], position: ColumnUnit, value: ColumnUnit) -> list[str]:
        """Return in words which sizes look as if another unit was meant than the heading names.

        Raises
        ------
        UnitError
            If nothing names the unit.
        """
        told = []
        for key, column, unit, doubtful in (
            ("position_unit", self.found.begin, position, self._position_doubt),
            ("value_unit", self.found.value, value, self._value_doubt),
        ):
            doubt = doubtful(intervals)
            if doubt is None or getattr(self.wanted, key) is not None:
                continue
            sentence, likely = doubt
            if unit.is_assumed:
                likely = (*likely, unit.unit) if likely else ()
                raise self._question(
                    key, f"no unit is named for {column!r}, and in {unit_words(unit.unit)} {sentence}", likely
                )
            told.append(f"{sentence}: is the unit right?")
        return told

    def _position_doubt(self, intervals: Sequence[Interval]) -> tuple[str, tuple[str, ...]] | None:
        table_end_m = max(end for one in intervals for end in (one.from_m, one.to_m) if end < float("inf"))
        length_m = table_end_m - min(one.from_m for one in intervals)
        likely = ("mi",) if self.found.amount.unit == "mph" else ("km",)
        if 0 < length_m < SHORTEST_LINE_M:
            return f"it covers {length_m:g} m in all", likely
        fastest = max((one.value or 0.0 for one in intervals), default=0.0) if self.kind == "limits" else 0.0
        if 0 < length_m * 3.6 < SHORTEST_RUN_S * fastest:
            return f"it covers {length_m:g} m in all, with limits to {fastest:.4g} km/h", likely
        return None

    def _value_doubt(self, intervals: Sequence[Interval]) -> tuple[str, tuple[str, ...]] | None:
        doubts: Mapping[str, Callable[[Sequence[float]], tuple[str, tuple[str, ...]] | None]] = {
            "gradients": _gradient_doubt,
            "curves": _radius_doubt,
        }
        amounts = [abs(one.value) for one in intervals if one.value]
        return doubts[self.kind](amounts) if self.kind in doubts and amounts else None


def _gradient_doubt(permille: Sequence[float]) -> tuple[str, tuple[str, ...]] | None:
    steepest = max(permille)
    if steepest > STEEPEST_PERMILLE:
        return f"gradients reach {steepest:.4g} per mille", ("ratio",) if min(permille) > 1 else ()
    if steepest < LEVELLEST_PERMILLE:
        # a fraction of 0.06 is the steepest, and a line in per cent is rarely as level
        return f"no gradient exceeds {steepest:.4g} per mille", ("fraction",) if steepest < 0.06 else ()
    return None


def _radius_doubt(radii_m: Sequence[float]) -> tuple[str, tuple[str, ...]] | None:
    if min(radii_m) >= SMALLEST_RADIUS_M:
        return None
    return f"radii go down to {min(radii_m):.4g} m", ("km",) if max(radii_m) < SMALLEST_RADIUS_M else ()


def _is_nothing(cell: Cell, quantity: Quantity) -> bool:
    """Return whether a cell is empty or, in any unit, 0."""
    text = text_of_cell(cell)
    return not text.strip("-+0.,") or is_zero_in_words(text, quantity)
