"""Tables of cells, from CSV, a track in GPX or a workbook (.xlsx), which openpyxl of the extra `excel` reads."""

import csv
import io
import zipfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from datetime import date, datetime, time, timedelta
from itertools import islice, product, zip_longest
from threading import Lock
from typing import Any

from railjoule.core.csv_text import unguarded
from railjoule.core.errors import ScenarioError
from railjoule.core.imports.findings import FromFile, Notes
from railjoule.core.imports.gpx import is_gpx, read_track_points
from railjoule.core.imports.source_file import MAX_BYTES, SourceFile, read_text, select_sheet
from railjoule.core.scenario._sentences import shorten, show, shown_list

Cell = str | float
"""Content of a cell: text, also of a number, or the number of a workbook; an empty text if there is none."""

Row = tuple[int, tuple[Cell, ...]]

MAX_ROWS = 200_000
MAX_COLUMNS = 250
LONGEST_NAME = 200
"""Characters of a column's name."""
# in this order: a decimal comma never splits a row where another separator does
SEPARATORS = ("\t", ";", ",")
LEADING_ROWS = 30
"""Rows among which that of the columns' names is looked for: programs write who made the file, and when, above it."""
HeaderTest = Callable[[Sequence[str]], bool]
"""Whether some names can be those of a table's columns."""
ZIP_MARK, OLD_WORKBOOK_MARK = b"PK\x03\x04", b"\xd0\xcf\x11\xe0"
# a workbook is a zip file: of the 50 MB that may come in, a thousand times as much may come out
MAX_UNPACKED_BYTES = 4 * MAX_BYTES
MAX_FILES = 2000
"""Files in the zip file; a workbook has one a sheet, picture and chart, and some ten of its own."""
ROWS_OF_TITLES = 100
"""A sheet whose first so many rows are empty counts as empty."""

_LONG_CELLS = Lock()


@dataclass(frozen=True)
class CellTable(FromFile):
    """The cells of a table.

    `rows` have their numbers, as a spreadsheet counts, and one cell for each column; `separator` is empty for a
    workbook, whose `sheets` are those with content. With `has_header` the names are those of the file.
    """

    header: tuple[str, ...]
    rows: tuple[tuple[int, tuple[Cell, ...]], ...]
    separator: str = ""
    has_header: bool = True
    sheets: tuple[str, ...] = ()

    def column(self, name: str) -> list[tuple[int, Cell]]:
        """Select the cells of a column, each with the number of its row."""
        index = self.header.index(name)
        return [(number, cells[index]) for number, cells in self.rows]


def read_cells(source: SourceFile, sheet: str | None = None, is_header: HeaderTest | None = None) -> CellTable:
    """Read the cells of a CSV file, of a track in GPX or of a sheet of a workbook.

    Parameters
    ----------
    source : SourceFile
        The file.
    sheet : str, optional
        The workbook's sheet, or the track; by default its only one.
    is_header : callable, optional
        Distinguishes the names of the columns from other rows above the table; if no row passes, or without it, the
        first row of at least two cells has them.

    Raises
    ------
    ChoiceError
        If there are several sheets or tracks and none is named.
    ScenarioError
        If it is no table, or larger than allowed.
    """
    if source.content.startswith(OLD_WORKBOOK_MARK):
        raise ScenarioError(f"{source.name}: an old workbook (.xls); save it as .xlsx or CSV.")
    notes = Notes(source.name)
    if source.content.startswith(ZIP_MARK):
        rows, sheets = _workbook_rows(source, sheet, notes)
        return replace(_named_table(rows, "", notes, is_header), sheets=sheets)
    if is_gpx(source):
        header, rows = read_track_points(source, sheet, notes)
        return CellTable(source.name, header, tuple(rows), findings=tuple(notes.findings), unused=tuple(notes.unused))
    if sheet is not None:
        raise ScenarioError(f"{source.name}: sheet = {show(sheet)}, but the file is no workbook (.xlsx).")
    text, notes.findings = read_text(source)
    separator = _find_separator(text, is_header)
    return _named_table(_csv_rows(source.name, text, separator), separator, notes, is_header)


def _checked_row(name: str, number: int, row: list[Cell]) -> Row:
    """Strip empty cells at the end of a row; ScenarioError if it is one too many or has too many cells."""
    while row and (row[-1] == "" or (isinstance(row[-1], str) and not row[-1].strip())):
        row.pop()
    if len(row) > MAX_COLUMNS:
        raise ScenarioError(f"{name}, row {number}: {len(row)} columns; at most {MAX_COLUMNS} are permitted.")
    if number > MAX_ROWS:
        raise ScenarioError(f"{name}: more than the {MAX_ROWS} rows permitted.")
    return number, tuple(row)


