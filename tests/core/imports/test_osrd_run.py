import re
from pathlib import Path

import pytest

from railjoule.core.errors import ScenarioError
from railjoule.core.imports import SourceFile
from railjoule.core.imports.osrd_run import read_osrd_line

FILE = SourceFile.read(Path(__file__).parent / "files" / "osrd-run.csv")


def test_limits_neutral_sections_and_stops_become_a_line():
    line = read_osrd_line(FILE, "Example")
    assert line.document["line"] == {
        "name": "Example",
        "sections": [
            {"length_m": 1000, "speed_limit_kmh": 80},
            {"length_m": 1500, "speed_limit_kmh": 100},
        ],
        "neutral_sections": [{"from_m": 500, "to_m": 600}],
        "stations": [{"name": "B", "position_m": 1500, "dwell_s": 30}],
    }
    assert [(one.from_m, one.to_m) for one in line.line.neutral_sections] == [(500, 600)]
    assert line.unused == (
        "osrd-run.csv: columns not used: ch, trackName, lineCode, electrificationMode, electrificationProfile.",
    )
    assert [finding.sentence for finding in line.findings] == ["osrd-run.csv: no gradients are given: a level line."]


def test_rows_out_of_order_are_told():
    lines = FILE.content.decode().splitlines()
    lines[3], lines[4] = lines[4], lines[3]
    line = read_osrd_line(SourceFile("r.csv", "\n".join(lines).encode()))
    assert line.findings[0].sentence == "r.csv: rows that lie before the row above, put in order: 5."
    assert line.line.sections == read_osrd_line(FILE).line.sections


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ("speedLimit", "limit", "r.csv: not a run of OSRD: the column speedLimit is missing; it has op, ch, trackName, "
         "time, seconds, position, speed, limit and 4 more."),
        (";80;", ";900;", "r.csv, row 2: speedLimit = '900' must be at most 600 km/h."),
        (";0,1;", ";here;", "r.csv, row 3: position = 'here' must be a number with the decimal sign ,."),
        (";80;", ";;", None),
    ],
)  # fmt: skip
def test_bad_runs_are_refused_in_one_sentence(old, new, sentence):
    source = SourceFile("r.csv", FILE.content.decode().replace(old, new).encode())
    if sentence is None:
        gaps = [finding.sentence for finding in read_osrd_line(source).findings if finding.kind == "gap"]
        assert gaps == ["r.csv: nothing from 0 to 1,000 m, at the line's begin: taken as without a limit."]
    else:
        with pytest.raises(ScenarioError, match=f"^{re.escape(sentence)}$"):
            read_osrd_line(source)
