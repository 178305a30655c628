"""Helper processes that compile, and the runs that need not wait for them."""

import logging
import os
import subprocess
import sys

import pytest

from railjoule.core import load_scenario
from railjoule.core.compilation import Compilation, compilation, needs_compiler, parts, require_compiled
from railjoule.core.compilation import background as module
from railjoule.core.compilation.background import PARTS_IN_ORDER
from railjoule.core.compiled import MODE

HELPER = """
import sys
print("kernel", flush=True)
for line in sys.stdin:
    part = line.strip()
    if part in {killed!r}:
        sys.exit(9)
    print("kernel\\nkernel\\npart", flush=True)
"""


@pytest.fixture
def cold(monkeypatch, tmp_path):
    """Begin as on a fresh machine, with helpers that compile nothing; return what sets the parts that kill them."""
    monkeypatch.setattr(MODE, "is_compiled", False)
    monkeypatch.setattr(MODE, "is_saving", True)
    marks = []
    monkeypatch.setattr(module.kernel_cache, "cache_folder", lambda: tmp_path)
    monkeypatch.setattr(module.kernel_cache, "has_all_kernels", lambda: bool(marks))
    monkeypatch.setattr(module.kernel_cache, "mark_complete", lambda: marks.append(True))
    monkeypatch.setattr(module.kernel_cache, "remove_old_formats", lambda: None)

    def use(*killed):
        def start():
            pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
            return subprocess.Popen([sys.executable, "-c", HELPER.format(killed=killed)], **pipes)

        monkeypatch.setattr(module, "_start_helper", start)
        return marks

    return use


def test_all_parts_are_compiled_once_and_counted(cold):
    marks, one, called = cold(), Compilation(), []
    one.then(lambda: called.append(MODE.is_compiled))
    assert one.begin()
    assert not one.begin()
    assert one.ready.wait(30)
    # two lines a part, and one of each helper's own
    assert one.kernel_count == 2 * len(PARTS_IN_ORDER) + min(2, os.cpu_count() or 1)
    assert marks == [True]
    assert called == [True]
    one.then(lambda: called.append("later"))
    assert called == [True, "later"]


def test_a_helper_that_is_killed_costs_a_line_in_the_log_and_nothing_else(cold, caplog):
    marks, one = cold("proof"), Compilation()
    with caplog.at_level(logging.WARNING):
        one.begin()
        assert one.ready.wait(30)
    assert marks == []
    assert MODE.is_compiled
    assert not MODE.is_saving
    assert [record.getMessage() for record in caplog.records] == [
        "the process that compiled proof has ended (exit status 9)",
        "the process that compiled proof has ended (exit status 9)",
        "parts of the solver are compiled at their first use, and not saved: proof",
    ]


def test_no_process_can_be_started(cold, monkeypatch, caplog):
    cold()

    def fail():
        raise OSError("no room")

    monkeypatch.setattr(module, "_start_helper", fail)
    one = Compilation()
    one.begin()
    assert one.ready.wait(30)
    assert MODE.is_compiled
    assert "no process could be started to compile: no room" in caplog.text


def test_what_another_process_has_compiled_meanwhile_is_not_compiled_again(cold):
    marks, one = cold(), Compilation()
    marks.append(True)
    one.begin()
    assert one.ready.wait(30)
    assert one.kernel_count == 0


def test_waiting_is_announced_on_standard_error(cold, monkeypatch, capsys):
    cold()
    monkeypatch.setattr(module, "compilation", Compilation)
    require_compiled()
    assert capsys.readouterr().err.splitlines()[0] == (
        "railjoule compiles its solver, only this once; this takes about a minute."
    )
    require_compiled()
    assert capsys.readouterr().err == ""


def test_the_parts_are_those_that_the_helpers_take():
    assert tuple(parts.PARTS) == PARTS_IN_ORDER


@pytest.mark.parametrize(
    ("name", "strategies", "expected"),
    [
        ("metro-with-limit", ["fastest", "optimal"], False),
        ("ftorek-300s", ["optimal", "eoc"], False),
        ("metro-with-limit", ["bellman"], True),
        ("metro-10-stations", ["optimal"], True),
        ("tram-950m", ["optimal"], True),
    ],
)
def test_short_runs_of_smooth_drives_need_no_compiler(name, strategies, expected):
    assert needs_compiler(load_scenario(name), *strategies) is expected


def test_a_helper_ends_with_the_process_that_started_it():
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
    with subprocess.Popen([sys.executable, "-m", "railjoule.core.compilation.parts"], **pipes) as helper:
        assert helper.stdin is not None
        helper.stdin.close()
        assert helper.wait(50) == 0


COLD = """
import railjoule.core as core
from railjoule.core.advice import advise
from railjoule.core.compiled import MODE
# however slow this machine is at the moment
MODE.before_interpreting = lambda: None
for name in ("metro-with-limit", "liashenko-ii"):
    run = core.solve(core.load_scenario(name))
    print(float(run.energy_kwh), float(run.bound.energy_j), len(advise(run)))
from numba.core.dispatcher import Dispatcher
import gc
kernels = [one for one in gc.get_objects() if isinstance(one, Dispatcher) and one.__module__.startswith("railjoule")]
print(sum(len(one.signatures) for one in kernels))
"""


def test_a_fresh_machine_solves_the_first_scenarios_without_compiling_and_with_the_same_digits(tmp_path):
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    process = subprocess.run([sys.executable, "-c", COLD], env=environment, capture_output=True, text=True, check=True)
    *runs, compiled = process.stdout.split("\n")[:-1]
    assert compiled == "0"
    assert process.stderr == ""
    for name, line in zip(("metro-with-limit", "liashenko-ii"), runs, strict=True):
        run = parts.solve(load_scenario(name))
        assert run.bound is not None
        energy, bound, count = line.split()
        assert float(energy) == pytest.approx(run.energy_kwh, rel=1e-12)
        assert float(bound) == pytest.approx(run.bound.energy_j, rel=1e-9)
        assert int(count) == len(run.advice)


def test_the_compilation_of_a_process_is_one():
    assert compilation() is compilation()
