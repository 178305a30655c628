"""Numbers, sentences and tables of a run with set speeds."""

import math
from collections.abc import Sequence

import numpy as np

from railjoule.core import Scenario, Trajectory
from railjoule.core.energy import share_above
from railjoule.core.energy_along import BRAKES
from railjoule.core.limit_search.search import LimitSearch
from railjoule.core.units import J_PER_KWH, W_PER_KW
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.look.markup import Markup, markup
from railjoule.dashboard.pages.speed_limits.compute import (
    InterStationRuns,
    LimitRun,
    LimitTrip,
    StorageCurve,
    run_figures,
)
from railjoule.dashboard.parts import html as parts

REGULATOR_WORDS = {"Coast": "coast", "Brake": "brake", "As in the paper": "literal"}
"""The regulators, by what they do above a set speed."""
RUNS_WORDS = {"All runs together": "together", "Each run by itself": "separate"}
"""The two ways to search the inter-station runs of a line."""
RULES = {
    "coast": "The train drives below its set speed and coasts above it.",
    "brake": "The train drives below its set speed and brakes ahead of a lower one.",
    "literal": "The train drives below its set speed and brakes above it; within {zone} km/h of it, it does neither.",
}
"""The rule of each regulator; `zone` is half of the dead zone of the published relay."""
TARGETS = (
    "Set speeds are targets, not limits of the line. The travel time may differ from the timetable within a window."
)


def run_cells(run: LimitRun, window_s: tuple[float, float]) -> list[str]:
    """Return the numbers of a run; `window_s` contains the earliest and latest arrival [s]."""
    need = run.need
    return [
        cost_figure(run),
        parts.figure("Energy", words.energy(run.run.energy_kwh), "kWh", "from the supply"),
        optimum_figure(run),
        time_figure(run.run.travel_time_s, window_s),
        parts.figure(
            "Storage needed",
            words.energy(need.max_drop_kwh),
            "kWh",
            # upwards, as less power would not do
            f"{words.number(math.ceil(need.charging_peak_kw), 0)} kW at most",
        ),
    ]


def trip_cells(trip: LimitTrip, window_s: tuple[float, float]) -> list[str]:
    """Return the numbers of a trip while a step moves, without the optimum in its time."""
    return [
        parts.figure("Extra energy of set speeds", "\u2013", "", "release the step to compare", "main"),
        parts.figure("Energy", words.energy(trip.energy_kwh), "kWh", "from the supply"),
        parts.figure("Optimum", "\u2013", "", ""),
        time_figure(trip.travel_time_s, window_s),
        parts.figure("Storage needed", "\u2013", "", ""),
    ]


def time_figure(time_s: float, window_s: tuple[float, float]) -> str:
    """Return the travel time, and whether it is within the window."""
    first, last = window_s
    # the search uses all of the window, up to rounding
    rounding = 1e-5 * last
    if first - rounding <= time_s <= last + rounding:
        detail = f"allowed {words.number(first)} to {words.number(last)} s"
    elif time_s > last:
        detail = markup('<span class="worse">{} s too late</span>', words.number(time_s - last))
    else:
        detail = markup('<span class="open">{} s too early</span>', words.number(first - time_s))
    return parts.figure("Travel time", words.time(time_s), "s", detail)


def losses_table(run: Trajectory) -> str:
    """Return the losses of a run's drive by kind; their mean powers are over the time in motion."""
    losses_j = {kind: joules for kind, joules in run.energy.losses_j.items() if kind not in BRAKES}
    whole_j, moves = sum(losses_j.values()), np.diff(run.position_m) > 0
    seconds = float(np.sum(np.diff(run.time_s)[moves]))

    def row(name: str, joules: float, strong: bool = False) -> tuple[tuple[str, ...], bool]:
        share = words.share(joules / whole_j) if whole_j > 0 else ""
        power = words.number(joules / seconds / W_PER_KW)
        return (name, words.energy(joules / J_PER_KWH), share, power), strong

    rows = [row(words.LOSS_WORDS[kind], joules) for kind, joules in losses_j.items()]
    head = ("Lost to", "kWh", "%", "mean power, kW")
    return parts.inset(parts.table("Losses of the powertrain", head, [*rows, row("All", whole_j, True)]))


def heading(run: LimitRun) -> Markup:
    """Return the heading of the page, with the rule of the regulator."""
    scenario, count = run.run.scenario, len(run.limits_kmh)
    how = "found by search" if scenario.search.limits_kmh is None else "given"
    what = f"{count} section{'' if count == 1 else 's'}, set speeds {how}"
    return parts.heading("Speed limits", scenario.title, what, "") + rule_html(scenario)


def rule_html(scenario: Scenario) -> Markup:
    """Return the rule of the regulator, and how the travel time is set."""
    search = scenario.search
    rule = RULES[search.regulator].format(zone=words.number(search.dead_zone_kmh))
    return markup('<p style="padding:0 20px 8px;max-width:90ch">{} {} {}</p>', rule, TARGETS, scenario.time_note)


def notes(run: LimitRun) -> Markup:
    """Return the notes of a run, the first of them on an optimum that is missing."""
    without = run.no_optimum and f"No optimum in the time of the run: {run.no_optimum}"
    first = parts.note_paragraphs([without] if without else [])
    return markup('<div class="columns">{}</div>', first + parts.notes(run.run))


