"""The sections of a report, each made from the findings alone; a new one is a function and a line in `document.py`."""

import importlib.metadata
import platform
from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from railjoule.core import Trajectory
from railjoule.core.scenario import format_scenario
from railjoule.core.simulation.disturbances import DisturbedRun
from railjoule.core.simulation.field_oriented import FieldOrientedRun
from railjoule.core.studies.table import StudyTable
from railjoule.core.trajectory import MEASURED
from railjoule.core.units import J_PER_KWH
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.look.markup import Markup, joined, markup
from railjoule.dashboard.pages.motor.texts import held_words, parts_table, run_figures
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.report.figures import Figures, Plot
from railjoule.dashboard.report.findings import Findings
from railjoule.dashboard.report.section_names import SECTION_TITLES
from railjoule.dashboard.report.tables import scenario_tables

PACKAGES = ("railjoule", "numpy", "scipy", "numba", "bokeh")
FRONTIER_ROWS = 10
NOT_PROVEN = (
    "The bound does not say that the data of vehicle and line are right; it is computed in ordinary floating-point "
    "numbers."
)
OF_MEASURED = (
    "A measured run has the speeds of a train\u2019s recorder, and its efforts and powers where the recorder has them; "
    "what it lacks is the scenario\u2019s model at these speeds. All others are computed by the model alone."
)
HINT = Markup(
    '<p class="note screen">Drag to zoom in, double click to see all; Ctrl and the wheel zoom as well. '
    "The mouse writes values into the captions.</p>"
)
ABOUT = Markup(
    '<p class="prose">This file works offline. railjoule opens it instead of the scenario\u2019s file, as the scenario '
    "below is part of it; saved as scenario.toml it gives the same numbers on the command line: "
    "<code>railjoule compare scenario.toml</code>.</p>"
)


def section(name: str, title: str, *content: str) -> Markup:
    """Return a section under its heading."""
    return markup(
        '<section id="{name}" aria-labelledby="{name}-title"><h2 id="{name}-title">{title}</h2>{content}</section>',
        name=name,
        title=title,
        content=joined(content),
    )


def figure_element(plot: Plot) -> Markup:
    """Return the place of a figure, and that of its copy on paper."""
    return markup(
        '<figure class="plot" data-plot="{}" style="min-height:{}px"><div class="live" id="{}"></div>'
        '<div class="paper" aria-hidden="true">{}<canvas></canvas></div></figure>',
        plot.name,
        plot.height,
        plot.place,
        markup('<p class="paper-caption">{}</p>', plot.caption) if plot.caption else "",
    )


def plots(figures: Figures, group: str) -> Markup:
    """Return the places of the figures of a group."""
    return joined(map(figure_element, figures.plots(group)))


def listed(sentences: Iterable[str]) -> Markup:
    """Return sentences as a list; nothing without any."""
    items = joined(markup("<li>{}</li>", sentence) for sentence in sentences)
    return markup('<ul class="notes">{}</ul>', items) if items else items


def note(sentence: str) -> Markup:
    """Return a sentence in small letters."""
    return parts.note_paragraphs([sentence])


# ---- before all others


def foreword(findings: Findings) -> Markup:
    """Return the author's note, and what a reader must know of the page that the report comes from."""
    paragraphs = joined(markup("<p>{}</p>", paragraph) for paragraph in findings.contents.paragraphs)
    told = markup('<p class="message">{}</p>', findings.note) if findings.note else Markup()
    if not paragraphs:
        return told
    return told + section("note", "Note by the author", markup('<div class="prose author">{}</div>', paragraphs))


# ---- result


def result(findings: Findings, figures: Figures) -> Markup:
    """Return the numbers of the first run, the slider of the travel time, the driver's advice and the figures."""
    run = findings.run
    return section(
        "result",
        SECTION_TITLES["result"],
        markup('<p id="shown" role="status">{}</p>', shown_words(run)),
        slider(findings),
        markup('<div id="numbers">{}</div>', numbers(findings, run)),
        markup('<div id="advice">{}</div>', parts.advice(run, stale=False)),
        plots(figures, "runs"),
        HINT,
    )


def shown_words(run: Trajectory) -> str:
    """Return whose numbers are shown."""
    other = comparisons.other_time_of(run)
    return f"{words.strategy(run.strategy)}, {words.time(run.travel_time_s)} s{f', {other}' if other else ''}"


def numbers(findings: Findings, run: Trajectory) -> Markup:
    """Return the row of numbers of a run; an optimum over another time brings its own price of a second."""
    runs = findings.runs
    if run.strategy == "optimal":
        runs = replace(runs, runs={"optimal": run})
    return parts.run_figures(runs, run, None, stale=False)


