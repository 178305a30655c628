"""Sections of a line as a table in a CSV file."""

import csv
from pathlib import Path
from typing import Any

from railjoule.core.errors import ScenarioError
from railjoule.core.scenario._sentences import nearest, show
from railjoule.core.scenario.line import Section
from railjoule.core.scenario.text_file import read_text


def read_sections(name: str, folder: Path | None) -> list[dict[str, Any]]:
    """Return the rows of a CSV file whose columns are the keys of a section.

    Parameters
    ----------
    name : str
        The file, relative to `folder`.
    folder : Path or None
        Where scenario files may name other files; None where they may not.

    Raises
    ------
    ScenarioError
        If the file cannot be read, a column is unknown, or a cell is not a number.
    """
    if folder is None:
        raise ScenarioError(f"line.file = {name!r} can only be read from a scenario file on disk.")
    try:
        rows = list(csv.reader(read_text(folder / name).splitlines()))
    except csv.Error as error:
        raise ScenarioError(f"line.file {name!r}: not a table in CSV: {error}.") from None
    if not rows:
        raise ScenarioError(f"line.file {name!r} is empty.")
    header = [column.strip() for column in rows[0]]
    for column in header:
        if column not in Section.model_fields:
            hint = nearest(column, Section.model_fields)
            end = "" if hint.endswith("?") else "."
            raise ScenarioError(f"line.file {name!r}: unknown column {show(column)}, {hint}{end}")
    if len(set(header)) < len(header):
        raise ScenarioError(f"line.file {name!r}: a column stands there twice.")
    return [_section(header, row, f"line.file {name!r}, row {number}") for number, row in enumerate(rows[1:], 2) if row]


def _section(header: list[str], row: list[str], place: str) -> dict[str, float]:
    if len(row) != len(header):
        raise ScenarioError(f"{place}: {len(row)} cells under {len(header)} columns.")
    section = {}
    for column, cell in zip(header, row, strict=True):
        if cell.strip():
            try:
                section[column] = float(cell)
            except ValueError:
                raise ScenarioError(f"{place}: {column} = {show(cell.strip())} must be a number.") from None
    return section
