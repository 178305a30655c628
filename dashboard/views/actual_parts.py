"""What Drive tells of the actual run: its numbers, and where its extra energy comes from."""

from collections.abc import Sequence

from railjoule.core import Trajectory
from railjoule.core.scenario import Scenario
from railjoule.core.simulate.actual_run import ActualRun, Cause
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.store import Runs, same_plan
from railjoule.dashboard.views.parts import figure, figures, price_figure

EQUAL = "The actual run equals the plan. Change load, position or add a stop."
LEAST_STOP_ERROR_M = 0.05
SAME_ENERGY = 1e-9
"""Relatively: two ways to solve for the same plan."""


def belongs_to(actual: ActualRun, run: Trajectory) -> bool:
    """Return whether an actual run is that of the scenario and the strategy of a run."""
    return actual.planned.strategy == run.strategy and same_plan(actual.scenario, run.scenario)


def is_same_plan(actual: ActualRun, run: Trajectory) -> bool:
    """Return whether an actual run starts from this run of Drive."""
    return abs(actual.planned.energy.net_j - run.energy.net_j) <= SAME_ENERGY * abs(run.energy.net_j)


def cause_words(cause: Cause, scenario: Scenario) -> str:
    """Return what a cause is called: which way the load differs, how many stops there are."""
    disturbance = scenario.disturbance
    if cause.name == "load" and disturbance.actual_load_factor is not None:
        heavier = disturbance.actual_load_factor > scenario.vehicle.load_factor
        return "Heavier than planned" if heavier else "Lighter than planned"
    if cause.name == "stops" and len(disturbance.stops) == 1:
        return "Unplanned stop"
    return words.CAUSE_WORDS[cause.name]


def actual_figures(actual: ActualRun, runs: Runs, run: Trajectory) -> str:
    """Return the numbers of Drive while an actual run stands beside the plan."""
    largest = actual.largest_cause
    cause = figure("Largest cause", words.UNKNOWN, "", "none", kind="cause")
    if largest is not None:
        told = cause_words(largest, actual.scenario)
        added = words.energy_difference(largest.energy_kwh)
        cause = figure("Largest cause", added, "kWh", told[0].lower() + told[1:], kind="cause")
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
    label = "Actual run saves" if actual.extra_kwh < 0 and actual.causes else "Actual run costs"
    amount = comparisons.above(driven, planned)
    more = f'<b class="over">{amount}</b>' if amount.unit == "%" else ""
    detail = f"{words.energy(driven)} kWh against {words.energy(planned)} planned" if actual.causes else EQUAL
    return figure(
        label, words.energy_difference(actual.extra_kwh), f"kWh {more}", detail, kind="main", term="Actual run costs"
    )


def _planned(actual: ActualRun, run: Trajectory) -> str:
    energy = words.energy(actual.planned.energy_kwh)
    if not is_same_plan(actual, run):
        amount = comparisons.above(actual.planned.energy_kwh, run.energy_kwh)
        detail = f"keeps to the target braking curve: {amount}"
        whole = f"{amount.sentence} the run without it, {words.energy(run.energy_kwh)} kWh"
        return figure("Planned run", energy, "kWh", detail, whole=whole)
    if run.is_proven and comparisons.is_reference(run):
        return figure("Planned run", energy, "kWh", '<span class="proven">\u2713 proven optimum</span>')
    return figure("Planned run", energy, "kWh", words.strategy(run.strategy))


def late_words(actual: ActualRun) -> str:
    """Return how late a run arrives, and how far from its place it stands, as HTML."""
    late, error = actual.delay_s, actual.stop_error_m
    if abs(late) < comparisons.OTHER_TIME_S:
        told = "on time"
    elif late < 0:
        told = f"{words.time(-late)} s early"
    else:
        told = f'<span class="open">{words.time(late)} s late</span>'
    if abs(error) >= LEAST_STOP_ERROR_M:
        side = "beyond the stop" if error > 0 else "short of the stop"
        told += f', <span class="open">{words.number(abs(error))} m {side}</span>'
    return told


def causes_block(actual: ActualRun) -> str:
    """Return where the extra energy comes from, as bars that follow one another and sum to the whole."""
    if not actual.causes:
        return f'<div class="block causes"><h2>Where the extra energy comes from</h2><p class="note">{EQUAL}</p></div>'
    energies = [cause.energy_kwh for cause in actual.causes]
    ends = _running(energies)
    low, high = min(0.0, *ends), max(0.0, *ends)
    scale = max(high - low, 1e-9)

    def bar(name: str, start: float, length: float, colour: str, strong: bool = False) -> str:
        left, width = 100 * (min(start, start + length) - low) / scale, 100 * abs(length) / scale
        told = f"{words.energy_difference(length)} kWh"
        return (
            f"<span>{f'<b>{name}</b>' if strong else name}</span>"
            f'<span class="track"><i style="left:{left:.2f}%;width:{max(width, 0.3):.2f}%;'
            f'background:{colour}"></i></span>'
            f'<span class="amount">{f"<b>{told}</b>" if strong else told}</span>'
        )

    rows = [
        bar(cause_words(cause, actual.scenario), start, cause.energy_kwh, "var(--rj-costbar)")
        for cause, start in zip(actual.causes, [0.0, *ends], strict=False)
    ]
    rows.append(bar("Together", 0.0, ends[-1], "var(--rj-pinned)", strong=True))
    title = f"Where the extra {words.energy(abs(actual.extra_kwh))} kWh comes from"
    if actual.extra_kwh < 0:
        title = f"Where the saved {words.energy(abs(actual.extra_kwh))} kWh comes from"
    notes = "".join(f'<p class="note">{note}</p>' for note in actual.notes)
    order = '<p class="note">Each cause is added to those above it.</p>' if len(energies) > 1 else ""
    return f'<div class="block causes"><h2>{title}</h2><div class="flow">{"".join(rows)}</div>{order}{notes}</div>'


def _running(energies: Sequence[float]) -> list[float]:
    ends, total = [], 0.0
    for energy in energies:
        total += energy
        ends.append(total)
    return ends
