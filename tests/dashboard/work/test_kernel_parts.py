import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from railjoule.core.compiled import specialisations
from railjoule.core.strategies import spacing
from railjoule.dashboard.state.scenario import FIRST_SCENARIO
from railjoule.dashboard.state.workbench import Workbench
from railjoule.dashboard.work import kernel_parts as module
from railjoule.dashboard.work.kernel_parts import (
    ALL,
    FIRST,
    FIRST_STRATEGIES,
    KERNELS,
    PARTS,
    PARTS_FIRST,
    SHARES,
    all_kernels,
    begun,
    compile_parts,
    is_done,
    progress,
    tell_done,
)

PIECES_BEFORE_THE_WHOLE = """
from railjoule.core.interior_point.proof import prove
from railjoule.core.interior_point.solver import minimise_energy
from railjoule.dashboard.work.kernel_parts import PARTS

for part in ("tasks", "fastest", "advice", "proof", "solver", "optimum"):
    PARTS[part]()
print(len(minimise_energy.signatures), len(prove.signatures))
"""


def test_the_parts_are_shared_out_each_once() -> None:
    assert sorted(part for share in SHARES for part in share) == sorted(PARTS)
    assert set(PARTS_FIRST) <= set(PARTS)


def test_the_first_page_is_the_one_with_which_a_page_opens() -> None:
    assert FIRST == FIRST_SCENARIO
    assert set(FIRST_STRATEGIES) == set(Workbench().drawn)


def test_pieces_are_compiled_for_the_types_that_the_whole_has() -> None:
    command = [sys.executable, "-c", PIECES_BEFORE_THE_WHOLE]
    assert subprocess.run(command, capture_output=True, text=True, check=True).stdout.split() == ["1", "1"]


def test_a_coarse_metro_uses_both_ways_of_mending_what_switches_too_soon(monkeypatch: pytest.MonkeyPatch) -> None:
    used: set[str] = set()
    for kernel in (spacing.given_up, spacing.lengthened):

        def call(*arguments: Any, kernel: Any = kernel) -> Any:
            used.add(kernel.__name__)
            return kernel(*arguments)

        monkeypatch.setattr(spacing, kernel.__name__, call)
    PARTS["metro"]()
    PARTS["regulators"]()
    assert used == {"given_up", "lengthened"}


def test_progress_counts_what_this_process_and_others_have_compiled(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    here = min(sum(map(specialisations, all_kernels())), KERNELS)
    assert progress()[1] == KERNELS
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    assert progress() == (here, KERNELS)
    (tmp_path / "motion").mkdir()
    for number in range(here + 1):
        (tmp_path / "motion" / f"passes.kernel-{number}.py311.nbi").touch()
    assert progress() == (min(here + 1, KERNELS), KERNELS)


def test_one_core_compiles_in_one_process(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "cpu_count", lambda: 1)
    assert begun() == []


def test_a_filled_cache_is_known_again(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    assert not is_done(ALL)
    tell_done(ALL)
    assert is_done(ALL)
    with monkeypatch.context() as elsewhere:
        # a second copy of the same sources shares the folder, but not the kernels
        elsewhere.setattr(module, "__file__", str(tmp_path / "copy" / "kernel_parts.py"))
        assert not is_done(ALL)
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "missing"))
    tell_done(ALL)
    assert not is_done(ALL)


def test_a_start_goes_on_where_the_one_before_it_ended(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    done: list[str] = []
    monkeypatch.setattr(module, "PARTS", {name: lambda name=name: done.append(name) for name in PARTS})
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    compile_parts(["solver", "optimum"])
    compile_parts(["solver", "optimum", "metro"])
    assert done == ["solver", "optimum", "metro"]


def test_a_process_that_compiles_ends_with_its_parent() -> None:
    # the parent ends at once; its child, which would sleep for a minute, holds the output open until it ends
    child = (
        "import time; from railjoule.dashboard.work.kernel_parts import help_out; help_out({parent}); time.sleep(60)"
    )
    parent = (
        "import os, subprocess, sys; child = sys.argv[1].format(parent=os.getpid());"
        "print(subprocess.Popen([sys.executable, '-c', child]).pid)"
    )
    command = [sys.executable, "-c", parent, child]
    told = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True, timeout=50)
    assert told.stdout.strip().isdigit()
