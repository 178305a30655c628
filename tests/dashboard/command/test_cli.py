import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from commands import answer, complaint

from railjoule.core import load_scenario, solve
from railjoule.dashboard.command import commands, values
from railjoule.dashboard.command.cli import BAD_INPUT, BROKEN_PIPE, INTERRUPTED, OK, main

COMMAND = [sys.executable, "-m", "railjoule.dashboard"]
ON_SCREEN = ("panel", "panel_material_ui", "param", "bokeh", "holoviews", "pandas", "casadi", "pyarrow")
CHANGES = ["vehicle.load_factor=0.3", "line.reverse=true", "title=night"]


@pytest.mark.parametrize(
    "words",
    [
        ["liashenko-ii", "--set", *CHANGES],
        ["--set", *CHANGES, "liashenko-ii"],
        ["--set", CHANGES[0], "--set", CHANGES[1], "liashenko-ii", "--set", CHANGES[2]],
        ["--set", CHANGES[0], "liashenko-ii", "--set", *CHANGES[1:]],
    ],
)
def test_changes_may_stand_anywhere(capsys, words):
    result = json.loads(answer(capsys, "solve", *words, "--json"))
    changes = {"vehicle.load_factor": 0.3, "line.reverse": True, "title": "night"}
    assert result["title"] == "night"
    assert result["energy_kwh"] == solve(load_scenario("liashenko-ii", changes)).energy_kwh


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("0.3", 0.3),
        ("120", 120),
        ("true", True),
        ('"a b"', "a b"),
        ("[600, 900]", [600, 900]),
        ("[{from_m = 600, to_m = 900, limit_kmh = 50}]", [{"from_m": 600, "to_m": 900, "limit_kmh": 50}]),
        ("optimal", "optimal"),
        ("a b = c", "a b = c"),
        ("1\nother = 2", "1\nother = 2"),
        ("[" * 10_000, "[" * 10_000),
        ("1" * 10_000, "1" * 10_000),
        ("", ""),
        ("0,3", 0.3),
        ("a, b", "a, b"),
        ("2:30", "2:30"),
    ],
)
def test_values_are_toml_or_texts(text, value):
    assert values.changes([f"key={text}"]) == {"key": value}


@pytest.mark.parametrize(
    ("text", "time_s"), [("133.7", 133.7), ("133,7", 133.7), ("2:30", 150), ("1:02:03", 3723), ("01:02:03", 3723)]
)
def test_times_may_be_typed_as_on_a_clock(text, time_s):
    assert values.changes([f"timetable.travel_time_s={text}"]) == {"timetable.travel_time_s": time_s}


@pytest.mark.parametrize(
    ("read", "text", "value"),
    [
        (values.number, "-1000,5", -1000.5),
        (values.share, "0,9", 0.9),
        (values.share, "90 %", 0.9),
        (values.seconds, "2:30", 150),
        (values.seconds, "0,5", 0.5),
        (values.whole(1, 9), "9", 9),
        # not by way of a float, which rounds it
        (values.whole(0), "9007199254740993", 9_007_199_254_740_993),
        (values.pair("a"), " speed = v [m/s]", ("speed", "v [m/s]")),
        (values.pair("a", values.number), "effort_gain=0,5", ("effort_gain", 0.5)),
        (values.field_range, "vehicle.load_factor=0,5:1", ("vehicle.load_factor", (0.5, 1.0))),
        (values.chainage, "12+345", 12_345),
        (values.file(".csv"), "A.CSV", Path("A.CSV")),
    ],
)
def test_each_type_reads_what_people_type(read, text, value):
    assert read(text) == value


def test_parquet_without_pyarrow_says_what_to_install(capsys, monkeypatch, tmp_path):
    monkeypatch.setattr("importlib.util.find_spec", lambda _: None)
    words = complaint(capsys, "solve", "liashenko-ii", "--trajectory", str(tmp_path / "run.parquet"))
    assert "pip install pyarrow" in words


def test_help_and_version_are_no_errors(capsys):
    assert "Energy-optimal driving" in answer(capsys, "--help")
    assert "FILE" in answer(capsys, "solve", "--help")
    assert answer(capsys, "--version").startswith("railjoule ")


def test_an_interrupt_is_silent(capsys, monkeypatch):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(commands, "compare_strategies", interrupted)
    assert main(["compare", "liashenko-ii"]) == INTERRUPTED
    assert capsys.readouterr() == ("", "")


def run_process(*words, **settings):
    return subprocess.run([*COMMAND, *words], capture_output=True, text=True, check=False, timeout=300, **settings)


def test_titles_survive_a_terminal_without_unicode():
    settings = {**os.environ, "PYTHONIOENCODING": "ascii"}
    process = run_process("solve", "liashenko-0", "--set", 'title="Žilina"', env=settings)
    assert process.returncode == OK
    assert process.stdout.startswith("\\u017dilina: Optimal\n")


def test_a_reader_that_leaves_is_no_error():
    process = subprocess.Popen([*COMMAND, "limits"], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    process.stdout.close()
    assert process.wait(timeout=300) == BROKEN_PIPE
    assert process.stderr.read() == b""
    process.stderr.close()


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="this system has no /dev/full to write to")
def test_a_full_disk_is_one_sentence():
    with open("/dev/full", "w") as full:
        process = subprocess.run(
            [*COMMAND, "solve", "liashenko-0"], stdout=full, stderr=subprocess.PIPE, timeout=300, check=False
        )
    assert process.returncode == BAD_INPUT
    assert process.stderr == b"railjoule: the result cannot be written: No space left on device.\n"


def test_solving_imports_nothing_of_the_screen():
    code = (
        "import sys; from railjoule.dashboard.command.cli import main; main(['solve', 'liashenko-0']);"
        f"main(['compare', 'liashenko-0']); print(sorted(set({ON_SCREEN!r}) & set(sys.modules)))"
    )
    process = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=300)
    assert process.stdout.splitlines()[-1] == "[]"


@pytest.mark.parametrize(("error", "words"), [(MemoryError, "not enough memory"), (RecursionError, "nested")])
def test_memory_that_is_not_there_is_told(capsys, monkeypatch, error, words):
    def fail(*_, **__):
        raise error

    monkeypatch.setattr("railjoule.dashboard.command.commands.solve_scenario", fail)
    assert words in complaint(capsys, "solve", "liashenko-ii")
