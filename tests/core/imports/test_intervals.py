import math
import re
from pathlib import Path

import pytest

from railjoule.core.errors import ScenarioError, UnitError
from railjoule.core.imports import PRESETS, ColumnMap, SourceFile, read_intervals

FILES = Path(__file__).parent / "files"


def table_of(text, kind="gradients", name="a.csv", **columns):
    return read_intervals(SourceFile(name, text.encode()), kind, ColumnMap(**columns))


def values(table):
    return [(one.from_m, one.to_m, one.value) for one in table.intervals]


def told(table, kind):
    return [finding.sentence for finding in table.findings if finding.kind == kind]


@pytest.mark.parametrize(
    ("file", "kind", "expected"),
    [
        ("gradients.csv", "gradients", [(0, 350, 2.5), (350, 800, -4), (800, 1500, 0)]),
        ("limits.csv", "limits", [(0, 500, 60), (500, 1500, 80)]),
        ("curves.csv", "curves", [(200, 400, 300), (600, 700, 0)]),
    ],
)
def test_columns_and_units_are_found(file, kind, expected):
    table = read_intervals(SourceFile.read(FILES / file), kind)
    assert values(table) == expected
    assert table.unused == ()


def test_what_was_taken_for_granted_is_told():
    assert told(table_of("from,to,gradient\n0,100,5\n"), "assumption") == [
        "a.csv: no unit is named for 'from': taken as m.",
        "a.csv: no unit is named for 'gradient': taken as per mille.",
    ]
    assert told(table_of("from (km),to (km),gradient (%)\n0,1,2\n"), "assumption") == []


@pytest.mark.parametrize(
    ("header", "value", "permille"),
    [("gradient (%)", "2.5", 25), ("Neigung [\u2030]", "2.5", 2.5), ("slope", "1:40", 25), ("grade (mm/m)", "-3", -3)],
)
def test_units_of_gradients(header, value, permille):
    assert values(table_of(f"from,to,{header}\n0,100,{value}\n")) == [(0, 100, permille)]


@pytest.mark.parametrize(
    ("header", "value", "kmh"), [("speed (km/h)", "80", 80), ("limit_mph", "50", 80.4672), ("v_max (m/s)", "20", 72)]
)
def test_units_of_limits(header, value, kmh):
    assert values(table_of(f"from_m,to_m,{header}\n0,100,{value}\n", "limits")) == [(0, 100, pytest.approx(kmh))]


def test_columns_are_named_in_any_capitals_and_accents():
    text = "X,Y,D\u00c9CLIVIT\u00c9\n1,2,3\n"
    table = table_of(text, columns={"from": "x", "to": "y", "value": "declivite"}, position_unit="km")
    assert values(table) == [(1000, 2000, 3)]


def test_a_table_without_names_goes_by_place():
    assert values(table_of("0,100,5\n100,200,-3\n")) == [(0, 100, 5), (100, 200, -3)]
    assert values(table_of("0,5\n100,-3\n")) == [(0, 100, 5), (100, math.inf, -3)]
    assert values(table_of("0,100\n300,400\n", "neutral")) == [(0, 100, None), (300, 400, None)]


@pytest.mark.parametrize("preset", [name for name in PRESETS if name != "rinf-gradients"])
def test_presets_read_their_tables(preset):
    kind, columns = PRESETS[preset]
    chosen = ColumnMap(rows={"NOM_VOIE": "V1"} if kind == "gradients" else {}).over(columns)
    assert (
        values(read_intervals(SourceFile.read(FILES / f"{preset}.csv"), kind, chosen))
        == {
            "gradients": [(12000, 12850, 2.5), (12850, 13400, -4), (13400, 14000, 0), (14200, 15000, 3)],
            "limits": [(12000, 14000, 120), (14200, 15000, 90)],
            "curves": [(12100, 12400, 450), (14500, 14600, 800)],
        }[kind]
    )