def cost_figure(run: LimitRun) -> str:
    """Return the cost of the set speeds beside the best known run of the same time."""
    cost, reference = comparisons.above_reference(run.run), run.run.reference
    if cost is None or reference is None:
        return parts.figure("Extra energy of set speeds", words.UNKNOWN, "", "no optimum to compare with", "main")
    name = comparisons.reference_noun(reference.proven)
    return parts.figure("Extra energy of set speeds", *cost, f"above the {name} in the same time", "main")


def optimum_figure(run: LimitRun) -> str:
    """Return the energy of the best known run in the time that the limits take, and how far it is from its bound."""
    reference, bound = run.run.reference, run.run.lower_bound_kwh
    if reference is None:
        return parts.figure("Optimum", words.UNKNOWN, "", "not found")
    whole = ""
    if reference.proven:
        detail: str = parts.PROVEN
    elif bound is None:
        detail = "no bound is known"
    else:
        amount = comparisons.above(reference.energy_kwh, bound)
        detail = parts.markup('<span class="open">\u25d0</span> {} bound', amount.sentence)
        whole = f"Not proven: the bound is {words.energy(bound)} kWh"
    name = comparisons.reference_noun(reference.proven).capitalize()
    return parts.figure(
        name,
        words.energy(reference.energy_kwh),
        "kWh",
        detail,
        whole=whole,
        term="Optimum" if reference.proven else "Best known",
    )


def sections_table(run: LimitRun) -> str:
    """Return the limits of the sections with the speeds that the run reaches in them."""
    ends = [0.0, *run.borders_m.tolist(), run.run.distance_m]
    rows = []
    for number, (limit, start, end) in enumerate(zip(run.limits_kmh, ends[:-1], ends[1:], strict=True), 1):
        inside = (run.run.position_m >= start) & (run.run.position_m <= end)
        top = words.speed(float(run.run.speed_ms[inside].max()), 1) if inside.any() else "\u2013"
        cells = (str(number), words.number(start, 0), words.number(end, 0), words.number(float(limit)), top)
        rows.append((cells, False))
    table = parts.table("Sections", ("Section", "from, m", "to, m", "set speed, km/h", "top speed, km/h"), rows)
    return parts.inset(table)


def section_pairs(search: LimitSearch) -> dict[str, tuple[int, int, int]]:
    """Return the pairs of neighbouring sections that one search moves: its run, the first of the two there, and before.

    All are counted from 0; the last number is that of the sections before the run.
    """
    pairs: dict[str, tuple[int, int, int]] = {}
    before = 0
    for number, run in enumerate(search.runs or (search,)):
        sections = len(run.best.limits_ms)
        for k in range(max(sections - 1, 1)):
            name = f"{before + k + 1} and {before + k + 2}" if sections > 1 else f"{before + 1}"
            pairs[name] = number, k, before
        before += sections
    return pairs


def inter_station_table(found: InterStationRuns) -> str:
    """Return times and energies of the inter-station runs, searched each by itself and all together."""
    ways = {way: found.runs[way] for way in RUNS_WORDS.values() if way in found.runs}
    columns = [values for run in ways.values() for values in run_figures(run)]
    header = ("Run", *(f"{way}, {unit}" for way in ways for unit in ("s", "kWh")))
    shown = (words.time, words.energy) * len(ways)
    names = [name.removeprefix("from ") for name in found.names]
    cells = [[show(float(value)) for value in column] for show, column in zip(shown, columns, strict=True)]
    rows: list[tuple[Sequence[str], bool]] = [(row, False) for row in zip(names, *cells, strict=True)]
    # the whole energy has the auxiliaries in dwells, too
    whole = [value for run in ways.values() for value in (run.travel_time_s, run.energy_kwh)]
    totals = [show(value) for show, value in zip(shown, whole, strict=True)]
    rows.append((("All, with dwells", *totals), True))
    notes = list(found.refusals.values())
    if len(ways) == len(RUNS_WORDS):
        together, separate = (found.runs[way].energy_kwh for way in ("together", "separate"))
        more = share_above(separate, together)
        notes.append(
            f"Separate runs each keep their own time and need {words.share(more)} % more than together, where the "
            "search can move time from one to another."
        )
    return parts.inset(parts.table("Inter-station runs", header, rows), parts.note_paragraphs(notes))


def storage_table(storage: StorageCurve) -> str:
    """Return energies with resistors, with the chosen storage and with a receptive line."""
    chosen, need = storage.chosen, storage.need
    size = words.energy(chosen.storage.size_kwh)

    def row(name: str, energy: float, strong: bool = False) -> tuple[tuple[str, ...], bool]:
        saved = chosen.with_resistors_kwh - energy
        share = -share_above(energy, chosen.with_resistors_kwh)
        return (name, words.energy(energy), words.energy(saved), words.share(share)), strong

    rows = [
        row("Resistors", chosen.with_resistors_kwh),
        row(f"Storage, {size} kWh, {words.number(math.ceil(chosen.storage.power_kw), 0)} kW", chosen.energy_kwh, True),
        row("Fully receptive supply", chosen.with_receptive_line_kwh),
    ]
    note = (
        f"Braking generates {words.energy(need.generated_kwh)} kWh at up to {words.number(need.charging_peak_kw, 0)} "
        f"kW; driving takes up to {words.number(need.discharging_peak_kw, 0)} kW. The storage loses "
        f"{words.energy(chosen.storage_loss_kwh)} kWh, resistors dissipate {words.energy(chosen.dissipated_kwh)} kWh; "
        f"{words.number(need.cycles_per_day, 0)} full cycles of the size needed in an 18-hour day."
    )
    table = parts.table("Recovered braking energy, kWh", ("Absorbed by", "from the supply", "saved", "%"), rows)
    return parts.inset(table, parts.note_paragraphs([note]))
