"""The sections of a report as data: titles, figures, tables and texts, which assets/templates/report.html writes."""

import shlex
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from railjoule.core import Trajectory
from railjoule.core.scenario import format_scenario
from railjoule.core.simulation.disturbances import DisturbedRun
from railjoule.core.simulation.field_oriented import FieldOrientedRun
from railjoule.core.studies.table import StudyTable
from railjoule.core.trajectory import MEASURED
from railjoule.core.units import J_PER_KWH
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.look.markup import escaped
from railjoule.dashboard.pages.motor.texts import held_words, parts_table, run_figures
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.provenance import versions
from railjoule.dashboard.report.contents import Contents
from railjoule.dashboard.report.figures import Figures
from railjoule.dashboard.report.findings import Findings
from railjoule.dashboard.report.section_names import SECTION_TITLES
from railjoule.dashboard.report.surface import enoc_surface
from railjoule.dashboard.report.tables import scenario_tables

FRONTIER_ROWS = 10
NOT_PROVEN = (
    "The bound does not say that the data of vehicle and line are right; it is computed in ordinary floating-point "
    "numbers."
)
OF_MEASURED = (
    "A measured run has the speeds of a train\u2019s recorder, and its efforts and powers where the recorder has them; "
    "what it lacks is the scenario\u2019s model at these speeds. All others are computed by the model alone."
)


class Piece(NamedTuple):
    """A part of a section: its kind is the name of a macro of the template, its value what the macro writes."""

    kind: str
    value: Any


class Section(NamedTuple):
    """A section under its title."""

    name: str
    title: str
    pieces: list[Piece]


def sections(findings: Findings, figures: Figures) -> list[Section]:
    """Return the chosen sections that have contents, in the report's order."""
    paragraphs = findings.contents.paragraphs
    note = [Section("note", "Note by the author", [Piece("author", paragraphs)])] if paragraphs else []
    chosen = (name for name in SECTION_TITLES if findings.contents.has(name))
    # the embedded scenario has the id that the section of this name would have
    ids = {"scenario": "scenario-tables"}
    made = [Section(ids.get(name, name), _title(name, findings), MAKERS[name](findings, figures)) for name in chosen]
    return note + [section for section in made if section.pieces]


def _title(name: str, findings: Findings) -> str:
    if name != "reality":
        return SECTION_TITLES[name]
    return "In closed loop" if findings.scenario.simulation.kind == "field_oriented" else "Under the disturbance"


def run_texts(findings: Findings, run: Trajectory) -> dict[str, str]:
    """Return the texts of a run by the ids of their places; the slider writes those of other optima there."""
    other, runs = comparisons.other_time_of(run), findings.runs
    # an optimum over another time has a marginal energy of its own
    if run.strategy == "optimal":
        runs = replace(runs, runs={"optimal": run})
    return {
        "shown": escaped(
            f"{words.strategy(run.strategy)}, {words.time(run.travel_time_s)} s{f', {other}' if other else ''}"
        ),
        "numbers": parts.run_figures(runs, run, None, stale=False),
        "advice": parts.advice(run, stale=False),
        "account": parts.account(run),
        "phases": parts.phase_table(run),
    }


def _result(findings: Findings, figures: Figures) -> list[Piece]:
    optima, slider = findings.optima, None
    if len(optima) > 1:
        slider = {
            "last": len(optima) - 1,
            "own": findings.own,
            "time": words.time(optima[findings.own].travel_time_s),
        }
    texts = run_texts(findings, findings.run)
    return [
        Piece("lead", {**texts, "slider": slider}),
        Piece("figures", figures.places("result")),
        Piece("hint", None),
    ]


def _energy(findings: Findings, figures: Figures) -> list[Piece]:
    run = findings.run
    return [Piece("energy", {**run_texts(findings, run), "runs": parts.runs_table(findings.runs, run.strategy, ())})]


def _pinned(findings: Findings, figures: Figures) -> list[Piece]:
    """Return the runs that were pinned on the page, measured ones among them, beside the first run."""
    first = findings.run
    if not findings.pinned:
        return []
    rows = [
        (
            (
                name,
                words.energy(run.energy_kwh),
                words.energy_difference(run.energy_kwh - first.energy_kwh),
                comparisons.beside(run, first),
                words.time(run.travel_time_s),
                words.number(run.max_speed_kmh),
                words.number(run.distance_m, 0),
            ),
            run is first,
        )
        for name, run in ((words.strategy(first.strategy), first), *findings.pinned)
    ]
    head = ("Run", "kWh", "kWh more", "%", "s", "km/h", "m")
    measured = any(run.strategy == MEASURED for _, run in findings.pinned)
    return [_table("Pinned runs beside the first run", head, rows), *([_note(OF_MEASURED)] if measured else [])]


def _trade_off(findings: Findings, figures: Figures) -> list[Piece]:
    optima = findings.optima
    if len(optima) < 2:
        reason = findings.runs.refused.get("optimal", "there is no optimum over other times")
        return [_note(f"No frontier: {reason}")]
    rows = [
        (
            (
                words.time(run.travel_time_s),
                words.energy(run.energy_kwh),
                words.UNKNOWN if run.price_of_time_w is None else words.price(run.price_of_time_w),
                words.number(run.max_speed_kmh),
                comparisons.cell(comparisons.above_own_bound(run)),
            ),
            k == findings.own,
        )
        for k, run in enumerate(optima)
        if k in {findings.own, *np.linspace(0, len(optima) - 1, FRONTIER_ROWS).astype(int)}
    ]
    head = ("Travel time, s", "kWh", "per extra second, Wh/s", "top, km/h", "above the bound, %")
    cells = [len(run.nodes_m) - 1 for run in optima]
    return [
        Piece("figures", figures.places("trade-off")),
        _table("Optima", head, rows),
        _note(f"{len(optima)} optima over {words.number(min(cells), 0)} to {words.number(max(cells), 0)} cells."),
        *([Piece("surface", surface)] if (surface := surface_data(findings)) else []),
    ]


