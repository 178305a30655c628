"""The phases of a run."""

import numpy as np

from railjoule.core.arrays import BoolArray
from railjoule.core.phases.borders import with_borders_in_cells, with_steady_pieces, without_negligible_power
from railjoule.core.phases.labels import label_cells
from railjoule.core.phases.phase import COAST, NAMES, STAND, Phase, RunData
from railjoule.core.phases.segments import Segment, joined, split_segments, with_pulses


def find_phases(run: RunData) -> tuple[Phase, ...]:
    """Return the phases of a run, in order.

    No brake is lost, however short, and no coasting draws energy. Only an effort that is too small or too short to show
    beside coasting is left out, and a cell within which power is switched off or on. Power by short pulses is a speed
    that is held by turns.
    """
    labels, begins_hold, negligible = label_cells(run)
    # The order matters: short segments are joined first, or they would count as pulses; pulses become holds before the
    # borders within cells move, as a border belongs to the segments that remain; straight pieces come last, over final
    # ends.
    segments = with_pulses(run, joined(run, split_segments(run, labels, begins_hold)))
    segments = without_negligible_power(run, with_borders_in_cells(run, segments), negligible)
    segments = with_steady_pieces(run, segments)
    energies = _energies_j(run, segments, negligible)
    starts = [(one.place_m, one.time_s, one.speed_ms) for one in segments]
    starts.append((float(run.position_m[-1]), float(run.time_s[-1]), float(run.speed_ms[-1])))
    phases = []
    for one, energy, (place, time, speed), (end_m, end_s, end_ms) in zip(
        segments, energies, starts[:-1], starts[1:], strict=True
    ):
        phases.append(Phase(NAMES[one.kind], place, end_m, time, end_s, speed, end_ms, energy, one.share))
    return tuple(phases)


def _energies_j(run: RunData, segments: list[Segment], negligible: BoolArray) -> list[float]:
    """Return the energy of each segment [J]; that of a negligible effort counts where the driver last had one."""
    taken, energies = np.diff(run.energy_j), [0.0] * len(segments)
    for k, one in enumerate(segments):
        cells = slice(one.first, one.last)
        # the labels call such a cell coasting, and no coasting may draw energy: the sum over all phases must stay that
        # of the run
        hidden = float(taken[cells] @ negligible[cells]) if one.kind == COAST else 0.0
        energies[k] += float(taken[cells].sum()) - hidden
        if hidden:
            energies[_receiver(segments, k)] += hidden
    return energies


def _receiver(segments: list[Segment], coast: int) -> int:
    """Return the last segment with an effort before a coasting one, else the next one after it, else itself."""
    order = (*range(coast - 1, -1, -1), *range(coast + 1, len(segments)))
    return next((k for k in order if segments[k].kind not in (COAST, STAND)), coast)
