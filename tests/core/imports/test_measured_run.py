import re
from pathlib import Path

import numpy as np
import pytest

from railjoule.core.errors import ScenarioError
from railjoule.core.imports import SourceFile
from railjoule.core.imports.measured_run import read_run

FILE = Path(__file__).parent / "files" / "run.csv"


def run_of(text, **columns):
    return read_run(SourceFile("r.csv", text.encode()), columns)


def told(run, kind):
    return [finding.sentence for finding in run.findings if finding.kind == kind]


def test_columns_and_units_of_a_recorder_are_found():
    run = read_run(SourceFile.read(FILE))
    assert run.time_s.tolist() == [0, 1, 2, 3]
    assert run.position_m == pytest.approx([0, 0.5, 2, 4.5])
    assert run.speed_ms == pytest.approx([0, 1, 2, 3])
    assert run.effort_n[:3] == pytest.approx([0, 1e5, 1e5])
    assert np.isnan(run.effort_n[3])
    assert run.line_power_w[1] == pytest.approx(140e3)
    assert run.line_energy_j == pytest.approx([0, 72e3, 288e3, 540e3])
    assert run.unused == ("run.csv: columns not used: Door.",)


def test_the_table_is_that_of_our_runs():
    columns = read_run(SourceFile.read(FILE)).to_columns()
    names = ["position_m", "time_s", "speed_kmh", "effort_kn", "line_power_kw", "line_energy_kwh"]
    assert list(columns) == names
    assert columns["line_energy_kwh"] == pytest.approx([0, 0.02, 0.08, 0.15])


def test_our_own_tables_are_read_back():
    columns = read_run(SourceFile.read(FILE)).to_columns()
    rows = [",".join(columns), *(",".join(map(str, row)) for row in zip(*columns.values(), strict=True))]
    again = run_of("\n".join(rows).replace("nan", "")).to_columns()
    for name, values in columns.items():
        assert again[name] == pytest.approx(values, nan_ok=True)
    assert told(run_of("\n".join(rows).replace("nan", "")), "assumption") == []


def test_a_published_set_is_known_by_its_columns():
    text = (
        "time_iso,time_unix,electric_powerDemand,odometry_vehicleSpeed,traction_brakePressure,traction_tractionForce\n"
        "x,1600000000,1000,0,200000,0\nx,1600000001,50000,2,0,9000\n"
    )
    run = run_of(text)
    assert run.speed_ms.tolist() == [0, 2]
    assert run.effort_n.tolist() == [0, 9000]
    assert run.brake_pressure_pa.tolist() == [200_000, 0]
    assert run.position_m.tolist() == [0, 1]  # the mean of 0 and 2 m/s for 1 s
    assert told(run, "assumption") == ["r.csv: positions follow from speeds and times."]
    assert run.unused == ("r.csv: columns not used: time_iso.",)


def test_columns_are_named_with_their_units():
    run = run_of("a,b\n0,10\n2,20\n", time="a [min]", speed="b [m/s]")
    assert (run.time_s.tolist(), run.speed_ms.tolist()) == ([0, 120], [10, 20])


def test_units_that_nobody_names_are_told():
    assert told(run_of("time,speed\n0,36\n1,36\n"), "assumption")[:2] == [
        "r.csv: no unit is named for 'time': taken as s.",
        "r.csv: no unit is named for 'speed': taken as km/h.",
    ]


def test_times_follow_from_positions_where_none_are_told():
    run = run_of("position_m,speed_ms\n0,0\n10,10\n30,10\n")
    assert run.time_s.tolist() == [0, 2, 4]


@pytest.mark.parametrize(
    ("times", "expected"),
    [
        (("23:59:59", "00:00:01"), [0, 2]),
        (("2026-01-31T10:15:30.5", "2026-01-31T10:15:31"), [0, 0.5]),
        (("2026-01-31T10:15:30Z", "2026-01-31T11:15:31+01:00"), [0, 1]),
        (("10:15", "10:16"), [0, 60]),
    ],
)
def test_clocks(times, expected):
    run = run_of(f"time,speed_kmh\n{times[0]},1\n{times[1]},1\n")
    assert run.time_s.tolist() == expected


def test_falling_positions_are_counted_from_the_first():
    run = run_of("time_s,position_km,speed_kmh\n0,12.5,0\n10,12.4,36\n20,12.3,36\n")
    assert run.position_m == pytest.approx([0, 100, 200])
    assert told(run, "order") == ["r.csv: positions fall; they are counted from the first row."]


def test_positions_that_go_back_are_told():
    run = run_of("time_s,position_m,speed_kmh\n0,0,36\n1,10,36\n2,9.5,36\n3,20,36\n")
    assert told(run, "order") == ["r.csv: the position goes back 1 time, first at 1 s; kept as measured."]


def test_rows_without_use_are_told():
    run = run_of("time_s,position_m,speed_kmh\n0,0,36\n1,10,36\n1,10,36\n2,,36\n3,30,36\n")
    assert run.time_s.tolist() == [0, 1, 3]
    assert run.unused == (
        "r.csv: 1 row without time or position or speed.",
        "r.csv: 1 row at the time of the row above.",
    )


@pytest.mark.parametrize(
    ("text", "columns", "sentence"),
    [
        ("time,x\n0,1\n1,2\n", {}, "r.csv: no column of speed was found; name it, as speed=COLUMN, of time, x."),
        ("speed,a\n0,1\n1,2\n", {}, "r.csv: no column of time or position was found; name it, as time=COLUMN, "
         "of speed, a."),
        ("time_s,speed_kmh\n0,1\n1,fast\n", {}, "r.csv, row 3: speed_kmh = 'fast' must be a number."),
        ("time_s,speed_kmh\n5,1\n1,1\n", {}, "r.csv, row 3: its time lies before that of the row above."),
        ("time_s,speed_kmh\n5,1\n", {}, "r.csv: has fewer than 2 rows with numbers."),
        ("position_m,speed_kmh\n5,0\n9,0\n", {}, "r.csv, row 3: moves on from the row above without speed."),
        ("time,speed\n25:70:99x,1\n1,2\n", {}, "r.csv, row 2: time = '25:70:99x' must be a time, as 10:15:30 or "
         "2026-01-31T10:15:30."),
        ("time,speed\n0,1\n1,2\n", {"speeds": "speed"}, "r.csv: 'speeds' must be one of time, position, speed, "
         "effort, power, energy, brake_pressure."),
        ("time,v\n0,1\n1,2\n", {"speed": "v [knots]"}, "r.csv: speed = 'v [knots]' must have one of ms, kmh, mph."),
        ("time,v\n0,1\n1,2\n", {"speed": "w"}, "r.csv: speed = 'w' is not a column of it: time, v."),
    ],
)  # fmt: skip
def test_bad_runs_are_refused_in_one_sentence(text, columns, sentence):
    with pytest.raises(ScenarioError, match=f"^{re.escape(sentence)}$"):
        run_of(text, **columns)
