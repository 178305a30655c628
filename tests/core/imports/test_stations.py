"""Tables of stations: columns, clocks, direction and travel time, and the sentences where they contradict."""

import re

import pandas as pd
import pytest

import railjoule as rj
from railjoule.core.errors import ScenarioError, UnitError
from railjoule.core.imports import ColumnMap, SourceFile, build_line, read_intervals, read_stations

LEVEL = b"from (km),to (km),gradient (\xe2\x80\xb0)\n0,10,0\n"


def build(text, gradients=LEVEL, reverse=False, **columns):
    table = read_stations(SourceFile("s.csv", text.encode()), ColumnMap(**columns))
    return build_line(
        gradients=read_intervals(SourceFile("g.csv", gradients), "gradients"), stations=table, reverse=reverse
    )


def build_stations(text, **settings):
    return build(text, **settings).document["line"]["stations"]


def test_arrivals_on_a_clock_become_times_from_the_departure():
    """Written by hand: 23:58:30 to 00:01:40 are 190 s, to 00:06:10 460 s; 00:01:40 to 00:02:10 are 30 s."""
    line = build("Station,km,Arrival,Departure\nA,1,,23:58:30\nB,4,00:01:40,00:02:10\nC,9,00:06:10,\n")
    assert line.document["line"]["stations"] == [
        {"name": "A", "position_m": 0},
        {"name": "B", "position_m": 3000, "arrival_s": 190, "dwell_s": 30},
        {"name": "C", "position_m": 8000, "arrival_s": 460},
    ]
    assert (line.travel_time_s, line.line.length_m) == (460, 8000)
    assert "s.csv: row 4, 'C', gives timetable.travel_time_s = 460 s, its arrival." in line.sentences
    assert "s.csv: the run lies between A and C, the first and the last of it (else --begin, --end)." in line.sentences


@pytest.mark.parametrize(
    "text",
    [
        "name;km;arrival_s;dwell_s\nA;0;;\nB;3,5;200;30\nC;10;500;\n",
        "name,km,arrival (min),dwell (s)\nA,0,0,\nB,3.5,3.3333333333,30\nC,10,8.3333333333,\n",
        "Name,Position [m],Ankunft,Abfahrt\nA,0,,10:00:00\nB,3500,10:03:20,10:03:50\nC,10000,10:08:20,\n",
        "stop_name,km,arrival,departure\nA,0,,11:58:00 AM\nB,3.5,12:01:20 PM,12:01:50 PM\nC,10,12:06:20 PM,\n",
        "name,km,dwell,departure\nA,0,,1:00:00\nB,3.5,30 s,1:03:50\nC,10,0,1:08:20\n",
        "station,km,arrival,departure\nA,0,,2026-01-31 23:59:00\nB,3.5,2026-02-01 00:02:20,2026-02-01 00:02:50\n"
        "C,10,2026-02-01 00:07:20,\n",
    ],
)
def test_one_timetable_in_six_notations(text):
    stations = build_stations(text)
    assert [(one["name"], one["position_m"]) for one in stations] == [("A", 0), ("B", 3500), ("C", 10000)]
    assert (stations[1]["arrival_s"], stations[1]["dwell_s"]) == (pytest.approx(200), 30)
    assert build(text).travel_time_s == pytest.approx(500)


def test_windows_are_kept_and_the_latest_arrival_at_the_terminus_is_the_travel_time():
    text = (
        "name,km,earliest arrival [s],latest arrival [s],latest departure [s]\nA,0,,,\nB,4,180,200,250\nC,10,400,500,\n"
    )
    line = build(text)
    window = {"earliest_arrival_s": 180, "latest_arrival_s": 200}
    assert line.document["line"]["stations"][1] == {"name": "B", "position_m": 4000, **window}
    assert line.document["line"]["stations"][2]["latest_arrival_s"] == 500
    assert line.travel_time_s == 500
    assert any("latest departure" in one for one in line.unused)


def test_a_run_in_falling_chainage_counts_from_its_own_departure():
    text = "name,km,arrival,departure\nC,10,,8:00\nB,4,8:06,8:07\nA,0,8:12,\n"
    line = build(text, reverse=True)
    assert [(one["name"], one["position_m"]) for one in line.document["line"]["stations"]] == [
        *[("C", 0), ("B", 6000), ("A", 10000)]
    ]
    assert line.document["line"]["stations"][1]["arrival_s"] == 360
    assert line.travel_time_s == 720
    with pytest.raises(
        ScenarioError, match=r"by its times the train runs in falling chainage; run it so, as --reverse"
    ):
        build(text)