def test_falling_and_rising_in_words_is_found_without_a_preset():
    table = table_of("from,to,gradient,Art\n0,100,5,Gef\u00e4lle\n100,200,3,rise\n")
    assert values(table) == [(0, 100, -5), (100, 200, 3)]


def test_level_with_a_gradient_is_asked_about():
    table = table_of("from,to,gradient,type\n0,100,5,level\n")
    assert told(table, "question") == ["a.csv: row 2 has 'level' and 5 per mille."]


@pytest.mark.parametrize(
    "text",
    [
        "ILL_GradProfile\n2.5(12.340)\n-4(12.690)\n0(13.140)\n",
        "id;ILL_GradProfile\n1;2.5(12.340)\n1;-4(12.690)\n1;0(13.140)\n",
        "+2.5 (12.340);-4 (12.690);0 (13.140)\n",
        "id\tILL_GradProfile\n1\t2,5(12,340) -4(12,690) 0(13,140)\n",
    ],
)
def test_gradients_with_their_km(text):
    assert values(table_of(text)) == [(12340, 12690, 2.5), (12690, 13140, -4), (13140, math.inf, 0)]


def test_gradients_with_their_km_are_of_one_line():
    text = "line,ILL_GradProfile,name\nA,2.5(12.340),x\nA,-4(12.690),\nB,7(0.5),y\nA,,z\n"
    with pytest.raises(ScenarioError, match=r"^a.csv: its rows are of several line: A, B; choose one, as gradients"):
        table_of(text)
    table = table_of(text, rows={"line": "A"})
    assert values(table) == [(12340, 12690, 2.5), (12690, math.inf, -4)]
    assert table.unused == (
        "a.csv: 1 row not of line = A.",
        "a.csv: columns not used: name.",
        "a.csv: row 5 is without ILL_GradProfile.",
    )


def test_a_note_that_looks_like_a_gradient_is_none():
    table = table_of("from,to,gradient,note\n0,100,5,bridge 2(3)\n100,200,1,\n")
    assert values(table) == [(0, 100, 5), (100, 200, 1)]


def test_one_line_and_one_track_must_be_chosen():
    text = "from,to,gradient,track,line\n0,100,5,1,A\n0,100,-5,2,A\n"
    with pytest.raises(ScenarioError, match=r"^a.csv: its rows are of several track: 1, 2; choose one, as "):
        table_of(text)
    table = table_of(text, rows={"track": "2"})
    assert values(table) == [(0, 100, -5)]
    assert table.unused == ("a.csv: 1 row not of track = 2.",)


def test_rows_that_are_not_there_cannot_be_chosen():
    with pytest.raises(ScenarioError, match=r"^a.csv: no row has track = '3'; there are 1\.$"):
        table_of("from,to,gradient,track\n0,100,5,1\n", rows={"track": "3"})


def test_columns_and_rows_without_use_are_told():
    table = table_of("from,to,gradient,name\n0,100,5,a\n100,200,,b\n200,300,5,c\n")
    assert table.unused == ("a.csv: columns not used: name.", "a.csv: row 3 is without gradient.")


def test_gaps_are_told_with_rows():
    table = table_of("from,to,gradient\n0,100,5\n150,200,5\n")
    (gap,) = [finding for finding in table.findings if finding.kind == "gap"]
    assert gap.stretch_m == (100, 150)
    assert gap.sentence == (
        "a.csv: nothing from 100 to 150 m, between rows 2 and 3: a gap of the table, taken as level, or a jump of the "
        "chainage."
    )


def test_curves_may_have_gaps():
    assert told(table_of("from,to,radius\n0,100,500\n150,200,500\n", "curves"), "gap") == []


def test_overlaps_and_repeated_rows_are_told():
    assert told(table_of("from_m,to_m,limit\n0,100,60\n80,200,50\n80,200,50\n", "limits"), "overlap") == [
        "a.csv: rows 2 and 3 overlap from 80 to 100 m; the lower counts.",
        "a.csv: row 4 repeats row 3.",
    ]


