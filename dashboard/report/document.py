"""The report's file: the template with sections, figures, style, Bokeh's own script once, the embedded scenario."""

import base64
import hashlib
from collections.abc import Iterable
from datetime import datetime
from pathlib import Path
from typing import Any

import bokeh

from railjoule.core.scenario import format_scenario
from railjoule.dashboard.keep.dropped import embedded
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.look.markup import Markup
from railjoule.dashboard.look.scripts import source
from railjoule.dashboard.look.templates import template
from railjoule.dashboard.look.theme import report_css
from railjoule.dashboard.report.figures import Figures
from railjoule.dashboard.report.findings import Findings
from railjoule.dashboard.report.sections import run_texts, sections


def report_html(findings: Findings, made_at: datetime) -> str:
    """Return the whole file.

    Parameters
    ----------
    findings : Findings
        The last ones of `railjoule.dashboard.report.findings.compute_findings`.
    made_at : datetime
        When the report was made, with its time zone.
    """
    scenario, run = findings.scenario, findings.run
    figures = Figures(findings)
    # without figures, the library's two megabytes would draw nothing
    draws = any(figures.charts.values())
    turns = findings.contents.has("trade-off") and findings.enoc_map is not None
    texts = [*([bokeh_script()] if draws else []), source("report"), *([source("surface")] if turns else [])]
    scripts = [Markup(text) for text in texts]
    # assets/scripts/report.js reads these by their names
    data = {
        **figures.data(),
        "distance": max(one.distance_m for one in findings.runs.runs.values()),
        "own": findings.own,
        "optima": optima_data(findings, figures),
    }
    return template("report").render(
        words=words,
        comparisons=comparisons,
        title=words.title(scenario.title),
        subtitle=words.subtitle(run.distance_m, scenario.vehicle),
        made_at=f"{made_at.day} {made_at:%B %Y}, {made_at:%H:%M} {made_at:%Z}".strip(),
        css=Markup(report_css()),
        contents=findings.contents,
        remark=findings.note,
        sections=sections(findings, figures),
        embedded=Markup(embedded(format_scenario(scenario))),
        embedding=figures.embedding,
        data=data,
        scripts=scripts,
        policy=Markup(policy(scripts, draws=draws)),
    )


def optima_data(findings: Findings, figures: Figures) -> list[dict[str, Any]]:
    """Return texts and figures of all optima; none without a slider, which belongs to the result."""
    optima = findings.optima
    if len(optima) < 2 or not findings.contents.has("result"):
        return []
    # at the timetable's own time the report shows its first run
    shown = [(findings.run, None) if k == findings.own else (run, run) for k, run in enumerate(optima)]
    return [
        {
            "time": f"{words.time(run.travel_time_s)} s",
            "texts": run_texts(findings, run),
            **figures.moved(optimum),
        }
        for run, optimum in shown
    ]


def policy(scripts: Iterable[str], draws: bool) -> str:
    """Return the content security policy of the file: it may run its own scripts, and request nothing.

    Parameters
    ----------
    scripts : iterable of str
        The texts of its script elements.
    draws : bool
        Whether Bokeh is among them, which makes functions of the texts in its models.
    """
    hashes = (base64.b64encode(hashlib.sha256(text.encode()).digest()).decode() for text in scripts)
    allowed = " ".join([*(f"'sha256-{one}'" for one in hashes), *(["'unsafe-eval'"] if draws else [])])
    return (
        f"default-src 'none'; script-src {allowed}; style-src 'unsafe-inline'; img-src data: blob:; font-src data:; "
        "base-uri 'none'; form-action 'none'"
    )


def bokeh_script() -> str:
    """Return Bokeh's own script, without the additions of other packages in this process."""
    folder = Path(bokeh.__file__).parent / "server" / "static" / "js"
    texts = ((folder / f"{name}.min.js").read_text(encoding="utf-8") for name in ("bokeh", "bokeh-widgets"))
    # it would end the element that contains the script
    return "\n".join(text.replace("</script", "<\\/script") for text in texts)
