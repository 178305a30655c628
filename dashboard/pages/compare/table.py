"""The answer of Compare, the numbers of all runs, and the differences of their scenarios."""

from collections.abc import Iterable, Mapping, Sequence

from railjoule.core import Trajectory
from railjoule.core.units import J_PER_KWH
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.look.differences import difference_words
from railjoule.dashboard.pages.compare.charts import Contender
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.state.pins import Pin

HINT = parts.Markup(
    '<p class="note fewer-columns">A wider screen shows instructions, recuperated energy and losses, too.</p>'
)
"""assets/css/parts.css leaves those columns out on narrow screens, and the difference in kWh."""


def answer(among: Sequence[Contender], reference: Contender, so_far: bool = False) -> parts.Markup:
    """Return the strategy of least energy that keeps the timetable, the next one, and the late ones, as HTML.

    Pinned runs take no part: their scenarios may differ. Late runs take none, as more time always saves energy.
    `so_far` means that further strategies are under way.
    """
    strategies = [contender for contender in among if not contender.is_pinned]
    late = [f"{one.name} {comparisons.delay_words(one.run)}" for one in strategies if comparisons.delay_words(one.run)]
    on_time = sorted(
        (one for one in strategies if not comparisons.delay_words(one.run)), key=lambda one: one.run.energy_kwh
    )
    if not on_time:
        return parts.Markup()
    least_kwh = on_time[0].run.energy_kwh
    # runs that read the same are equal: the first of them in the order of the strategies
    equal = [one for one in on_time if comparisons.above(one.run.energy_kwh, least_kwh).is_none]
    best = min(equal, key=strategies.index)
    cells = [
        parts.figure(
            f"Least energy in {words.time(best.run.scenario.travel_time_s)} s: {best.name}",
            words.energy(best.run.energy_kwh),
            "kWh",
            _against(best, reference),
            "main",
            term="Energy from the supply",
        )
    ]
    others = [one for one in on_time if one not in equal]
    if others:
        more = comparisons.above(others[0].run.energy_kwh, best.run.energy_kwh)
        detail = f"{others[0].name}, {words.energy(others[0].run.energy_kwh)} kWh"
        cells.append(parts.figure("Next best", *more, detail))
    cells.append(
        parts.figure(
            "Strategies on time",
            str(len(on_time)),
            f"of {len(strategies)}",
            "others under way" if so_far else ", ".join(late) or "none is late",
        )
    )
    return parts.figures(cells)


def _against(best: Contender, reference: Contender) -> str:
    """Return the energy of the best run compared with the reference, in a few words; of the reference, its proof."""
    if best is reference:
        return parts.PROVEN if best.run.is_proven else comparisons.reference_detail(best.run)
    amount = comparisons.above(best.run.energy_kwh, reference.run.energy_kwh)
    other = " of another scenario" if difference_words(best.run.scenario, reference.run.scenario) else ""
    late = comparisons.delay_words(reference.run)
    return f"{amount.sentence} {reference.name}{other}{f', {late}' if late else ''}"


def comparison_table(among: Sequence[Contender], reference: Contender) -> parts.Markup:
    """Return the table as HTML; the reference is its chosen row, and losses that no run has are left out."""
    losses = [contender.run.energy.losses_j for contender in among]
    kinds = [kind for kind in dict.fromkeys(kind for each in losses for kind in each) if _has_any(losses, kind)]
    header = ["Run", "kWh", "vs reference, kWh", "vs reference, %", "s", "km/h", "instructions", "recuperated"]
    header += [words.LOSS_WORDS[kind].lower() for kind in kinds]
    buttons = [parts.markup('<button type="button" class="sort" data-act="sort">{}</button>', word) for word in header]
    # added to HTML, a name is escaped: users give pins theirs
    rows = [
        (
            [parts.swatch(contender.key) + contender.name, *_numbers(contender.run, reference.run, kinds)],
            contender is reference,
        )
        for contender in among
    ]
    title = "Runs, energies in kWh"
    # of other strategies the column of times shows it
    notes = parts.other_times(contender.run for contender in among if contender.key == "optimal")
    template = '<div class="wide-table wraps" tabindex="0" role="region" aria-label="{}">{}</div>{}{}'
    return parts.markup(template, title, parts.table(title, buttons, rows), HINT, notes)


def arrival_table(among: Sequence[Contender]) -> parts.Markup:
    """Return the arrivals of all runs of the scenario at its stations as HTML; nothing on a line without any."""
    runs = [contender for contender in among if not contender.is_pinned]
    if not runs or not runs[0].run.station_arrivals:
        return parts.Markup()
    header = ["Run", *(name for name, *_ in runs[0].run.station_arrivals)]
    rows = [
        (
            [parts.swatch(one.key) + one.name, *(words.time(time_s) for *_, time_s in one.run.station_arrivals)],
            False,
        )
        for one in runs
    ]
    title = "Arrivals, s"
    template = '<div class="wide-table wraps" tabindex="0" role="region" aria-label="{}">{}</div>'
    return parts.markup(template, title, parts.table(title, header, rows))


def _has_any(losses: Sequence[Mapping[str, float]], kind: str) -> bool:
    return any(abs(each.get(kind, 0.0)) >= words.LEAST_ENERGY_KWH * J_PER_KWH for each in losses)


def _numbers(run: Trajectory, reference: Trajectory, kinds: Sequence[str]) -> list[str]:
    """Return the cells of a run but its name."""
    losses = (run.energy.losses_j.get(kind) for kind in kinds)
    return [
        words.energy(run.energy_kwh),
        words.energy_difference(run.energy_kwh - reference.energy_kwh),
        comparisons.beside(run, reference),
        words.time(run.travel_time_s),
        words.number(run.max_speed_kmh),
        str(len(words.instruction_groups(run.advice))),
        words.energy(run.energy.recuperated_j / J_PER_KWH),
        *(words.UNKNOWN if joules is None else words.energy(joules / J_PER_KWH) for joules in losses),
    ]


def refusals(refused: Mapping[str, str]) -> parts.Markup:
    """Return the reasons for which strategies do not accept the scenario, each once."""
    reasons: dict[str, list[str]] = {}
    for name, reason in refused.items():
        reasons.setdefault(reason, []).append(words.STRATEGY_WORDS[name])
    return parts.note_paragraphs(f"{', '.join(names)}: {reason}" for reason, names in reasons.items())


def scenario_differences(pins: Iterable[Pin], reference: Contender) -> parts.Markup:
    """Return the differences of pinned scenarios from that of the reference, as HTML."""
    items = [
        parts.markup(
            "<li><b>{} {}</b>: {}.</li>",
            pin.number,
            pin.name,
            "; ".join(difference_words(pin.trajectory.scenario, reference.run.scenario)) or "the same scenario",
        )
        for pin in pins
        if pin.trajectory is not reference.run
    ]
    if not items:
        return parts.Markup()
    return parts.markup(
        '<div class="block"><h2>Pinned scenarios against that of {}</h2><ul class="differences">{}</ul></div>',
        reference.name,
        parts.joined(items),
    )
