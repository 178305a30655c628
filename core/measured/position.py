"""The position of a recorder: its direction, its order, and whether its noise leaves a distance to read."""

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.errors import RecordingError
from railjoule.core.imports.source_file import counted
from railjoule.core.measured.table import Table

FALLING = "Positions fall: the train runs in falling chainage, counted from the first row."
LARGEST_NOISE_SHARE = 0.02
"""Of the distance: positions that leave the speeds by more, as a root mean square, were reset."""


def direction_of(table: Table) -> int:
    """Return -1 for a train that runs in falling chainage, else 1: in falling chainage most steps fall."""
    steps = np.sign(np.diff(table.values["position"]))
    return -1 if float(np.sum(steps)) < 0 and table.values["position"][-1] < table.values["position"][0] else 1


def require_rising(table: Table, quantity: str, may_stay: bool) -> None:
    """Raise RecordingError if a time, or a position in the direction of the run, goes back."""
    direction = direction_of(table) if quantity == "position" else 1
    difference = direction * np.diff(table.values[quantity])
    for row in np.flatnonzero(difference < 0 if may_stay else difference <= 0)[:1]:
        bound = ("at least" if direction > 0 else "at most") if may_stay else "above"
        raise RecordingError(
            f"{table.source}: {table.told(quantity, row + 1)} must be {bound} that of the row before, "
            f"{table.told(quantity, row).partition(' = ')[2]}: the rows are not in order, or the recorder"
            " was reset."
        )


def readable_position(table: Table, covered_m: FloatArray, notes: list[str]) -> FloatArray | None:
    """Return the distance by the odometer since the first row [m], without steps back; None where it cannot be read.

    Parameters
    ----------
    table : Table
        The rows of the run, with a position.
    covered_m : array of shape (n,)
        Distance by the speeds [m].
    notes : list of str
        Receives a sentence where the position goes back.
    """
    position: FloatArray = direction_of(table) * (table.values["position"] - table.values["position"][0])
    steps = np.diff(position)
    back = np.flatnonzero(steps < 0)
    if not len(back):
        return position
    name, worst = table.columns["position"].header, int(np.argmin(steps))
    # the speeds have the shape of the distance, the positions its size
    basis = np.column_stack([np.ones(len(covered_m)), covered_m])
    (offset, factor), *_ = np.linalg.lstsq(basis, position, rcond=None)
    noise = float(np.sqrt(np.mean((position - offset - factor * covered_m) ** 2)))
    if noise > LARGEST_NOISE_SHARE * covered_m[-1]:
        notes.append(
            f"{name} is not used: it goes back by {-steps[worst]:.4g} m in row {table.rows[worst + 1]}. Distances "
            "follow from speed and time."
        )
        return None
    notes.append(
        f"{name} goes back in {counted(len(back), 'row')}, by up to {-steps[worst]:.3g} m: its noise of {noise:.2g} m "
        "is averaged out with the speeds."
    )
    distance: FloatArray = factor * covered_m
    return distance
