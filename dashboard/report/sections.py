"""The sections of a report, each made from the findings alone; a new one is a function and a line in `document.py`."""

import html
import importlib.metadata
import platform
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from railjoule.core import Trajectory
from railjoule.core.scenario import format_scenario
from railjoule.core.simulate.disturbances import DisturbedRun
from railjoule.core.simulate.field_oriented import FieldOrientedRun
from railjoule.core.studies.sensitivity import SensitivityTable
from railjoule.core.units import J_PER_KWH
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.report.figures import Figures, Plot
from railjoule.dashboard.report.tables import scenario_tables
from railjoule.dashboard.store.report import Findings
from railjoule.dashboard.views import parts
from railjoule.dashboard.views.motor import held_words, parts_table, run_figures

PACKAGES = ("railjoule", "numpy", "scipy", "numba", "bokeh")
FRONTIER_ROWS = 10
NOT_PROVEN = (
    "The bound does not say that the data of vehicle and line are right, nor how much a finer mesh would gain; it is "
    "computed in ordinary floating-point numbers."
)


def section(name: str, title: str, content: str) -> str:
    """Return a section under its heading; nothing without content."""
    return f'<section id="{name}" aria-labelledby="{name}-title"><h2 id="{name}-title">{title}</h2>{content}</section>'


def figure_element(plot: Plot) -> str:
    """Return the place of a figure, and that of its copy on paper."""
    caption = f'<p class="paper-caption">{plot.caption}</p>' if plot.caption else ""
    return (
        f'<figure class="plot" data-plot="{plot.name}" style="min-height:{plot.height}px">'
        f'<div class="live" id="{plot.place}"></div>'
        f'<div class="paper" aria-hidden="true">{caption}<canvas></canvas></div></figure>'
    )


# ---- result


def result(findings: Findings, figures: Figures) -> str:
    """Return the numbers of the first run, the slider of the travel time, the driver's advice and the figures."""
    run = findings.run
    note = f'<p class="message">{html.escape(findings.note)}</p>' if findings.note else ""
    content = (
        f'{note}<p id="shown" role="status">{shown_words(run)}</p>{slider(findings)}'
        f'<div id="numbers">{numbers(findings, run)}</div><div id="advice">{parts.advice(run, stale=False)}</div>'
    )
    plots = "".join(figure_element(plot) for plot in figures.plots("runs"))
    hint = (
        '<p class="note screen">Drag to zoom in, double click to see all; Ctrl and the wheel zoom as well. '
        "The mouse writes values into the captions.</p>"
    )
    return section("result", "Result", f"{content}{plots}{hint}")


def shown_words(run: Trajectory) -> str:
    """Return whose numbers are shown."""
    other = comparisons.other_time_of(run)
    return f"{words.strategy(run.strategy)}, {words.time(run.travel_time_s)} s{f', {other}' if other else ''}"


def numbers(findings: Findings, run: Trajectory) -> str:
    """Return the row of numbers of a run; an optimum over another time brings its own price of a second."""
    runs = findings.runs
    if run.strategy == "optimal":
        runs = replace(runs, runs={"optimal": run})
    return parts.run_figures(runs, run, None, stale=False)


def slider(findings: Findings) -> str:
    """Return the slider over the optima; without optima there is none."""
    optima = findings.optima
    if len(optima) < 2:
        return ""
    own = own_index(findings)
    return (
        '<div class="slider screen"><label for="time">Travel time of the optimum, s</label>'
        f'<input id="time" type="range" min="0" max="{len(optima) - 1}" step="1" value="{own}" '
        f'aria-valuetext="{words.time(optima[own].travel_time_s)} s">'
        f'<output for="time">{words.time(optima[own].travel_time_s)} s</output>'
        '<button type="button" id="back">Back to the timetable</button></div>'
    )


def own_index(findings: Findings) -> int:
    """Return which optimum is that of the timetable."""
    times = np.array([run.travel_time_s for run in findings.optima])
    return int(np.argmin(np.abs(times - findings.scenario.travel_time_s)))


# ---- where the energy goes, runs, phases


def energy(findings: Findings, figures: Figures) -> str:
    """Return the energy account, all runs and the phases."""
    run = findings.run
    blocks = (
        f'<div id="account">{parts.account(run)}</div>',
        parts.runs_table(findings.runs, run.strategy, ()),
        f'<div id="phases">{parts.phase_table(run)}</div>',
    )
    return section("energy", "Energy, runs and phases", f'<div class="columns">{"".join(blocks)}</div>')


