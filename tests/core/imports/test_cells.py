import csv
import re

import pytest

from railjoule.core.errors import ScenarioError
from railjoule.core.imports import SourceFile
from railjoule.core.imports.cells import MAX_COLUMNS, MAX_ROWS, read_cells


def cells_of(text, name="a.csv"):
    return read_cells(SourceFile(name, text.encode() if isinstance(text, str) else text))


@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_separators_are_found(separator):
    table = cells_of("\n".join(separator.join(row) for row in (("from", "to"), ("0", "1.5"))))
    assert (table.header, table.rows, table.separator) == (("from", "to"), ((2, ("0", "1.5")),), separator)


def test_decimal_commas_do_not_split_rows():
    assert cells_of("from;to\n0,5;1,5\n").rows == ((2, ("0,5", "1,5")),)


def test_rows_are_numbered_as_a_spreadsheet_does():
    assert [number for number, _ in cells_of('from,name\n\n0,"two\nlines"\n5,b\n').rows] == [4, 5]


def test_a_title_above_the_table_is_told():
    table = cells_of("Line 12\n\nfrom,to\n0,1\n")
    assert (table.header, table.unused) == (("from", "to"), ("a.csv, row 1: 'Line 12' above the table.",))


def test_a_table_without_names_has_columns_by_number():
    table = cells_of("0,100,5\n100,200,-3\n")
    assert (table.has_header, table.header) == (False, ("column 1", "column 2", "column 3"))
    assert len(table.rows) == 2


def test_empty_cells_at_the_end_need_no_column():
    assert cells_of("from,to\n0,1,,\n").rows == ((2, ("0", "1")),)


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        ("", "a.csv: holds no rows."),
        ("from,to\n", "a.csv: has the columns from, to, and no rows below."),
        ("from,to\n0,1,2\n", "a.csv, row 2: 3 cells under 2 columns."),
        ("from,from\n0,1\n", "a.csv, row 1: the column 'from' appears twice."),
        ("from,to\n0,1\0\n", "a.csv: not a text file: it holds the character NUL."),
        (f"{'x,' * 10_000}x\n0\n", f"a.csv, row 1: 10001 columns; at most {MAX_COLUMNS} are permitted."),
        (f"{'x' * 300},to\n0,1\n", "a.csv, row 1: a column's name has 300 characters; at most 200."),
        ("0,1\n" * (MAX_ROWS + 1), f"a.csv: more than the {MAX_ROWS} rows permitted."),
        (b"\xd0\xcf\x11\xe0old", "a.csv: an old workbook (.xls); save it as .xlsx or CSV."),
    ],
)
def test_what_is_no_table_is_refused_in_one_sentence(content, sentence):
    with pytest.raises(ScenarioError, match=f"^{re.escape(sentence)}$"):
        cells_of(content)


def test_long_cells_are_read_and_the_limit_of_others_stays():
    limit = csv.field_size_limit()
    assert cells_of(f"from,shape\n0,{'x' * 200_000}\n").rows[0][1][1] == "x" * 200_000
    assert csv.field_size_limit() == limit


def test_only_workbooks_have_sheets():
    with pytest.raises(ScenarioError, match=r"^a.csv: sheet = 'Line', but the file is no workbook"):
        read_cells(SourceFile("a.csv", b"from,to\n0,1\n"), "Line")
