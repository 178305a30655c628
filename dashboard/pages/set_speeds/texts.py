"""Numbers, sentences and tables of a run with set speeds."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from railjoule.core import Scenario, Trajectory
from railjoule.core.energy import share_above
from railjoule.core.energy_along import BRAKES
from railjoule.core.units import J_PER_KWH, W_PER_KW
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.look.markup import Markup, markup
from railjoule.dashboard.pages.set_speeds.compute import (
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
TARGETS = "Set speeds are targets, speed limits are kept anyway. The travel time may differ from the timetable by {} %."
DRAG = "Drag a set speed or the end of its section."


def run_cells(run: LimitRun, window_s: tuple[float, float]) -> list[str]:
    """Return the numbers of a run; `window_s` contains the earliest and latest arrival [s]."""
    return [cost_figure(run.run), energy_figure(run.run.energy_kwh), time_figure(run.run.travel_time_s, window_s)]


def trip_cells(trip: LimitTrip, window_s: tuple[float, float]) -> list[str]:
    """Return the numbers of a trip while a step moves, without the optimum in its time."""
    return [
        parts.figure("Extra energy of set speeds", "\u2013", "", "release the step to compare", "main"),
        energy_figure(trip.energy_kwh),
        time_figure(trip.travel_time_s, window_s),
    ]


def energy_figure(kwh: float) -> Markup:
    """Return an energy."""
    return parts.figure("Energy", words.energy(kwh), "kWh", "from the supply")


def time_figure(time_s: float, window_s: tuple[float, float]) -> str:
    """Return the travel time, and whether it is within the window."""
    first, last = window_s
    # the search uses all of the window, up to rounding
    rounding = 1e-5 * last
    if first - rounding <= time_s <= last + rounding:
        detail = f"permitted {words.number(first)} to {words.number(last)} s"
    elif time_s > last:
        detail = markup('<span class="worse">{} s too late</span>', words.number(time_s - last))
    else:
        detail = markup('<span class="open">{} s too early</span>', words.number(first - time_s))
    return parts.figure("Travel time", words.time(time_s), "s", detail)


def cost_figure(run: Trajectory) -> Markup:
    """Return the cost of the set speeds beside the best known run of the same time."""
    cost, reference = comparisons.above_reference(run), run.reference
    if cost is None or reference is None:
        return parts.figure("Extra energy of set speeds", words.UNKNOWN, "", "no optimum to compare with", "main")
    name, least = comparisons.reference_noun(reference.proven), words.energy(reference.energy_kwh)
    detail = markup("above the {} in the same time, {} kWh{}", name, least, _proof(run, reference.proven))
    return parts.figure("Extra energy of set speeds", *cost, detail, "main")


def _proof(run: Trajectory, proven: bool) -> Markup:
    if proven:
        return markup(" {}", parts.PROVEN)
    bound, reference = run.lower_bound_kwh, run.reference
    if bound is None or reference is None:
        return Markup()
    return markup(
        '; <span class="open">\u25d0</span> {} bound', comparisons.above(reference.energy_kwh, bound).sentence
    )


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
    """Return the heading of the page."""
    scenario = run.run.scenario
    how = "found by search" if scenario.search.limits_kmh is None else "given"
    return parts.heading("Set speeds", scenario.title, f"{_count(run)} {how}", "")


def _count(run: LimitRun) -> str:
    count = len(run.limits_kmh)
    return f"{count} set speed{'' if count == 1 else 's'}"


def finding(run: LimitRun, counts: Mapping[int, Trajectory]) -> Markup:
    """Return the cost of the set speeds, that of the best of some numbers of sections, and how to change them."""
    needs, best = f"With {_count(run)} the train needs {words.energy(run.run.energy_kwh)} kWh", ""
    if run.run.reference is not None:
        needs += f"{_more(run.run)} in the same time, {words.energy(run.run.reference.energy_kwh)} kWh"
    if counts:
        count, found = min(counts.items(), key=lambda one: one[1].energy_kwh)
        best = f"Of {min(counts)} to {max(counts)} equal sections, {count} need the least: "
        best += f"{words.energy(found.energy_kwh)} kWh{_more(found)}."
    return parts.finding(f"{needs}.", best, DRAG)


def _more(run: Trajectory) -> str:
    amount, reference = comparisons.above_reference(run), run.reference
    if amount is None or reference is None:
        return ""
    noun = comparisons.reference_noun(reference.proven)
    return f", {amount.size} {amount.unit} {'less' if amount.is_less else 'more'} than the {noun}"


def counts_table(counts: Mapping[int, Trajectory], shown: int) -> Markup:
    """Return the runs found by search by the number of equal sections; that of the page is the chosen row."""
    rows = [
        (
            (
                str(count),
                words.energy(run.energy_kwh),
                comparisons.cell(comparisons.above_reference(run)),
                words.time(run.travel_time_s),
                words.number(run.max_speed_kmh),
            ),
            count == shown,
        )
        for count, run in counts.items()
    ]
    is_proven = all(run.reference is not None and run.reference.proven for run in counts.values())
    head = ("Sections", "kWh", f"vs {comparisons.reference_name(is_proven)} in its time, %", "s", "km/h")
    return parts.inset(parts.table("Equal sections, set speeds found by search", head, rows))


def rule(scenario: Scenario) -> str:
    """Return the rule of the regulator, and how the travel time is set."""
    search = scenario.search
    of_regulator = RULES[search.regulator].format(zone=words.number(search.dead_zone_kmh))
    return f"{of_regulator} {TARGETS.format(words.number(100 * search.time_window))} {scenario.time_note}"


def notes(run: LimitRun) -> Markup:
    """Return the rule of the regulator and the notes of a run, with the reason for a missing optimum."""
    without = run.no_optimum and f"No optimum in the time of the run: {run.no_optimum}"
    first = parts.note_paragraphs(filter(None, [rule(run.run.scenario), without]))
    return markup('<div class="columns">{}</div>', first + parts.notes(run.run))


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


def storage_words(storage: StorageCurve) -> Markup:
    """Return the savings of the chosen storage and of a receptive supply, and the storage needed, as a sentence."""
    chosen, need = storage.chosen, storage.need
    size, power = words.energy(chosen.storage.size_kwh), words.number(math.ceil(chosen.storage.power_kw), 0)
    saved, most = (
        words.energy(chosen.with_resistors_kwh - kwh) for kwh in (chosen.energy_kwh, chosen.with_receptive_line_kwh)
    )
    share = words.share(-share_above(chosen.energy_kwh, chosen.with_resistors_kwh))
    # upwards, as less power would not do
    peak = words.number(math.ceil(max(need.charging_peak_kw, need.discharging_peak_kw)), 0)
    return parts.note_paragraphs(
        [
            f"On-board storage of {size} kWh and {power} kW saves {saved} kWh ({share} %) against brake resistors, a "
            f"fully receptive supply {most} kWh. The run needs {words.energy(need.max_drop_kwh)} kWh and {peak} kW: "
            f"{words.number(need.cycles_per_day, 0)} full cycles of that size in an 18-hour day."
        ],
        "padding:0 6px",
    )
