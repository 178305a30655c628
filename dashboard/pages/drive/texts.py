"""Texts of Drive: the numbers of the actual run, the causes of its extra energy, the proof, and the driver's card."""

from itertools import accumulate

import numpy as np
from markupsafe import Markup

from railjoule.core import Trajectory
from railjoule.core.arrays import FloatArray
from railjoule.core.bounds import ProofStep
from railjoule.core.scenario import Scenario
from railjoule.core.simulation.actual_run import ActualRun, Cause
from railjoule.core.simulation.actual_vehicle import actually_loaded
from railjoule.core.units import MS_PER_KMH
from railjoule.dashboard.charts.track import as_steps, limits_of
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.look.glossary import info
from railjoule.dashboard.look.templates import template
from railjoule.dashboard.look.typed import clock
from railjoule.dashboard.pages.drive.compute import Answer
from railjoule.dashboard.parts.html import (
    escaped,
    figure,
    figures,
    flow_bar,
    joined,
    markup,
    note_paragraphs,
    plain_table,
    price_figure,
    stop_times,
)
from railjoule.dashboard.work.runs import Runs, same_plan

CAUSES = '<div class="block causes"><h2>{}</h2>{}</div>'
OPEN = '<span class="open">{}</span>'
EQUAL = "The actual run equals the plan. Change load, position or add a stop."
SAME_ENERGY = 1e-9
"""Relative difference of energies within which two plans count as the same."""


def belongs_to(actual: ActualRun, run: Trajectory) -> bool:
    """Return whether an actual run has the scenario and the strategy of a run."""
    return actual.planned.strategy == run.strategy and same_plan(actual.scenario, run.scenario)


def is_same_plan(actual: ActualRun, run: Trajectory) -> bool:
    """Return whether an actual run starts from this run of Drive."""
    return abs(actual.planned.energy.net_j - run.energy.net_j) <= SAME_ENERGY * abs(run.energy.net_j)


def cause_words(cause: Cause, scenario: Scenario) -> str:
    """Return the name of a cause, with the direction of a load error and the number of stops."""
    disturbance = scenario.disturbance
    if cause.name == "load" and disturbance.has_load:
        heavier = actually_loaded(scenario.vehicle, disturbance).load_mass_kg > scenario.vehicle.load_mass_kg
        return "Heavier than planned" if heavier else "Lighter than planned"
    if cause.name == "stops" and len(disturbance.stops) == 1:
        return "Unplanned stop"
    return words.CAUSE_WORDS[cause.name]


def actual_figures(actual: ActualRun, runs: Runs, run: Trajectory) -> str:
    """Return the numbers of Drive while an actual run stands beside the plan."""
    largest = actual.max_cause
    cause = figure("Largest cause", words.UNKNOWN, "", "none", kind="cause")
    if largest is not None:
        name = cause_words(largest, actual.scenario)
        added = words.energy_difference(largest.energy_kwh)
        cause = figure("Largest cause", added, "kWh", name[0].lower() + name[1:], kind="cause")
    return figures(
        [
            _main(actual),
            _planned(actual, run),
            figure("Travel time", words.time(actual.actual.travel_time_s), "s", late_words(actual)),
            price_figure(run, runs.best),
            cause,
        ]
    )


def _main(actual: ActualRun) -> str:
    planned, driven = actual.planned.energy_kwh, actual.actual.energy_kwh
    detail = f"{words.energy(driven)} kWh against {words.energy(planned)} planned" if actual.causes else EQUAL
    if is_false_saving(actual):
        missed, detail = comparisons.headline(driven, planned, actual.delay_s, actual.stop_error_m, detail)
        return figure("Actual run", *missed, detail, kind="main", term="Actual run costs")
    label = "Actual run saves" if actual.extra_kwh < 0 and actual.causes else "Actual run costs"
    amount = comparisons.above(driven, planned)
    unit = markup('kWh <b class="over">{}</b>', amount) if amount.unit == "%" else "kWh "
    return figure(label, words.energy_difference(actual.extra_kwh), unit, detail, kind="main", term="Actual run costs")


def is_false_saving(actual: ActualRun) -> bool:
    """Return whether an actual run needs less than its plan, but arrives late or misses the stop."""
    energies = actual.actual.energy_kwh, actual.planned.energy_kwh
    return bool(actual.causes and comparisons.is_false_saving(*energies, actual.delay_s, actual.stop_error_m))


