import json
import re
from pathlib import Path

import numpy as np
import pytest
import xarray
from commands import answer, complaint
from validated import validate_once

from railjoule.core import Check, CheckResult, load_scenario, save_scenario, solve
from railjoule.core.validation import PAPERS
from railjoule.core.validation import benchmark as core_benchmark
from railjoule.core.validation.benchmark import Timing
from railjoule.dashboard.command import commands
from railjoule.dashboard.command.cli import BAD_INPUT, BROKEN_RULE, OK, main

SHORTEST_TIME_S = 76.9
"""Of liashenko-ii; guards against change only."""
CLOSED_LOOP_KEYS = {
    *("planned", "actual", "overconsumption", "stop_error_m", "delay_s", "energy_by_input_power_kwh"),
    *("energy_by_parts_kwh", "magnetising_loss_kwh", "max_tracking_error_m", "max_current_a", "max_phase_voltage_v"),
}
"""What the design promises of a simulation in closed loop."""


def test_solve_prints_json(capsys):
    result = json.loads(answer(capsys, "solve", "liashenko-ii", "--json"))
    run = solve(load_scenario("liashenko-ii"))
    assert result["energy_kwh"] == run.energy_kwh
    assert result["lower_bound_kwh"] == run.lower_bound_kwh
    assert result["shortest_time_s"] == pytest.approx(SHORTEST_TIME_S, abs=0.1)


def test_advise_prints_what_few_orders_cost(capsys):
    found = json.loads(answer(capsys, "advise", "liashenko-ii", "--json"))
    (run,) = found["runs"]
    # power, coast, brake: the optimum of this profile has no more
    assert run["changes"] == found["changes"] == 2
    # these runs are over the mesh of the scenario, the optimum is over a finer one
    assert run["price_kwh"] == pytest.approx(0, abs=1e-3)
    assert [order["action"] for order in found["advice"]] == ["full_power", "coast", "brake"]


def test_advise_prints_one_order_a_line(capsys):
    text = answer(capsys, "advise", "liashenko-ii")
    assert "changes" in text
    assert "  3. brake fully from" in text


def test_solve_proves_for_as_long_as_it_is_told(capsys):
    first, usual = (
        json.loads(answer(capsys, "solve", "tram-950m-recuperating", "--strategy", "optimal", *given, "--json"))
        for given in (("--prove-seconds", "0"), ())
    )
    assert first["energy_kwh"] == usual["energy_kwh"]
    assert first["gap"] > usual["gap"]
    assert (first["bound_covers"], usual["bound_covers"]) == ("every run", "runs over this mesh")
    assert first["lower_bound_kwh"] == usual["every_run_lower_bound_kwh"] < usual["lower_bound_kwh"]


def test_solve_prints_words(capsys):
    text = answer(capsys, "solve", "liashenko-ii")
    assert text.startswith("Metro, profile II: Optimal\n1.30 km in 133.7 s, at most 46.1 km/h\n")
    assert "2.223 kWh from the supply, proven optimal, 0.01 % above the bound" in text
    assert "133.7 s; shortest possible 76.9 s, timetable 133.7 s: slack 56.8 s (73.8 %)" in text
    assert "full power to 27.6 km/h, coast from 24 m, brake fully from 1,278 m to a stop" in text
    assert "would save" in text
    assert "iterations" in text


def test_solve_tells_how_far_a_strategy_is_from_the_best(capsys):
    text = answer(capsys, "solve", "ftorek-300s", "--strategy", "enoc")
    assert "1.7 % above the optimum of 4.181 kWh" in text
    assert "Extra second" not in text
    assert "ENOC accelerates and brakes for 31.0 s each" in text


def test_the_strategy_of_the_command_goes_before_the_scenarios(capsys):
    words = ("solve", "ftorek-300s", "--set", "strategy=enoc", "--json")
    assert json.loads(answer(capsys, *words))["strategy"] == "enoc"
    assert json.loads(answer(capsys, *words, "--strategy", "fastest"))["strategy"] == "fastest"


def test_the_fastest_run_needs_no_timetable_that_can_be_kept(capsys):
    words = ("solve", "liashenko-ii", "--strategy", "fastest", "--set", "timetable.travel_time_s=10")
    result = json.loads(answer(capsys, *words, "--json"))
    assert result["gap"] is None
    assert result["travel_time_s"] == pytest.approx(SHORTEST_TIME_S, abs=0.1)
    assert "no bound known" in answer(capsys, *words)


