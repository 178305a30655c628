import io

import openpyxl
import pytest

from railjoule.core import RailjouleError, load_scenario
from railjoule.core.imports import SourceFile
from railjoule.core.measured import to_recording
from railjoule.dashboard.pages.files.columns import (
    MAX_ROWS,
    Meaning,
    RunFile,
    read_meanings,
    read_run_file,
    read_runs,
    run_sheets,
    settled,
    used_table,
)

VEHICLE = load_scenario("metro-with-limit").vehicle
"""212 t, 285 kN, 80 km/h."""


def file(header: str, *rows: str) -> RunFile:
    """Return a file; without rows it holds a short run of five columns."""
    usual = tuple(f"{k},{10 * k},36,{150 + k},900" for k in range(12))
    return read_run_file(SourceFile("run.csv", "\n".join([header, *(rows or usual)]).encode()))


def test_columns_are_known_by_their_names() -> None:
    assert read_meanings(file("time_s,position_m,speed_kmh,effort_kn,notch"), {}) == {
        "time_s": Meaning("time", "s"),
        "position_m": Meaning("position", "m"),
        "speed_kmh": Meaning("speed", "km/h"),
        "effort_kn": Meaning("effort", "kN"),
        "notch": Meaning(""),
    }


def test_the_columns_of_a_published_set_are_known() -> None:
    # Widmer, Ritter, Onder: ZTBus, whose efforts are N and speeds m/s
    names = "time_unix,odometry_vehicleSpeed,traction_tractionForce,electric_powerDemand,traction_brakePressure"
    found = read_meanings(file(names), {})
    assert found["traction_tractionForce"] == Meaning("effort", "N")
    assert found["odometry_vehicleSpeed"] == Meaning("speed", "m/s")


def test_what_a_user_says_goes_before_names() -> None:
    table = file("time_s,weg,speed_kmh,effort_kn,x")
    found = read_meanings(table, {"weg": "position m", "effort_kn": "", "x": "nonsense furlong"})
    assert found["weg"] == Meaning("position", "m")
    assert found["effort_kn"] == found["x"] == Meaning("")


def test_a_unit_that_cannot_be_is_asked_about_and_not_used_before() -> None:
    # 161 N in a train of 212 t would be an effort of nothing
    table = file("time_s,position_m,speed_kmh,effort_n,power_kw")
    _, doubts, _ = settled(table, {}, VEHICLE)
    (doubt,) = doubts
    assert doubt.sentence == "At most 161.0 N in a train of 212 t: was kN meant?"
    assert doubt.answers == (("Use kN", "effort kN"), ("Keep N", "effort N"))
    for _, answer in doubt.answers:
        found, left, _ = settled(table, {"effort_n": answer}, VEHICLE)
        assert left == ()
        assert found["effort_n"] == Meaning.of(answer)


def test_a_unit_that_is_not_named_is_assumed_where_one_alone_fits() -> None:
    found, doubts, assumed = settled(file("time_s,position_m,speed_kmh,effort,power"), {}, VEHICLE)
    assert doubts == ()
    assert found["effort"].unit == "kN"
    assert assumed == ("effort: no unit is named, taken as kN.", "power: no unit is named, taken as kW.")


def test_a_unit_that_is_not_named_is_asked_for_where_two_fit() -> None:
    # 18 are a slow train in km/h, and a usual one in m/s
    _, doubts, _ = settled(file("time_s,position_m,speed", *(f"{k},{18 * k},18" for k in range(12))), {}, VEHICLE)
    (doubt,) = doubts
    assert doubt.sentence == "At most 18.0 in a train of 212 t, and no unit is named: is it km/h or m/s?"


def test_a_line_current_and_its_voltage_are_known() -> None:
    head = "Temps (s);Vitesse (km/h);Courant ligne (A);Tension cat\u00e9naire (V)"
    found, doubts, _ = settled(file(head, *(f"{k};{3 * k};{100 * k};750" for k in range(12))), {}, VEHICLE)
    assert doubts == ()
    assert found["Courant ligne (A)"] == Meaning("line_current", "A")
    assert found["Tension cat\u00e9naire (V)"] == Meaning("line_voltage", "V")


