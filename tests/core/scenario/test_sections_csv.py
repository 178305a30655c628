"""Sections of a line from a CSV file."""

import pytest
from builders import PLAIN

from railjoule.core import ScenarioError, load_scenario
from railjoule.core.scenario import parse_scenario, scenario_from_document

GOOD = "length_m, gradient_permille, speed_limit_kmh\n500, 3.5,\n\n700, -2, 60\n"


def with_file(folder, content, name="line.csv"):
    (folder / "line.csv").write_text(content, encoding="utf-8") if isinstance(content, str) else (
        folder / "line.csv"
    ).write_bytes(content)
    return scenario_from_document({**PLAIN, "line": {"file": name}}, folder=folder)


def test_rows_become_sections(tmp_path):
    line = with_file(tmp_path, GOOD).line
    assert [section.length_m for section in line.sections] == [500, 700]
    assert [section.gradient_permille for section in line.sections] == [3.5, -2]
    assert [section.speed_limit_kmh for section in line.sections] == [None, 60]


def test_a_table_saved_by_a_spreadsheet(tmp_path):
    assert with_file(tmp_path, b"\xef\xbb\xbf" + GOOD.encode()).line == with_file(tmp_path, GOOD).line


def test_the_file_lies_beside_the_scenario(tmp_path, monkeypatch):
    (tmp_path / "line.csv").write_text(GOOD, encoding="utf-8")
    text = '[vehicle]\npreset = "metro-81-7036"\n[line]\nfile = "line.csv"\n[timetable]\ntravel_time_s = 150\n'
    (tmp_path / "run.toml").write_text(text, encoding="utf-8")
    monkeypatch.chdir("/")
    assert load_scenario(tmp_path / "run.toml").line.length_m == 1200
    with pytest.raises(ScenarioError, match=r"line.file = 'line.csv' can only be read from a scenario file on disk."):
        parse_scenario(text)


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        ("", "line.file 'line.csv' is empty."),
        ("length_m\n", "line.sections is empty."),
        ("length\n5\n", "line.file 'line.csv': unknown column 'length', did you mean 'length_m'?"),
        ("length_m,length_m\n5,6\n", "line.file 'line.csv': a column appears twice."),
        ("length_m,gradient_permille\n5\n", "line.file 'line.csv', row 2: 1 cells under 2 columns."),
        ("length_m\n5\n6,7\n", "line.file 'line.csv', row 3: 2 cells under 1 columns."),
        ("length_m\n5\nfive\n", "line.file 'line.csv', row 3: length_m = 'five' must be a number."),
        ("length_m\n1,5\n", "row 2: 2 cells under 1 columns."),
        ("length_m\nnan\n", "line.sections[0].length_m = nan must be a finite number."),
        ("length_m\n5\n-5\n", "line.sections[1].length_m = -5 must be above 0."),
        ("length_m,gradient_permille\n,4\n", "line.sections[0].length_m is missing."),
        ("length_m\n" + "5" * 200_000 + "\n", "line.file 'line.csv': not a table in CSV: "),
        (b"length_m\n\xff\n", "line.csv: not UTF-8 text."),
    ],
)
def test_a_table_that_is_none(tmp_path, content, sentence):
    with pytest.raises(ScenarioError) as error:
        with_file(tmp_path, content)
    assert sentence in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ({"file": 3}, "line.file = 3 must be the name of a CSV file."),
        ({"file": ["a.csv"]}, "line.file = ['a.csv'] must be the name of a CSV file."),
        ({"file": "none.csv"}, "there is no such file."),
        ({"file": "a.csv", "preset": "liashenko-i"}, "line needs only one of preset, file and sections."),
        ({"file": "a.csv", "sections": [{"length_m": 5}]}, "line needs only one of preset, file and sections."),
    ],
)
def test_a_key_that_names_none(tmp_path, line, sentence):
    with pytest.raises(ScenarioError) as error:
        scenario_from_document({**PLAIN, "line": line}, folder=tmp_path)
    assert sentence in str(error.value)


def test_many_wrong_rows_are_counted(tmp_path):
    content = "length_m\n" + "-1\n" * 2000
    with pytest.raises(ScenarioError, match=r"line.sections\[0\].length_m = -1 must be above 0 \(and 1999 more\)."):
        with_file(tmp_path, content)
