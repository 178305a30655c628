import re
import tomllib
from pathlib import Path

import pytest

from railjoule.core.errors import ScenarioError
from railjoule.core.imports import PRESETS, ColumnMap, SourceFile, build_line, read_intervals
from railjoule.core.scenario import scenario_from_document

FILES = Path(__file__).parent / "files"
VEHICLE = {"vehicle": {"preset": "metro-81-7036"}, "timetable": {"travel_time_s": 180}}


def table_of(text, kind):
    return read_intervals(SourceFile(f"{kind}.csv", text.encode()), kind)


def tables(*kinds):
    return {kind: read_intervals(SourceFile.read(FILES / f"{kind}.csv"), kind) for kind in kinds}


def sentences(line, kind):
    return [finding.sentence for finding in line.findings if finding.kind == kind]


def test_sections_lie_between_all_changes():
    line = build_line(**tables("gradients", "limits", "curves"), name="Example")
    assert line.document["line"] == {
        "name": "Example",
        "sections": [
            {"length_m": 200, "gradient_permille": 2.5, "speed_limit_kmh": 60},
            {"length_m": 150, "gradient_permille": 2.5, "speed_limit_kmh": 60, "curve_radius_m": 300},
            {"length_m": 50, "gradient_permille": -4, "speed_limit_kmh": 60, "curve_radius_m": 300},
            {"length_m": 100, "gradient_permille": -4, "speed_limit_kmh": 60},
            {"length_m": 300, "gradient_permille": -4, "speed_limit_kmh": 80},
            {"length_m": 700, "speed_limit_kmh": 80},
        ],
    }
    assert line.line.length_m == 1500


def test_the_toml_is_the_line_of_a_scenario():
    text = build_line(**tables("gradients", "limits")).to_toml()
    assert text.startswith("# Imported from gradients.csv, limits.csv.\n# limits.csv: no unit is named for 'from'")
    assert scenario_from_document({**tomllib.loads(text), **VEHICLE}).line.length_m == 1500


def test_the_csv_is_the_file_of_a_line(tmp_path):
    line = build_line(**tables("gradients", "limits", "curves"))
    (tmp_path / "line.csv").write_text(line.to_csv())
    scenario = scenario_from_document({**VEHICLE, "line": {"file": "line.csv"}}, folder=tmp_path)
    assert scenario.line.sections == line.line.sections


def test_a_names_line_break_cannot_leave_the_comment():
    table = read_intervals(SourceFile("a\n[x]\n.csv", b"from_m,to_m,limit\n0,100,60\n"), "limits")
    assert set(tomllib.loads(build_line(limits=table).to_toml())) == {"line"}


def test_running_in_falling_chainage_mirrors_positions_and_gradients():
    forward = build_line(**tables("gradients", "limits", "curves"))
    backward = build_line(**tables("gradients", "limits", "curves"), reverse=True)
    assert backward.line.sections == forward.line.model_copy(update={"reverse": True}).in_running_order().sections
    assert backward.is_reversed


def test_a_part_of_the_line_is_cut_out():
    line = build_line(**tables("gradients", "limits"), begin_m=400, end_m=1000)
    assert [section.length_m for section in line.line.sections] == [100, 300, 200]
    assert line.begin_m == 400
    assert "gradients.csv: 1 row outside 400 to 1,000 m: 2." in line.unused


def test_what_counts_where_rows_overlap():
    limits = table_of("from_m,to_m,limit\n0,100,60\n50,200,80\n", "limits")
    gradients = table_of("from,to,gradient\n0,200,5\n50,100,-5\n", "gradients")
    curves = table_of("from,to,radius\n0,200,300\n50,100,500\n", "curves")
    line = build_line(gradients=gradients, limits=limits, curves=curves)
    rows = [(s.length_m, s.gradient_permille, s.speed_limit_kmh, s.curve_radius_m) for s in line.line.sections]
    assert rows == [(50, 5, 60, 300), (50, -5, 60, 300), (100, 5, 80, 300)]


def test_overlaps_count_alike_in_both_directions():
    line = build_line(gradients=table_of("from,to,gradient\n0,200,5\n50,100,-5\n", "gradients"), reverse=True)
    assert [(s.length_m, s.gradient_permille) for s in line.line.sections] == [(100, -5), (50, 5), (50, -5)]


