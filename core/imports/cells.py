"""Tables of cells, from CSV or from a workbook."""

import csv
import io
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from threading import Lock

from railjoule.core.csv_text import unguarded
from railjoule.core.errors import ScenarioError
from railjoule.core.imports.findings import Finding
from railjoule.core.imports.source_file import LARGEST_BYTES, SourceFile, shown_list, text_of
from railjoule.core.scenario._sentences import shorten, show

Cell = str | float
"""What a cell holds: text, also of a number, or the number of a workbook; an empty text where nothing."""

MOST_ROWS = 200_000
MOST_COLUMNS = 250
LONGEST_NAME = 200
"""Characters of a column's name."""
# in this order: a decimal comma never splits a row where another separator does
SEPARATORS = ("\t", ";", ",")
LEADING_ROWS = 30
"""Rows among which that of the columns' names is looked for: programs write who made the file, and when, above it."""
HeaderTest = Callable[[Sequence[str]], bool]
"""Whether some names can be those of a table's columns."""
ZIP_MARK, OLD_WORKBOOK_MARK = b"PK\x03\x04", b"\xd0\xcf\x11\xe0"

_LONG_CELLS = Lock()


@dataclass(frozen=True)
class CellTable:
    """The cells of a table.

    Parameters
    ----------
    source : str
        The file.
    header : tuple of str
        The columns' names.
    rows : tuple of (int, tuple of Cell)
        The number of each row, as a spreadsheet counts, and its cells, one a column.
    separator : str
        What stands between cells; empty in a workbook.
    has_header : bool
        Whether the names are the file's.
    sheets : tuple of str
        Of a workbook all that hold anything.
    findings, unused
        See `Imported`.
    """

    source: str
    header: tuple[str, ...]
    rows: tuple[tuple[int, tuple[Cell, ...]], ...]
    separator: str = ""
    has_header: bool = True
    sheets: tuple[str, ...] = ()
    findings: tuple[Finding, ...] = field(default=(), kw_only=True)
    unused: tuple[str, ...] = field(default=(), kw_only=True)

    def column(self, name: str) -> list[tuple[int, Cell]]:
        """Return the cells of a column, each with the number of its row."""
        index = self.header.index(name)
        return [(number, cells[index]) for number, cells in self.rows]


def read_cells(source: SourceFile, sheet: str | None = None, is_header: HeaderTest | None = None) -> CellTable:
    """Return the cells of a CSV file or of a sheet of a workbook.

    Parameters
    ----------
    source : SourceFile
        The file.
    sheet : str, optional
        The workbook's sheet; by default its only one.
    is_header : callable, optional
        Tells the names of the columns from other rows above the table; where no row passes, or without it, the first
        row of at least two cells has them.

    Raises
    ------
    ChoiceError
        If a workbook has several sheets and none is named.
    ScenarioError
        If it is no table, or larger than allowed.
    """
    if source.content.startswith(OLD_WORKBOOK_MARK):
        raise ScenarioError(f"{source.name}: an old workbook (.xls); save it as .xlsx or CSV.")
    if source.content.startswith(ZIP_MARK):
        # only here: it is the one that needs a package which need not be installed
        from railjoule.core.imports.workbook import rows_of_workbook  # noqa: PLC0415

        rows, sheets, name = rows_of_workbook(source, sheet)
        others = [other for other in sheets if other != name]
        unused = [f"{source.name}: sheets not read: {shown_list(others)}."] if others else []
        return replace(_table(source.name, rows, "", [], unused, is_header), sheets=sheets)
    if sheet is not None:
        raise ScenarioError(f"{source.name}: sheet = {show(sheet)}, but the file is no workbook (.xlsx).")
    text, findings = text_of(source)
    separator = _separator_of(text, is_header)
    return _table(source.name, _csv_rows(source.name, text, separator), separator, findings, [], is_header)


def checked_row(name: str, number: int, cells: Iterable[Cell]) -> tuple[int, tuple[Cell, ...]]:
    """Return a numbered row without the empty cells at its end.

    Raises
    ------
    ScenarioError
        If it has too many cells, or is one too many.
    """
    row = list(cells)
    while row and (row[-1] == "" or (isinstance(row[-1], str) and not row[-1].strip())):
        row.pop()
    if len(row) > MOST_COLUMNS:
        raise ScenarioError(f"{name}, row {number}: {len(row)} columns; at most {MOST_COLUMNS} are allowed.")
    if number > MOST_ROWS:
        raise ScenarioError(f"{name}: more than the {MOST_ROWS} rows allowed.")
    return number, tuple(row)


