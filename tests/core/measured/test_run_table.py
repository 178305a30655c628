import io
import re
from pathlib import Path

import numpy as np
import openpyxl
import pytest

from railjoule.core import RailjouleError
from railjoule.core.imports import SourceFile
from railjoule.core.measured import RecorderFormat, recorder_cells, run_table

FILES = Path(__file__).parents[1] / "imports" / "files"


def read(source, form=None, sheet=None):
    form = form or RecorderFormat()
    return run_table(recorder_cells(source, form, sheet), form)


def run_of(text, **columns):
    return read(SourceFile("r.csv", text.encode()), RecorderFormat(columns=columns))


def recorder_file():
    return read(SourceFile.read(FILES / "run.csv"))


def test_columns_and_units_of_a_recorder_are_found():
    run = recorder_file()
    assert run.columns["time_s"].tolist() == [0, 1, 2, 3]
    assert run.columns["position_m"] == pytest.approx([0, 0.5, 2, 4.5])
    assert run.columns["speed_kmh"] / 3.6 == pytest.approx([0, 1, 2, 3])
    assert run.columns["effort_kn"][:3] * 1e3 == pytest.approx([0, 1e5, 1e5])
    assert np.isnan(run.columns["effort_kn"][3] * 1e3)
    assert run.columns["line_power_kw"][1] * 1e3 == pytest.approx(140e3)
    assert run.columns["line_energy_kwh"] * 3.6e6 == pytest.approx([0, 72e3, 288e3, 540e3])
    assert "Columns not used: Door." in run.notes
    assert "Force (kN) has no value in 1 of 4 rows." in run.notes


def test_a_workbook_is_read_like_the_csv_that_it_could_be():
    """Numbers, times and empty cells as a spreadsheet program keeps them, below a title."""
    book = openpyxl.Workbook()
    book.active.append(["Recorder 17"])
    for line in (FILES / "run.csv").read_text().splitlines():
        cells = [cell.replace(",", ".") for cell in line.split(";")]
        book.active.append([float(cell) if re.fullmatch(r"[\d.]+", cell) else cell or None for cell in cells])
    written = io.BytesIO()
    book.save(written)
    found, expected = read(SourceFile("run.xlsx", written.getvalue())), recorder_file()
    for name, values in expected.columns.items():
        assert found.columns[name] == pytest.approx(values, nan_ok=True)
    assert "Row 1: 'Recorder 17' above the table." in found.notes


def test_the_table_is_that_of_our_runs():
    columns = recorder_file().columns
    names = ["position_m", "time_s", "speed_kmh", "effort_kn", "line_power_kw", "line_energy_kwh"]
    assert list(columns) == names
    assert columns["line_energy_kwh"] == pytest.approx([0, 0.02, 0.08, 0.15])


def test_our_own_tables_are_read_back():
    columns = recorder_file().columns
    rows = [",".join(columns), *(",".join(map(str, row)) for row in zip(*columns.values(), strict=True))]
    again = run_of("\n".join(rows))
    for name, values in columns.items():
        assert again.columns[name] == pytest.approx(values, nan_ok=True)
    assert not [note for note in again.notes if "No unit" in note]


def test_a_published_set_is_known_by_its_columns():
    text = (
        "time_iso,time_unix,electric_powerDemand,odometry_vehicleSpeed,traction_brakePressure,traction_tractionForce\n"
        "x,1600000000,1000,0,200000,0\nx,1600000001,50000,2,0,9000\n"
    )
    run = run_of(text)
    assert run.columns["speed_kmh"] / 3.6 == pytest.approx([0, 2])
    assert run.columns["effort_kn"] * 1e3 == pytest.approx([0, 9000])
    assert run.columns["brake_pressure_kpa"] * 1e3 == pytest.approx([200_000, 0])
    assert run.columns["position_m"].tolist() == [0, 1]  # the mean of 0 and 2 m/s for 1 s
    assert run.notes == ("Columns not used: time_iso.", "Positions follow from speeds and times.")


