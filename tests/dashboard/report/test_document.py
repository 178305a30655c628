import base64
import hashlib
import json
import re
from dataclasses import replace
from datetime import UTC, datetime
from html import escape
from html.parser import HTMLParser

import pytest

from railjoule.core import load_scenario, solve
from railjoule.core.scenario import parse_scenario
from railjoule.dashboard.keep.dropped import scenario_in_report
from railjoule.dashboard.look import words
from railjoule.dashboard.report.contents import Contents
from railjoule.dashboard.report.document import report_html
from railjoule.dashboard.report.findings import Findings, ReportRequest, compute_findings
from railjoule.dashboard.report.section_names import SECTION_TITLES
from railjoule.dashboard.report.sections import MAKERS, bound_sentences, report_command, sensitivity

MADE_AT = datetime(2026, 3, 9, 14, 5, tzinfo=UTC)
CANARY = "</style></script></title><img src=x onerror='window.pwned=true'>\"&"
MAX_BYTES = 5_000_000
"""The issue's bar."""
FIGURES_BYTES = 1_000_000
"""Bokeh's script alone has more."""


def request(changes: dict[str, object] | None = None) -> ReportRequest:
    return ReportRequest(load_scenario("metro-with-limit", changes))


@pytest.fixture(scope="module")
def findings() -> Findings:
    stations = [{"name": CANARY, "position_m": 1200.0, "dwell_s": 20.0}]
    changes = {
        "title": CANARY,
        "vehicle.name": CANARY,
        "line.name": CANARY,
        "line.stations": stations,
        "timetable.travel_time_s": 230.0,
        "disturbance.actual_load_factor": 1.0,
    }
    *_, found = compute_findings(request(changes))
    return found


@pytest.fixture(scope="module")
def page(findings: Findings) -> str:
    return report_html(findings, MADE_AT)


class Addresses(HTMLParser):
    """Reads what a page may ask for."""

    def __init__(self) -> None:
        super().__init__()
        self.found: set[str | None] = set()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.found |= {value for name, value in attrs if name in {"src", "href"}}


def without_scripts(page: str) -> str:
    """Return what a browser shows: the page without scripts and styles."""
    return re.sub(r"<(script|style)\b.*?</\1>", "", page, flags=re.DOTALL)


def data(page: str) -> dict:
    return json.loads(page.partition('<script type="application/json" id="data">')[2].partition("</script>")[0])


def test_no_text_of_a_user_becomes_markup(page: str) -> None:
    shown = without_scripts(page)
    for sign in ("<img", "<script", "</style", "x onerror='", "true'>\""):
        assert sign not in shown
    assert shown.count("&lt;img src=x") >= 5  # both titles, vehicle, line, station
    # what scripts read: no text in it ends their element
    for name in ("figures", "data"):
        assert "<" not in page.partition(f'id="{name}">')[2].partition("</script>")[0]


def test_it_is_one_file_that_asks_for_nothing(page: str) -> None:
    shown = without_scripts(page)
    reader = Addresses()
    reader.feed(shown)
    assert reader.found == {"data:,"}
    styles = "".join(re.findall(r"<style>(.*?)</style>", page, re.DOTALL))
    assert set(re.findall(r"url\((.{5})", styles)) == {"data:"}
    assert "@import" not in styles
    assert len(page.encode()) < MAX_BYTES
    assert not re.search(r"<script[^>]*\ssrc=", shown)


def test_date_versions_and_refusals_are_told(page: str, findings: Findings) -> None:
    assert "9 March 2026, 14:05 UTC" in page
    for package in ("railjoule", "numpy", "numba", "Python"):
        assert f'<th scope="col">{package}' in page
    assert findings.runs.refused
    for reason in findings.runs.refused.values():
        assert reason in page


def test_reality_is_told(page: str, findings: Findings) -> None:
    assert findings.reality is not None
    assert f"{words.share_difference(findings.reality.overconsumption)} % energy" in page


def test_the_slider_knows_every_optimum(page: str, findings: Findings) -> None:
    values = data(page)
    assert len(values["optima"]) == len(findings.optima)
    for k in (0, 20, -1):
        run, moved = findings.optima[k], values["optima"][k]
        assert f">{words.energy(run.energy_kwh)}<span>kWh" in moved["texts"]["numbers"]
        speeds = [columns["speed"] for columns in moved["sources"].values() if "speed" in columns]
        assert len(speeds) == 1
        assert max(speeds[0]) == pytest.approx(run.max_speed_kmh, rel=1e-4)
        assert len(moved["sources"][values["phases"]]["left"]) == len(run.phases)
        points = [
            one for one in moved["sources"].values() if one.get("x") == [pytest.approx(run.travel_time_s, rel=1e-4)]
        ]
        assert [one["y"] for one in points] == [[pytest.approx(run.energy_kwh, rel=1e-4)]]
    assert values["optima"][values["own"]]["sources"] == {}


@pytest.mark.parametrize("sections", [("result",), ("trade-off",), ("reality",), tuple(SECTION_TITLES)])
def test_all_painted_models_are_in_the_file(findings: Findings, sections: tuple[str, ...]) -> None:
    for found in (findings, replace(findings, reality=None, optima=())):
        made = chosen(found, *sections)
        figures = made.partition('id="figures">')[2].partition("</script>")[0]
        values = data(made)
        ids = {model for model, *_ in values["worn"]} | values["colours"].keys()
        assert all(f'"id":"{one}"' in figures for one in ids)