def _separator_of(text: str, is_header: HeaderTest | None) -> str:
    """Return what stands between cells: what splits the names of the columns, or else most of the first rows."""
    beginning = [line for line in text.split("\n", LEADING_ROWS)[:LEADING_ROWS] if line.strip()]
    if is_header is not None:
        for line in beginning:
            for separator in SEPARATORS:
                if separator in line and is_header([_name(cell.strip().strip('"')) for cell in line.split(separator)]):
                    return separator
    for separator in SEPARATORS:
        if sum(separator in line for line in beginning) > len(beginning) / 2:
            return separator
    return SEPARATORS[-1]


def _csv_rows(name: str, text: str, separator: str) -> list[tuple[int, tuple[Cell, ...]]]:
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=separator)
    # The library's limit of 131,072 characters in a cell is one for all readers. The shape of a line on a map exceeds
    # it, and the file is limited anyway.
    with _LONG_CELLS:
        before = csv.field_size_limit(LARGEST_BYTES)
        try:
            return [checked_row(name, reader.line_num, [unguarded(cell) for cell in cells]) for cells in reader]
        except csv.Error as error:
            raise ScenarioError(f"{name}, row {reader.line_num}: not a table in CSV: {error}.") from None
        finally:
            csv.field_size_limit(before)


def _table(
    name: str,
    rows: list[tuple[int, tuple[Cell, ...]]],
    separator: str,
    findings: list[Finding],
    unused: list[str],
    is_header: HeaderTest | None,
) -> CellTable:
    """Put the names of the columns over the rows beneath them."""
    filled = [row for row in rows if row[1]]
    if not filled:
        raise ScenarioError(f"{name}: holds no rows.")
    begin = _header_index(filled, is_header)
    above = [f"{name}, row {number}: {shorten(str(cells[0]))!r} above the table." for number, cells in filled[:begin]]
    has_header = not _holds_numbers(filled[begin][1])
    body = filled[begin + 1 :] if has_header else filled[begin:]
    width = max(len(cells) for _, cells in filled[begin:])
    if has_header:
        number, names = filled[begin]
        header = [_name(cell) for cell in names]
        for row_number, cells in body:
            if len(cells) > len(header):
                raise ScenarioError(f"{name}, row {row_number}: {len(cells)} cells under {len(header)} columns.")
        named = [column for column in header if column]
        if longest := max((column for column in named), key=len, default="")[LONGEST_NAME:]:
            told = LONGEST_NAME + len(longest)
            raise ScenarioError(f"{name}, row {number}: a column's name has {told} characters; at most {LONGEST_NAME}.")
        twice = sorted({column for column in named if named.count(column) > 1})
        if twice:
            raise ScenarioError(f"{name}, row {number}: the column {show(twice[0])} appears twice.")
        width = len(header)
    else:
        header = [f"column {index + 1}" for index in range(width)]
    # a spreadsheet may have cells under no name
    header = [column or f"column {index + 1}" for index, column in enumerate(header)]
    padded = tuple((number, (*cells, *[""] * (width - len(cells)))) for number, cells in body)
    if not padded:
        raise ScenarioError(f"{name}: has the columns {shown_list(header)}, and no rows beneath.")
    return CellTable(
        name, tuple(header), padded, separator, has_header, findings=tuple(findings), unused=(*unused, *above)
    )


def _header_index(rows: list[tuple[int, tuple[Cell, ...]]], is_header: HeaderTest | None) -> int:
    """Return the index of the row of names: titles over a table have one cell, its columns at least two."""
    if is_header is not None:
        for index, (_, cells) in enumerate(rows[:LEADING_ROWS]):
            if len(cells) > 1 and is_header([_name(cell) for cell in cells]):
                return index
    counts = [sum(cell != "" for cell in cells) for _, cells in rows[:LEADING_ROWS]]
    if max(counts) < 2:
        return 0
    return next(index for index, count in enumerate(counts) if count >= 2)


def _holds_numbers(cells: tuple[Cell, ...]) -> bool:
    """Return whether a row holds values and not names: no name of a column begins with a digit or a sign."""
    texts = [cell for cell in cells if cell != ""]
    return all(not isinstance(cell, str) or cell.strip()[:1] in "+-0123456789" for cell in texts)


def _name(cell: Cell) -> str:
    """Return a cell as the name of a column, in one line."""
    return " ".join(str(cell).split())