def test_rows_out_of_order_are_put_in_order_and_told():
    table = table_of("from,to,gradient\n0,100,1\n200,300,3\n100,200,2\n")
    assert [one.value for one in table.intervals] == [1, 2, 3]
    assert told(table, "order") == ["a.csv: row 4 lies before the row above; put in order."]


def test_rows_against_the_chainage_are_turned_round():
    table = table_of("from,to,gradient\n300,200,3\n200,0,-1\n")
    assert values(table) == [(0, 200, 1), (200, 300, -3)]
    assert told(table, "order") == [
        "a.csv: rows 2, 3 run against rising chainage; turned round, with the signs of their gradients changed."
    ]


def test_places_in_falling_chainage_hold_downwards():
    """300 to 200 m rises by 3 towards 200 m, 200 to 0 m falls; where the value at 0 m ends, nobody says."""
    table = table_of("position,gradient\n300,3\n200,-1\n0,7\n")
    assert values(table) == [(0, 200, 1), (200, 300, -3)]
    assert table.unused == ("a.csv: row 4, the last in falling chainage: no row has its end.",)


def test_a_place_may_repeat_the_value_before_it():
    """Some tables give both ends of each stretch."""
    table = table_of("position,gradient\n0,3\n100,3\n100,2\n200,0\n")
    assert values(table) == [(0, 100, 3), (100, 200, 2), (200, math.inf, 0)]
    assert table.unused == ("a.csv: row 3 has no length.",)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        # check.md, section 4: the later row counted
        ("from_m,to_m,gradient\n0,350,2.5\n0,350,7\n350,800,-4\n",
         "a.csv: rows 2 and 3 give two values from 0 to 350 m: 2.5 and 7; leave one of them out."),
        ("from_m,to_m,gradient\n0,350,2.5\n0,800,7\n",
         "a.csv: rows 2 and 3 give two values from 0 to 350 m: 2.5 and 7; leave one of them out."),
        ("position_m,gradient\n0,3\n100,1\n100,2\n200,0\n",
         "a.csv: rows 3 and 4 begin at 100 m: 1 and 2; leave one of them out."),
        ("position_m,gradient\n200,3\n100,1\n100,2\n0,0\n",
         "a.csv: rows 3 and 4 begin at 100 m: 1 and 2; leave one of them out."),
        ("position_m,limit\n0,80\n1000,60\n1000,50\n2000,40\n",
         "a.csv: rows 3 and 4 begin at 1,000 m: 60 and 50; leave one of them out."),
    ],
)  # fmt: skip
def test_two_values_of_one_place_are_refused(text, told):
    with pytest.raises(ScenarioError, match=f"^{re.escape(told)}$"):
        table_of(text, "limits" if "limit" in text else "gradients")


@pytest.mark.parametrize(
    ("text", "told"),
    [
        # check.md, section 4: the line ended at 350 instead of 800 m
        ("from_m,to_m,limit\n0,350,60\n350,800,\n", "row 3, from 350 to 800 m, has no value, and without it the line "
         "would end at 350 m; write its value, or delete the row."),
        ("from_m,to_m,limit\n0,350,\n350,800,60\n", "row 2, from 0 to 350 m, has no value, and without it the line "
         "would begin at 350 m; write its value, or delete the row."),
        ("from_m,limit\n0,\n350,60\n800,50\n", "row 2, from 0 to 350 m, has no value, and without it the line would "
         "begin at 350 m; write its value, or delete the row."),
    ],
)  # fmt: skip
def test_a_row_without_a_value_does_not_shorten_the_line(text, told):
    with pytest.raises(ScenarioError, match=f"^a.csv: {re.escape(told)}$"):
        table_of(text, "limits")


