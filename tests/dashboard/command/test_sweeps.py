import json
from types import SimpleNamespace

import numpy as np
import pandas
import pytest
import xarray

from railjoule.core import load_scenario, solve
from railjoule.dashboard.command import sweeps
from railjoule.dashboard.command.cli import BAD_INPUT, INTERRUPTED, OK, main

RANGES = ("vehicle.load_factor=0:1", "timetable.travel_time_s=105:130")


def command(target, *words, over=RANGES, sample="9", file="liashenko-ii"):
    asked = ["study", "sweep", file, "--over", *over, "--sample", sample, "-o", str(target)]
    return main([*asked, "--set", "solver.mesh_m=25", *words])


def complaint(capsys, *words, **asked):
    """Return the one sentence of a command that is refused."""
    assert command(*words, **asked) == BAD_INPUT
    told = capsys.readouterr()
    assert told.out == ""
    assert told.err.count("\n") == 1
    assert "Traceback" not in told.err
    return told.err


@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
def test_a_sweep_becomes_a_table(capsys, tmp_path, suffix):
    target = tmp_path / f"out{suffix}"
    assert command(target, "--method", "grid", "--columns", "max_speed_kmh", "--json") == OK
    told = json.loads(capsys.readouterr().out)
    assert (told["rows"], told["without_run"]) == (9, 0)
    assert told["runs_per_s"] == pytest.approx(9 / told["seconds"])
    table = pandas.read_csv(target) if suffix == ".csv" else pandas.read_parquet(target)
    assert told["sensitivities"] is None
    # the contract of design.md: one column a field, then energy, bound, time and price
    assert list(table.columns) == [
        "vehicle.load_factor", "timetable.travel_time_s", "energy_kwh", "lower_bound_kwh", "travel_time_s",
        "price_of_time_w", "max_speed_kmh", "reason",
    ]  # fmt: skip
    assert table["vehicle.load_factor"].tolist() == [0.0] * 3 + [0.5] * 3 + [1.0] * 3
    run = solve(load_scenario("liashenko-ii", {"solver.mesh_m": 25, "timetable.travel_time_s": 117.5}))
    # a sweep has the mesh of the scenario, which an optimum refines
    assert run.lower_bound_kwh < table["energy_kwh"][4] == pytest.approx(run.energy_kwh, rel=1e-2)
    assert np.all(table["lower_bound_kwh"] <= table["energy_kwh"])
    # nothing is left of what was written aside
    assert [path.name for path in tmp_path.iterdir()] == [target.name]


def test_the_same_seed_gives_the_same_file(tmp_path):
    files = [tmp_path / f"{name}.csv" for name in "abc"]
    for file, seed in zip(files, "110", strict=True):
        assert command(file, "--method", "random", "--seed", seed) == OK
    assert files[0].read_bytes() == files[1].read_bytes() != files[2].read_bytes()


def test_rows_without_a_run_are_told(capsys, tmp_path):
    over = ("timetable.travel_time_s=50:130",)
    assert command(tmp_path / "out.csv", "--method", "grid", over=over, sample="3") == OK
    told = capsys.readouterr().out
    assert "3 rows" in told
    assert "of them without a run, such as: timetable.travel_time_s = 50 s is shorter than the shortest" in told


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("nowhere/out.csv", "cannot be written: No such file or directory"),
        ("folder.csv", "cannot be written: Is a directory"),
    ],
)
def test_what_cannot_be_written_is_told_before_anything_is_solved(capsys, tmp_path, monkeypatch, name, words):
    monkeypatch.setattr(sweeps, "run_study", None)
    (tmp_path / "folder.csv").mkdir()
    assert words in complaint(capsys, tmp_path / name)


def test_a_table_that_no_disk_takes_is_refused_before_anything_is_solved(capsys, tmp_path, monkeypatch):
    monkeypatch.setattr(sweeps, "run_study", None)
    # 100,000 rows of 6 numbers, of 20 bytes in the table and of 8 where they are kept until then
    monkeypatch.setattr(sweeps.shutil, "disk_usage", lambda _: SimpleNamespace(free=16_000_000))
    told = complaint(capsys, tmp_path / "out.csv", sample="100000")
    assert "would take about 0.0168 GB, with the rows kept until it is written, and there are 0.016 GB left" in told
    assert list(tmp_path.iterdir()) == []