def slider(findings: Findings) -> Markup:
    """Return the slider over the optima; without optima there is none."""
    optima = findings.optima
    if len(optima) < 2:
        return Markup()
    own = own_index(findings)
    return markup(
        '<div class="slider screen"><label for="time">Travel time of the optimum, s</label>'
        '<input id="time" type="range" min="0" max="{last}" step="1" value="{own}" aria-valuetext="{time} s">'
        '<output for="time">{time} s</output>'
        '<button type="button" id="back">Back to the timetable</button></div>',
        last=len(optima) - 1,
        own=own,
        time=words.time(optima[own].travel_time_s),
    )


def own_index(findings: Findings) -> int:
    """Return which optimum is that of the timetable."""
    times = np.array([run.travel_time_s for run in findings.optima])
    # the nearest: an optimum that gains nothing by waiting takes less time than it is allowed
    return int(np.argmin(np.abs(times - findings.scenario.travel_time_s)))


# ---- where the energy goes, runs, phases


def energy(findings: Findings, figures: Figures) -> Markup:
    """Return the energy account, all runs and the phases."""
    run = findings.run
    columns = markup(
        '<div class="columns"><div id="account">{}</div>{}<div id="phases">{}</div></div>',
        parts.account(run),
        parts.runs_table(findings.runs, run.strategy, ()),
        parts.phase_table(run),
    )
    return section("energy", SECTION_TITLES["energy"], columns)


def pinned(findings: Findings, figures: Figures) -> Markup:
    """Return the runs that were pinned on the page, measured ones among them, beside the first run."""
    run = findings.run
    if not findings.pinned:
        return Markup()
    rows = [
        ((name, *_pinned_cells(one, run)), one is run)
        for name, one in ((words.strategy(run.strategy), run), *findings.pinned)
    ]
    head = ("Run", "kWh", "kWh more", "%", "s", "km/h", "m")
    measured = any(one.strategy == MEASURED for _, one in findings.pinned)
    return section(
        "pinned",
        SECTION_TITLES["pinned"],
        parts.table("Pinned runs beside the first run", head, rows),
        note(OF_MEASURED) if measured else "",
    )


def _pinned_cells(run: Trajectory, first: Trajectory) -> tuple[str, ...]:
    return (
        words.energy(run.energy_kwh),
        words.energy_difference(run.energy_kwh - first.energy_kwh),
        comparisons.beside(run, first),
        words.time(run.travel_time_s),
        words.number(run.max_speed_kmh),
        words.number(run.distance_m, 0),
    )


def trade_off(findings: Findings, figures: Figures) -> Markup:
    """Return the energy-time frontier as figure and table."""
    optima = findings.optima
    if len(optima) < 2:
        reason = findings.runs.refused.get("optimal", "there is no optimum over other times")
        return section("trade-off", SECTION_TITLES["trade-off"], note(f"No frontier: {reason}"))
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
    cells = [len(run.nodes_m) - 1 for run in optima]
    return section(
        "trade-off",
        SECTION_TITLES["trade-off"],
        plots(figures, "frontier"),
        parts.table("Optima", head, rows),
        note(f"{len(optima)} optima over {words.number(min(cells), 0)} to {words.number(max(cells), 0)} cells."),
        surface_element(figures, "enoc"),
    )


def surface_element(figures: Figures, name: str) -> Markup:
    """Return the place of a surface; nothing where there is none."""
    surface = figures.surfaces.get(name)
    return Markup() if surface is None else surface.element


# ---- what is proven, who refused


def proof(findings: Findings, figures: Figures) -> Markup:
    """Return the bound in words, the notes of all strategies and the refusals."""
    names, runs = words.STRATEGY_WORDS, findings.runs
    proven = joined(markup("<p>{}</p>", sentence) for sentence in bound_sentences(findings))
    notes = listed(words.about(names[name], note) for name, run in runs.runs.items() for note in run.all_notes)
    refusals = listed(words.about(names[name], reason) for name, reason in runs.refused.items())
    told = markup("<h3>Notes of the strategies</h3>{}", notes) if notes else ""
    refused = markup("<h3>Strategies that refused</h3>{}", refusals) if refusals else ""
    return section("proof", SECTION_TITLES["proof"], markup('<div class="prose">{}{}{}</div>', proven, told, refused))