def test_a_place_without_a_value_ends_the_row_above():
    table = table_of("from_m,limit\n0,60\n350,\n800,50\n1200,\n", "limits")
    assert values(table) == [(0, 350, 60), (800, 1200, 50)]
    assert told(table, "reading") == ["a.csv: row 5 has no value: the line ends there, at 1,200 m."]
    assert len(told(table, "gap")) == 1


# ---- units


@pytest.mark.parametrize(
    ("heading", "cell", "permille"),
    [
        ("gradient (1 in)", "100", 10),
        ("gradient [1:n]", "-200", -5),
        ("grade_1_in_x", "150", 20 / 3),
        ("slope (m/m)", "0.012", 12),
        ("gradient (-)", "-0.008", -8),
        ("gradient_deg", "1.5", 26.1859),
        ("gradient (deg)", "1.5", 26.1859),
        ("gradient_rad", "0.01", 10.00033),
        ("gradient_per_10000", "120", 12),
        ("gradient ft/mi", "52.8", 10),
        ("gradient", "1.2 %", 12),
        ("\u0423\u0445\u0438\u043b, \u2030", "3.5", 3.5),
    ],
)
def test_a_heading_or_cell_names_the_unit_of_gradients(heading, cell, permille):
    """field.md, faults 4 and 5; core.md, B3."""
    table = table_of(f"from_m\tto_m\t{heading}\n0\t500\t{cell}\n")
    assert [one.value for one in table.intervals] == pytest.approx([permille], rel=1e-5)
    assert table.findings == ()


@pytest.mark.parametrize(
    ("heading", "cell", "radius_m"),
    [
        ("radius_km", "0.35", 350),
        ("radius_ft", "955", 291.084),
        ("Radius [ch]", "17.4", 350.032),
        ("radius (yd)", "400", 365.76),
        ("curve radius (deg)", "6", 291.196),
        ("degree of curve", "6", 291.196),
        ("curvature (1/m)", "0.004", 250),
    ],
)
def test_a_heading_names_the_unit_of_curves(heading, cell, radius_m):
    table = table_of(f"from_m,to_m,{heading}\n0,500,{cell}\n", "curves")
    assert [one.value for one in table.intervals] == pytest.approx([radius_m], rel=1e-5)
    assert table.findings == ()


@pytest.mark.parametrize(
    ("heading", "end_m"),
    [("from (feet)", 304.8), ("from_mile", 1609344), ("milepost_from", 1609344), ("from [yd]", 914.4),
     ("Kilometer", 1e6), ("from ch", 20116.8), ("PK [m]", 1000),
     ("\u041f\u043e\u0447\u0430\u0442\u043e\u043a, \u043a\u043c", 1e6)],
)  # fmt: skip
def test_a_heading_names_the_unit_of_positions(heading, end_m):
    table = table_of(f"{heading}\tto\tgradient_permille\n0\t1000\t5\n")
    assert (table.end_m, table.findings) == (pytest.approx(end_m), ())


