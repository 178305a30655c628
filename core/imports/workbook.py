"""Rows of a workbook (.xlsx), read by openpyxl, which the extra `excel` installs."""

import io
import zipfile
from collections.abc import Iterator
from datetime import date, datetime, time, timedelta
from itertools import islice, zip_longest
from typing import Any

from railjoule.core.errors import ChoiceError, ScenarioError
from railjoule.core.imports.cells import MOST_ROWS, Cell, checked_row
from railjoule.core.imports.source_file import LARGEST_BYTES, SourceFile, shown_list
from railjoule.core.scenario._sentences import show

# a workbook is a zip file: of the 50 MB that may come in, a thousand times as much may come out
LARGEST_UNPACKED_BYTES = 4 * LARGEST_BYTES
MOST_FILES = 2000
"""Files in the zip file; a workbook has one a sheet, picture and chart, and some ten of its own."""
ROWS_OF_TITLES = 100
"""A sheet whose first so many rows are empty counts as empty."""


def rows_of_workbook(
    source: SourceFile, sheet: str | None
) -> tuple[list[tuple[int, tuple[Cell, ...]]], tuple[str, ...], str]:
    """Return the numbered rows of a sheet, the names of all sheets that hold anything, and that of the sheet.

    Raises
    ------
    ChoiceError
        If several sheets hold anything and none is named.
    ScenarioError
        If openpyxl is missing, the file is no workbook, or it unpacks to more than allowed.
    """
    try:
        import openpyxl  # noqa: PLC0415  (of an extra, and slow to import)
    except ModuleNotFoundError:
        raise ScenarioError(
            f"{source.name}: reading .xlsx needs openpyxl, which is not installed: pip install 'railjoule[excel]'; "
            "or save the sheet as CSV."
        ) from None
    _require_small(source)
    try:
        # what formulas gave when the workbook was saved, and beside it the formulas: a sheet that another program
        # wrote may hold formulas without what they give, which would read as empty cells
        values, formulas = (
            openpyxl.load_workbook(io.BytesIO(source.content), read_only=True, data_only=data_only, keep_links=False)
            for data_only in (True, False)
        )
        sheets = _filled_sheets(values)
        name = _sheet_name(source.name, sheets, sheet)
        rows = [
            checked_row(source.name, number, (_cell(source.name, number, *pair) for pair in pairs))
            for number, pairs in _rows(source.name, values[name], formulas[name])
        ]
    except ScenarioError:
        raise
    # openpyxl has no error of its own for a broken file: whatever its parsers meet comes through
    except Exception as error:
        raise ScenarioError(f"{source.name}: not a workbook that can be read: {show(str(error))}.") from None
    return rows, sheets, name


def _require_small(source: SourceFile) -> None:
    """Raise ScenarioError if the file would unpack to more than allowed; nothing is unpacked for that."""
    if len(source.content) > LARGEST_BYTES:
        raise ScenarioError(f"{source.name}: larger than the {LARGEST_BYTES / 1e6:g} MB allowed.")
    try:
        with zipfile.ZipFile(io.BytesIO(source.content)) as package:
            parts = package.infolist()
    except (zipfile.BadZipFile, NotImplementedError, ValueError) as error:
        raise ScenarioError(f"{source.name}: not a workbook that can be read: {error}.") from None
    # a part that unpacks to more than it says is cut off there by the library, and its checksum is then wrong
    unpacked = sum(part.file_size for part in parts)
    if unpacked > LARGEST_UNPACKED_BYTES:
        raise ScenarioError(
            f"{source.name}: unpacks to {unpacked / 1e6:.0f} MB; at most {LARGEST_UNPACKED_BYTES / 1e6:g} MB are "
            "allowed."
        )
    if len(parts) > MOST_FILES:
        raise ScenarioError(f"{source.name}: holds {len(parts)} files; at most {MOST_FILES} are allowed.")


def _filled_sheets(book: Any) -> tuple[str, ...]:
    """Return the names of the sheets that hold anything: spreadsheet programs add empty ones."""
    names = []
    for name in book.sheetnames:
        sheet = book[name]
        if hasattr(sheet, "reset_dimensions"):
            sheet.reset_dimensions()
        # a sheet of a chart has no rows
        rows = islice(sheet.iter_rows(values_only=True), ROWS_OF_TITLES) if hasattr(sheet, "iter_rows") else ()
        if any(cell is not None for row in rows for cell in row):
            names.append(name)
    # in one that begins far down, reading it says what is wrong
    return tuple(names or book.sheetnames[:1])


def _sheet_name(source: str, names: tuple[str, ...], sheet: str | None) -> str:
    if not names:
        raise ScenarioError(f"{source}: holds no rows.")
    if sheet is None and len(names) > 1:
        raise ChoiceError(source, "sheet", names)
    if sheet is None:
        return names[0]
    if sheet not in names:
        raise ScenarioError(f"{source}: sheet = {show(sheet)} must be one of {shown_list(list(names))}.")
    return sheet


def _rows(source: str, values: Any, formulas: Any) -> Iterator[tuple[int, Iterator[tuple[Any, Any]]]]:
    """Give the rows of a sheet with both what cells hold and their formulas, as far as they are allowed."""
    for sheet in (values, formulas):
        # the size that the file claims is not its own: up to that of the largest sheet would be filled up with nothing
        if hasattr(sheet, "reset_dimensions"):
            sheet.reset_dimensions()
    both = zip_longest(values.iter_rows(values_only=True), formulas.iter_rows(values_only=True), fillvalue=())
    for number, (row, formula) in enumerate(both, 1):
        if number > MOST_ROWS:
            raise ScenarioError(f"{source}: more than the {MOST_ROWS} rows allowed.")
        yield number, zip_longest(row, formula)


def _cell(source: str, number: int, value: Any, formula: Any) -> Cell:
    """Return what a cell holds.

    Raises
    ------
    ScenarioError
        If it is a formula of which the file does not say what it gives.
    """
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
    if isinstance(value, datetime | date | time):
        return value.isoformat()
    if isinstance(value, timedelta):
        return value.total_seconds()
    return str(value)
