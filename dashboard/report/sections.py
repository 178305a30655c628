"""The sections of a report as data, which the macros of the same names in assets/templates/report.html write."""

import shlex
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from railjoule.core import Trajectory
from railjoule.core.scenario import format_scenario
from railjoule.core.simulation.disturbances import DisturbedRun
from railjoule.core.simulation.field_oriented import FieldOrientedRun
from railjoule.core.studies.table import StudyTable
from railjoule.core.trajectory import MEASURED
from railjoule.dashboard.look import comparisons, side_by_side, words
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
Data = Mapping[str, Any]


class Section(NamedTuple):
    """A section: the name of its macro, its title, and the data that the macro writes."""

    name: str
    title: str
    data: Data


def sections(findings: Findings, figures: Figures) -> list[Section]:
    """Return the chosen sections that have contents, in the report's order."""
    closed_loop = findings.scenario.simulation.kind == "field_oriented"
    titles = {**SECTION_TITLES, "reality": "In closed loop" if closed_loop else "Under the disturbance"}
    chosen = (name for name in titles if findings.contents.has(name))
    made = [Section(name, titles[name], MAKERS[name](findings, figures)) for name in chosen]
    return [section for section in made if section.data]


def run_texts(findings: Findings, run: Trajectory) -> dict[str, str]:
    """Return the texts of a run by the ids of their places; the slider writes those of other optima there."""
    other, runs = comparisons.other_time_of(run), findings.runs
    # an optimum over another time has a marginal energy of its own
    if run.strategy == "optimal":
        runs = replace(runs, runs={"optimal": run})
    shown = f"{words.strategy(run.strategy)}, {words.time(run.travel_time_s)} s{f', {other}' if other else ''}"
    return {
        "shown": escaped(shown),
        "numbers": parts.run_figures(runs, run, None, stale=False),
        "advice": parts.advice(run, stale=False),
        "account": parts.account(run),
        "phases": parts.phase_table(run),
    }


def _result(findings: Findings, figures: Figures) -> Data:
    optima, own, slider = findings.optima, findings.own, {}
    if len(optima) > 1:
        slider = {"last": len(optima) - 1, "own": own, "time": f"{words.time(optima[own].travel_time_s)} s"}
    return {**run_texts(findings, findings.run), "slider": slider, "places": figures.places("result")}


def _energy(findings: Findings, figures: Figures) -> Data:
    run = findings.run
    return {**run_texts(findings, run), "runs": parts.runs_table(findings.runs, run.strategy, ())}


def _pinned(findings: Findings, figures: Figures) -> Data:
    """Return the runs that were pinned on the page, measured ones among them, beside the first run."""
    first = findings.run
    if not findings.pinned:
        return {}
    measured = any(run.strategy == MEASURED for _, run in findings.pinned)
    return {
        "runs": [(words.strategy(first.strategy), first), *findings.pinned],
        "first": first,
        "measured": measured,
    }


def _second(findings: Findings, figures: Figures) -> Data:
    """Return the second scenario beside the first, with the numbers of both."""
    if findings.pair is None:
        refusal = findings.refusals.get("second", "")
        return {"refusal": refusal} if refusal else {}
    first, second = findings.pair.runs
    sentences = [
        side_by_side.scenarios_differ(first.scenario, second.scenario),
        side_by_side.lengths_differ(first, second),
        findings.pair.refusal,
    ]
    return {
        "names": side_by_side.pair_names(first, second),
        "sentence": " ".join(filter(None, sentences)),
        "head": side_by_side.HEAD,
        "rows": side_by_side.pair_rows(first, second),
        "places": figures.places("second"),
    }