def _planned(actual: ActualRun, run: Trajectory) -> str:
    energy = words.energy(actual.planned.energy_kwh)
    if not is_same_plan(actual, run):
        amount = comparisons.above(actual.planned.energy_kwh, run.energy_kwh)
        detail = f"keeps to the target braking curve: {amount}"
        whole = f"{amount.sentence} the run without it, {words.energy(run.energy_kwh)} kWh"
        return figure("Planned run", energy, "kWh", detail, whole=whole)
    if run.is_proven and comparisons.is_reference(run):
        return figure("Planned run", energy, "kWh", Markup('<span class="proven">\u2713 proven optimum</span>'))
    return figure("Planned run", energy, "kWh", words.strategy(run.strategy))


def late_words(actual: ActualRun) -> str:
    """Return delay and stopping error of a run as HTML."""
    late = actual.delay_s
    parts = [markup(OPEN, missed) for missed in comparisons.misses(late, actual.stop_error_m)]
    if late < comparisons.OTHER_TIME_S:
        parts.insert(0, escaped("on time" if late > -comparisons.OTHER_TIME_S else f"{words.time(-late)} s early"))
    return joined(parts, ", ")


def causes_block(actual: ActualRun) -> str:
    """Return the causes of the extra energy as consecutive bars that sum to the whole."""
    if not actual.causes:
        return markup(CAUSES, "Causes of the extra energy", note_paragraphs([EQUAL]))
    energies = [cause.energy_kwh for cause in actual.causes]
    ends = list(accumulate(energies))
    low, high = min(0.0, *ends), max(0.0, *ends)
    # causes may add nothing at all: the bars must still have a scale
    scale = max(high - low, 1e-9)

    def bar(name: str, start: float, length: float, kind: str, strong: bool = False) -> Markup:
        left, amount = (min(start, start + length) - low) / scale, f"{words.energy_difference(length)} kWh"
        return flow_bar(name, amount, left, abs(length) / scale, kind, strong)

    rows = [
        bar(cause_words(cause, actual.scenario), start, cause.energy_kwh, "cost")
        # not strict: each begins where the one before has ended, and nothing at the last end
        for cause, start in zip(actual.causes, [0.0, *ends], strict=False)
    ]
    rows.append(bar("Together", 0.0, ends[-1], "all", strong=True))
    title = f"Causes of the extra {words.energy(abs(actual.extra_kwh))} kWh"
    if actual.extra_kwh < 0:
        energy = words.energy(abs(actual.extra_kwh))
        title = f"Causes of the {'difference: ' if is_false_saving(actual) else 'saving: '}{energy} kWh less"
    order = ["Each cause is added to those above it."] if len(energies) > 1 else []
    flow = markup("<div class=flow>{}</div>", joined(rows))
    return markup(CAUSES, title, flow + note_paragraphs([*order, *actual.notes]))


# ---- the proof

BOXES = 1e6
EXHAUSTED = "The page proves no more; the command line does, with --prove-seconds."
PROOF = (
    '<div class="block inset"><h2>Lower bound {}</h2><div class="proof-row">'
    '<span role="status" aria-live="polite">{}'
    '</span> <span class="muted">{}</span></div>{}</div>'
)


def proof_block(run: Trajectory, end: str, notes: str) -> Markup:
    """Return the statement of a run's bound, the progress of its proof, the solver's numbers and notes, as HTML."""
    milliseconds, cells = words.number(1e3 * run.solve_time_s), len(run.nodes_m) - 1
    iterations = f", {run.iterations} iterations" if run.iterations else ""
    solved = f"Solved in {milliseconds} ms{iterations}, {words.number(cells, 0)} cells."
    statement = "No bound is known." if run.bound is None else run.bound.statement
    # the count of boxes is not read aloud at every step, the statement is
    return markup(PROOF, info("Proof"), statement, end, notes + note_paragraphs([solved]))


def progress(step: ProofStep | None) -> Markup:
    """Return how many boxes of its budget a proof has used, as HTML; None while it waits for others."""
    share, amount = 0.0, "begins"
    if step is not None:
        share = step.share
        amount = f"{words.number(step.boxes / BOXES)} of {words.number(step.budget / BOXES)} million boxes"
    bar = '<progress max="1" value="{}" aria-label="Share of the boxes looked at"></progress>{}'
    return markup(bar, f"{share:.3f}", amount)


# ---- the worth


