"""The phases of a run."""

import math

import numpy as np

from railjoule.core.arrays import BoolArray, FloatArray
from railjoule.core.phases.borders import with_borders_in_cells, with_steady_pieces, without_negligible_power
from railjoule.core.phases.labels import label_cells
from railjoule.core.phases.phase import COAST, NAMES, STAND, Phase
from railjoule.core.phases.run_data import RunData
from railjoule.core.phases.segments import (
    FIRST,
    KIND,
    LAST,
    PLACE,
    SHARE,
    SPEED,
    TIME,
    joined,
    segments_of,
    with_pulses,
)


def find_phases(run: RunData) -> tuple[Phase, ...]:
    """Return the phases of a run, in order.

    No brake is lost, however short, and no coasting draws energy: what is left out is but an effort that is too
    small or too short to tell beside coasting, and a cell within which power is switched off or on. Power by short
    pulses is a speed that is held by turns.
    """
    rows, energy_j = _segments(run)
    starts = rows[:, [PLACE, TIME, SPEED]].tolist()
    starts.append([float(run.position_m[-1]), float(run.time_s[-1]), float(run.speed_ms[-1])])
    return tuple(
        Phase(
            NAMES[int(kind)],
            *(place, end_place),
            *(start, end),
            *(entering, leaving),
            energy,
            None if math.isnan(share) else share,
        )
        for kind, share, energy, (place, start, entering), (end_place, end, leaving) in zip(
            rows[:, KIND].tolist(), rows[:, SHARE].tolist(), energy_j.tolist(), starts[:-1], starts[1:], strict=True
        )
    )


def _segments(run: RunData) -> tuple[FloatArray, FloatArray]:
    """Return the segments of a run and their energies [J]."""
    labels, begins_hold, negligible = label_cells(run)
    # The order matters: short segments are joined first, or they would count as pulses; pulses become holds before the
    # borders within cells move, as a border belongs to what is left; straight pieces come last, over final ends.
    rows = with_pulses(run, joined(run, segments_of(run, labels, begins_hold)))
    rows = without_negligible_power(run, with_borders_in_cells(run, rows), negligible)
    rows = with_steady_pieces(run, rows)
    return rows, _energies(run, rows, negligible)


def _energies(run: RunData, rows: FloatArray, negligible: BoolArray) -> FloatArray:
    """Return the energy of each segment [J]; what a negligible effort takes counts where the driver last had one."""
    count = rows.shape[0]
    energy = np.zeros(count)
    for k in range(count):
        for i in range(int(rows[k, FIRST]), int(rows[k, LAST])):
            taken = run.energy_j[i + 1] - run.energy_j[i]
            # the labels call such a cell coasting, and no coasting may draw energy: the sum over all phases must stay
            # that of the run
            receiver = _receiver_of(rows, k) if negligible[i] and rows[k, KIND] == COAST else k
            energy[receiver] += taken
    return energy


def _receiver_of(rows: FloatArray, coast: int) -> int:
    """Return the last segment with an effort before a coasting one, else the next one after it, else itself."""
    for k in range(coast - 1, -1, -1):
        if rows[k, KIND] != COAST and rows[k, KIND] != STAND:
            return k
    for k in range(coast + 1, rows.shape[0]):
        if rows[k, KIND] != COAST and rows[k, KIND] != STAND:
            return k
    return coast