@pytest.mark.parametrize(
    ("text", "kind", "doubt"),
    [
        ("from_m,to_m,gradient (x)\n0,500,5\n", "gradients", "'gradient (x)' contains 'x', which is not understood"),
        ("from_m,to_m,gradient (\u2030; fall +)\n0,500,5\n", "gradients",
         "'gradient (\u2030; fall +)' contains '\u2030; fall +', which is not understood"),
        ("from_m,to_m,gradient compensated\n0,500,5\n", "gradients",
         "'gradient compensated' contains 'compensated', which is not understood"),
        ("from_m,to_m,gradient (%) [\u2030]\n0,500,5\n", "gradients",
         "'gradient (%) [\u2030]' names 2 units, per cent and per mille"),
        ("from_m,to_km,gradient_permille\n0,500,5\n", "gradients", "'from_m' and 'to_km' name two units, m and km"),
        ("from (furlong),to,limit_kmh\n0,500,60\n", "limits",
         "'from (furlong)' contains 'furlong', which is not understood"),
        ("from_m,to_m,curvature\n0,500,0.004\n", "curves",
         "'curvature' is no radius, and does not name the unit of its curvatures"),
        ("from_m,to_m,gradient\n0,500,1.2 %\n500,900,3\n", "gradients",
         "row 2 names a unit under 'gradient', and row 3 does not"),
        # by size, where no unit is named
        ("from_m,to_m,gradient\n0,500,100\n500,900,-200\n", "gradients",
         "no unit is named for 'gradient', and in per mille gradients reach 200 per mille"),
        ("from_m,to_m,slope\n0,500,0.012\n500,900,0\n", "gradients",
         "no unit is named for 'slope', and in per mille no gradient exceeds 0.012 per mille"),
        ("from_m,to_m,radius\n0,500,0.35\n500,900,1.2\n", "curves",
         "no unit is named for 'radius', and in m radii go down to 0.35 m"),
        ("from,to,gradient_permille\n0,48.5,5\n", "gradients",
         "no unit is named for 'from', and in m it covers 48.5 m in all"),
        ("from,to,speed_mph\n0,120.5,40\n120.5,203.2,60\n", "limits",
         "no unit is named for 'from', and in m it covers 203.2 m in all, with limits to 96.56 km/h"),
    ],
)  # fmt: skip
def test_a_unit_in_doubt_is_asked_for(text, kind, doubt):
    with pytest.raises(UnitError, match=f"^{re.escape(f'a.csv: {doubt}; name the unit, as {kind}.')}"):
        table_of(text, kind)


@pytest.mark.parametrize(
    ("text", "kind", "answer", "expected"),
    [
        ("from_m,to_m,gradient (x)\n0,500,5\n", "gradients", {"value_unit": "percent"}, (0, 500, 50)),
        ("from_m,to_m,gradient\n0,500,100\n", "gradients", {"value_unit": "ratio"}, (0, 500, 10)),
        ("from_m,to_m,radius\n0,500,0.35\n", "curves", {"value_unit": "km"}, (0, 500, 350)),
        ("from,to,speed_mph\n0,200,50\n", "limits", {"position_unit": "mi"}, (0, 321868.8, 80.4672)),
        # what was asked about may be right
        ("from_m,to_m,radius\n0,500,18\n", "curves", {"value_unit": "m"}, (0, 500, 18)),
    ],
)
def test_the_answer_settles_it(text, kind, answer, expected):
    with pytest.raises(UnitError) as caught:
        table_of(text, kind)
    assert answer.keys() == {caught.value.key}
    assert set(answer.values()) <= {*caught.value.likely, "percent", "m"}
    table = table_of(text, kind, **answer)
    assert values(table) == [pytest.approx(expected)]
    assert table.findings == ()


def test_a_size_in_doubt_is_told_where_the_unit_is_named():
    table = table_of("from_m,to_m,gradient_permille\n0,500,70\n")
    assert told(table, "question") == ["a.csv: gradients reach 70 per mille: is the unit right?"]
    assert told(table_of("from_m,to_m,gradient\n0,500,70\n", value_unit="permille"), "question") == []


def test_a_column_of_another_quantity_is_no_gradient():
    """field.md, row 13: heights that the user names as the column of gradients were per mille."""
    with pytest.raises(UnitError, match=r"'elevation_m' contains 'm', which is not understood; name the unit, as "):
        table_of("position_m,elevation_m\n0,120\n1000,128\n", columns={"value": "elevation_m"})


def test_knots_are_no_speed_of_trains():
    with pytest.raises(
        ScenarioError, match=r"^a.csv, row 2: limit \(kn\) = '40' is in knots, which are not read; write"
    ):
        table_of("from_m,to_m,limit (kn)\n0,500,40\n", "limits")


def test_a_cell_must_not_contradict_its_heading():
    """core.md, B3: 12 per mille under per cent was 120 per mille."""
    told = "a.csv, row 2: gradient [%] = '12 \u2030' is in per mille, but the column in per cent."
    with pytest.raises(ScenarioError, match=f"^{re.escape(told)}$"):
        table_of("from_m,to_m,gradient [%]\n0,500,12 \u2030\n")


