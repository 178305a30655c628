import json
import math
import re
import tomllib
from pathlib import Path

import openpyxl
from commands import complaint

from railjoule.core.scenario import load_scenario
from railjoule.core.strategies import prepare_task
from railjoule.dashboard.command.cli import BAD_INPUT, OK, main

FILES = Path(__file__).parents[2] / "core" / "imports" / "files"


def imported(capsys, *words):
    """Run an import that must succeed; return what it printed and what it told."""
    status = main(("import", *map(str, words)))
    captured = capsys.readouterr()
    assert status == OK, captured.err
    return captured.out, captured.err.splitlines()


def refusal(capsys, *words):
    """Run an import that must fail; return its one sentence."""
    return complaint(capsys, "import", *map(str, words))


# ---- intervals


def test_a_line_of_a_file_becomes_a_scenario_on_the_way(capsys, tmp_path):
    line = tmp_path / "line.toml"
    imported(capsys, *limits_with(target=line))
    sets = ("--set", "vehicle.preset=metro-81-7036", "timetable.average_speed_kmh=35")
    assert main(("solve", str(line), *sets)) == OK


def test_tables_become_a_line(capsys, tmp_path):
    target = tmp_path / "line.toml"
    names = (f"--{kind}={FILES / kind}.csv" for kind in ("gradients", "limits", "curves"))
    out, told = imported(capsys, "intervals", *names, "--name", "Example", "-o", target)
    assert out == f"{target}: 1.50 km, 6 sections\n"
    assert told == ["limits.csv: no unit is named for 'from': taken as m."]
    line = tomllib.loads(target.read_text())["line"]
    assert (line["name"], len(line["sections"])) == ("Example", 6)


def limits_with(*words, target):
    """Return the words of an import of the limits with others."""
    return ("intervals", "--limits", FILES / "limits.csv", *words, "-o", target)


def test_a_line_with_a_vehicle_is_a_scenario(capsys, tmp_path):
    target = tmp_path / "scenario.toml"
    words = ("--vehicle", "metro-81-7036", "--travel-time-s", "150", "--name", "Example")
    out, _ = imported(capsys, *limits_with(*words, target=target))
    assert out == f"{target}: 1.50 km, 2 sections, 150.0 s\n"
    scenario = load_scenario(target)
    assert scenario.title == "Example, Metro 81-7036, 5 cars"
    assert (scenario.vehicle.preset, scenario.travel_time_s) == ("metro-81-7036", 150)


def test_a_vehicle_may_be_a_file_and_its_time_found(capsys, tmp_path):
    train, target = tmp_path / "train.toml", tmp_path / "scenario.toml"
    train.write_text('[vehicle]\npreset = "metro-81-7036"\nload_factor = 1.0\n[drive]\nrecuperation_factor = 0.3\n')
    _, told = imported(capsys, *limits_with("--vehicle", train, target=target))
    scenario = load_scenario(target)
    assert (scenario.vehicle.load_factor, scenario.vehicle.drive.recuperation_factor) == (1.0, 0.3)
    assert scenario.travel_time_s == math.ceil(1.1 * prepare_task(scenario).shortest_travel_time_s)
    assert told[-1].startswith(f"no --travel-time-s: {scenario.travel_time_s:g} s, 10 % above the shortest possible")


def test_presets_rows_and_direction(capsys, tmp_path):
    target = tmp_path / "line.toml"
    words = (
        "--gradients",
        FILES / "sncf-gradients.csv",
        "--preset",
        "sncf-gradients",
        "--rows",
        "gradients.NOM_VOIE=V1",
    )
    out, told = imported(capsys, "intervals", *words, "--begin", "12.4km", "--end", "13+400", "--reverse", "-o", target)
    assert out.endswith(": 1.00 km, 2 sections\n")
    assert [row["gradient_permille"] for row in tomllib.loads(target.read_text())["line"]["sections"]] == [4, -2.5]
    assert "not used: sncf-gradients.csv: 1 row not of NOM_VOIE = V1." in told
    assert "not used: sncf-gradients.csv: columns not used: LIB_LIGNE." in told


def test_columns_and_units_are_named(capsys, tmp_path):
    (tmp_path / "t.csv").write_text("a;b;c\n1;2;0,5\n")
    columns = ("gradients.from=a", "gradients.to=b", "gradients.value=c", "gradients.position_unit=km")
    words = ("--gradients", tmp_path / "t.csv", "--columns", *columns, "gradients.value_unit=percent")
    imported(capsys, "intervals", *words, "-o", tmp_path / "line.toml")
    line = tomllib.loads((tmp_path / "line.toml").read_text())["line"]
    assert line["sections"] == [{"length_m": 1000, "gradient_permille": 5}]