def test_the_run_of_a_simulation_of_osrd():
    run = read(SourceFile.read(FILES / "osrd-run.csv"), RecorderFormat("osrd"))
    assert run.columns["time_s"].tolist() == [0, 20, 45, 50, 70, 120, 150, 240.5]
    assert run.columns["position_m"].tolist() == [0, 100, 500, 600, 1000, 1500, 1500, 2500]
    assert run.columns["speed_kmh"][1:3] / 3.6 == pytest.approx([10, 20])
    assert "1 row at the time of the row above: left out." in run.notes
    assert (
        read(SourceFile.read(FILES / "osrd-run.csv")).columns["position_m"].tolist()
        == run.columns["position_m"].tolist()
    )


def test_columns_are_named_with_their_units():
    run = run_of("a,b\n0,10\n2,20\n", time="a [min]", speed="b [m/s]")
    assert run.columns["time_s"].tolist() == [0, 120]
    assert run.columns["speed_kmh"].tolist() == pytest.approx([36, 72])


@pytest.mark.parametrize(
    ("head", "row", "column", "value"),
    [
        ("t,v_mph", "0,100", "speed_kmh", 160.9344),
        ("t,v_kmh,x_mi", "0,1,0", "position_m", 0),
        ("t,v_kmh,power_mw", "0,1,1.5", "line_power_kw", 1500),
        ("t,v_kmh,brake_pressure_bar", "0,1,5", "brake_pressure_kpa", 500),
        ("t,v_kmh,brake", "0,1,1", "brake_applied", 1),
        ("Zeit (s);Geschwindigkeit (km/h);Zugkraft (kN);Bremskraft (kN)", "0;1;0;70,5", "effort_kn", -70.5),
        ("Horodatage;Vitesse (km/h);Effort de traction (kN)", "31/01/2026 10:15:30;1;12,5", "effort_kn", 12.5),
        ("Temps (s);Vitesse (km/h);PK (km)", "0;1;012+345", "position_m", 0),
    ],
)
def test_units_and_names_of_other_languages(head, row, column, value):
    later = row.replace("10:15:30", "10:15:31") if ":" in row else f"1{row[1:]}"
    columns = run_of(f"{head}\n{row}\n{later}\n").columns
    assert columns[column][0] == pytest.approx(value)
    assert columns["time_s"].tolist() == [0, 1]


def test_units_that_nobody_names_are_told():
    assert run_of("time,speed\n0,36\n1,36\n").notes[:2] == (
        "No unit is named for 'time': taken as s.",
        "No unit is named for 'speed': taken as km/h.",
    )


def test_current_times_voltage_is_the_power_where_nothing_else_tells_it():
    text = "t,v_kmh,Line current (A),Line voltage (V)\n0,0,0,750\n1,10,400,700\n2,10,-100,800\n"
    run = run_of(text)
    assert run.columns["line_power_kw"] * 1e3 == pytest.approx([0, 280e3, -80e3])
    assert run.notes[-1] == (
        "The electric power is the line current times the line voltage; regenerated current counts as negative."
    )
    assert run.columns["line_current_a"].tolist() == [0, 400, -100]
    with_power = run_of(text.replace("Line voltage (V)", "power_w"))
    assert with_power.columns["line_power_kw"] * 1e3 == pytest.approx([750, 700, 800])


def test_times_follow_from_positions_where_none_are_told():
    assert run_of("position_m,speed_ms\n0,0\n10,10\n30,10\n").columns["time_s"].tolist() == [0, 2, 4]


@pytest.mark.parametrize(
    ("times", "expected"),
    [
        (("23:59:59", "00:00:01"), [0, 2]),
        (("2026-01-31T10:15:30.5", "2026-01-31T10:15:31"), [0, 0.5]),
        (("2026-01-31T10:15:30Z", "2026-01-31T11:15:31+01:00"), [0, 1]),
        (("10:15", "10:16"), [0, 60]),
        (("31/01/2026 23:59:59", "01/02/2026 00:00:01"), [0, 2]),
        (("01/31/2026 10:15:30", "01/31/2026 10:15:31"), [0, 1]),
    ],
)
def test_clocks(times, expected):
    assert run_of(f"time,speed_kmh\n{times[0]},1\n{times[1]},1\n").columns["time_s"].tolist() == expected


