import os
import subprocess
import sys
from pathlib import Path

import pytest

from railjoule.dashboard.state.scenario import FIRST_SCENARIO
from railjoule.dashboard.state.workbench import Workbench
from railjoule.dashboard.work import warmup as module
from railjoule.dashboard.work.warmup import APART, FIRST, FIRST_KERNELS, FIRST_STRATEGIES, Warmup, all_kernels, begun

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
from railjoule.dashboard.work.warmup import all_kernels, warmup

def compiled():
    return {kernel.py_func.__qualname__: len(kernel.signatures) for kernel in all_kernels()}

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


def test_nothing_is_left_to_compile_after_the_warm_up() -> None:
    result = subprocess.run([sys.executable, "-c", EVERY_STRATEGY], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == "{}"


def test_progress_counts_kernels() -> None:
    done, count = Warmup().progress
    assert 0 <= done <= count == FIRST_KERNELS < len(list(all_kernels()))


def test_the_first_page_is_the_one_with_which_a_page_opens() -> None:
    assert FIRST == FIRST_SCENARIO
    assert set(FIRST_STRATEGIES) == set(Workbench().drawn)


class Helper:
    """A process that compiles elsewhere, as the warm-up sees it."""

    def __init__(self, *parts: str) -> None:
        self.parts, self.killed = parts, False

    def wait(self) -> int:
        return 1  # what it could not do, the process itself does

    def kill(self) -> None:
        self.killed = True


@pytest.mark.parametrize("filled", [False, True])
def test_other_processes_compile_behind_the_first_page_where_the_cache_is_empty(
    monkeypatch: pytest.MonkeyPatch, filled: bool
) -> None:
    done: list[str] = []
    helpers: list[Helper] = []
    one = Warmup()

    def begin(*parts: str) -> list[Helper]:
        helpers.append(Helper(*parts))
        return helpers[-1:]

    monkeypatch.setattr(module, "is_filled", lambda: filled)
    monkeypatch.setattr(module, "begun", begin)
    monkeypatch.setattr(module, "drive_first", lambda: done.append(f"first {one.first.is_set()}"))
    monkeypatch.setattr(module, "drive_all", lambda: done.append(f"all {one.first.is_set()} {one.ready.is_set()}"))
    one.start()
    assert one.ready.wait(30)
    assert done == ["first False", "all True False"]
    assert [helper.parts for helper in helpers] == ([] if filled else [(APART,), ()])
    one.wait()
    assert all(helper.killed for helper in helpers)


def test_a_page_opens_even_where_the_kernels_cannot_be_compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail() -> None:
        raise OSError

    monkeypatch.setattr(module, "is_filled", lambda: True)
    monkeypatch.setattr(module, "drive_first", fail)
    one = Warmup()
    one.start()
    assert one.ready.wait(30)
    assert one.first.is_set()


def test_one_core_compiles_in_one_process(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "cpu_count", lambda: 1)
    assert begun() == []


def test_a_filled_cache_is_known_again(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    assert not module.is_filled()
    module.tell_done()
    assert module.is_filled()
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "missing"))
    module.tell_done()
    assert not module.is_filled()


def test_a_process_that_compiles_ends_with_its_parent() -> None:
    # the parent ends at once; its child, which would sleep for a minute, holds the output open until it ends
    child = "import time; from railjoule.dashboard.work.warmup import help_out; help_out({parent}); time.sleep(60)"
    parent = (
        "import os, subprocess, sys; child = sys.argv[1].format(parent=os.getpid());"
        "print(subprocess.Popen([sys.executable, '-c', child]).pid)"
    )
    command = [sys.executable, "-c", parent, child]
    told = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True, timeout=50)
    assert told.stdout.strip().isdigit()
