import csv
import io
from pathlib import Path

import pandas
import pytest
from hypothesis import given
from hypothesis import strategies as st

from railjoule.core.csv_text import csv_of_rows, csv_of_table, guarded, plain_table, unguarded, write_csv

# what OWASP's page on CSV injection lists as beginnings of a formula
FORMULAS = ("=1+1", "+1+1", "-2+3", "@SUM(A1)", "\t=1", "\r=1", '=HYPERLINK("http://x","y")', "-", "+49 30", "-3.2 km")
NUMBERS = ("-3.2", "+4", "-1e-3", "-.5", "0", "-3.")
# what can begin a formula, a number and a mark, so that examples hold many of each
TEXTS = st.text(alphabet="='+-@\t\r.0123e \"a,;\n", max_size=8)


@pytest.mark.parametrize("text", FORMULAS)
def test_a_formula_is_told_to_be_text(text: str) -> None:
    assert guarded(text) == f"'{text}"
    assert unguarded(guarded(text)) == text


@pytest.mark.parametrize("cell", [*NUMBERS, -3.2, 7, None, "plain", "a=b", "'quoted'", ""])
def test_numbers_and_plain_texts_stay(cell: object) -> None:
    assert guarded(cell) == unguarded(cell) == cell


@given(TEXTS)
def test_every_text_comes_back(text: str) -> None:
    assert unguarded(guarded(text)) == text


@given(st.lists(st.lists(TEXTS, min_size=2, max_size=2), min_size=1, max_size=4))
def test_rows_come_back_and_none_of_their_cells_is_a_formula(rows: list[list[str]]) -> None:
    read = list(csv.reader(io.StringIO(csv_of_rows(rows), newline="")))
    assert [[unguarded(cell) for cell in row] for row in read] == rows
    for cell in (cell for row in read for cell in row):
        assert not cell or cell[0] not in "=+-@\t\r" or float(cell) is not None


def test_a_table_comes_back_with_its_names(tmp_path: Path) -> None:
    table = pandas.DataFrame({"=name": ["=A1", "-3.2 km", "fine"], "x_m": [-3.2, 0.0, 4.5], "n": [-1, 2, 3]})
    text = csv_of_table(table)
    assert text.splitlines()[:2] == ["'=name,x_m,n", "'=A1,-3.2,-1"]
    pandas.testing.assert_frame_equal(plain_table(pandas.read_csv(io.StringIO(text))), table)
    write_csv(table.set_index("=name"), tmp_path / "t.csv", index=True)
    pandas.testing.assert_frame_equal(plain_table(pandas.read_csv(tmp_path / "t.csv")), table)


def test_columns_named_by_numbers_keep_their_place() -> None:
    table = pandas.DataFrame({0: ["=a"], "x": [1], 2.5: ["b"]})
    assert csv_of_table(table) == "0,x,2.5\n'=a,1,b\n"
    assert table[0].tolist() == ["=a"]


def test_no_other_module_writes_csv() -> None:
    """One place guards: what writes past it is found by its words."""
    folder = Path(__file__).resolve().parents[2]
    found = [
        path.relative_to(folder).as_posix()
        for part in ("core", "dashboard")
        for path in (folder / part).rglob("*.py")
        if any(
            words in path.read_text(encoding="utf-8")
            for words in ("csv.writer", "DictWriter", "DataFrame.to_csv", ").to_csv(")
        )
    ]
    assert found == ["core/csv_text.py"]