def test_no_unit_is_named_is_said_where_none_is():
    """Neither of columns with a unit in each cell, nor of curves in silence."""
    table = table_of("from,to,gradient\n0 m,500 m,1:40\n500 m,800 m,level\n")
    assert told(table, "assumption") == []
    table = table_of("from_m,to_m,radius\n0,500,300\n", "curves")
    assert told(table, "assumption") == ["a.csv: no unit is named for 'radius': taken as m."]


def test_a_decimal_sign_in_doubt_is_told():
    """core.md, B5."""
    table = table_of("from_km;to_km;gradient_permille\n1.234;12.345;5\n")
    assert told(table, "reading") == ["a.csv: row 2 may be read in two ways; its point is for decimals here."]


@pytest.mark.parametrize(
    ("text", "kind", "sentence"),
    [
        ("from,to,limit\n0,100,fast\n", "limits", "a.csv, row 2: limit = 'fast' must be a number."),
        ("from,to,limit\n0,100,0\n", "limits", "a.csv, row 2: limit = '0' must be above 0 km/h."),
        ("from,to,limit\n0,100,700\n", "limits", "a.csv, row 2: limit = '700' must be at most 600 km/h."),
        (
            "from,to,gradient (%)\n0,100,25\n",
            "gradients",
            "a.csv, row 2: gradient (%) = '25', which is 250 per mille, must be at most 200 per mille.",
        ),
        ("from,to,limit\n=A1,100,60\n", "limits", "a.csv, row 2: from = '=A1' is a formula; write what it gives."),
        (
            "a,b,c\n0,100,60\n",
            "limits",
            "a.csv: no column has the start of each row; name it, as limits.from=COLUMN, of a, b, c.",
        ),
        (
            "from,to,c\n0,1,60\n",
            "limits",
            "a.csv: no column of limits was found; name it, as limits.value=COLUMN, of from, to, c.",
        ),
        (
            "from,from km,speed\n0,1,60\n",
            "limits",
            "a.csv: 'from' and 'from km' may both be the column 'from'; name one, as limits.from=COLUMN.",
        ),
        ("from,to,limit\n,,\n,5,60\n", "limits", "a.csv: no row has both a position and a value."),
        ("from,to,limit\n5,5,60\n", "limits", "a.csv: no row has a length: all begin where they end."),
        ("0,1,2,3,4\n", "limits", "a.csv: 5 columns without names; the first row must name them."),
        (
            "2.5(12.3) x\n1(13)\n2(14)\n",
            "gradients",
            "a.csv, row 1: '2.5(12.3) x' must be a gradient and its km, as 2.5(12.340).",
        ),
    ],
)
def test_bad_tables_are_refused_in_one_sentence(text, kind, sentence):
    with pytest.raises(ScenarioError, match=f"^{re.escape(sentence)}$"):
        table_of(text, kind)


@pytest.mark.parametrize(
    ("columns", "sentence"),
    [
        ({"columns": {"value": "limits"}}, "a.csv: value = 'limits' is not a column of it, did you mean 'limit'?"),
        ({"columns": {"begin": "from"}}, "a.csv: limits.begin is unknown, choose one of direction, from, to, value."),
        (
            {"position_unit": "furlong"},
            "a.csv: limits.position_unit = 'furlong' must be one of m, km, mi, ch, yd, ft, pk, mi.ch, mi.yd.",
        ),
        ({"value_unit": "permille"}, "a.csv: limits.value_unit = 'permille' must be one of km/h, m/s, mph."),
        ({"decimal": ";"}, "a.csv: limits.decimal = ';' must be . or ,."),
        ({"rows": {"track": "1"}}, "a.csv: 'track' is not a column of it, so no rows can be chosen by it."),
    ],
)
def test_wrong_settings_are_refused_in_one_sentence(columns, sentence):
    with pytest.raises(ScenarioError, match=f"^{re.escape(sentence)}$"):
        table_of("from,to,limit\n0,100,60\n", "limits", **columns)


