import io
import re
import sys
import zipfile
from datetime import date

import pytest

from railjoule.core.errors import ChoiceError, ScenarioError
from railjoule.core.imports import SourceFile, read_intervals
from railjoule.core.imports.cells import MAX_COLUMNS, MAX_FILES, MAX_UNPACKED_BYTES, read_cells

openpyxl = pytest.importorskip("openpyxl")


EMPTY = "Sheet2"


def workbook(rows, sheets=("Line",)):
    book = openpyxl.Workbook()
    book.active.title = sheets[0]
    for row in rows:
        book.active.append(row)
    for name in sheets[1:]:
        sheet = book.create_sheet(name)
        if name != EMPTY:
            sheet.append(["from", "to"])
            sheet.append([5, 6])
    stream = io.BytesIO()
    book.save(stream)
    return stream.getvalue()


def package(files):
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files:
            archive.writestr(name, content)
    return stream.getvalue()


def test_a_workbook_is_read_like_csv():
    content = workbook([["from_km", "to_km", "gradient_permille"], [0, 0.35, 2.5], [0.35, "0.8", "1:250"]])
    table = read_intervals(SourceFile("line.xlsx", content), "gradients")
    assert [(one.from_m, one.to_m, one.value, one.row) for one in table.intervals] == [
        (0, 350, 2.5, 2),
        (350, 800, 4.0, 3),
    ]


def test_a_sheet_is_chosen_by_its_name():
    source = SourceFile("line.xlsx", workbook([["from", "to"], [0, 1]], ("Line", "Notes", EMPTY)))
    with pytest.raises(ChoiceError, match=r"^line.xlsx: holds 2 sheets, Line, Notes; choose one sheet by its name\.$"):
        read_cells(source)
    with pytest.raises(ScenarioError, match=r"^line.xlsx: sheet = 'Lines' must be one of Line, Notes\.$"):
        read_cells(source, "Lines")
    table = read_cells(source, "Line")
    assert table.rows == ((2, (0.0, 1.0)),)
    assert (table.sheets, table.unused) == (("Line", "Notes"), ("line.xlsx: sheets not read: Notes.",))


def test_the_only_sheet_that_holds_anything_needs_no_name():
    source = SourceFile("line.xlsx", workbook([["from", "to"], [0, 1]], ("Line", EMPTY)))
    assert (read_cells(source).rows, read_cells(source).unused) == (((2, (0.0, 1.0)),), ())


def test_a_formula_without_its_result_is_no_empty_cell():
    content = workbook([["from", "to"], [0, 1], [1, "=A3+5"]])
    told = "line.xlsx, row 3: '=A3+5' is a formula whose result is not in the file"
    with pytest.raises(ScenarioError, match=f"^{re.escape(told)}"):
        read_cells(SourceFile("line.xlsx", content))


def test_dates_are_no_positions():
    content = workbook([["from", "to", "limit"], [date(2026, 1, 2), 5, 60]])
    with pytest.raises(ScenarioError, match=r"^line.xlsx, row 2: from = '2026-01-02T00:00:00' must be a number\.$"):
        read_intervals(SourceFile("line.xlsx", content), "limits")


def test_many_columns_are_refused():
    content = workbook([["x"] * 10_000])
    with pytest.raises(ScenarioError, match=rf"row 1: 10000 columns; at most {MAX_COLUMNS} are permitted"):
        read_cells(SourceFile("line.xlsx", content))


def test_a_cell_far_down_is_refused():
    book = openpyxl.Workbook()
    book.active.cell(1_048_576, 1, "x")
    stream = io.BytesIO()
    book.save(stream)
    with pytest.raises(ScenarioError, match=r"^line.xlsx: more than the 200000 rows permitted\.$"):
        read_cells(SourceFile("line.xlsx", stream.getvalue()))


def test_a_size_that_the_file_claims_costs_nothing():
    with zipfile.ZipFile(io.BytesIO(workbook([["from", "to"], [0, 1]]))) as archive:
        files = [(part, archive.read(part)) for part in archive.namelist()]
    claimed = [(name, data.replace(b'ref="A1:B2"', b'ref="A1:XFD1048576"')) for name, data in files]
    assert any(b"XFD1048576" in data for _, data in claimed)
    assert read_cells(SourceFile("line.xlsx", package(claimed))).rows == ((2, (0.0, 1.0)),)


def test_what_unpacks_to_too_much_is_not_unpacked():
    bomb = package([("xl/workbook.xml", b"0" * (MAX_UNPACKED_BYTES + 1))])
    assert len(bomb) < 1_000_000
    with pytest.raises(ScenarioError, match=r"^line.xlsx: unpacks to 200 MB; at most 200 MB are permitted\.$"):
        read_cells(SourceFile("line.xlsx", bomb))


def test_too_many_files_are_refused():
    with pytest.raises(ScenarioError, match=rf"holds {MAX_FILES + 1} files"):
        read_cells(SourceFile("line.xlsx", package([(f"{index}.xml", b"") for index in range(MAX_FILES + 1)])))


@pytest.mark.parametrize("content", [b"PK\x03\x04nothing", package([("readme.txt", b"no workbook")])])
def test_a_broken_workbook_is_told(content):
    with pytest.raises(ScenarioError, match=r"^line.xlsx: not a workbook that can be read: "):
        read_cells(SourceFile("line.xlsx", content))


def test_entities_within_entities_are_refused():
    """The one that grows to a thousand million from ten lines; the XML parser of Python stops it."""
    content = workbook([["from", "to"], [0, 1]])
    entities = "".join(f'<!ENTITY a{n} "{f"&a{n - 1};" * 10}">' for n in range(1, 10))
    xml = f'<?xml version="1.0"?><!DOCTYPE x [<!ENTITY a0 "lol">{entities}]><worksheet>&a9;</worksheet>'.encode()
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        files = [(part, archive.read(part)) for part in archive.namelist()]
    grown = [(name, xml if "sheet1" in name else data) for name, data in files]
    with pytest.raises(ScenarioError, match=r"^line.xlsx: "):
        read_cells(SourceFile("line.xlsx", package(grown)))


def test_what_to_install_is_told(monkeypatch):
    content = workbook([["from", "to"], [0, 1]])
    monkeypatch.setitem(sys.modules, "openpyxl", None)
    with pytest.raises(
        ScenarioError, match=r"needs openpyxl, which is not installed: pip install 'railjoule\[excel\]'"
    ):
        read_cells(SourceFile("line.xlsx", content))