def test_columns_have_names_of_colours(page: str) -> None:
    values = data(page)
    colours = {
        name
        for columns in [*values["colours"].values(), *(c for run in values["optima"] for c in run["sources"].values())]
        for column in ("colour", "fill", "ink")
        for name in columns.get(column, ())
    }
    assert colours >= {"optimal", "bellman", "full_power", "on_full_power"}
    assert colours <= values["tokens"]["light"].keys()


def test_the_current_has_a_figure(page: str) -> None:
    assert {"speed", "energy", "effort", "current", "power"} <= data(page)["figures"].keys()


def test_the_file_has_its_command_and_citation(page: str, findings: Findings) -> None:
    assert report_command(Contents()) == "railjoule report scenario.toml -o report.html"
    some = Contents(("proof", "file"), "A. Author", "One")
    assert report_command(some) == (
        "railjoule report scenario.toml --sections proof,file --author 'A. Author' --note note.txt -o report.html"
    )
    shown = without_scripts(page)
    assert report_command(Contents()) in shown
    assert escape(findings.run.cite()) in shown


def test_extra_energy_is_shaded_from_none_to_most(findings: Findings) -> None:
    assert findings.table is not None
    cells = [cell for _, row in sensitivity(findings.table)["rows"] for cell in row]
    assert max(share for _, share in cells) == 100
    assert all(share == 0 for text, share in cells if text.startswith(words.MINUS) or text in {"late", "0.00"})


def test_the_bound_is_stated() -> None:
    sentences = bound_sentences(next(compute_findings(request())))
    best = solve(load_scenario("metro-with-limit"))
    assert sentences[0].startswith(f"The optimum needs {words.energy(best.energy_kwh)} kWh, and it is proven")
    assert best.bound is not None
    assert sentences[1] == best.bound.statement


def test_a_run_that_is_not_the_optimum_names_its_distance() -> None:
    findings = next(compute_findings(request({"strategy": "bellman"})))
    # 7.81 kWh and a share of 7e-9 more, as `railjoule compare metro-with-limit` has it
    assert bound_sentences(findings)[1] == "Bellman needs 7.81 kWh, 0.00 % above the optimum of 7.81 kWh."


# ---- what is asked for


def headings(page: str) -> list[str]:
    return re.findall(r"<h2 id=\"[\w-]+-title\">([^<]+)</h2>", page)


def chosen(findings: Findings, *sections: str, **texts: str) -> str:
    return report_html(replace(findings, contents=Contents(sections, **texts)), MADE_AT)


def test_every_section_that_can_be_chosen_is_made() -> None:
    assert MAKERS.keys() == SECTION_TITLES.keys()


def test_the_sections_that_are_chosen_stand_in_the_report_s_order(page: str, findings: Findings) -> None:
    assert headings(chosen(findings, "scenario", "proof")) == ["Lower bound", "Scenario"]
    # this scenario is disturbed and has neither pinned runs nor a second scenario
    titles = {**SECTION_TITLES, "reality": "Under the disturbance"}
    assert headings(page) == [title for name, title in titles.items() if name not in {"pinned", "second"}]


@pytest.mark.parametrize("section", SECTION_TITLES)
def test_each_section_stands_alone(findings: Findings, section: str) -> None:
    made = chosen(findings, section)
    # without pinned runs and a second scenario
    assert len(headings(made)) == (section not in {"pinned", "second"})
    has_figures = section in {"result", "trade-off", "reality"}
    assert bool(data(made)["figures"]) == has_figures
    assert (len(made.encode()) > FIGURES_BYTES) == has_figures
    assert parse_scenario(scenario_in_report(made, "report.html")) == findings.scenario


def test_author_and_note_are_texts(page: str, findings: Findings) -> None:
    made = without_scripts(chosen(findings, "file", author=CANARY, note=f"{CANARY}\nOne\n\nTwo"))
    assert "<img" not in made
    assert ", by &lt;/style&gt;" in made
    assert "&#39;window.pwned=true&#39;&gt;&#34;&amp;\nOne</p><p>Two</p>" in made
    assert headings(made) == ["Note by the author", "About this file"]
    assert "Note by the author" not in page
    assert re.search("UTC<.p><.header>", page)


def test_a_browser_may_run_the_report_s_own_scripts_alone(page: str, findings: Findings) -> None:
    for made, draws in ((page, True), (chosen(findings, "proof", note=CANARY), False)):
        policy = re.search(r'<meta http-equiv="Content-Security-Policy" content="([^"]+)">', made)
        assert policy is not None
        rules = dict(rule.split(" ", 1) for rule in policy[1].split("; "))
        assert rules["default-src"] == "'none'"
        scripts = re.findall(r"<script>(.*?)</script>", made, re.DOTALL)
        hashes = [base64.b64encode(hashlib.sha256(text.encode()).digest()).decode() for text in scripts]
        # Bokeh makes functions of texts
        library = ["'unsafe-eval'"] if draws else []
        assert rules["script-src"].split() == [*(f"'sha256-{one}'" for one in hashes), *library]
        assert made.index("Content-Security-Policy") < made.index("<title>")


def test_a_run_in_closed_loop_has_its_section_and_its_machine() -> None:
    scenario = load_scenario("ftorek-300s", {"strategy": "enoc", "simulation.kind": "field_oriented"})
    *_, found = compute_findings(ReportRequest(scenario))
    shown = without_scripts(report_html(found, MADE_AT))
    assert "In closed loop" in shown
    assert "Energy at the motors, by part" in shown
    assert "Induction machine" in shown
