import os
import runpy
import subprocess
import sys
from pathlib import Path

import pytest

from railjoule.dashboard.work import kernel_parts
from railjoule.dashboard.work import warmup as module
from railjoule.dashboard.work.kernel_parts import PARTS, PARTS_FIRST
from railjoule.dashboard.work.warmup import Reached, Warmup

EVERY_STRATEGY = """
from railjoule.core import compare, load_scenario
from railjoule.core.advice import advise
from railjoule.core.scenario import preset_names
from railjoule.core.simulate.field_oriented import current_ripple, simulate_field_oriented
from railjoule.core.studies.induction_map import induction_map
from railjoule.core.studies.motor_map import motor_map
from railjoule.dashboard.pages.speed_limits.compute import (
    LimitsRequest,
    StorageRequest,
    compute_limit_run,
    compute_limit_trip,
    compute_storage,
)
from railjoule.dashboard.pages.trade_off.compute import TradeOffRequest, compute_trade_off
from railjoule.core.compiled import specialisations
from railjoule.dashboard.work.kernel_parts import all_kernels
from railjoule.dashboard.work.warmup import warmup

def compiled():
    return {kernel.py_func.__qualname__: specialisations(kernel) for kernel in all_kernels()}

warmup().start()
assert warmup().ready.wait(240)
before = compiled()
for name in preset_names("scenarios"):
    for run in compare(load_scenario(name))[0]:
        advise(run)
    compute_trade_off(TradeOffRequest(load_scenario(name), 400.0, False, 1.0))
machine = load_scenario("ftorek-300s")
driven = simulate_field_oriented(machine)
advise(driven.actual)
current_ripple(driven, 100.0)
induction_map(machine)
metro = load_scenario("kharkiv-like-20kmh")
motor_map(metro)
for regulator in ("coast", "brake", "literal"):
    request = LimitsRequest(metro, {"search.regulator": regulator, "search.limits_kmh": [40.0, 30.0]})
    compute_limit_trip(request)
    compute_storage(StorageRequest(compute_limit_run(request), None, None, 0.95, 0.95))
after = compiled()
print({name: count for name, count in after.items() if count != before.get(name)})
"""

COLD_PAGES = """
from railjoule.core.compiled import specialisations
from railjoule.dashboard.page_list import PAGES
from railjoule.dashboard.work import warmup as module
from railjoule.dashboard.work.kernel_parts import all_kernels

# another process is at it, and never done
module.begun = lambda: [type("Busy", (), {"poll": lambda self: None})()]
module.warmup().start()

from railjoule.dashboard.app import Session

session = Session()
for page in PAGES:
    session.state.page = page
session.state.page = "Start"
session.browser._open("tram-950m")
session.state.scenario.load_percent = 50.0
print(sum(map(specialisations, all_kernels())), module.warmup().compiles)
"""


@pytest.mark.nightly
def test_nothing_is_left_to_compile_after_the_warm_up() -> None:
    result = subprocess.run([sys.executable, "-c", EVERY_STRATEGY], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == "{}"


def test_nothing_compiles_on_the_event_loop_while_other_processes_do(tmp_path: Path) -> None:
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    command = [sys.executable, "-W", "ignore", "-c", COLD_PAGES]
    result = subprocess.run(command, capture_output=True, text=True, check=True, env=environment)
    assert result.stdout.split() == ["0", "True"]


class Helper:
    """A process that compiles elsewhere, as the warm-up sees it."""

    def __init__(self) -> None:
        self.ended, self.killed = False, False

    def poll(self) -> int | None:
        return 1 if self.ended else None

    def wait(self) -> int:
        return 1

    def kill(self) -> None:
        self.killed = True


@pytest.fixture
def drives(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Return what the warm-up does in its own process, as it does it."""
    done: list[str] = []
    for name in ("first_task", "drive_fastest", "drive_optimum", "drive_all"):
        monkeypatch.setattr(module, name, lambda name=name: done.append(name))
    return done


EVERYTHING = ["first_task", "drive_fastest", "drive_optimum", "drive_all"]


def test_a_filled_cache_is_read_without_other_processes(monkeypatch: pytest.MonkeyPatch, drives: list[str]) -> None:
    monkeypatch.setattr(module, "is_done", lambda _: True)
    monkeypatch.setattr(module, "begun", lambda: pytest.fail("a process was begun"))
    one = Warmup()
    one.start()
    assert not one.holds_up_tasks
    assert not one.holds_up_runs
    assert one.ready.wait(30)
    assert drives == EVERYTHING


def test_as_a_command_it_compiles_everything(monkeypatch: pytest.MonkeyPatch) -> None:
    done: list[str] = []
    monkeypatch.setattr(kernel_parts, "is_done", lambda _: True)
    for name in EVERYTHING:
        monkeypatch.setattr(kernel_parts, name, lambda name=name: done.append(name))
    runpy.run_path(str(module.__file__), run_name="__main__")
    assert done == EVERYTHING


def test_each_stage_is_told_when_its_parts_are_there(monkeypatch: pytest.MonkeyPatch, drives: list[str]) -> None:
    there: set[str] = set()
    helper, one = Helper(), Warmup()
    monkeypatch.setattr(module, "is_done", there.__contains__)
    monkeypatch.setattr(module, "begun", lambda: [helper])
    monkeypatch.setattr(module, "LOOKS_EVERY_S", 0.001)
    one.start()
    assert one.holds_up_tasks
    assert one.reached == Reached(False, False, False, False)
    there.add("tasks")
    assert one.tasks.wait(30)
    assert (one.holds_up_tasks, one.holds_up_runs) == (False, True)
    there.add("fastest")
    assert one.fastest.wait(30)
    there |= set(PARTS_FIRST)
    assert one.first.wait(30)
    assert one.reached == Reached(True, True, True, False)
    assert not one.holds_up_runs
    there |= set(PARTS)
    assert one.ready.wait(30)
    assert drives == EVERYTHING
    one.wait()
    assert helper.killed


def test_what_other_processes_could_not_do_is_done_here(monkeypatch: pytest.MonkeyPatch, drives: list[str]) -> None:
    helper, one = Helper(), Warmup()
    helper.ended = True
    monkeypatch.setattr(module, "is_done", lambda _: False)
    monkeypatch.setattr(module, "begun", lambda: [helper])
    one.start()
    assert one.ready.wait(30)
    assert drives == EVERYTHING


def test_a_page_opens_even_where_the_kernels_cannot_be_compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail() -> None:
        raise OSError

    monkeypatch.setattr(module, "is_done", lambda _: True)
    monkeypatch.setattr(module, "first_task", fail)
    one = Warmup()
    one.start()
    assert one.ready.wait(30)
    assert one.reached == Reached(True, True, True, True)
