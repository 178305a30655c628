"""The report's file: sections, figures, style, Bokeh's own script once, the embedded scenario."""

import base64
import hashlib
from collections.abc import Callable, Iterable, Mapping
from datetime import datetime
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

import bokeh
import numpy as np
from jinja2 import Environment, StrictUndefined, Template

from railjoule.core import Trajectory
from railjoule.core.arrays import FloatArray
from railjoule.core.scenario import format_scenario
from railjoule.dashboard.charts.quantities import (
    EFFORT,
    ENERGY,
    LARGEST_EFFORT,
    MOTOR_CURRENT,
    POSITION,
    POWER,
    SPEED,
    TIME,
)
from railjoule.dashboard.keep.embedded import embedded
from railjoule.dashboard.look import words
from railjoule.dashboard.look.markup import Markup, joined
from railjoule.dashboard.look.scripts import source
from railjoule.dashboard.look.theme import report_css
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.report import sections
from railjoule.dashboard.report.figures import Figures
from railjoule.dashboard.report.findings import Findings
from railjoule.dashboard.report.section_names import SECTION_TITLES

SECTIONS: Mapping[str, Callable[[Findings, Figures], Markup]] = {
    "result": sections.result,
    "energy": sections.energy,
    "pinned": sections.pinned,
    "trade-off": sections.trade_off,
    "proof": sections.proof,
    "reality": sections.reality,
    "robustness": sections.robustness,
    "scenario": sections.scenario,
    "file": sections.about_file,
}
"""What a report tells, by the names of `SECTION_TITLES`; a section without content returns an empty text."""


def report_html(findings: Findings, made_at: datetime) -> str:
    """Return the whole file.

    Parameters
    ----------
    findings : Findings
        The last ones of `railjoule.dashboard.report.findings.compute_findings`.
    made_at : datetime
        When the report was made, with its time zone.
    """
    scenario, run, contents = findings.scenario, findings.run, findings.contents
    figures = Figures(findings)
    chosen = (SECTIONS[name](findings, figures) for name in SECTION_TITLES if contents.has(name))
    charts = figures.handles()
    # without figures, the library's two megabytes would draw nothing
    draws = bool(figures.places)
    library = [bokeh_script()] if draws else []
    scripts = [Markup(text) for text in (*library, source("report"), source("surface"))]
    # assets/scripts/report.js reads these by their names
    data = {
        **figures.paints(),
        "charts": charts,
        "draws": draws,
        "optimum": figures.optimum,
        "spare": figures.spare_texts(),
        "distance": max(run.distance_m for run in findings.runs.runs.values()),
        "phases": _phases(run),
        "optima": optima_data(findings, figures),
        "words": words.PHASE_WORDS,
    }
    return frame().render(
        title=words.title(scenario.title),
        subtitle=words.subtitle(run.distance_m, scenario.vehicle.name, scenario.vehicle.load_factor),
        made_at=moment(made_at),
        css=Markup(report_css()),
        author=contents.author.strip(),
        content=joined([sections.foreword(findings), *chosen]),
        scenario=Markup(embedded(format_scenario(scenario))),
        figures=figures.embedding(),
        data=data,
        surfaces={name: surface.data for name, surface in figures.surfaces.items()},
        scripts=scripts,
        policy=Markup(policy(scripts, draws=draws)),
    )


@cache
def frame() -> Template:
    """Return the template of the file; it escapes whatever is not marked as HTML, and misses no name in silence."""
    made = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, keep_trailing_newline=True)
    # NaN is no JSON: a browser would refuse all of the data
    made.policies["json.dumps_kwargs"] = {"separators": (",", ":"), "allow_nan": False}
    template = files("railjoule.assets").joinpath("templates", "report.html").read_text(encoding="utf-8")
    return made.from_string(template)


