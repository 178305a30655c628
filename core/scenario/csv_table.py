"""Tables in CSV files that a scenario names: sections of a line, efficiency maps."""

import csv
from collections.abc import Callable, Iterable
from pathlib import Path

from railjoule.core.errors import ScenarioError
from railjoule.core.scenario._sentences import show, suggestion
from railjoule.core.scenario.drive import MIN_POINTS
from railjoule.core.scenario.line import Section
from railjoule.core.scenario.text_file import read_text

MAP_COLUMNS = ("torque_nm", "speed_rads", "efficiency")
Folder = Path | Callable[[str], str]
"""Where the files are that a scenario names: a folder, or what reads the text of one by its name."""


def read_rows(key: str, name: str, folder: Folder | None, columns: Iterable[str]) -> list[dict[str, float]]:
    """Return the rows of a CSV file by column; empty cells are left out.

    Parameters
    ----------
    key : str
        The scenario's key that names the file, such as 'line.file'.
    name : str
        The file, relative to `folder`.
    folder : Path, callable or None
        Where scenario files may name other files; None where they may not.
    columns : iterable of str
        Columns that it may have.

    Raises
    ------
    ScenarioError
        If the file cannot be read, a column is unknown, or a cell is not a number.
    """
    known = tuple(columns)
    # a scenario that came as a text, as on the page, may not name files: they would be the server's
    if folder is None:
        raise ScenarioError(f"{key} = {name!r} can only be read from a scenario file on disk.")
    text = read_text(folder / name) if isinstance(folder, Path) else folder(name)
    try:
        rows = list(csv.reader(text.splitlines()))
    except csv.Error as error:
        raise ScenarioError(f"{key} {name!r}: not a table in CSV: {error}.") from None
    if not rows:
        raise ScenarioError(f"{key} {name!r} is empty.")
    header = [column.strip() for column in rows[0]]
    for column in header:
        if column not in known:
            hint = suggestion(column, known)
            end = "" if hint.endswith("?") else "."
            raise ScenarioError(f"{key} {name!r}: unknown column {show(column)}, {hint}{end}")
    # a row becomes a dictionary, in which the second of two columns of a name would replace the first without a word
    if len(set(header)) < len(header):
        raise ScenarioError(f"{key} {name!r}: a column appears twice.")
    # numbered from 2, as an editor counts the lines of a file with a header; a blank line is an empty row
    return [_row(header, row, f"{key} {name!r}, row {number}") for number, row in enumerate(rows[1:], 2) if row]


def _row(header: list[str], row: list[str], place: str) -> dict[str, float]:
    if len(row) != len(header):
        raise ScenarioError(f"{place}: {len(row)} cells under {len(header)} columns.")
    values = {}
    for column, cell in zip(header, row, strict=True):
        if cell.strip():
            try:
                values[column] = float(cell)
            except ValueError:
                raise ScenarioError(f"{place}: {column} = {show(cell.strip())} must be a number.") from None
    return values


def read_map(name: str, folder: Folder | None) -> list[list[float]]:
    """Read the points of an efficiency map; arguments and errors as in `read_rows`.

    Raises
    ------
    ScenarioError
        If a column is missing, a cell is empty, or there are too few points.
    """
    points = []
    for number, row in enumerate(read_rows("drive.file", name, folder, MAP_COLUMNS), 1):
        missing = [column for column in MAP_COLUMNS if column not in row]
        if missing:
            raise ScenarioError(f"drive.file {name!r}: point {number} has no {missing[0]}.")
        points.append([row[column] for column in MAP_COLUMNS])
    # the model has the same bound, but here the sentence can name the file
    if len(points) < MIN_POINTS:
        raise ScenarioError(f"drive.file {name!r} has {len(points)} of at least {MIN_POINTS} points.")
    return points


def read_sections(name: str, folder: Folder | None) -> list[dict[str, float]]:
    """Read sections, whose keys are the columns; arguments and errors as in `read_rows`."""
    return read_rows("line.file", name, folder, Section.model_fields)
