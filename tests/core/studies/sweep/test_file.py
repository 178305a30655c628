import os
import signal
import sqlite3
import subprocess
import sys

import numpy as np
import pytest

from railjoule.core import load_scenario
from railjoule.core.studies.sweep import StudyFileError, SweepFile, make_study, run_study
from tests.builders import plain_scenario

OVER = {"vehicle.load_factor": (0.0, 1.0), "timetable.travel_time_s": (50.0, 200.0)}


def study(**changes):
    scenario = changes.pop("scenario", plain_scenario({"solver.mesh_m": 50.0}))
    return make_study(scenario, **{"over": OVER, "sample": 300, **changes})


def same(one, other):
    assert np.array_equal(one.index, other.index)
    for name in one.samples:
        assert np.array_equal(one.samples[name], other.samples[name])
    for name in one.columns:
        assert np.array_equal(one.columns[name], other.columns[name], equal_nan=True)
    assert one.reasons == other.reasons


def made(path, asked):
    kept = SweepFile.create(path, asked)
    run_study(kept)
    return kept


def test_a_file_gives_back_what_was_put_in(tmp_path):
    kept = made(tmp_path / "a.runs", study())
    table = kept.to_table()
    assert table.reasons
    kept.close()
    # all in one file, once it is closed
    assert [path.name for path in tmp_path.iterdir()] == ["a.runs"]
    with SweepFile.open(tmp_path / "a.runs") as again:
        same(again.to_table(), table)
        assert again.gaps() == []
        assert again.study.fingerprint == study().fingerprint
        assert again.seconds == pytest.approx(table.seconds)


def test_a_preset_s_scenario_is_read_back_to_the_same_fingerprint(tmp_path):
    asked = study(scenario=load_scenario("tram-950m"), over={"vehicle.load_factor": (0.1, 0.3)})
    SweepFile.create(tmp_path / "a.runs", asked).close()
    with SweepFile.open(tmp_path / "a.runs") as again:
        assert again.study.fingerprint == asked.fingerprint


KILLED = """
import sys
from railjoule.core.studies.sweep import SweepFile, run_study
from tests.core.studies.sweep.test_file import study
asked = study(sample=int(sys.argv[2]))
kept = SweepFile.create(sys.argv[1], asked)
run_study(kept, progress=lambda done: print(done, flush=True))
"""


@pytest.mark.nightly
def test_a_killed_process_loses_nothing_that_it_told_of(tmp_path):
    rows, path = 6_000, tmp_path / "a.runs"
    command = [sys.executable, "-c", KILLED, path, str(rows)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        told = [int(process.stdout.readline()) for _ in range(3)]
        os.kill(process.pid, signal.SIGKILL)
    asked = study(sample=rows)
    with SweepFile.open(path, asked) as kept, made(tmp_path / "b.runs", asked) as whole:
        assert told[-1] <= kept.done < rows
        run_study(kept)
        same(kept.to_table(), whole.to_table())


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"seed": 1}, "whose seed differs: 0, not 1"),
        ({"sample": 299}, "whose sample differs: 300, not 299"),
        ({"method": "halton"}, "whose method differs: sobol, not halton"),
        ({"strategy": "phases"}, "whose strategy differs: optimal, not phases"),
        ({"columns": ("energy_kwh",)}, "whose columns differs"),
        ({"over": dict(reversed(OVER.items()))}, "whose over differs"),
        ({"scenario": plain_scenario({"solver.mesh_m": 20.0})}, "whose scenario differs."),
    ],
)
def test_another_study_is_refused(tmp_path, changes, words):
    SweepFile.create(tmp_path / "a.runs", study()).close()
    with pytest.raises(StudyFileError, match=words):
        SweepFile.open(tmp_path / "a.runs", study(**changes))


def test_rows_of_another_version_may_be_read_and_no_more_added(tmp_path, monkeypatch):
    made(tmp_path / "a.runs", study()).close()
    monkeypatch.setattr("railjoule.core.studies.sweep.study.solver_version", lambda: "of next week")
    with SweepFile.open(tmp_path / "a.runs") as kept:
        assert kept.done == kept.study.sample
    with pytest.raises(StudyFileError, match="whose solver differs"):
        SweepFile.open(tmp_path / "a.runs", study())


def test_a_file_that_is_none_is_refused_in_a_sentence(tmp_path):
    (tmp_path / "text.runs").write_text("no database, and long enough to be read as one" * 99)
    other = sqlite3.connect(tmp_path / "other.runs")
    other.execute("CREATE TABLE things (name TEXT)")
    other.close()
    for name, words in (("none", "there is no such file"), ("text", "holds no study"), ("other", "holds no study")):
        with pytest.raises(StudyFileError, match=words):
            SweepFile.open(tmp_path / f"{name}.runs")
    with pytest.raises(StudyFileError, match="exists already"):
        SweepFile.create(tmp_path / "text.runs", study())
    with pytest.raises(StudyFileError, match="cannot be written: it cannot be opened"):
        SweepFile.create(tmp_path / "nowhere" / "a.runs", study())


def test_two_processes_do_not_go_on_with_one_study(tmp_path):
    kept = SweepFile.create(tmp_path / "a.runs", study())
    with pytest.raises(StudyFileError, match="another process is at work on it"):
        SweepFile.open(tmp_path / "a.runs")
    kept.close()
    SweepFile.open(tmp_path / "a.runs").close()


def test_a_full_disk_is_told_and_costs_nothing_that_is_kept(tmp_path):
    kept = SweepFile.create(tmp_path / "a.runs", study(sample=200))
    [(pages,)] = kept._connection.execute("PRAGMA page_count").fetchall()
    # SQLite's own bound stands for that of a disk: it answers in the same words
    kept._connection.execute(f"PRAGMA max_page_count = {pages + 4}")
    with pytest.raises(StudyFileError, match="cannot be written: the disk is full"):
        run_study(kept)
    assert 0 < kept.done < 200
    kept._connection.execute("PRAGMA max_page_count = 100000")
    run_study(kept)
    same(kept.to_table(), made(tmp_path / "b.runs", study(sample=200)).to_table())