def policy(scripts: Iterable[str], draws: bool) -> str:
    """Return what a browser may do for the file: run these scripts and no others, and ask for nothing.

    Parameters
    ----------
    scripts : iterable of str
        The scripts as they stand in their elements.
    draws : bool
        Whether Bokeh is among them, which makes functions of the texts that its models carry.
    """
    hashes = (base64.b64encode(hashlib.sha256(text.encode()).digest()).decode() for text in scripts)
    allowed = " ".join([*(f"'sha256-{one}'" for one in hashes), *(["'unsafe-eval'"] if draws else [])])
    return "; ".join(
        [
            "default-src 'none'",
            f"script-src {allowed}",
            "style-src 'unsafe-inline'",
            "img-src data: blob:",
            "font-src data:",
            "base-uri 'none'",
            "form-action 'none'",
        ]
    )


def bokeh_script() -> str:
    """Return Bokeh's own script, without what other packages in this process add to its resources."""
    folder = Path(bokeh.__file__).parent / "server" / "static" / "js"
    texts = ((folder / f"{name}.min.js").read_text(encoding="utf-8") for name in ("bokeh", "bokeh-widgets"))
    # it would end the element in which the script stands
    return "\n".join(text.replace("</script", "<\\/script") for text in texts)


def moment(made_at: datetime) -> str:
    """Return date and time as people read them."""
    return f"{made_at.day} {made_at:%B %Y}, {made_at:%H:%M} {made_at:%Z}".strip()


def optima_data(findings: Findings, figures: Figures) -> dict[str, Any]:
    """Return what moves with the travel time: of each optimum its lines, its phases and its texts."""
    optima = findings.optima
    # a single one leaves the slider nowhere to go, and the slider is the result's
    if len(optima) < 2 or not findings.contents.has("result"):
        return {"own": 0, "runs": []}
    own = sections.own_index(findings)
    # at its own place of the slider the report shows what it has drawn
    moved = [findings.runs.runs["optimal"] if k == own else run for k, run in enumerate(optima)]
    shown = [findings.run if k == own else run for k, run in enumerate(optima)]
    runs = [
        {
            **_texts(findings, run),
            "lines": {} if k == own else _lines(optimum),
            "names": names,
            "point": _point(optimum),
        }
        for k, (run, optimum, names) in enumerate(zip(shown, optima, figures.names_of(moved), strict=True))
    ]
    return {"own": own, "runs": runs}


def _texts(findings: Findings, run: Trajectory) -> dict[str, Any]:
    """Return what is told of a run."""
    return {
        "time": f"{words.time(run.travel_time_s)} s",
        "shown": sections.shown_words(run),
        "phases": _phases(run),
        "numbers": sections.numbers(findings, run),
        "advice": parts.advice(run, stale=False),
        "account": parts.account(run),
        "table": parts.phase_table(run),
    }


def _phases(run: Trajectory) -> list[list[Any]]:
    """Return name, start [m], end [m] and target speed of each group of phases that one line of the advice has."""
    groups = [
        (run.phases[group[0]], run.phases[group[-1]], run.advice[group[0]])
        for group in words.instruction_groups(run.advice)
    ]
    return [
        [first.phase, first.start_m, last.end_m, "" if told.to_kmh is None else words.tenths(told.to_kmh)]
        for first, last, told in groups
    ]


def _point(run: Trajectory) -> list[float]:
    return [run.travel_time_s, run.energy_kwh]


def _lines(run: Trajectory) -> dict[str, list[float]]:
    """Return the columns of an optimum that the figures draw."""
    known = [MOTOR_CURRENT] if run.current_a is not None else []
    drawn = [POSITION, TIME, SPEED, ENERGY, EFFORT, LARGEST_EFFORT, POWER, *known]
    return {quantity.name: _rounded(quantity.values(run)) for quantity in drawn}


def _rounded(values: FloatArray) -> list[float]:
    """Return values with about five digits, which no figure can tell from all."""
    size = float(np.max(np.abs(values), initial=0.0))
    # of a greatest value from 100 on, five digits leave two decimals: 4 less the power of ten
    digits = 5 - int(np.floor(np.log10(size))) if size > 0 else 0
    return [float(value) for value in np.round(values, digits - 1)]
