"""The numbers of all runs and their differences to a reference, as a table."""

from collections.abc import Mapping, Sequence

from railjoule.core import Trajectory
from railjoule.core.strategies import STRATEGIES
from railjoule.core.units import J_PER_KWH
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.pages.compare.contenders import Contender
from railjoule.dashboard.parts import html as parts

HINT = parts.Markup('<p class="note scroll-hint">Swipe sideways for more columns.</p>')


def comparison_table(among: Sequence[Contender], reference: Contender) -> parts.Markup:
    """Return the table as HTML; the reference is its chosen row, and losses that no run has are left out."""
    losses = [contender.run.energy.losses_j for contender in among]
    kinds = [kind for kind in dict.fromkeys(kind for each in losses for kind in each) if _any(losses, kind)]
    header = ["Run", "kWh", "vs ref., kWh", "%", "s", "vs ref., s", "km/h", "recuperated"]
    header += [words.LOSS_WORDS[kind].lower() for kind in kinds]
    best = among[0].run.reference
    header.append(f"above {comparisons.reference_name(best is not None and best.proven)}, %")
    buttons = [parts.markup('<button type="button" class="sort" data-act="sort">{}</button>', word) for word in header]
    rows = []
    for contender in among:
        # added to HTML, a name is escaped: users give pins theirs
        cells: list[str] = [parts.swatch(contender.key) + contender.name]
        cells += numbers(contender.run, reference.run, kinds)
        rows.append((cells, contender is reference))
    title = "Runs side by side, energies in kWh"
    table = parts.table(title, buttons, rows)
    notes = parts.other_times(contender.run for contender in among if contender.key in STRATEGIES)
    template = '<div class="wide-table" tabindex="0" role="region" aria-label="{}">{}</div>{}{}'
    return parts.markup(template, title, table, HINT, notes)


def _any(losses: Sequence[Mapping[str, float]], kind: str) -> bool:
    """Return whether any run has a loss that its table would show."""
    return any(abs(each.get(kind, 0.0)) >= words.LEAST_ENERGY_KWH * J_PER_KWH for each in losses)


def numbers(run: Trajectory, reference: Trajectory, kinds: Sequence[str]) -> list[str]:
    """Return the cells of a run but its name."""
    energy = run.energy
    losses = (energy.losses_j.get(kind) for kind in kinds)
    return [
        words.energy(run.energy_kwh),
        words.energy_difference(run.energy_kwh - reference.energy_kwh),
        comparisons.beside(run, reference),
        words.time(run.travel_time_s),
        words.delay(run.travel_time_s - reference.travel_time_s),
        words.number(run.max_speed_kmh),
        words.energy(energy.recuperated_j / J_PER_KWH),
        *(words.UNKNOWN if joules is None else words.energy(joules / J_PER_KWH) for joules in losses),
        comparisons.in_time_asked(run),
    ]