def _find_separator(text: str, is_header: HeaderTest | None) -> str:
    """Find the separator of cells: the one that splits the names of the columns, or else most of the first rows."""
    beginning = [line for line in text.split("\n", LEADING_ROWS)[:LEADING_ROWS] if line.strip()]
    for line, separator in product(beginning, SEPARATORS):
        names = [_name(cell.strip().strip('"')) for cell in line.split(separator)]
        if is_header is not None and len(names) > 1 and is_header(names):
            return separator
    often = (one for one in SEPARATORS if sum(one in line for line in beginning) > len(beginning) / 2)
    return next(often, SEPARATORS[-1])


def _csv_rows(name: str, text: str, separator: str) -> list[Row]:
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=separator)
    # The library's limit of 131,072 characters in a cell is one for all readers. The shape of a line on a map exceeds
    # it, and the file is limited anyway.
    with _LONG_CELLS:
        before = csv.field_size_limit(MAX_BYTES)
        try:
            return [_checked_row(name, reader.line_num, [unguarded(cell) for cell in cells]) for cells in reader]
        except csv.Error as error:
            raise ScenarioError(f"{name}, row {reader.line_num}: not a table in CSV: {error}.") from None
        finally:
            csv.field_size_limit(before)


def _named_table(rows: list[Row], separator: str, notes: Notes, is_header: HeaderTest | None) -> CellTable:
    """Put the names of the columns over the rows below them."""
    name, filled = notes.source, [row for row in rows if row[1]]
    if not filled:
        raise ScenarioError(f"{name}: holds no rows.")
    begin = _header_index(filled, is_header)
    notes.unused += [
        f"{name}, row {number}: {shorten(str(cells[0]))!r} above the table." for number, cells in filled[:begin]
    ]
    # no name of a column begins with a digit or a sign
    has_header = any(
        isinstance(cell, str) and cell.strip()[:1] not in "+-0123456789" for cell in filled[begin][1] if cell != ""
    )
    body = filled[begin + has_header :]
    header = [_name(cell) for cell in filled[begin][1]] if has_header else [""] * max(len(cells) for _, cells in body)
    if has_header:
        _require_names(name, filled[begin][0], header, body)
    # a spreadsheet may have cells under no name
    header = [column or f"column {index}" for index, column in enumerate(header, 1)]
    if not body:
        raise ScenarioError(f"{name}: has the columns {shown_list(header)}, and no rows below.")
    padded = tuple((number, (*cells, *[""] * (len(header) - len(cells)))) for number, cells in body)
    return CellTable(
        name,
        tuple(header),
        padded,
        separator,
        has_header,
        findings=tuple(notes.findings),
        unused=tuple(notes.unused),
    )


def _require_names(name: str, number: int, header: Sequence[str], body: Sequence[Row]) -> None:
    """Raise ScenarioError if a row is longer than the header, or a column's name is too long or not unique."""
    for row_number, cells in body:
        if len(cells) > len(header):
            raise ScenarioError(f"{name}, row {row_number}: {len(cells)} cells under {len(header)} columns.")
    longest = max(map(len, header))
    if longest > LONGEST_NAME:
        raise ScenarioError(f"{name}, row {number}: a column's name has {longest} characters; at most {LONGEST_NAME}.")
    if twice := sorted({column for column in header if column and header.count(column) > 1}):
        raise ScenarioError(f"{name}, row {number}: the column {show(twice[0])} appears twice.")


def _header_index(rows: list[Row], is_header: HeaderTest | None) -> int:
    """Find the row of names: titles over a table have one cell, its columns at least two."""
    for index, (_, cells) in enumerate(rows[:LEADING_ROWS]):
        if is_header is not None and len(cells) > 1 and is_header([_name(cell) for cell in cells]):
            return index
    return next((index for index, (_, row) in enumerate(rows[:LEADING_ROWS]) if sum(cell != "" for cell in row) > 1), 0)


def _name(cell: Cell) -> str:
    """Format a cell as the name of a column, in one line."""
    return " ".join(str(cell).split())


def _workbook_rows(source: SourceFile, sheet: str | None, notes: Notes) -> tuple[list[Row], tuple[str, ...]]:
    """Read the rows of a sheet, and the names of all sheets with content.

    Raises
    ------
    ChoiceError
        If several sheets have content and none is named.
    ScenarioError
        If openpyxl is missing, the file is no workbook, or it unpacks to more than allowed.
    """
    name = source.name
    # what formulas gave when the workbook was saved, and beside it the formulas: a sheet that another program
    # wrote may hold formulas without what they give, which would read as empty cells
    with _workbooks(source, (True, False)) as books:
        sheets = _filled_sheets(books[0])
        is_file = source.sheet in sheets and sheet in (None, source.sheet)
        chosen = source.sheet if is_file else sheets[notes.chosen(sheets, sheet, "sheet")]
        values, formulas = (_sheet_rows(book[chosen]) for book in books)
        rows = [
            _checked_row(name, number, [_cell(name, number, *pair) for pair in zip_longest(*row)])
            for number, row in enumerate(zip_longest(values, formulas, fillvalue=()), 1)
        ]
    return rows, sheets