def trade_off(findings: Findings, figures: Figures) -> str:
    """Return the energy-time frontier as figure and table."""
    optima = findings.optima
    if len(optima) < 2:
        reason = findings.runs.refused.get("optimal", "there is no optimum over other times")
        return section("trade-off", "Energy and time", f'<p class="note">No frontier: {html.escape(reason)}</p>')
    chosen = np.unique(np.append(np.linspace(0, len(optima) - 1, FRONTIER_ROWS).astype(int), own_index(findings)))
    rows = [
        (
            (
                words.time(run.travel_time_s),
                words.energy(run.energy_kwh),
                words.UNKNOWN if run.price_of_time_w is None else words.price(run.price_of_time_w),
                words.number(run.max_speed_kmh),
                comparisons.cell(comparisons.above_own_bound(run)),
            ),
            k == own_index(findings),
        )
        for k, run in ((int(k), optima[k]) for k in chosen)
    ]
    head = ("Travel time, s", "kWh", "per extra second, Wh/s", "top, km/h", "above the bound, %")
    plots = "".join(figure_element(plot) for plot in figures.plots("frontier"))
    cells = int(np.count_nonzero(np.diff(optima[0].position_m)))
    note = f'<p class="note">{len(optima)} optima over a mesh of {words.number(cells, 0)} cells.</p>'
    table = parts.table("Optima", head, rows)
    return section("trade-off", "Energy and time", f"{plots}{table}{note}{surface_element(figures, 'enoc')}")


def surface_element(figures: Figures, name: str) -> str:
    """Return the place of a surface; nothing where there is none."""
    surface = figures.surfaces.get(name)
    return "" if surface is None else surface.element


# ---- what is proven, who refused


def proof(findings: Findings, figures: Figures) -> str:
    """Return the certificate in words, the notes of all strategies and who refused."""
    sentences = certificate(findings)
    notes = [(words.STRATEGY_WORDS[name], note) for name, run in findings.runs.runs.items() for note in run.notes]
    certified = "".join(f"<p>{html.escape(sentence)}</p>" for sentence in sentences)
    listed = "".join(f"<li>{html.escape(about(name, note))}</li>" for name, note in notes)
    told = f'<h3>Notes of the strategies</h3><ul class="notes">{listed}</ul>' if listed else ""
    refusals = "".join(
        f"<li>{html.escape(about(words.STRATEGY_WORDS[name], reason))}</li>"
        for name, reason in findings.runs.refused.items()
    )
    refused = f'<h3>Strategies that refused</h3><ul class="notes">{refusals}</ul>' if refusals else ""
    return section("proof", "What is proven", f'<div class="prose">{certified}{told}{refused}</div>')


def about(name: str, sentence: str) -> str:
    """Return a sentence that names its strategy."""
    return sentence if sentence.startswith(name) else f"{name}: {sentence}"


def certificate(findings: Findings) -> list[str]:
    """Return in sentences what is proven of the optimum and of the run that is shown."""
    best, run = findings.runs.best_known, findings.run
    above = comparisons.above_own_bound(best)
    if best.bound is None or above is None or best.lower_bound_kwh is None:
        return ["No lower bound of the energy is known for this timetable, so nothing is proven."]
    energy_words, bound_words = words.energy(best.energy_kwh), words.energy(best.lower_bound_kwh)
    if best.is_proven:
        first = (
            f"The optimum needs {energy_words} kWh, and it is proven: no run that the bound covers uses less "
            "energy, up to one part in a million."
        )
    else:
        first = (
            f"The best known run needs {energy_words} kWh. A bound of {bound_words} kWh is proven, so it is at most "
            f"{above.size} {above.unit} above the least energy of the runs that the bound covers."
        )
    sentences = [first, f"What the bound covers: {best.bound.statement}", NOT_PROVEN]
    more = comparisons.above_reference(run)
    if run is not best and run.reference is not None and more is not None:
        needed = f"{words.strategy(run.strategy)} needs {words.energy(run.energy_kwh)} kWh"
        known = comparisons.reference_words(run.reference, run.scenario.travel_time_s)
        sentences.insert(1, f"{needed}, {more.sentence} the {known}.")
    return sentences


# ---- what becomes of the plan