def _trade_off(findings: Findings, figures: Figures) -> Data:
    optima = findings.optima
    if len(optima) < 2:
        return {"refusal": findings.runs.refused.get("optimal", "there is no optimum over other times")}
    shown = {findings.own, *np.linspace(0, len(optima) - 1, FRONTIER_ROWS).astype(int).tolist()}
    return {
        "optima": [optima[k] for k in sorted(shown)],
        "own": optima[findings.own],
        "count": len(optima),
        "cells": [len(run.nodes_m) - 1 for run in optima],
        "places": figures.places("trade-off"),
        "surface": surface(findings),
    }


def surface(findings: Findings) -> Data | None:
    """Return the surface of ENOC's energy; None where ENOC does not accept the scenario."""
    found = findings.enoc_map
    return None if found is None else enoc_surface(found, findings.runs.runs.get("enoc"))


def _proof(findings: Findings, figures: Figures) -> Data:
    names, runs = words.STRATEGY_WORDS, findings.runs
    return {
        "sentences": bound_sentences(findings),
        "notes": words.notes_by_run({names[name]: run.all_notes for name, run in runs.runs.items()}),
        "refusals": [words.about(names[name], reason) for name, reason in runs.refused.items()],
    }


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
        needed = ", is ".join(filter(None, [needs, comparisons.delay_words(run)]))
        known = comparisons.reference_words(run.reference, run.scenario.travel_time_s)
        sentences.insert(1, f"{needed}, {more.sentence} the {known}.")
    return sentences


def _reality(findings: Findings, figures: Figures) -> Data:
    found, refusal = findings.reality, findings.refusals.get("reality", "")
    if found is None:
        return {"refusal": refusal} if refusal else {}
    energies = found.actual.energy_kwh, found.planned.energy_kwh
    data: dict[str, Any] = {
        "outcome": comparisons.outcome(*energies, found.delay_s, found.stop_error_m),
        "runs": {"Planned": found.planned, "Driven": found.actual},
        "places": figures.places("reality"),
        "events": [*found.notes] if isinstance(found, DisturbedRun | FieldOrientedRun) else [],
        "drive": [],
    }
    if isinstance(found, DisturbedRun):
        data["events"] = [*(words.notice(*event) for event in found.notices), *found.notes]
    if isinstance(found, FieldOrientedRun):
        numbers = parts.figures(run_figures(found), stale=False)
        data["drive"] = [numbers, held_words(found), parts_table(found)]
    return data


def _robustness(findings: Findings, figures: Figures) -> Data:
    if findings.table is None:
        return {"refusal": findings.refusals.get("robustness", "")}
    return sensitivity(findings.table)


def sensitivity(found: StudyTable) -> Data:
    """Return the extra energy over load and position error: texts, and percents of the largest as shades."""
    most = float(np.nanmax(found.overconsumption, initial=0.0)) or 1.0
    shades = np.nan_to_num(100 * np.clip(found.overconsumption, 0, None) / most).round().astype(int)
    rows = zip(found.energy_kwh, found.delay_s, found.stop_error_m, shades, strict=True)
    return {
        "found": found,
        "rows": [
            (
                load,
                [
                    (comparisons.extra_cell(*map(float, (energy, found.planned_energy_kwh, delay, error))), int(shade))
                    for energy, delay, error, shade in zip(*row, strict=True)
                ],
            )
            for load, row in zip(found.load_factor, rows, strict=True)
        ],
    }


def _scenario(findings: Findings, figures: Figures) -> Data:
    return {"tables": scenario_tables(findings.scenario)}


def _file(findings: Findings, figures: Figures) -> Data:
    return {
        "command": report_command(findings.contents),
        "versions": versions(),
        "citation": findings.run.cite(),
        "toml": format_scenario(findings.scenario),
    }


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


MAKERS: Mapping[str, Callable[[Findings, Figures], Data]] = {
    "result": _result,
    "energy": _energy,
    "pinned": _pinned,
    "second": _second,
    "trade-off": _trade_off,
    "proof": _proof,
    "reality": _reality,
    "robustness": _robustness,
    "scenario": _scenario,
    "file": _file,
}
"""Functions of the findings, by the names of `SECTION_TITLES`; a section without data is left out."""