def test_what_the_ends_cannot_have_is_not_used_with_a_word():
    line = build("name,km,dwell (s)\nA,0,20\nB,5,30\nC,10,40\n")
    assert line.document["line"]["stations"] == [
        {"name": "A", "position_m": 0},
        {"name": "B", "position_m": 5000, "dwell_s": 30},
        {"name": "C", "position_m": 10000},
    ]
    assert line.travel_time_s is None
    assert "s.csv: row 2, 'A', where the run begins: dwell." in line.unused
    assert "s.csv: row 4, 'C', where the run ends: dwell." in line.unused


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (
            "name,arrival\nA,1\n",
            "no column contains the position of each station; name it, as stations.position=COLUMN",
        ),
        ("name,km,departure\nA,0,8:00\nB,5,8:05\nC,10,8:10\n", "row 3, 'B', has a departure only; write its arrival"),
        (
            "name,km,arrival,departure,dwell (s)\nA,0,,8:00:00,\nB,5,8:05:00,8:05:50,20\nC,10,8:10:00,,\n",
            "row 3, 'B', stands for 50 s from arrival to departure, but has a dwell time of 20 s; leave out one",
        ),
        (
            "name,km,arrival,departure\nA,0,,8:00\nB,5,7:55,8:06\nC,10,8:10,\n",
            "'B', has an earlier arrival than the time",
        ),
        ("name,km,dwell\nA,0,\nB,5,0:30\n", "row 3: dwell = '0:30' may be minutes or hours; write 0:00:30"),
        ("name,km,arrival\nA,0,\nB,5,8:05\n", "row 2, 'A', where the run begins, has no departure; write it."),
        (
            "name,km,arrival,latest (s)\nA,0,8:00,\nB,5,8:05,900\n",
            "'arrival' has times of a day and 'latest (s)' has not",
        ),
        (
            "name,km,arrival (fortnights)\nA,0,\nB,5,3\n",
            "'fortnights', which is not understood; name the unit, as",
        ),
        ("name,km,arrival\nA,0,0\nB,5,nearly\n", "row 3: arrival = 'nearly' must be a number"),
    ],
)
def test_what_is_in_doubt_is_refused_in_one_sentence(text, sentence):
    with pytest.raises(ScenarioError, match=r"^s\.csv.*" + re.escape(sentence)):
        build(text)


def test_minutes_that_count_as_seconds_are_asked_about():
    """5 km in 4 s are 4500 km/h."""
    with pytest.raises(UnitError, match=r"from row 2 to row 3 a train has 4 s for 5,000 m; .* stations.value_unit=min"):
        build("name,km,arrival,departure\nA,0,,0\nB,5,4,5\nC,10,9,\n")
    line = build("name,km,arrival,departure\nA,0,,0\nB,5,4,5\nC,10,9,\n", value_unit="min")
    assert (line.document["line"]["stations"][1]["arrival_s"], line.travel_time_s) == (240, 540)


def test_columns_are_named_by_the_user():
    text = "a,b,c,d\nA,0,,8:00\nB,5,8:05,\n"
    columns = {"name": "a", "position": "b", "arrival": "c", "departure": "d"}
    assert build(text, columns=columns, position_unit="km").travel_time_s == 300


def test_a_line_of_tables_takes_a_table_of_stations():
    gradients = pd.DataFrame({"from [m]": [0], "to [m]": [3000], "gradient [permille]": [5]})
    stations = pd.DataFrame({"name": ["A", "B"], "position [m]": [500, 2500], "arrival [s]": [0.0, 150.0]})
    sentences = (r"gives timetable.travel_time_s = 150 s, its arrival", r"the run lies between A and B")
    with pytest.warns(UserWarning, match=sentences[0]), pytest.warns(UserWarning, match=sentences[1]):
        line = rj.Line.from_tables(gradients=gradients, stations=stations)
    assert line.length_m == 2000
    assert [(one.name, one.position_m, one.arrival_s) for one in line.stations] == [("A", 0, None), ("B", 2000, 150)]


def test_stations_of_a_program_are_kept_at_the_ends():
    gradients = pd.DataFrame({"from [m]": [0], "to [m]": [3000], "gradient [permille]": [5]})
    stations = [
        rj.Station(position_m=0),
        rj.Station(position_m=3000, latest_arrival_s=200),
        rj.Station(position_m=4000),
    ]
    with pytest.warns(UserWarning, match="stations outside 0 to 3,000 m: at 4,000 m"):
        line = rj.Line.from_tables(gradients=gradients, stations=stations)
    assert [(one.position_m, one.latest_arrival_s) for one in line.stations] == [(0, None), (3000, 200)]
