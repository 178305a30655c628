"""Sections of a line as a table in a CSV file."""

from railjoule.core.scenario.csv_table import Folder, read_rows
from railjoule.core.scenario.line import Section


def read_sections(name: str, folder: Folder | None) -> list[dict[str, float]]:
    """Return the rows of a CSV file whose columns are the keys of a section.

    Parameters
    ----------
    name : str
        The file, relative to `folder`.
    folder : Path, callable or None
        Where scenario files may name other files; None where they may not.

    Raises
    ------
    ScenarioError
        If the file cannot be read, a column is unknown, or a cell is not a number.
    """
    return read_rows("line.file", name, folder, Section.model_fields)