def test_a_file_that_was_there_stays_where_a_sweep_fails(capsys, tmp_path):
    target = tmp_path / "out.csv"
    target.write_text("earlier")
    complaint(capsys, target, "--strategy", "best")
    assert target.read_text() == "earlier"
    assert [path.name for path in tmp_path.iterdir()] == [target.name]


def test_a_person_at_a_terminal_sees_how_far_it_is(capsys, tmp_path, monkeypatch):
    assert command(tmp_path / "out.csv") == OK
    # none of it where nobody looks: a pipe's reader looks for errors
    assert capsys.readouterr().err == ""
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    assert command(tmp_path / "out.csv", sample="300", over=("vehicle.load_factor=0:1",)) == OK
    told = capsys.readouterr().err
    assert told.count("\r") > 1
    assert "100%" in told
    assert "300/300" in told
    assert "runs/s" in told


def stopped_at_the_first_progress(monkeypatch):
    """Let a person press Ctrl+C at the first news of a sweep, and nobody after."""
    run = sweeps.run_study

    def stop(results, progress, **given):
        def interrupted(done):
            progress(done)
            raise KeyboardInterrupt

        run(results, progress=interrupted, **given)

    monkeypatch.setattr(sweeps, "run_study", stop)
    return lambda: monkeypatch.setattr(sweeps, "run_study", run)


def test_a_stopped_sweep_goes_on_to_the_same_table(capsys, tmp_path, monkeypatch):
    go_on = stopped_at_the_first_progress(monkeypatch)
    target, kept = tmp_path / "out.parquet", tmp_path / "out.parquet.runs"
    assert command(target, sample="300") == INTERRUPTED
    assert "of 300 rows are kept in" in capsys.readouterr().err
    assert kept.exists()
    assert not target.exists()
    go_on()
    assert "--resume goes on with it; to begin again, remove it" in complaint(capsys, target, sample="300")
    assert "another study, whose seed differs: 0, not 1" in complaint(
        capsys, target, "--resume", "--seed", "1", sample="300"
    )
    assert command(target, "--resume", sample="300") == OK
    assert not kept.exists()
    assert command(tmp_path / "whole.parquet", sample="300") == OK
    pandas.testing.assert_frame_equal(pandas.read_parquet(target), pandas.read_parquet(tmp_path / "whole.parquet"))
    capsys.readouterr()
    assert "nothing is left to be done for it" in complaint(capsys, target, "--resume", sample="300")


def test_a_script_may_always_say_resume(tmp_path):
    assert command(tmp_path / "out.csv", "--resume") == OK


def test_shares_of_the_fields_are_told(capsys, tmp_path):
    target = tmp_path / "out.nc"
    assert command(target, "--json", sample="128") == OK
    told = json.loads(capsys.readouterr().out)
    shares = told["sensitivities"]
    assert list(shares) == ["vehicle.load_factor", "timetable.travel_time_s"]
    assert sum(of["first"] for of in shares.values()) == pytest.approx(1, abs=0.1)
    table = xarray.open_dataset(target, engine="scipy")
    assert table.sizes["row"] == 128
    assert table.attrs["railjoule_fingerprint"] == told["fingerprint"]
    assert command(tmp_path / "out.csv", sample="128") == OK
    assert "Sobol' indices" in capsys.readouterr().out


def test_a_cluster_that_is_none_is_told_and_nothing_is_left(capsys, tmp_path, monkeypatch):
    monkeypatch.setattr("railjoule.dashboard.command.cluster.CONNECTING_S", 0.5)
    told = complaint(capsys, tmp_path / "out.csv", "--scheduler", "tcp://127.0.0.1:9")
    assert "the cluster tcp://127.0.0.1:9 does not answer within 0.5 s" in told
    assert list(tmp_path.iterdir()) == []
