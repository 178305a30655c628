"""Tables as CSV in which no text is taken for a formula: spreadsheets run what begins as one, of any author.

Such a text gets an apostrophe before it, which readers here take away again; numbers stay as they are.
"""

import csv
import io
import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pandas

MARK = "'"
# with marks of its own before it, as else a text that has one would lose it when it is read
FORMULA = re.compile(r"'*[=+\-@\t\r]")
NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")


def guarded(cell: Any) -> Any:
    """Return a cell as it may be written: a text that a spreadsheet would run is marked as text."""
    runs = isinstance(cell, str) and FORMULA.match(cell) and not NUMBER.fullmatch(cell)
    return MARK + cell if runs else cell


def unguarded(cell: Any) -> Any:
    """Return a cell as it was before `guarded`."""
    marked = isinstance(cell, str) and cell.startswith(MARK) and FORMULA.match(cell)
    return cell[len(MARK) :] if marked else cell


def csv_of_rows(rows: Iterable[Iterable[Any]]) -> str:
    """Return rows of cells, the names of the columns among them, as CSV."""
    cells, text = [[guarded(cell) for cell in row] for row in rows], io.StringIO()
    csv.writer(text, lineterminator=_line_end(cell for row in cells for cell in row)).writerows(cells)
    return text.getvalue()


def csv_of_table(table: "pandas.DataFrame", header: bool = True) -> str:
    """Return a table as CSV without its index, with the names of its columns where they are asked for."""
    table = _mapped(table, guarded)
    return str(table.to_csv(index=False, header=header, lineterminator=_line_end(_texts(table))))


def write_csv(table: "pandas.DataFrame", path: Path, index: bool) -> None:
    """Write a table to a file as CSV, with its index if asked for; OSError where that fails."""
    path.write_text(csv_of_table(table.reset_index() if index else table), encoding="utf-8", newline="")


def plain_table(table: "pandas.DataFrame") -> "pandas.DataFrame":
    """Return a table that was read from such a CSV as it was before it was written."""
    return _mapped(table, unguarded)


def _mapped(table: "pandas.DataFrame", change: Any) -> "pandas.DataFrame":
    # shallow: whole columns are replaced, and a name need not be a text, as a keyword has to be
    changed = table.copy(deep=False)
    for name in _columns_of_text(table):
        changed[name] = table[name].map(change)
    return changed.rename(columns=change)


def _columns_of_text(table: "pandas.DataFrame") -> list[Any]:
    # columns of numbers hold no text; they are most of a table of a million rows
    return [name for name in table.columns if table[name].dtype.kind not in "biufcmM"]


def _texts(table: "pandas.DataFrame") -> Iterator[Any]:
    """Yield the names of the columns and all cells that may be texts."""
    yield from table.columns
    for name in _columns_of_text(table):
        yield from table[name]


def _line_end(cells: Iterable[Any]) -> str:
    # Python's writer quotes only the signs of its own line end: a single "\r" in a cell would begin a row
    return "\r\n" if any(isinstance(cell, str) and "\r" in cell for cell in cells) else "\n"
