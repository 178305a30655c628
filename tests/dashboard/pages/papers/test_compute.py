"""What is shipped of the papers' comparisons is what the code computes."""

import pytest

from railjoule.core.validation import COMPARISONS
from railjoule.dashboard.pages.papers.compute import shipped_tables

SAMPLE = {"ftorek": (0, 3, 5), "liashenko": (0,), "rawicki": (0, 5), "shtompel": (0,)}
"""Tables of each paper that are computed within seconds."""
CLOSE = 1e-6


def test_all_papers_are_shipped_with_all_their_tables() -> None:
    papers = shipped_tables().papers
    assert list(papers) == list(COMPARISONS)
    for name, paper in papers.items():
        assert paper.complete
        assert paper.table_count == len(COMPARISONS[name]().tables)


@pytest.mark.parametrize(("name", "number"), [(name, number) for name in SAMPLE for number in SAMPLE[name]])
def test_a_sample_is_computed_alike(name: str, number: int) -> None:
    shipped = shipped_tables().papers[name].validation.tables[number]
    fresh = COMPARISONS[name]().tables[number]()
    assert (shipped.title, shipped.place, shipped.reference) == (fresh.title, fresh.place, fresh.reference)
    assert len(shipped.rows) == len(fresh.rows)
    for kept, row in zip(shipped.rows, fresh.rows, strict=True):
        assert (kept.case, kept.quantity, kept.unit, kept.printed, kept.note) == (
            row.case,
            row.quantity,
            row.unit,
            row.printed,
            row.note,
        )
        assert kept.ours == pytest.approx(row.ours, rel=CLOSE, abs=1e-9)