def test_a_trajectory_becomes_csv(capsys, tmp_path):
    file = tmp_path / "run.csv"
    result = json.loads(answer(capsys, "solve", "liashenko-ii", "--json", "--trajectory", str(file)))
    header, *rows = file.read_text().splitlines()
    assert header.split(",")[:3] == ["position_m", "time_s", "speed_kmh"]
    assert len(rows) == result["cells"] + 1 == 300
    assert np.array(rows[-1].split(","), dtype=float)[1] == pytest.approx(result["travel_time_s"])


def test_a_trajectory_becomes_parquet(capsys, tmp_path):
    pytest.importorskip("pyarrow", reason="pyarrow is not installed, so there is no parquet to write")
    import pandas as pd  # noqa: PLC0415

    file = tmp_path / "run.parquet"
    answer(capsys, "solve", "liashenko-ii", "--trajectory", str(file))
    table = pd.read_parquet(file)
    assert table["line_energy_kwh"].iloc[-1] == pytest.approx(solve(load_scenario("liashenko-ii")).energy_kwh)


@pytest.fixture(scope="module")
def run_file(tmp_path_factory):
    """Return a file with a good run of liashenko-ii."""
    file = tmp_path_factory.mktemp("run") / "run.csv"
    solve(load_scenario("liashenko-ii")).to_dataframe().to_csv(file, index=False)
    return str(file)


def test_check_prints_json(capsys, run_file):
    result = json.loads(answer(capsys, "check", run_file, "--scenario", "liashenko-ii", "--json"))
    assert result["ok"] is True
    assert {"name", "largest", "allowed", "at_m"} <= result["checks"][0].keys()
    assert all(check["largest"] <= check["allowed"] for check in result["checks"])
    assert {rule["name"] for rule in result["not_checked"]} >= {"account", "bound below the energy"}


def test_check_prints_a_table_and_a_verdict(capsys, run_file):
    lines = answer(capsys, "check", run_file, "--scenario", "liashenko-ii").splitlines()
    assert lines[0].split() == ["rule", "largest", "deviation", "permitted", "share", "of", "position,", "m"]
    assert any(line.startswith("balance of forces ") for line in lines)
    assert "Not checked: account: a table of nodes has none." in lines
    assert lines[-1] == "The run keeps all 21 rules that were checked."


def test_a_broken_rule_ends_with_its_own_status(capsys, run_file):
    words = ("check", run_file, "--scenario", "liashenko-ii", "--set", "vehicle.traction.max_effort_kn=100")
    assert main(words) == BROKEN_RULE
    text, complaints = capsys.readouterr()
    assert complaints == ""
    (line,) = (line for line in text.splitlines() if line.endswith(" broken"))
    assert line.startswith("tractive effort ")
    assert "The run breaks 1 of 21 rules, worst of all 'tractive effort': by " in text
    assert main((*words, "--json")) == BROKEN_RULE
    assert json.loads(capsys.readouterr().out)["ok"] is False


def test_check_reads_parquet(capsys, tmp_path):
    pytest.importorskip("pyarrow", reason="pyarrow is not installed, so there is no parquet to write")
    file = tmp_path / "run.parquet"
    solve(load_scenario("liashenko-ii")).to_dataframe().to_parquet(file, index=False)
    assert json.loads(answer(capsys, "check", str(file), "--scenario", "liashenko-ii", "--json"))["ok"] is True


def test_solve_shows_its_check(capsys):
    words = ("solve", "ftorek-300s", "--strategy", "enoc", "--check")
    assert json.loads(answer(capsys, *words, "--json"))["check"]["ok"] is True
    last = answer(capsys, *words).splitlines()[-1]
    assert last.startswith("Check ")
    assert "The run keeps all " in last


def test_solve_shows_what_a_run_breaks(capsys, monkeypatch):
    broken = CheckResult(
        (Check("tractive effort", 0.02, 2e-6, 350.0, "the largest effort"), Check("stops", 0, 0, None, "")), ()
    )
    monkeypatch.setattr(commands, "check_run", lambda *_: broken)
    assert main(("solve", "liashenko-ii", "--check")) == BROKEN_RULE
    lines = capsys.readouterr().out.splitlines()
    (row,) = (line for line in lines if line.endswith(" broken"))
    assert row.split() == ["tractive", "effort", "0.02", "2e-06", "the", "largest", "effort", "350.0", "broken"]
    assert "The run breaks 1 of 2 rules" in " ".join(lines[-2:])


