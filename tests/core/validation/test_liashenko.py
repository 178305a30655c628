import pytest

from railjoule.core.validation import validate_liashenko


@pytest.fixture(scope="module")
def validation():
    return validate_liashenko()


def test_all_printed_cells_stand_beside_ours(validation):
    assert [table.place for table in validation.tables[:4]] == ["Table 4", "Table 5", "Table 6", "Table 7"]
    assert all(len(table.rows) == 35 for table in validation.tables[:4])


def test_light_lines_come_out_in_size(validation):
    """Table 5 at half load: within one point of what is printed, as findings.md says."""
    rows = [row for row in validation.tables[1].rows if row.case.endswith("load 0.5")]
    assert len(rows) == 7
    assert all(abs(row.ours - row.printed) < 1.0 for row in rows)


def test_every_difference_that_stays_has_its_sentence(validation):
    for table in validation.tables[:4]:
        assert all(row.note for row in table.rows if abs(row.ours - row.printed) > 0.05)


def test_examples_of_the_figures_stop_at_their_place(validation):
    errors = [row.ours for row in validation.tables[4].rows if row.quantity == "stopping error"]
    assert errors == pytest.approx([0.0] * 4, abs=0.01)
