"""The numbers of all runs and their differences to a reference, as a table."""

from collections.abc import Mapping, Sequence

from railjoule.core import Trajectory
from railjoule.core.units import J_PER_KWH
from railjoule.dashboard.look import words
from railjoule.dashboard.models.contenders import Contender
from railjoule.dashboard.views import parts

SAME_KWH, SAME_S, SAME_SHARE = 0.005, 0.05, 0.05
"""Differences below these are none: in kWh, s and %."""
NONE = "\u2013"


def comparison_table(among: Sequence[Contender], reference: Contender) -> str:
    """Return the table as HTML; the reference is its chosen row, and losses that no run has are left out."""
    losses = [contender.run.energy.losses_j for contender in among]
    kinds = [kind for kind in dict.fromkeys(kind for each in losses for kind in each) if _any(losses, kind)]
    header = ["Run", "kWh", "less ref.", "%", "s", "less ref.", "km/h", "given back"]
    header += [parts.escaped(loss_word(kind).lower()) for kind in kinds]
    header.append("above bound, %")
    header = [f'<button type="button" class="sort" data-act="sort">{word}</button>' for word in header]
    rows = []
    for contender in among:
        cells = [f"{parts.swatch(contender.key)}{parts.escaped(contender.name)}"]
        cells += numbers(contender.run, reference.run, kinds)
        rows.append((cells, contender is reference))
    title = "Runs side by side, energies in kWh"
    table = parts.table(title, header, rows)
    return f'<div class="wide-table" tabindex="0" role="region" aria-label="{title}">{table}</div>'


def _any(losses: Sequence[Mapping[str, float]], kind: str) -> bool:
    """Return whether any run has a loss that its table would show."""
    return any(abs(each.get(kind, 0.0)) >= SAME_KWH * J_PER_KWH for each in losses)


def loss_word(kind: str) -> str:
    """Return what a kind of loss is called."""
    return parts.LOSS_WORDS.get(kind, kind.replace("_", " ").capitalize())


def numbers(run: Trajectory, reference: Trajectory, kinds: Sequence[str]) -> list[str]:
    """Return the cells of a run but its name."""
    energy, other = run.energy, reference.energy_kwh
    more_kwh, more_s = run.energy_kwh - other, run.travel_time_s - reference.travel_time_s
    share = 100 * more_kwh / other if other > 0 else 0.0
    gap = NONE if run.gap is None else words.number(max(100 * run.gap, 0.0), 2)
    return [
        words.energy(run.energy_kwh),
        difference(more_kwh, SAME_KWH, 2),
        difference(share, SAME_SHARE, 1) if other > 0 else NONE,
        words.number(run.travel_time_s),
        difference(more_s, SAME_S, 1),
        words.number(run.max_speed_kmh),
        words.number(energy.recuperated_j / J_PER_KWH, 2),
        *(words.number(energy.losses_j[kind] / J_PER_KWH, 2) if kind in energy.losses_j else NONE for kind in kinds),
        gap,
    ]


def difference(value: float, same: float, digits: int) -> str:
    """Return a difference with its sign, or 0."""
    return "0" if abs(value) < same else words.signed(value, digits)
