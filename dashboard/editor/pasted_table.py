"""Blocks of cells as spreadsheets and CSV files give them."""

import csv
import difflib
from collections.abc import Sequence
from typing import Any

from railjoule.core.csv_text import unguarded
from railjoule.dashboard.editor.fields_of import Field

BLANKS = dict.fromkeys(map(ord, "\u00a0\u2009\u202f \t"))
"""Spaces that spreadsheets put between thousands."""
LONGEST_SHOWN = 30


class CellError(ValueError):
    """A cell that cannot be taken; the message is one sentence."""


def cells_of(text: str) -> list[list[str]]:
    """Return the cells of a block by rows, without empty rows.

    Tabs separate cells; where there are none semicolons, and where there are none of these commas. So decimals may
    have a comma unless commas separate.
    """
    separator = next((mark for mark in "\t;" if mark in text), ",")
    # not of tabs, which stand for empty cells at both ends of a block
    rows = csv.reader(text.strip("\r\n\ufeff").splitlines(), delimiter=separator)
    return [[unguarded(cell.strip()) for cell in row] for row in rows if any(cell.strip() for cell in row)]


def rows_of(text: str, columns: Sequence[Field], first: int = 0) -> list[dict[str, Any]]:
    """Return the rows of a block, with values by the names of columns; empty cells of columns that may be are left out.

    Parameters
    ----------
    text : str
        The block; its first row may name the columns, as a CSV file's does.
    columns : sequence of Field
        The columns of the table.
    first : int
        The column that a block without names begins in.

    Raises
    ------
    CellError
        If a column is unknown or a cell cannot be taken, with row, column, value and bound.
    """
    try:
        rows = cells_of(text)
    except csv.Error as error:
        raise CellError(f"This is not a table: {error}.") from None
    if not rows:
        raise CellError("The table is empty.")
    named = _named(rows[0], columns)
    number_of_first = 1 if named is None else 2
    order = list(columns[first:]) if named is None else named
    return [_row(row, order, number) for number, row in enumerate(rows if named is None else rows[1:], number_of_first)]


def _named(row: Sequence[str], columns: Sequence[Field]) -> list[Field] | None:
    """Return the columns that the first row names, None where it names none."""
    known = {name.lower(): column for column in columns for name in (column.name, column.label)}
    # a label holds a comma, which may have been taken for a separator
    known |= {column.label.split(",")[0].lower(): column for column in columns}
    if not any(cell.lower() in known for cell in row):
        return None
    found = []
    for cell in row:
        if cell.lower() not in known:
            names = ", ".join(column.name for column in columns)
            close = difflib.get_close_matches(cell.lower(), known, n=1)
            hint = f"did you mean {known[close[0]].name}?" if close else f"choose one of {names}."
            raise CellError(f"Row 1: unknown column {_shown(cell)}, {hint}")
        found.append(known[cell.lower()])
    if len(set(found)) < len(found):
        raise CellError("Row 1: a column appears twice.")
    return found


def _row(cells: Sequence[str], order: Sequence[Field], number: int) -> dict[str, Any]:
    cells = list(cells)
    # spreadsheets fill rows up with empty cells when they save them
    while len(cells) > len(order) and not cells[-1]:
        cells.pop()
    if len(cells) > len(order):
        raise CellError(f"Row {number}: {len(cells)} cells for {len(order)} columns.")
    return {
        column.name: value
        # not strict: where a row ends early, the rest of its cells is empty
        for column, cell in zip(order, cells, strict=False)
        if (value := parse_cell(column, cell, number)) is not None
    }


def parse_cell(column: Field, cell: str, row: int) -> Any:
    """Return the value of a cell; None where it is empty.

    Raises
    ------
    CellError
        If it cannot be taken, with row, column, value and bound.
    """
    text = cell if column.kind in {"text", "choice"} else cell.translate(BLANKS)
    if not text:
        return None
    try:
        return column.parse(text)
    except ValueError as error:
        raise CellError(f"Row {row}, {column.label}: {_shown(cell)}. {error}") from None


def _shown(cell: str) -> str:
    return repr(cell if len(cell) <= LONGEST_SHOWN else cell[: LONGEST_SHOWN - 3] + "...")