def test_compare_prints_json(capsys):
    values = json.loads(answer(capsys, "compare", "ftorek-300s", "--set", "vehicle.load_factor=0.5", "--json"))
    assert list(values) == ["results", "refused"]
    strategies = [result["strategy"] for result in values["results"]]
    assert strategies == ["optimal", "bellman", "eoc", "enoc", "phases", "speed_limits", "linear_reserve", "fastest"]
    assert values["refused"] == []
    best = values["results"][0]
    assert best["proven"]
    # whatever its mesh, each run in time has the same bound; the set speeds are late
    in_time = [result for result in values["results"] if result["strategy"] != "speed_limits"]
    assert all(result["lower_bound_kwh"] == best["lower_bound_kwh"] for result in in_time)
    assert all(result["gap"] >= 0 for result in values["results"])


def test_compare_tells_who_refuses(capsys):
    values = json.loads(answer(capsys, "compare", "metro-with-limit", "--json"))
    assert [entry["strategy"] for entry in values["refused"]] == ["eoc", "enoc"]
    assert all(entry["reason"].endswith(".") for entry in values["refused"])
    text = answer(capsys, "compare", "metro-with-limit")
    assert "\nEOC: needs a line without limits.\nENOC: needs" in text
    assert "Optimal" in text
    assert "proven optimal" in text


def test_validate_prints_json(capsys, monkeypatch):
    validate_once(monkeypatch)
    papers = json.loads(answer(capsys, "validate", "ftorek", "--json"))["papers"]
    assert list(papers) == ["ftorek"]
    rows = papers["ftorek"]["rows"]
    assert list(rows[0]) == [
        "table", "place", "case", "quantity", "unit", "printed", "railjoule", "difference_percent", "difference_points",
        "close", "note", "independent", "alternatives",
    ]  # fmt: skip
    # one row for each printed number: the energies of Table 1 are also compared with the optimum and a closed loop
    energies = [row for row in rows if row["printed"] == 4251.8]
    assert len(energies) == 1
    assert len(energies[0]["alternatives"]) == 2
    assert list(papers["ftorek"]["claims"][0]) == ["place", "claim", "railjoule", "verdict", "reason"]


@pytest.mark.nightly
def test_validate_without_a_paper_shows_all(capsys):
    whole = json.loads(answer(capsys, "validate", "--json"))["papers"]
    assert list(whole) == list(PAPERS)
    assert sum(len(paper["claims"]) for paper in whole.values()) >= 40
    one = json.loads(answer(capsys, "validate", "liashenko", "--json"))["papers"]
    assert one == {"liashenko": whole["liashenko"]}


@pytest.mark.nightly
def test_validate_prints_tables(capsys):
    text = answer(capsys, "validate", "ftorek")
    assert "ENOC with the printed acceleration times (Table 2, (12), (15))" in text
    assert any(line.split()[4:8] == ["W_T", "Wh", "4,406.7", "4,398.62"] for line in text.splitlines())
    assert "  [1] " in text
    assert "\nErrata\n" in text


def test_benchmark_prints_both(capsys, monkeypatch):
    timings = [Timing("liashenko-ii", 266, "optimal", 2.2239, 9, 0.00062), Timing("x", 10, "fastest", 1.0, 0, 0.1)]
    monkeypatch.setattr(core_benchmark, "benchmark", lambda: iter(timings))
    assert json.loads(answer(capsys, "benchmark", "--json"))["results"][0] == {
        "scenario": "liashenko-ii",
        "cell_count": 266,
        "solver": "optimal",
        "energy_kwh": 2.2239,
        "iterations": 9,
        "median_s": 0.00062,
    }
    monkeypatch.setattr("railjoule.core.validation.ipopt.is_installed", lambda: False)
    lines = answer(capsys, "benchmark").splitlines()
    assert "pip install casadi" in lines[-1]
    assert lines[2].split() == ["liashenko-ii", "266", "Optimal", "2.2239", "9", "0.62"]


@pytest.mark.parametrize(
    "words",
    [
        ("study", "tradeoff", "tram-950m", "-o", "{}.csv"),
        ("solve", "tram-950m", "--trajectory", "{}.csv"),
        ("solve", "tram-950m", "--trajectory", "{}.parquet"),
    ],
)
def test_a_full_disk_is_one_sentence_and_leaves_the_old_file(capsys, tmp_path, monkeypatch, words):
    target = Path(words[-1].format(tmp_path / "old"))
    target.write_text("old")

    # the last step of each writer, whichever library wrote
    monkeypatch.setattr("os.fsync", full_disk)
    told = complaint(capsys, *(word.format(tmp_path / "old") for word in words))
    assert told.endswith("cannot be written: No space left on device.")
    assert target.read_text() == "old"
    assert list(tmp_path.iterdir()) == [target]