def test_a_files_control_characters_do_not_reach_the_terminal(capsys, tmp_path):
    (tmp_path / "t.csv").write_text("from_m,to_m,limit,\x1b[31mred\n0,100,60,x\n")
    _, told = imported(capsys, "intervals", "--limits", tmp_path / "t.csv", "-o", tmp_path / "line.toml")
    assert any("red" in line for line in told)
    assert not any("\x1b" in line for line in told)


def test_a_line_is_not_written_while_one_of_its_files_is_refused(capsys, tmp_path):
    (tmp_path / "g.csv").write_text("from_m,to_m,gradient,track\n0,500,abc,1\n0,500,2,2\n")
    words = ("--limits", FILES / "limits.csv", "--gradients", tmp_path / "g.csv", "-o", tmp_path / "line.toml")
    assert refusal(capsys, "intervals", *words).startswith("g.csv: its rows are of several track: 1, 2; choose one")
    told = refusal(capsys, "intervals", *words, "--rows", "gradients.track=1")
    assert told == "g.csv, row 2: gradient = 'abc' must be a number."
    assert not (tmp_path / "line.toml").exists()
    _, told = imported(capsys, "intervals", "--limits", FILES / "limits.csv", "-o", tmp_path / "line.toml")
    assert "limits.csv: no gradients are given: a level line." in told


def test_a_code_page_is_found_or_named(capsys, tmp_path):
    file, target = tmp_path / "g.csv", tmp_path / "line.toml"
    file.write_bytes("Початок, км;Кінець, км;Ухил, \u2030\n0;0,5;3,5\n".encode("cp1251"))
    for words in ((), ("--encoding", "cp1251")):
        out, told = imported(capsys, "intervals", "--gradients", file, *words, "-o", target)
        assert out.endswith(": 0.50 km, 1 section\n")
        assert [line for line in told if "not UTF-8" in line][: not words] == told[: not words]


def test_a_code_page_is_told_where_a_file_is_refused(capsys, tmp_path):
    """field.md, fault 5: headings nobody has written, and no word of how they were read."""
    file = tmp_path / "g.csv"
    file.write_bytes("d\u00e9but,fin,\u00e9l\u00e9vation\n0,1,2\n".encode("cp1252"))
    told = refusal(capsys, "intervals", "--gradients", file, "-o", tmp_path / "line.toml")
    assert told.endswith(
        " Not UTF-8, and so read as Windows-1252; if that is wrong name another, as --encoding cp1251."
    )
    file.write_bytes("Rep\u00e8re,fin,gradient\n0,1,2\n".encode("cp1252"))
    told = refusal(capsys, "intervals", "--gradients", file, "--encoding", "klingon", "-o", tmp_path / "line.toml")
    assert told.startswith("--encoding 'klingon' is no code page; name one, such as ")


# ---- ttobench

TTOBENCH = ("ttobench", FILES / "ttobench-track.json", "--train", FILES / "ttobench-train.json")
JOURNEY = ("--journey", FILES / "ttobench-journey.json")


def test_a_track_and_a_train_become_a_scenario(capsys, tmp_path):
    target = tmp_path / "scenario.toml"
    out, told = imported(capsys, *TTOBENCH, *JOURNEY, "-o", target)
    assert out == f"{target}: 5.00 km, 9 sections, 1 station, 360.0 s\n"
    assert "not used: ttobench-train.json: num seats." in told
    assert main(("solve", str(target), "--json")) == OK
    # to the bound for every driving
    assert 0 <= json.loads(capsys.readouterr().out)["gap"] < 1e-4


def test_without_a_time_some_slack_is_assumed_and_told(capsys, tmp_path):
    target = tmp_path / "scenario.toml"
    _, told = imported(capsys, *TTOBENCH, "--stops", "ends", "-o", target)
    (sentence,) = [line for line in told if line.startswith("no journey and no --travel-time-s: ")]
    time, shortest = (float(part) for part in re.findall(r"([\d.]+) s[, .]", sentence))
    assert time == math.ceil(1.1 * shortest)
    assert tomllib.loads(target.read_text())["timetable"] == {"travel_time_s": time}
    assert f"# {sentence}" in target.read_text()


def test_a_table_of_sections_holds_no_neutral_ones(capsys, tmp_path):
    (tmp_path / "neutral.csv").write_text("from,to\n100,200\n")
    words = ("--limits", FILES / "limits.csv", "--neutral", tmp_path / "neutral.csv")
    _, told = imported(capsys, "intervals", *words, "-o", tmp_path / "line.csv")
    assert "not used: line.csv: it contains only sections, no neutral ones." in told
    _, told = imported(capsys, "intervals", *words, "-o", tmp_path / "line.toml")
    assert "neutral" not in told


