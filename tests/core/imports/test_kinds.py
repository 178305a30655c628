"""Kinds of tables by their headings, and the sheets of one workbook."""

import io

import openpyxl
import pytest

from railjoule.core.errors import ScenarioError
from railjoule.core.imports import SourceFile, kind_of_table, tables_of_file
from railjoule.core.imports.cells import read_cells

SHEETS = {
    "Profile": [["km", "height (m)"], [0, 120], [1, 128], [2.5, 128], [3, 121.5], [5, 150]],
    "Speeds": [["from (km)", "to (km)", "maxspeed"], [0, 1.5, "40 mph"], [1.5, 5, "60 mph"]],
    "Bends": [["from km", "to km", "degree of curve"], [0.5, 0.8, "6\u00b030'"]],
    "Tunnels": [["from km", "to km"], [2.6, 2.9]],
    "Stops": [["Station", "km", "arrival_s"], ["A", 0, None], ["B", 5, 480]],
    "Notes": [["made by me"]],
}


def workbook(sheets):
    book = openpyxl.Workbook()
    book.remove(book.active)
    for name, rows in sheets.items():
        sheet = book.create_sheet(name)
        for row in rows:
            sheet.append(row)
    content = io.BytesIO()
    book.save(content)
    return content.getvalue()


def found_in(sheets, chosen=None):
    return tables_of_file(SourceFile("line.xlsx", workbook(sheets)), chosen or {})


def test_the_sheets_of_a_workbook_are_found_by_their_headings():
    found = found_in(SHEETS)
    assert {kind: source.name for kind, (source, _) in found.tables.items()} == {
        "heights": "line.xlsx, Profile",
        "limits": "line.xlsx, Speeds",
        "curves": "line.xlsx, Bends",
        "tunnels": "line.xlsx, Tunnels",
        "stations": "line.xlsx, Stops",
    }
    assert found.unused == ("line.xlsx: sheets not read: Notes.",)


def test_two_sheets_of_one_kind_are_asked_about():
    sheets = {**SHEETS, "Down": SHEETS["Speeds"]}
    with pytest.raises(ScenarioError, match=r"the sheets Speeds, Down are all tables of limits; choose one, as lim"):
        found_in(sheets)
    assert found_in(sheets, {"limits": "Down"}).tables["limits"][0].name == "line.xlsx, Down"


def test_a_file_without_a_table_is_refused():
    with pytest.raises(ScenarioError, match=r"^line.xlsx: no sheet is a table of gradients, heights, limits"):
        found_in({"Notes": [["a", "b"], [1, 2]]})
    with pytest.raises(ScenarioError, match=r"^a.csv: the columns a, b name no kind of table; say it, as --gradients"):
        tables_of_file(SourceFile("a.csv", b"a,b\n1,2\n"), {})


@pytest.mark.parametrize(
    ("name", "header", "kind"),
    [
        ("a.csv", "from,to,gradient", "gradients"),
        ("a.csv", "km,elevation", "heights"),
        ("a.csv", "PKD,PKF,v_max", "limits"),
        ("a.csv", "from,to,radius", "curves"),
        ("a.csv", "from,to,factor", "tunnels"),
        ("neutral sections.csv", "from,to", "neutral"),
        ("a.csv", "name,km,dwell", "stations"),
        ("a.csv", "stop_name,shape_dist_traveled,arrival_time,departure_time", "stations"),
        ("a.csv", "time,position,speed", None),
        ("a.csv", "from,to", None),
    ],
)
def test_kinds_of_tables(name, header, kind):
    cells = read_cells(SourceFile(name, f"{header}\n{','.join('1' * (header.count(',') + 1))}\n".encode()))
    assert kind_of_table(cells, name) == kind