def test_simulate_shows_the_plan_and_what_became_of_it(capsys):
    changes = ["disturbance.coordinate_error_m=15", "disturbance.actual_load_factor=1"]
    assert main(["simulate", "liashenko-ii", "--set", *changes, "--json"]) == OK
    answer = json.loads(capsys.readouterr().out)
    keys = {"planned", "actual", "overconsumption", "stop_error_m", "stop_errors_m", "delay_s", "notes"}
    assert set(answer) == keys
    more = answer["actual"]["energy_kwh"] / answer["planned"]["energy_kwh"] - 1
    assert answer["overconsumption"] == pytest.approx(more)
    assert main(["simulate", "liashenko-ii", "--set", *changes]) == OK
    printed = capsys.readouterr().out
    assert f"{100 * more:+.1f} % energy" in printed
    assert answer["notes"][0] in printed


def test_simulate_drives_in_closed_loop(capsys):
    assert main(["simulate", "ftorek-300s", "--set", "simulation.kind=field_oriented", "--json"]) == OK
    answer = json.loads(capsys.readouterr().out)
    assert set(answer) >= CLOSED_LOOP_KEYS
    assert answer["energy_by_parts_kwh"] == pytest.approx(answer["energy_by_input_power_kwh"], rel=5e-4)
    assert answer["parts_kwh"]["magnetising"] == answer["magnetising_loss_kwh"] > 0
    assert main(["simulate", "ftorek-300s", "--set", "simulation.kind=field_oriented"]) == OK
    assert f"{answer['energy_by_input_power_kwh']:.3f}" in capsys.readouterr().out


def test_a_study_becomes_a_labelled_table(tmp_path):
    target = tmp_path / "table.nc"
    assert main(["study", "sensitivity", "liashenko-0", "-o", str(target)]) == OK
    with xarray.open_dataset(target, engine="scipy") as table:
        assert dict(table.sizes) == {"load_factor": 5, "coordinate_error_m": 7}
        assert table.overconsumption.sel(load_factor=0.5, coordinate_error_m=0.0).item() == pytest.approx(0, abs=1e-9)
        assert table.energy_kwh.attrs["units"] == "kWh"
    target = tmp_path / "frontier.csv"
    assert main(["study", "tradeoff", "liashenko-0", "-o", str(target)]) == OK
    assert target.read_text().startswith("travel_time_s,energy_kwh,price_of_time_wh_per_s,lower_bound_kwh")
    target = tmp_path / "chance.csv"
    assert main(["study", "montecarlo", "liashenko-0", "-o", str(target), "--set", "montecarlo.runs=20"]) == OK
    assert len(target.read_text().splitlines()) == 21
    target = tmp_path / "stops.csv"
    assert main(["study", "braking", "liashenko-0", "-o", str(target), "--set", "montecarlo.runs=20"]) == OK
    assert target.read_text().splitlines()[0].endswith("stop_error_m,stop_error_without_sensors_m")


def test_a_report_is_one_file_that_is_a_scenario_too(capsys, tmp_path):
    target = tmp_path / "report.html"
    changes = ["vehicle.load_factor=0.3", "title=night"]
    words = answer(capsys, "report", "liashenko-ii", "-o", str(target), "--strategy", "fastest", "--set", *changes)
    assert words.startswith(str(target)[:70])
    assert target.stat().st_size < 10_000_000
    result = json.loads(answer(capsys, "solve", str(target), "--json"))
    assert (result["title"], result["strategy"]) == ("night", "fastest")
    expected = solve(load_scenario("liashenko-ii", {"vehicle.load_factor": 0.3}), "fastest")
    assert result["energy_kwh"] == expected.energy_kwh


@pytest.mark.parametrize("apart", [["scenario", "proof"], ["scenario,proof"]], ids=["words", "commas"])
def test_a_report_of_chosen_sections_with_author_and_note(capsys, tmp_path, apart):
    (tmp_path / "note.txt").write_bytes("One <b>\r\n\r\nZw\u00f6lf\n".encode())
    words = ["--sections", *apart, "--author", "A. & B.", "--note", str(tmp_path / "note.txt")]
    answer(capsys, "report", "liashenko-0", "-o", str(tmp_path / "x.html"), *words)
    text = (tmp_path / "x.html").read_text(encoding="utf-8")
    assert re.findall(r'<section id="([\w-]+)"', text) == ["note", "proof", "scenario-tables"]
    assert "<p>One &lt;b&gt;</p><p>Zw\u00f6lf</p>" in text
    assert ", by A. &amp; B.</p>" in text
    (tmp_path / "note.txt").write_text("x" * 2001)
    assert "note: has 2,001 characters" in complaint(capsys, "report", "liashenko-0", "-o", "y.html", *words)