def surface_data(findings: Findings) -> dict[str, Any] | None:
    """Return the surface of ENOC's energy; None where ENOC does not accept the scenario."""
    found = findings.enoc_map
    return None if found is None else enoc_surface(found, findings.runs.runs.get("enoc"))


def _proof(findings: Findings, figures: Figures) -> list[Piece]:
    names, runs = words.STRATEGY_WORDS, findings.runs
    notes = [words.about(names[name], note) for name, run in runs.runs.items() for note in run.all_notes]
    refusals = [words.about(names[name], reason) for name, reason in runs.refused.items()]
    listed = {"Notes of the strategies": notes, "Strategies that refused": refusals}
    return [
        Piece("prose", bound_sentences(findings)),
        *(Piece("listed", (title, sentences)) for title, sentences in listed.items() if sentences),
    ]


def bound_sentences(findings: Findings) -> list[str]:
    """Return in sentences the lower bound, the distance of the optimum and that of the run that comes first."""
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


def _reality(findings: Findings, figures: Figures) -> list[Piece]:
    found = findings.reality
    if found is None:
        return [_note(findings.refusals["reality"])] if "reality" in findings.refusals else []
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
    pieces = [Piece("prose", [comparisons.outcome(*energies, found.delay_s, found.stop_error_m)])]
    if isinstance(found, DisturbedRun):
        pieces.append(Piece("listed", ("", [*(words.notice(*event) for event in found.notices), *found.notes])))
    if isinstance(found, FieldOrientedRun):
        numbers = parts.figures(run_figures(found), stale=False)
        pieces += [Piece("html", numbers + held_words(found)), Piece("listed", ("", found.notes))]
        pieces.append(Piece("html", parts_table(found)))
    head = ("Run", "kWh", "s", "km/h", "recuperated, kWh")
    return [*pieces, Piece("figures", figures.places("reality")), _table("Planned and actual", head, rows)]


def _robustness(findings: Findings, figures: Figures) -> list[Piece]:
    if findings.table is None:
        return [_note(findings.refusals.get("robustness", ""))]
    return sensitivity_pieces(findings.table)


def sensitivity_pieces(found: StudyTable) -> list[Piece]:
    """Return the extra energy over load and position error as a table with shaded cells."""
    most = float(np.nanmax(found.overconsumption, initial=0.0))
    rows = [
        (
            words.setting(load),
            [
                (
                    comparisons.extra_cell(float(energy), found.planned_energy_kwh, float(delay), float(error)),
                    round(max(100 * float(extra) / most, 0.0)) if most > 0 and np.isfinite(extra) else 0,
                )
                for energy, delay, error, extra in zip(*results, strict=True)
            ],
        )
        for load, *results in zip(
            found.load_factor, found.energy_kwh, found.delay_s, found.stop_error_m, found.overconsumption, strict=True
        )
    ]
    ways = "in both directions" if found.both_directions else "in one direction"
    load = words.setting(found.scenario.vehicle.load_factor)
    about = (
        f"The plan for a load of {load} % is followed {ways} with another load, by a train that assumes to be farther "
        f"on by the error; planned: {words.energy(found.planned_energy_kwh)} kWh. Energy against the plan, %."
    )
    head = ("Load, %", *(f"{words.signed(error, 0)} m" for error in found.coordinate_error_m))
    table = {"title": "Extra energy, %, over load and position error", "head": head, "rows": rows}
    return [Piece("shaded", table), _note(about), _note(comparisons.MISSED)]


def _scenario(findings: Findings, figures: Figures) -> list[Piece]:
    return [Piece("tables", scenario_tables(findings.scenario))]


def _file(findings: Findings, figures: Figures) -> list[Piece]:
    """Return how to load the file and to make it again, versions, citation and the scenario's TOML."""
    names, values = zip(*versions().items(), strict=True)
    about = {
        "command": report_command(findings.contents),
        "citation": findings.run.cite(),
        "toml": format_scenario(findings.scenario),
    }
    return [Piece("about", about), _table("Versions", names, [(values, False)]), Piece("sources", about)]


def report_command(contents: Contents) -> str:
    """Return the command that makes the report again from the scenario that it contains."""
    command = ["railjoule", "report", "scenario.toml"]
    if contents.sections != tuple(SECTION_TITLES):
        command += ["--sections", ",".join(contents.sections)]
    if contents.author.strip():
        command += ["--author", contents.author.strip()]
    if contents.note.strip():
        command += ["--note", "note.txt"]
    return shlex.join([*command, "-o", "report.html"])


def _table(title: str, head: Iterable[str], rows: Iterable[Any]) -> Piece:
    return Piece("html", parts.table(title, tuple(head), rows))


def _note(sentence: str) -> Piece:
    return Piece("html", parts.note_paragraphs([sentence]))


MAKERS: Mapping[str, Callable[[Findings, Figures], list[Piece]]] = {
    "result": _result,
    "energy": _energy,
    "pinned": _pinned,
    "trade-off": _trade_off,
    "proof": _proof,
    "reality": _reality,
    "robustness": _robustness,
    "scenario": _scenario,
    "file": _file,
}
"""Functions of the findings, by the names of `SECTION_TITLES`; a section without pieces is left out."""