def worth(
    run: Trajectory,
    baseline: Trajectory | None,
    name: str,
    refusal: str | None,
    price_per_kwh: float,
    trains_per_day: float,
    co2_kg_per_kwh: float,
) -> Markup:
    """Return the saving of a year against a baseline, as HTML; for a late run, its delay instead."""
    if baseline is None:
        missing = "Pin a run first." if name.startswith("Pinned") else "Computing ..."
        return note_paragraphs([missing if refusal is None else f"{name}: {refusal}"])
    late, later = comparisons.delay_words(run), comparisons.late(baseline.travel_time_s, run.travel_time_s)
    if late or later:
        return note_paragraphs(
            [f"This run is {late}: that saves nothing." if late else f"{name}: {later}, not comparable."]
        )
    saved_kwh = baseline.energy_kwh - run.energy_kwh
    energy_mwh, money, co2_t = yearly_saving(saved_kwh, trains_per_day, price_per_kwh, co2_kg_per_kwh)
    verb = "Saved" if saved_kwh >= 0 else "Lost"
    rows = [
        (
            (f"Energy, {words.number(abs(saved_kwh), 2)} kWh a run", f"{words.number(abs(energy_mwh), 0)} MWh"),
            False,
        ),
        (("Money, as the price", words.number(abs(money), 0)), False),
        (("CO\u2082", f"{words.number(abs(co2_t), 0)} t"), False),
    ]
    earlier_s = run.travel_time_s - baseline.travel_time_s
    note = f"{name}: {words.time(earlier_s)} s earlier." if earlier_s >= comparisons.OTHER_TIME_S else ""
    return plain_table((f"{verb} a year", ""), rows, "Saving of a year") + note_paragraphs(filter(None, [note]))


# ---- a moved instruction

DOING = {"coast": "Coasting", "brake": "Braking"}


def moved_words(answer: Answer) -> str:
    """Return the cost of a moved instruction in a sentence, or why it cannot be moved there."""
    move, run = answer.request, answer.found
    phase = move.run.phases[move.number]
    doing = DOING[phase.phase]
    if run is None:
        return f"{doing} {answer.refusal}"
    places = f"from {words.number(move.place_m, 0)} m instead of {words.number(phase.start_m, 0)} m"
    return f"{doing} {places}: {comparisons.above(run.energy_kwh, move.run.energy_kwh)}, same arrival."


# ---- the worth of a saving

DAYS_A_YEAR = 365
KWH_PER_MWH, KG_PER_T = 1e3, 1e3


def yearly_saving(
    saved_kwh: float, trains_per_day: float, price_per_kwh: float, co2_kg_per_kwh: float
) -> tuple[float, float, float]:
    """Return energy [MWh], money and carbon dioxide [t] that all trains of 365 days save; negative if lost.

    Parameters
    ----------
    saved_kwh : float
        Saving of one run [kWh].
    trains_per_day : float
    price_per_kwh : float
    co2_kg_per_kwh : float
        Carbon dioxide emitted per energy from the supply [kg/kWh].
    """
    yearly_kwh = saved_kwh * trains_per_day * DAYS_A_YEAR
    return yearly_kwh / KWH_PER_MWH, yearly_kwh * price_per_kwh, yearly_kwh * co2_kg_per_kwh / KG_PER_T


# ---- the driver's card

WIDTH, HEIGHT = 1000.0, 219.0
"""Of the figure of speed, in the units of assets/templates/driver_card.html."""
LARGEST_PX, SMALLEST_PX, PAGE_PX = 30.0, 8.0, 660.0
"""Sizes of the type; height that rows, heading and foot share."""
COLUMN_LINES = 9
"""Up to so many instructions stand in one column."""


def driver_card(run: Trajectory, note: str = "") -> str:
    """Return the advice with its times on a page to print, which needs no network; `note` is a sentence at its foot."""
    scenario, groups = run.scenario, words.instruction_groups(run.advice)
    starts = [clock(run.phases[group[0]].start_s) for group in groups]
    texts = [text[0].upper() + text[1:] for text in words.advice_in_words(run.advice)]
    stops = stop_times(run)
    borders, limits = limits_of(scenario)
    top = max(float(np.max(limits)), run.max_speed_kmh)

    def points(places: FloatArray, speeds: FloatArray) -> str:
        x, y = WIDTH * places / run.distance_m, HEIGHT * (1 - speeds / top)
        return " ".join(f"{one:.1f},{other:.1f}" for one, other in zip(x, y, strict=True))

    rows = max(len(texts) if len(texts) <= COLUMN_LINES else (len(texts) + 1) // 2, len(stops))
    return template("driver_card").render(
        title=words.title(scenario.title),
        train=words.subtitle(run.distance_m, scenario.vehicle),
        departure=clock(0.0),
        arrival=clock(run.travel_time_s),
        instructions=list(zip(starts, texts, strict=True)),
        stops=stops,
        speed=points(run.position_m, run.speed_ms / MS_PER_KMH),
        limit=points(*as_steps(borders, limits)),
        distance=words.distance(run.distance_m),
        top=words.number(top, 0),
        note=note,
        size=f"{min(LARGEST_PX, max(SMALLEST_PX, PAGE_PX / (1.85 * rows + 11))):.1f}",
    )
