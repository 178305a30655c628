"""Efficiency maps of drives as tables in CSV files."""

from railjoule.core.errors import ScenarioError
from railjoule.core.scenario.csv_table import Folder, read_rows

COLUMNS = ("torque_nm", "speed_rads", "efficiency")
# the same bound as of the model, asked here first, as here the sentence can name the file
LEAST_POINTS = 9
"""Three torques at three speeds."""


def read_map(name: str, folder: Folder | None) -> list[list[float]]:
    """Return the points of a CSV file with the columns torque_nm, speed_rads and efficiency.

    Parameters
    ----------
    name : str
        The file, relative to `folder`.
    folder : Path, callable or None
        Where scenario files may name other files; None where they may not.

    Raises
    ------
    ScenarioError
        If the file cannot be read, a column is unknown or missing, a cell is empty or not a number, or there are
        too few points.
    """
    points = []
    for number, row in enumerate(read_rows("drive.file", name, folder, COLUMNS), 1):
        missing = [column for column in COLUMNS if column not in row]
        if missing:
            raise ScenarioError(f"drive.file {name!r}: point {number} has no {missing[0]}.")
        points.append([row[column] for column in COLUMNS])
    if len(points) < LEAST_POINTS:
        raise ScenarioError(f"drive.file {name!r} has {len(points)} of at least {LEAST_POINTS} points.")
    return points