# ---- osrd and measured runs


def test_a_rolling_stock_becomes_a_vehicle(capsys, tmp_path):
    target = tmp_path / "vehicle.toml"
    out, told = imported(capsys, "osrd-stock", FILES / "osrd-stock.json", "-o", target)
    assert out == f"{target}: example, 200.0 t, 144.0 km/h\n"
    assert "not used: osrd-stock.json: modes not read: 1500V." in told
    assert tomllib.loads(target.read_text())["vehicle"]["length_m"] == 100


def test_a_recorders_table_becomes_one_of_ours(capsys, tmp_path):
    target = tmp_path / "run.csv"
    out, told = imported(capsys, "run", FILES / "run.csv", "-o", target)
    assert out == f"{target}: 0.00 km in 3.0 s, 4 rows\n"
    assert "run.csv: Columns not used: Door." in told
    imported(capsys, "run", FILES / "run.csv", "--columns", "speed=Velocity (km/h)", "-o", target)
    imported(
        capsys,
        "run",
        FILES / "run.csv",
        "--column",
        "speed=velocity (km/h) [m/s]",
        "--unit",
        "time=clock",
        "-o",
        target,
    )
    imported(capsys, "run", FILES / "run.csv", "--columns", "brake_pressure=Counter (kWh) [bar]", "-o", target)
    assert target.read_text().splitlines()[0].endswith(",brake_pressure_kpa")


def test_one_of_several_is_named(capsys, tmp_path):
    book = openpyxl.Workbook()
    book.active.title = "Monday"
    for sheet in (book.active, book.create_sheet("Tuesday")):
        for row in [["time_s", "speed_kmh"], [0, 0], [10, 36]]:
            sheet.append(row)
    book.save(tmp_path / "runs.xlsx")
    target = tmp_path / "run.csv"
    words = ("run", tmp_path / "runs.xlsx", "-o", target)
    assert refusal(capsys, *words) == "runs.xlsx: holds 2 sheets, Monday, Tuesday; choose one sheet by its name."
    assert refusal(capsys, *words, "--sheet", "Sunday") == (
        "runs.xlsx: sheet = 'Sunday' must be one of Monday, Tuesday."
    )
    # the mean of 0 and 10 m/s for 10 s
    assert imported(capsys, *words, "--sheet", "Tuesday")[0] == f"{target}: 0.05 km in 10.0 s, 2 rows\n"
    path = ("railtoolkit", FILES / "railtoolkit-path.yaml", "-o", tmp_path / "line.toml")
    assert refusal(capsys, *path) == (
        "railtoolkit-path.yaml: holds 2 paths, example, other; choose one path by its name."
    )
    assert imported(capsys, *path, "--path", "other")[0].endswith(": 0.50 km, 1 section\n")
    stocks = [{**json.loads((FILES / "osrd-stock.json").read_text()), "name": name} for name in ("light", "heavy")]
    (tmp_path / "stocks.json").write_text(json.dumps(stocks))
    stock = ("osrd-stock", tmp_path / "stocks.json", "-o", tmp_path / "vehicle.toml")
    assert refusal(capsys, *stock) == "stocks.json: holds 2 trains, light, heavy; choose one train by its name."
    assert imported(capsys, *stock, "--train", "heavy")[0].endswith("heavy, 200.0 t, 144.0 km/h\n")


# ---- railtoolkit


def test_files_of_railtoolkit_become_vehicles_and_lines(capsys, tmp_path):
    target = tmp_path / "out.toml"
    out, _ = imported(capsys, "railtoolkit", FILES / "railtoolkit-train.yaml", "-o", target)
    assert out == f"{target}: Example, 160.0 t, 140.0 km/h\n"
    out, notes = imported(capsys, "railtoolkit", FILES / "railtoolkit-path.yaml", "--id", "other", "-o", target)
    assert out == f"{target}: 0.50 km, 1 section\n"
    assert "not used: railtoolkit-path.yaml: paths not read: example." in notes