def reality(findings: Findings, figures: Figures) -> str:
    """Return what becomes of the plan under the scenario's disturbance, or in closed loop."""
    found = findings.reality
    in_closed_loop = findings.scenario.simulation.kind == "field_oriented"
    title = "In closed loop" if in_closed_loop else "Under the disturbance"
    if found is None:
        refusal = findings.reality_refusal
        return section("reality", title, f'<p class="note">{html.escape(refusal)}</p>') if refusal else ""
    rows = [
        (
            (
                word,
                words.energy(run.energy_kwh),
                words.time(run.travel_time_s),
                words.number(run.max_speed_kmh),
                words.energy(run.energy.recuperated_j / J_PER_KWH),
            ),
            False,
        )
        for word, run in (("Planned", found.planned), ("Driven", found.actual))
    ]
    more = comparisons.above(found.actual.energy_kwh, found.planned.energy_kwh)
    late, error = words.delay(found.delay_s), words.stop_error(found.stop_error_m)
    text = f"{more} energy, {late} s, stopping error {error} m."
    events = ""
    if isinstance(found, DisturbedRun):
        learned = [
            f"At {words.number(place, 0)} m, after {words.time(time)} s: {notice}."
            for place, time, notice in found.notices
        ]
        events = "".join(f"<li>{html.escape(sentence)}</li>" for sentence in [*learned, *found.notes])
        events = f'<ul class="notes">{events}</ul>' if events else ""
    if isinstance(found, FieldOrientedRun):
        notes = "".join(f"<li>{html.escape(sentence)}</li>" for sentence in found.notes)
        numbers = parts.figures(run_figures(found), stale=False)
        events = f'{numbers}{held_words(found)}<ul class="notes">{notes}</ul>{parts_table(found)}'
    plots = "".join(figure_element(plot) for plot in figures.plots("reality"))
    runs = parts.table("Planned and actual", ("Run", "kWh", "s", "km/h", "recuperated, kWh"), rows)
    return section("reality", title, f"<p>{text}</p>{events}{plots}{runs}")


def robustness(findings: Findings, figures: Figures) -> str:
    """Return what a wrong load and a wrong place cost."""
    title = "What a wrong load and a position error cost"
    if findings.table is None:
        return section("robustness", title, f'<p class="note">{html.escape(findings.table_refusal)}</p>')
    return section("robustness", title, sensitivity_table(findings.table) + surface_element(figures, "costs"))


def sensitivity_table(found: SensitivityTable) -> str:
    """Return the overconsumption over load and position error."""
    head = ("Load, %", *(f"{words.signed(error, 0)} m" for error in found.coordinate_errors_m))
    rows = [
        (
            (
                words.setting(load),
                *(words.share_difference(share) for share in shares),
            ),
            False,
        )
        for load, shares in zip(found.load_factors, found.overconsumption, strict=True)
    ]
    ways = "in both directions" if found.both_directions else "in one direction"
    load = words.setting(found.scenario.vehicle.load_factor)
    note = (
        f'<p class="note">The plan for a load of {load} % is followed {ways} with another load, by a train that '
        f"assumes to be farther on by the error; planned: {words.energy(found.planned_kwh)} kWh. "
        "Energy against the plan, %.</p>"
    )
    return f"{parts.table('Overconsumption, %, over load and position error', head, rows)}{note}"


# ---- scenario, file


def scenario(findings: Findings, figures: Figures) -> str:
    """Return the scenario as tables."""
    content = f'<div class="columns narrow">{scenario_tables(findings.scenario)}</div>'
    return section("scenario-tables", "Scenario", content)


def about_file(findings: Findings, figures: Figures) -> str:
    """Return versions, how to load the file again, and the scenario's TOML."""
    text = (
        "This file works offline. railjoule opens it instead of the scenario's file, as the scenario below is "
        "part of it; saved as scenario.toml it gives the same numbers on the command line: "
        "<code>railjoule compare scenario.toml</code>."
    )
    toml = html.escape(format_scenario(findings.scenario))
    pre = f'<details><summary>The scenario as TOML</summary><pre tabindex="0">{toml}</pre></details>'
    return section("file", "About this file", f'<p class="prose">{text}</p>{versions_table()}{pre}')


def versions_table() -> str:
    """Return the versions of what made the report."""
    versions: Sequence[tuple[str, str]] = [
        *((name, importlib.metadata.version(name)) for name in PACKAGES),
        ("Python", platform.python_version()),
    ]
    return parts.table("Versions", tuple(name for name, _ in versions), [([version for _, version in versions], False)])
