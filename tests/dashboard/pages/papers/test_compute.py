"""What is shipped of the papers' comparisons is what the code computes."""

import shutil
from importlib.resources import files
from pathlib import Path
from typing import Any

import pytest

from railjoule.core.citation import printed_numbers
from railjoule.core.validation import COMPARISONS, first_comparisons
from railjoule.dashboard.pages.papers import compute
from railjoule.dashboard.pages.papers.compute import ASSETS, input_hash, shipped_tables

SAMPLE = {"ftorek": (0, 3, 5), "liashenko": (0,), "rawicki": (0, 5), "shtompel": (0,)}
"""Tables of each paper that are computed within seconds."""
CLOSE = 1e-6


def test_all_papers_are_shipped_with_all_their_tables() -> None:
    papers = shipped_tables().papers
    assert list(papers) == list(COMPARISONS)
    for name, paper in papers.items():
        assert len(paper.tables) + len(paper.claims) == COMPARISONS[name]().step_count


@pytest.mark.parametrize(("name", "number"), [(name, number) for name in SAMPLE for number in SAMPLE[name]])
def test_a_sample_is_computed_alike(name: str, number: int) -> None:
    shipped = shipped_tables().papers[name].tables[number]
    fresh = COMPARISONS[name]().tables[number]()
    assert (shipped.title, shipped.place, shipped.reference) == (fresh.title, fresh.place, fresh.reference)
    assert len(shipped.rows) == len(fresh.rows)
    for kept, row in zip(shipped.rows, fresh.rows, strict=True):
        assert (kept.case, kept.quantity, kept.unit, kept.printed, kept.note, kept.source) == (
            row.case,
            row.quantity,
            row.unit,
            row.printed,
            row.note,
            row.source,
        )
        assert kept.value == pytest.approx(row.value, rel=CLOSE, abs=1e-9)


@pytest.mark.parametrize(
    "name",
    ["vehicles/suburban-ftorek.toml", "lines/liashenko-ii.toml", "scenarios/tram-950m.toml", "papers/ftorek-2025.toml"],
)
def test_other_assets_are_other_inputs(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A train 1 % heavier in the assets is computed anew, as the review papers.md tried."""
    for folder in ASSETS:
        shutil.copytree(str(files("railjoule.assets") / folder), tmp_path / folder)
    monkeypatch.setattr(compute, "files", lambda _: tmp_path)
    before = input_hash()
    (tmp_path / "papers" / "computed.json").write_text("{}")
    assert input_hash() == before
    changed = tmp_path / name
    changed.write_text(changed.read_text() + "\n# another number\n")
    assert input_hash() != before


def numbers_in_print(name: str) -> int:
    """Count the numbers other than zero that a paper prints and that are compared, from its file."""
    paper: dict[str, Any] = printed_numbers(name)
    if name == "ftorek-2025":
        # quantities of Tables 1 and 2, which begin with the case's time; of Table 3 the energies, the minimum and how
        # far the other two points lie above it; of the nameplate all but the frequency at which it holds
        in_tables = sum(len(run) - 1 for run in paper["table_1"] + paper["table_2"])
        changes = sum(len(entry) - 2 for entry in paper["change_percent"])
        return in_tables + len(paper["table_3"]) + 4 + changes + len(paper["nameplate"]) - 1
    if name == "liashenko-2025":
        return sum(len(row) for table in paper["table"] for row in table["overconsumption_percent"])
    phases = paper["phase"]
    # distance, time, first speed if not at rest; of part I, which the driver chose, no speed and nothing of the cruise
    planned = sum(2 + (one["start_ms"] != 0) for one in phases if one["part"] != "part I")
    driven = sum(2 for one in phases if one["part"] == "part I" and one["phase"] != "cruise")
    energies = sum("energy_kwh" in one for one in phases)
    in_figures = sum(1 + ("penalty_percent" in one) for one in paper["figure"])
    # of the nameplate voltage, current, power and power factor
    return planned + driven + energies + in_figures + 4


@pytest.mark.parametrize("name", ["ftorek-2025", "liashenko-2025", "rawicki-2013"])
def test_each_printed_number_counts_once(name: str) -> None:
    tables = shipped_tables().papers[name.partition("-")[0]].tables
    assert len(first_comparisons(tables)) == numbers_in_print(name)


def test_shtompel_prints_no_number() -> None:
    assert first_comparisons(shipped_tables().papers["shtompel"].tables) == ()