@pytest.mark.parametrize(
    ("header", "cells", "kmh"),
    [
        ("maxspeed", ("40 mph", "100 mph"), (64.37376, 160.9344)),
        ("maxspeed:forward", ("60 km/h", "25 m/s"), (60, 90)),
        ("railway:maxspeed", ("40", "100"), (40, 100)),
        ("Line speed (mph)", ("40 mph", "100"), (64.37376, 160.9344)),
    ],
)
def test_limits_of_openstreetmap(header, cells, kmh):
    """A mile is 1,609.344 m."""
    text = f"from_km,to_km,{header}\n" + "".join(f"{k},{k + 1},{cell}\n" for k, cell in enumerate(cells))
    assert values(table_of(text, "limits")) == [
        (1000 * k, 1000 * k + 1000, pytest.approx(limit)) for k, limit in enumerate(kmh)
    ]


@pytest.mark.parametrize("word", ["none", "walk", "signals", "variable"])
def test_words_in_place_of_a_speed_are_refused(word):
    with pytest.raises(ScenarioError, match=rf"^a.csv, row 3: maxspeed = '{word}' is no speed; write a number"):
        table_of(f"from_km,to_km,maxspeed\n0,1,40\n1,2,{word}\n", "limits")


def test_a_unit_of_the_user_counts_for_cells_without_one():
    text = "from_km,to_km,maxspeed\n0,1,80\n1,2,40 mph\n"
    with pytest.raises(UnitError, match=r"row 3 names a unit under 'maxspeed', and row 2 does not; name the"):
        table_of(text, "limits")
    table = table_of(text, "limits", value_unit="km/h")
    assert [one.value for one in table.intervals] == [80, pytest.approx(64.37376)]


def test_units_of_one_table_may_stand_in_all_its_cells():
    table = table_of("from,to,gradient\n0 m,1.2 km,12 \u2030\n1.2 km,1 mi,1 in 80\n1 mi,2 mi,-1.5 %\n")
    assert values(table) == [
        *[(0, 1200, 12), (1200, pytest.approx(1609.344), 12.5)],
        (pytest.approx(1609.344), pytest.approx(3218.688), -15),
    ]


@pytest.mark.parametrize(
    ("header", "cell", "metres"),
    [
        ("degree of curve", "6", 50 / math.sin(math.radians(3)) * 0.3048),
        ("degree of curve", "6\u00b030'", 50 / math.sin(math.radians(3.25)) * 0.3048),
        ("degree of curve", "6\u00b030'36\"", 50 / math.sin(math.radians(3.255)) * 0.3048),
        ("degree of curve (chord)", "6", 50 / math.sin(math.radians(3)) * 0.3048),
        ("degree of curve (arc)", "6", 100 / math.radians(6) * 0.3048),
        ("curvature in degrees (arc)", "6\u00b0", 30.48 / math.radians(6)),
        ("curvature (1/m)", "0.002", 500),
        ("curvature (rad/km)", "-2", 500),
        ("curvature [1/ft]", "0.001", 304.8),
        ("radius [ch]", "20", 402.336),
        ("radius (miles)", "0.25", 402.336),
        ("radius (yd)", "440", 402.336),
        ("radius", "1320 ft", 402.336),
        ("radius_km", "0.35", 350),
        ("radius", "20 ch", 402.336),
    ],
)
def test_units_of_curves(header, cell, metres):
    """Over a chord of 100 ft the radius is 50 ft / sin(D/2), over an arc of it 100 ft / D; a mile is 80 ch, 1760 yd."""
    assert [one.value for one in table_of(f"from_m,to_m,{header}\n0,900,{cell}\n", "curves").intervals] == [
        pytest.approx(metres)
    ]