def test_plain_names_of_current_and_voltage_are_known_where_both_are_there() -> None:
    table = file("Zeit [s];v [km/h];Strom [A];Spannung [V]", *(f"{k};{3 * k};{100 * k};750" for k in range(12)))
    found, doubts, _ = settled(table, {}, VEHICLE)
    assert doubts == ()
    assert found["Strom [A]"] == Meaning("line_current", "A")
    assert found["Spannung [V]"] == Meaning("line_voltage", "V")
    alone = file("Zeit [s];v [km/h];Strom [A]", *(f"{k};{3 * k};{100 * k}" for k in range(12)))
    assert settled(alone, {}, VEHICLE)[0]["Strom [A]"] == Meaning("")


def test_a_unit_that_is_not_known_is_asked_about() -> None:
    table = file("Time [ticks],v [km/h],Weg [yd]", *(f"{k},{3 * k},{k}" for k in range(12)))
    _, doubts, _ = settled(table, {}, VEHICLE)
    assert [doubt.sentence for doubt in doubts] == [
        "The unit ticks is not known: is it s or ms?",
        "The unit yd is not known: is it m or km?",
    ]
    found, left, _ = settled(table, {"Time [ticks]": "time ms", "Weg [yd]": ""}, VEHICLE)
    assert left == ()
    assert found["Time [ticks]"] == Meaning("time", "ms")


def test_a_time_since_1970_in_milliseconds_is_read_so() -> None:
    table = file("timestamp,speed_kmh", *(f"{1743292760000 + 1000 * k},{3 * k}" for k in range(12)))
    found, doubts, assumed = settled(table, {}, VEHICLE)
    assert doubts == ()
    assert found["timestamp"] == Meaning("time", "ms")
    assert assumed == ("timestamp: read in ms, as a time since 1970.",)
    assert to_recording(*used_table(table, found)).duration_s == pytest.approx(11.0)


def test_rows_stand_in_the_lines_that_they_have_in_the_file() -> None:
    table = file("made by a program", "time_s;x;speed_kmh", *(f"{k};0;{'' if k == 5 else k}" for k in range(15)))
    cells, form = used_table(table, {"time_s": Meaning("time", "s"), "speed_kmh": Meaning("speed", "km/h")})
    assert cells.header == ("time_s", "speed_kmh")
    assert cells.rows[0] == (3, ("0", "0"))
    recording = to_recording(cells, form)
    assert len(recording.time_s) == 14
    assert "1 row without time_s or speed_kmh is left out: 8." in recording.notes


def test_each_sheet_of_a_workbook_that_names_a_speed_is_a_run() -> None:
    book = openpyxl.Workbook()
    book.active.title = "About"
    book.active.append(["made by", "a program"])
    for name in ("Monday", "Tuesday"):
        sheet = book.create_sheet(name)
        for row in [["time_s", "speed_kmh"], *([k, 3.6 * k] for k in range(12))]:
            sheet.append(row)
    written = io.BytesIO()
    book.save(written)
    found = read_runs(SourceFile("runs.xlsx", written.getvalue()))
    assert [file.name for file in found] == ["runs.xlsx, Monday", "runs.xlsx, Tuesday"]
    cells, form = used_table(found[1], read_meanings(found[1], {}))
    assert to_recording(cells, form).name == "runs.xlsx, Tuesday"
    assert "Sheets that are not read as a run: About." in to_recording(cells, form).notes
    with pytest.raises(
        RailjouleError, match=r"^runs.xlsx: none of its sheets is a table with a speed; it has About\.$"
    ):
        run_sheets(SourceFile("runs.xlsx", written.getvalue()), ("About",))


@pytest.mark.parametrize(
    ("content", "told"),
    [
        (b"", "run.csv: holds no rows."),
        (b"1,2\n3,4\n", "the first row must name the columns"),
        (b"\x00\x01\x02", "not a text file"),
        (b"PK\x03\x04junk", "not a workbook that can be read"),
        (b"time_s,time_s\n1,2\n", "appears twice"),
        (b"t,v\n" + b"1,1\n" * (MAX_ROWS + 1), "at most 20\u202f000 can be read"),
    ],
)
def test_what_is_no_run_is_told_in_one_sentence(content: bytes, told: str) -> None:
    with pytest.raises(RailjouleError) as caught:
        read_run_file(SourceFile("run.csv", content))
    assert told in str(caught.value)
    assert len(str(caught.value)) < 200