def test_falling_positions_are_counted_from_the_first():
    run = run_of("time_s,position_km,speed_kmh\n0,12.5,0\n10,12.4,36\n20,12.3,36\n")
    assert run.columns["position_m"] == pytest.approx([0, 100, 200])
    assert run.notes == ("Positions fall: the train runs in falling chainage, counted from the first row.",)


def test_what_goes_back_is_told_and_kept():
    run = run_of("time_s,position_m,speed_kmh\n0,0,36\n1,10,36\n2,9.5,-3\n3,20,36\n")
    assert "The position goes back 1 time, first at 1 s; kept as measured." in run.notes
    assert "The speed is negative in 1 row, first speed_kmh = -3 km/h in row 4; kept as measured." in run.notes
    assert run.columns["speed_kmh"][2] / 3.6 == pytest.approx(-3 / 3.6)


def test_rows_without_use_are_told():
    run = run_of("time_s,position_m,speed_kmh\n0,0,36\n1,10,36\n1,10,36\n2,,36\n3,30,36\n")
    assert run.columns["time_s"].tolist() == [0, 1, 3]
    assert run.notes == (
        "1 row without time_s or position_m or speed_kmh is left out: 5.",
        "1 row at the time of the row above: left out.",
    )


def test_a_file_that_mixes_its_decimal_signs_is_read_column_by_column():
    run = run_of("time_s;position_m;speed_kmh\n0;0,0;0.5\n1;0,25;1.5\n")
    assert run.columns["position_m"].tolist() == [0, 0.25]
    assert run.columns["speed_kmh"] / 3.6 * 3.6 == pytest.approx([0.5, 1.5])


@pytest.mark.parametrize(
    ("text", "columns", "sentence"),
    [
        ("time,x\n0,1\n1,2\n", {}, "r.csv: no column holds the speed; the file has time, x. Name it by --column "
         "speed=NAME."),
        ("speed,a\n0,1\n1,2\n", {}, "r.csv: no column holds the time or position; the file has speed, a. Name it by "
         "--column time=NAME."),
        ("time_s,speed_kmh\n0,1\n1,fast\n", {}, "r.csv, row 3: speed_kmh = 'fast' must be a number."),
        ("time_s,speed_kmh\n5,1\n1,1\n", {}, "r.csv: time_s = 1 s in row 3 must be at least that of the row before, "
         "5 s in row 2: the rows are not in order, or the recorder was reset."),
        ("time_s,speed_kmh\n5,1\n", {}, "r.csv: has fewer than 2 rows with numbers."),
        ("position_m,speed_kmh\n5,0\n9,0\n", {}, "r.csv: speed_kmh = 0 km/h in row 3 and in the row before, but the "
         "position changes: without a column of time it is not known how long that took."),
        ("time,speed\n25:70:99x,1\n1,2\n", {}, "r.csv, row 2: time = '25:70:99x' must be a time, as 10:15:30, 10:15:30 "
         "PM or 2026-01-31T10:15:30."),
        ("time,speed\n0,1\n1,2\n", {"speeds": "speed"}, "--column speeds: must be one of time, position, speed, "
         "effort, tractive_effort, braking_effort, brake, power, energy, line_current, line_voltage."),
        ("time,v\n0,1\n1,2\n", {"speed": "v [knots]"}, "r.csv: speed = 'v [knots]': the unit must be one of km/h, m/s, "
         "mph."),
        ("time,v\n0,1\n1,2\n", {"speed": "w"}, "r.csv: there is no column 'w' for speed; the file has time, v."),
    ],
)  # fmt: skip
def test_bad_runs_are_refused_in_one_sentence(text, columns, sentence):
    with pytest.raises(RailjouleError, match=f"^{re.escape(sentence)}$"):
        run_of(text, **columns)