def full_disk(_):
    raise OSError(28, "No space left on device")


def test_a_report_that_cannot_be_written(capsys, tmp_path, monkeypatch):
    (tmp_path / "old.html").write_text("old")
    with monkeypatch.context() as patch:
        patch.setattr("os.fsync", full_disk)
        told = complaint(capsys, "report", "liashenko-0", "-o", str(tmp_path / "old.html"))
    # a long path is shortened
    assert told.endswith(" cannot be written: No space left on device.")
    assert (tmp_path / "old.html").read_text() == "old"


def test_a_crush_load_is_marked(capsys):
    crowded = ["liashenko-ii", "--set", "vehicle.load_factor=1.2"]
    for command in ("solve", "compare", "simulate"):
        assert "Crush load, 120 % of capacity." in answer(capsys, command, *crowded)
        assert "rush load" not in answer(capsys, command, "liashenko-ii")
    assert json.loads(answer(capsys, "solve", *crowded, "--json"))["load_factor"] == 1.2


def test_a_run_that_misses_a_window_of_arrival_ends_with_status_2(capsys):
    """The run is shown all the same, and the sentence names station, arrival and window."""
    station = "{ name = 'Mid', position_m = 700, dwell_s = 20, earliest_arrival_s = 150 }"
    changes = ["--set", f"line.stations=[{station}]", "timetable.travel_time_s=300", "solver.mesh_m=25"]
    assert main(["solve", "liashenko-0", "--strategy", "fastest", "--json", *changes]) == BAD_INPUT
    shown = capsys.readouterr()
    assert json.loads(shown.out)["strategy"] == "fastest"
    assert "It arrives at Mid after" in shown.err
    assert "was to arrive no earlier than 150.0 s" in shown.err
    assert main(["solve", "liashenko-0", "--strategy", "optimal", "--json", *changes]) == OK
    assert 0 <= json.loads(capsys.readouterr().out)["gap"] < 0.02


def test_two_scenarios_stand_side_by_side(capsys, tmp_path):
    """The numbers are those of two single solves, and the differences are formed here from them."""
    other = tmp_path / "other.toml"
    save_scenario(load_scenario("tram-950m").replace({"title": "Slower", "timetable.travel_time_s": 110.0}), other)
    pair = json.loads(answer(capsys, "compare", "tram-950m", str(other), "--set", "vehicle.load_factor=0.5", "--json"))
    solved = [
        json.loads(answer(capsys, "solve", name, "--set", "vehicle.load_factor=0.5", "--json"))
        for name in ("tram-950m", str(other))
    ]
    for one, run in zip(pair["results"], solved, strict=True):
        same = set(run) - {"solve_time_s"}
        assert {key: one[key] for key in same} == {key: run[key] for key in same}
    first, second = solved
    assert pair["differences"]["energy_kwh"] == second["energy_kwh"] - first["energy_kwh"] < 0
    assert pair["differences"]["travel_time_s"] == pytest.approx(15.0, abs=1e-6)
    assert pair["scenarios"] == "The second scenario has travel time 110.0 s instead of 95.0 s."


def test_the_second_scenario_may_be_the_first_one_changed(capsys):
    words = ("compare", "metro-with-limit", "--set-second", "vehicle.preset=tram-105n", "vehicle.load_factor=0.5")
    text = answer(capsys, *words)
    assert "vehicle Tram 105N instead of Metro 81-7036, 5 cars" in " ".join(text.split())
    (row,) = (line.split() for line in text.splitlines() if line.startswith("Energy, kWh"))
    first, second, difference, percent = (float(cell) for cell in row[-4:])
    assert difference == pytest.approx(second - first, abs=0.011)
    assert percent == pytest.approx(100 * (second / first - 1), abs=0.1)
    assert complaint(capsys, "compare", "a", "b", "--set", "c").startswith("3 FILEs are named; at most 2 scenarios")
    assert complaint(capsys, "compare", "tram-950m", "--set-second", "x").startswith("x: there is no such file")