def bound_sentences(findings: Findings) -> list[str]:
    """Return in sentences what is proven of the optimum and of the run that is shown."""
    best, run = findings.runs.best_known, findings.run
    above = comparisons.above_own_bound(best)
    if best.bound is None or above is None or best.lower_bound_kwh is None:
        return ["No lower bound of the energy is known for this timetable, so nothing is proven."]
    energy_words, bound_words = words.energy(best.energy_kwh), words.energy(best.lower_bound_kwh)
    if best.is_proven:
        first = (
            f"The optimum needs {energy_words} kWh, and it is proven: it lies {above.sentence} a lower bound. Runs up "
            f"to {words.share(best.scenario.solver.tolerance)} % above count as the optimum."
        )
    else:
        first = (
            f"The best known run needs {energy_words} kWh. A bound of {bound_words} kWh is proven, so it is at most "
            f"{above.size} {above.unit} above the least energy of the runs that the bound covers."
        )
    sentences = [first, best.bound.statement, NOT_PROVEN]
    more = comparisons.above_reference(run)
    if run is not best and run.reference is not None and more is not None:
        needs = f"{words.strategy(run.strategy)} needs {words.energy(run.energy_kwh)} kWh"
        needed = ", is ".join(filter(None, [needs, comparisons.late_of(run)]))
        known = comparisons.reference_words(run.reference, run.scenario.travel_time_s)
        sentences.insert(1, f"{needed}, {more.sentence} the {known}.")
    return sentences


# ---- what becomes of the plan


def reality(findings: Findings, figures: Figures) -> Markup:
    """Return what becomes of the plan under the scenario's disturbance, or in closed loop."""
    found = findings.reality
    in_closed_loop = findings.scenario.simulation.kind == "field_oriented"
    title = "In closed loop" if in_closed_loop else "Under the disturbance"
    if found is None:
        refusal = findings.reality_refusal
        return section("reality", title, note(refusal)) if refusal else Markup()
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
    energies = found.actual.energy_kwh, found.planned.energy_kwh
    events = Markup()
    if isinstance(found, DisturbedRun):
        events = listed([*(words.notice(*told) for told in found.notices), *found.notes])
    if isinstance(found, FieldOrientedRun):
        numbers = parts.figures(run_figures(found), stale=False)
        events = joined([numbers, held_words(found), listed(found.notes), parts_table(found)])
    return section(
        "reality",
        title,
        markup("<p>{}</p>", comparisons.outcome(*energies, found.delay_s, found.stop_error_m)),
        events,
        plots(figures, "reality"),
        parts.table("Planned and actual", ("Run", "kWh", "s", "km/h", "recuperated, kWh"), rows),
    )


def robustness(findings: Findings, figures: Figures) -> Markup:
    """Return what a wrong load and a wrong place cost."""
    title = SECTION_TITLES["robustness"]
    if findings.table is None:
        return section("robustness", title, note(findings.table_refusal))
    return section("robustness", title, sensitivity_table(findings.table), surface_element(figures, "costs"))


def sensitivity_table(found: StudyTable) -> Markup:
    """Return the overconsumption over load and position error."""
    head = ("Load, %", *(f"{words.signed(error, 0)} m" for error in found.coordinate_error_m))
    rows = [
        (
            (
                words.setting(load),
                *(
                    comparisons.extra_cell(float(energy), found.planned_energy_kwh, float(delay), float(error))
                    for energy, delay, error in zip(*results, strict=True)
                ),
            ),
            False,
        )
        for load, *results in zip(found.load_factor, found.energy_kwh, found.delay_s, found.stop_error_m, strict=True)
    ]
    ways = "in both directions" if found.both_directions else "in one direction"
    load = words.setting(found.scenario.vehicle.load_factor)
    told = (
        f"The plan for a load of {load} % is followed {ways} with another load, by a train that assumes to be farther "
        f"on by the error; planned: {words.energy(found.planned_energy_kwh)} kWh. Energy against the plan, %."
    )
    table = parts.table("Overconsumption, %, over load and position error", head, rows)
    return joined([table, note(told), note(comparisons.MISSED)])


# ---- scenario, file


def scenario(findings: Findings, figures: Figures) -> Markup:
    """Return the scenario as tables."""
    tables = markup('<div class="columns narrow">{}</div>', scenario_tables(findings.scenario))
    return section("scenario-tables", SECTION_TITLES["scenario"], tables)


def about_file(findings: Findings, figures: Figures) -> Markup:
    """Return versions, how to load the file again, and the scenario's TOML."""
    toml = markup(
        '<details><summary>The scenario as TOML</summary><pre tabindex="0">{}</pre></details>',
        format_scenario(findings.scenario),
    )
    return section("file", SECTION_TITLES["file"], ABOUT, versions_table(), toml)


def versions_table() -> Markup:
    """Return the versions of what made the report."""
    versions: Sequence[tuple[str, str]] = [
        *((name, importlib.metadata.version(name)) for name in PACKAGES),
        ("Python", platform.python_version()),
    ]
    return parts.table("Versions", tuple(name for name, _ in versions), [([version for _, version in versions], False)])