def test_a_data_sheet_becomes_a_vehicle_and_its_assumptions_are_weighed(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    sheet = (
        "mass_t=60",
        "power_kw=800",
        "max_acceleration_ms2=0,9",
        "max_speed_kmh=120",
        "length_m=41",
        "name=Own car",
    )
    assert main(["import", "data-sheet", *sheet, "regenerative=false", "-o", "car.toml"]) == OK
    printed = capsys.readouterr()
    assert printed.out == "car.toml: Own car, 60.0 t, 120.0 km/h\n"
    assert "vehicle.rotating_mass_factor = 0.1: TTOBench, Stadler FLIRT." in printed.err
    line = ("--set", "line.preset=flat-5km", "timetable.travel_time_s=320")
    assert main(["study", "assumptions", "car.toml", "-o", "effects.csv", *line]) == OK
    shown = capsys.readouterr().out
    assert "resistance.constant_n_per_kn" in shown
    assert shown.endswith("assumptions\n")
    assert (tmp_path / "effects.csv").read_text(encoding="utf-8").startswith("assumption,")
    assert main(["import", "data-sheet", "mass_t", "-o", "car.toml"]) == BAD_INPUT
    assert "KEY=VALUE mass_t: must be KEY=VALUE, such as mass_t=120." in capsys.readouterr().err
    assert main(["import", "data-sheet", *sheet, "colour=1", "-o", "car.toml"]) == BAD_INPUT
    assert "data sheet: unknown key colour" in capsys.readouterr().err
    assert main(["study", "assumptions", "ftorek-300s", "-o", "effects.csv"]) == BAD_INPUT
    assert "nothing of the vehicle is assumed" in capsys.readouterr().err


def test_a_shipped_vehicle_without_a_file_runs_in_its_scenario(capsys):
    assert main(["solve", "--strategy", "fastest", "--set", "vehicle.preset=light-rail-sd160"]) == OK
    assert capsys.readouterr().out.startswith("Light rail, seven stations: Fastest")
    assert main(["solve", "--set", "vehicle.preset=light-rail"]) == BAD_INPUT
    assert "there is no preset 'light-rail' among the vehicles" in capsys.readouterr().err


# ---- a workbook, stations, heights, GPX


def test_one_workbook_becomes_a_scenario(capsys, tmp_path):
    book = openpyxl.Workbook()
    book.active.title = "Slopes"
    for row in (["from_m", "to_m", "gradient (%)"], [0, 1000, 0.5], [1000, 2000, -0.5]):
        book.active.append(row)
    stops = book.create_sheet("Stops")
    for row in (
        ["Station", "position (m)", "arrival", "departure"],
        ["A", 0, None, "9:58:30"],
        ["B", 2000, "10:01:00", None],
    ):
        stops.append(row)
    book.create_sheet("Remarks").append(["none"])
    book.save(tmp_path / "line.xlsx")
    target = tmp_path / "s.toml"
    out, notes = imported(capsys, "intervals", tmp_path / "line.xlsx", "--vehicle", "metro-81-7036", "-o", target)
    assert out == f"{target}: 2.00 km, 2 sections, 2 stations, 150.0 s\n"
    assert "line.xlsx, Stops: row 3, 'B', gives timetable.travel_time_s = 150 s, its arrival." in notes
    assert "not used: line.xlsx: sheets not read: Remarks." in notes
    scenario = load_scenario(target)
    assert scenario.travel_time_s == 150
    assert [one.name for one in scenario.line.stations] == ["A", "B"]
    assert [one.gradient_permille for one in scenario.line.sections] == [5, -5]


def test_a_line_with_the_time_of_its_stations_needs_a_vehicle_only(capsys, tmp_path):
    stations = FILES / "stations.csv"
    gradients = tmp_path / "gradients.csv"
    gradients.write_text("from_m,to_m,gradient\n0,1500,4\n")
    target = tmp_path / "line.toml"
    imported(capsys, "intervals", "--gradients", gradients, "--stations", stations, "-o", target)
    assert tomllib.loads(target.read_text())["timetable"] == {"travel_time_s": 210}
    assert main(("solve", str(target), "--set", "vehicle.preset=metro-81-7036")) == OK


def test_files_of_one_kind_exclude_each_other(capsys, tmp_path):
    limits = FILES / "limits.csv"
    assert refusal(capsys, "intervals", limits, limits, "-o", tmp_path / "a.toml") == (
        "limits.csv and limits.csv are both tables of limits; leave out one of them."
    )


def test_a_track_in_gpx_is_a_line_and_a_run(capsys, tmp_path):
    track = FILES / "track.gpx"
    out, notes = imported(capsys, "intervals", track, "-o", tmp_path / "line.toml")
    assert out.endswith(": 1.60 km, 2 sections\n")
    assert any("Douglas and Peucker" in one for one in notes)
    out, _ = imported(capsys, "run", track, "-o", tmp_path / "run.csv")
    assert out.endswith("run.csv: 1.60 km in 130.0 s, 131 rows\n")