def test_a_table_that_ends_early_is_told():
    line = build_line(
        gradients=table_of("from,to,gradient\n0,800,5\n", "gradients"),
        limits=table_of("from,to,limit\n100,900,60\n", "limits"),
    )
    assert sentences(line, "gap") == [
        "gradients.csv: nothing from 800 to 900 m, at the line's end: taken as level.",
        "limits.csv: nothing from 0 to 100 m, at the line's begin: taken as without a limit.",
    ]
    assert line.line.sections[0].speed_limit_kmh is None


def test_a_gap_of_all_tables_is_asked_about_as_a_jump():
    chosen = {}
    for name in ("sncf-gradients", "sncf-limits", "sncf-curves"):
        kind, columns = PRESETS[name]
        rows = ColumnMap(rows={"NOM_VOIE": "V1"} if kind == "gradients" else {})
        chosen[kind] = read_intervals(SourceFile.read(FILES / f"{name}.csv"), kind, rows.over(columns))
    line = build_line(**chosen)
    assert line.line.length_m == 3000
    assert sentences(line, "question") == [
        "no table has anything from 14,000 to 14,200 m: does the chainage jump there? The line is taken to have these "
        "200 m."
    ]


def test_a_place_without_an_end_reaches_to_the_end_of_the_line():
    gradients = table_of("position,gradient\n0,3\n100,1\n", "gradients")
    line = build_line(gradients=gradients, limits=table_of("from,to,limit\n0,400,60\n", "limits"))
    assert [(s.length_m, s.gradient_permille) for s in line.line.sections] == [(100, 3), (300, 1)]
    assert sentences(line, "gap") == []


def test_a_place_at_the_end_of_the_line_is_told():
    line = build_line(gradients=table_of("position,gradient\n0,3\n100,1\n", "gradients"))
    assert [(s.length_m, s.gradient_permille) for s in line.line.sections] == [(100, 3)]
    assert sentences(line, "gap") == ["gradients.csv: no row has the end of row 3, and the line ends where it begins."]


def test_a_line_needs_an_end():
    gradients = table_of("position,gradient\n100,3\n", "gradients")
    with pytest.raises(ScenarioError, match=r"^gradients.csv: no row has the end of the line; name it\.$"):
        build_line(gradients=gradients)
    assert build_line(gradients=gradients, end_m=500).line.length_m == 400


def test_a_factor_of_a_tunnel_is_used():
    limits = table_of("from,to,limit\n0,400,60\n", "limits")
    line = build_line(limits=limits, tunnels=table_of("from,to,tunnel_factor\n100,300,1.5\n", "tunnels"))
    assert [section.tunnel_factor for section in line.line.sections] == [1, 1.5, 1]


def test_neutral_sections_lie_on_the_line_as_it_runs():
    limits = table_of("from,to,limit\n1000,1400,60\n", "limits")
    # the second begins before the line
    neutral = table_of("from,to\n1350,1390\n900,1020\n", "neutral")
    line = build_line(limits=limits, neutral=neutral)
    assert [(one.from_m, one.to_m) for one in line.line.neutral_sections] == [(0, 20), (350, 390)]
    line = build_line(limits=limits, neutral=neutral, reverse=True)
    assert line.document["line"]["neutral_sections"] == [{"from_m": 10, "to_m": 50}, {"from_m": 380, "to_m": 400}]
    assert line.unused == ()
    assert "neutral_sections" in line.to_toml()


def test_what_a_line_has_no_key_for_is_kept_and_told():
    limits = table_of("from,to,limit\n1000,1400,60\n", "limits")
    tunnels = table_of("from,to,area (m2)\n1100,1300,40\n", "tunnels")
    line = build_line(limits=limits, tunnels=tunnels, reverse=True)
    assert [(one.from_m, one.to_m, one.value) for one in line.tunnels] == [(100, 300, 40)]
    assert line.unused == ("tunnels.csv: tunnels without a factor on quadratic resistance: 100 to 300 m of the line.",)


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({}, "no table of the line is given: gradients, limits, curves, tunnels or neutral."),
        (
            {"begin_m": 900, "end_m": 400},
            "the line's end at 400 m must lie beyond its begin at 900 m.",
        ),
        ({"end_m": 0.5}, "limits.csv: line is 0.5 m long, and must be at least 1 m."),
    ],
)
def test_lines_that_cannot_be_are_refused_in_one_sentence(given, sentence):
    with pytest.raises(ScenarioError, match=f"^{re.escape(sentence)}$"):
        build_line(**(tables("limits") if given else {}), **given)