@contextmanager
def _workbooks(source: SourceFile, only_values: Sequence[bool]) -> Iterator[list[Any]]:
    """Open a workbook, with or without its formulas; ScenarioError for whatever is wrong with it."""
    name = source.name
    try:
        import openpyxl  # noqa: PLC0415  (of an extra, and slow to import)
    except ModuleNotFoundError:
        raise ScenarioError(
            f"{name}: reading .xlsx needs openpyxl, which is not installed: pip install 'railjoule[excel]'; "
            "or save the sheet as CSV."
        ) from None
    _require_small(source)
    try:
        yield [
            openpyxl.load_workbook(io.BytesIO(source.content), read_only=True, data_only=one, keep_links=False)
            for one in only_values
        ]
    except ScenarioError:
        raise
    # openpyxl has no error of its own for a broken file: whatever its parsers meet comes through
    except Exception as error:
        raise ScenarioError(f"{name}: not a workbook that can be read: {show(str(error))}.") from None


def first_rows_of_sheets(source: SourceFile) -> dict[str, CellTable | None]:
    """Read the names of columns and the first rows of each sheet of a workbook; None if a sheet is no table.

    Raises
    ------
    ScenarioError
        If the file is no workbook, or it unpacks to more than allowed.
    """
    tables: dict[str, CellTable | None] = {}
    with _workbooks(source, (True,)) as (book,):
        for sheet in _filled_sheets(book):
            name = select_sheet(source, sheet).name
            rows = enumerate(islice(_sheet_rows(book[sheet]), LEADING_ROWS), 1)
            tables[sheet] = None
            with suppress(ScenarioError):
                read = [
                    _checked_row(name, number, [_cell(name, number, one, None) for one in row]) for number, row in rows
                ]
                tables[sheet] = _named_table(read, "", Notes(name), None)
    return tables


def _require_small(source: SourceFile) -> None:
    """Raise ScenarioError if the file would unpack to more than allowed; nothing is unpacked for that."""
    name = source.name
    if len(source.content) > MAX_BYTES:
        raise ScenarioError(f"{name}: larger than the {MAX_BYTES / 1e6:g} MB permitted.")
    try:
        with zipfile.ZipFile(io.BytesIO(source.content)) as package:
            parts = package.infolist()
    except (zipfile.BadZipFile, NotImplementedError, ValueError) as error:
        raise ScenarioError(f"{name}: not a workbook that can be read: {error}.") from None
    # a part that unpacks to more than it declares is cut off there by the library, and its checksum is then wrong
    unpacked = sum(part.file_size for part in parts)
    if unpacked > MAX_UNPACKED_BYTES:
        raise ScenarioError(
            f"{name}: unpacks to {unpacked / 1e6:.0f} MB; at most {MAX_UNPACKED_BYTES / 1e6:g} MB are permitted."
        )
    if len(parts) > MAX_FILES:
        raise ScenarioError(f"{name}: holds {len(parts)} files; at most {MAX_FILES} are permitted.")


def _filled_sheets(book: Any) -> tuple[str, ...]:
    """List the sheets with content: spreadsheet programs add empty ones."""
    names = [
        name
        for name in book.sheetnames
        if any(cell is not None for row in islice(_sheet_rows(book[name]), ROWS_OF_TITLES) for cell in row)
    ]
    # in one that begins far down, reading it gives the error
    return tuple(names or book.sheetnames[:1])


def _sheet_rows(sheet: Any) -> Iterator[tuple[Any, ...]]:
    """Iterate over the rows of a sheet; a sheet of a chart has none."""
    # the size that the file claims is not its own: up to that of the largest sheet would be filled up with nothing
    if hasattr(sheet, "reset_dimensions"):
        sheet.reset_dimensions()
    return sheet.iter_rows(values_only=True) if hasattr(sheet, "iter_rows") else iter(())


def _cell(source: str, number: int, value: Any, formula: Any) -> Cell:
    """Convert a cell of a workbook; ScenarioError if it is a formula whose result the file does not contain."""
    if value is None:
        if isinstance(formula, str) and formula.startswith("="):
            raise ScenarioError(
                f"{source}, row {number}: {show(formula)} is a formula whose result is not in the file; open and save "
                "it in a spreadsheet program."
            )
        return ""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, int | float):
        return float(value)
    if isinstance(value, timedelta):
        return value.total_seconds()
    return value.isoformat() if isinstance(value, datetime | date | time) else str(value)
