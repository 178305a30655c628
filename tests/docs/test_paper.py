"""The paper, the citation and the list of changes: in their forms, and with the numbers that the program computes."""

import collections
import json
import re
import tomllib
from pathlib import Path

import pytest
import yaml
from documents import PAPER, ROOT

from railjoule.core import STRATEGIES, load_scenario, solve
from railjoule.core.citation import bibtex, printed_numbers

TEXT = PAPER.read_text(encoding="utf-8")
_, HEAD, BODY = TEXT.split("---\n", 2)
BIBLIOGRAPHY = PAPER.with_name("paper.bib").read_text(encoding="utf-8")
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
# the journal asks for 750 to 1750 words
FEWEST, MOST = 750, 1750
SECTIONS = [
    "Summary",
    "Statement of need",
    "State of the field",
    "Software design",
    "Research impact statement",
    "AI usage disclosure",
    "Acknowledgements",
    "References",
]
COMPUTED = json.loads((ROOT / "assets" / "papers" / "computed.json").read_text(encoding="utf-8"))["papers"]
ROW = re.compile(
    r"^\| (Ftorek|Liashenko|Rawicki|Shtompel) \| (.+?) \| (.+?) \| (.+?) \| ([\d.]+) \| ([\d.]+) \|$", re.MULTILINE
)


def decimals(number: str) -> int:
    return len(number.partition(".")[2])


def test_the_head_has_what_the_journal_asks_for():
    head = yaml.safe_load(HEAD)
    assert head.keys() >= {"title", "tags", "authors", "affiliations", "date", "bibliography"}
    assert head["bibliography"] == "paper.bib"
    places = {place["index"] for place in head["affiliations"]}
    assert all(author["affiliation"] in places for author in head["authors"])


def test_sections_are_those_of_the_journal():
    assert re.findall(r"^# (.+)$", BODY, re.MULTILINE) == SECTIONS


def test_it_is_neither_too_short_nor_too_long():
    assert FEWEST <= len(re.sub(r"^\|.*$|^#.*$", "", BODY, flags=re.MULTILINE).split()) <= MOST


def test_references_are_those_that_are_cited():
    assert set(re.findall(r"@([a-z]+\d*)", BODY)) == set(re.findall(r"^@\w+\{(\w+),", BIBLIOGRAPHY, re.MULTILINE))


def test_numbers_are_those_that_validate_prints():
    rows = ROW.findall(BODY)
    assert len(rows) == 6
    for paper, case, quantity, unit, printed, computed in rows:
        candidates = [
            row
            for table in COMPUTED[paper.lower()]["tables"]
            for row in table["rows"]
            if (row["case"], row["quantity"], row["unit"]) == (case, quantity, unit)
        ]
        assert any(
            row["printed"] == float(printed) and f"{row['value']:.{decimals(computed)}f}" == computed
            for row in candidates
        ), (paper, case, quantity)


def test_claims_are_counted_by_their_verdicts():
    verdicts = collections.Counter(claim["verdict"] for paper in COMPUTED.values() for claim in paper["claims"])
    counts = re.search(
        r"of (\d+) claims, .*?(\d+) are supported, (\d+) are refuted and (\d+) cannot", " ".join(BODY.split())
    )
    names = ("supports", "refutes", "cannot be decided")
    assert list(map(int, counts.groups())) == [verdicts.total(), *(verdicts[name] for name in names)]


def test_the_saving_over_the_printed_optima_is_as_told():
    shares = [
        1 - float(computed) / float(printed) for paper, *_, printed, computed in ROW.findall(BODY) if paper == "Ftorek"
    ]
    assert f"undercut by {100 * min(shares):.1f} to {100 * max(shares):.1f} %" in " ".join(BODY.split())


@pytest.mark.parametrize(("mesh_m", "cells"), [(70.0, 773), (10.0, 4863)])
def test_the_benchmark_is_solved_as_told(mesh_m, cells):
    """In the paper and in the page that compares tools; the times there are measured, and held by no test."""
    scenario = load_scenario(Path(ROOT / "tests" / "benchmarks" / "g1.toml")).replace(**{"solver.mesh_m": mesh_m})
    run = solve(scenario)
    assert f"{run.energy_kwh:.3f} kWh over {cells} cells" in " ".join(BODY.split())
    assert 0 <= run.gap <= 1.1e-4
    assert len(run.position_m) == cells + 1
    compared = (ROOT / "assets" / "docs" / "explanation" / "need.md").read_text(encoding="utf-8")
    assert f"| {cells} | {run.energy_kwh:.3f} kWh |" in compared


def test_the_citation_is_that_of_this_version():
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert citation["cff-version"] == "1.2.0"
    assert citation["version"] == PROJECT["version"]
    assert citation["license"] in PROJECT["license"]
    assert citation["authors"]
    assert all("title" in one and "authors" in one for one in citation["references"])
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    assert f"\n## [{PROJECT['version']}] - {citation['date-released']}\n" in changes


def test_the_citation_and_bibtex_name_the_same_authors():
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    papers = {strategy.source for strategy in STRATEGIES.values() if strategy.source}
    assert len(citation["references"]) == len(papers)
    for name in papers:
        paper = printed_numbers(name)
        (reference,) = (one for one in citation["references"] if one["title"] == paper["title"])
        names = [f"{author['given-names']} {author['family-names']}" for author in reference["authors"]]
        assert names == paper["authors"]
        assert reference.get("doi") == paper.get("doi")
        assert f"  author = {{{' and '.join(names)}}}," in bibtex([name])


def test_changes_have_the_form_of_keep_a_changelog():
    text = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    versions = re.findall(r"^## \[(.+?)\]( - \d{4}-\d\d-\d\d)?$", text, re.MULTILINE)
    assert versions[0] == ("Unreleased", "")
    assert all(date for _, date in versions[1:])
    kinds = {"Added", "Changed", "Deprecated", "Removed", "Fixed", "Security"}
    assert set(re.findall(r"^### (.+)$", text, re.MULTILINE)) <= kinds
    assert PROJECT["version"] in text
