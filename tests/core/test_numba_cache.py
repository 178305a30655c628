"""Two traps of numba's cache, each in processes of their own.

Numba looks at a kernel's own file alone: an edited helper elsewhere would keep its old number. And a kernel that takes
a function never finds itself in the cache again.
"""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from railjoule.core import _numba_cache, load_scenario, solve
from railjoule.core._numba_cache import VARIABLE, cache_root, source_hash

PACKAGE = {
    "__init__.py": "from small._numba_cache import select_cache_folder\n\nFOLDER = select_cache_folder()\n",
    "helper.py": "import numba\n\n\n@numba.njit(cache=True)\ndef resistance(v):\n    return 2.0 * v\n",
    "total.py": (
        "import numba\n\nfrom small.helper import resistance\n\n\n"
        "@numba.njit(cache=True)\ndef total(v):\n    return 1.0 + resistance(v)\n\n\n"
        "if __name__ != '__main__':\n    print(total(3.0), sum(total.stats.cache_hits.values()))\n"
    ),
}


def answer(code, folder, **variables):
    """Return what a new process prints that keeps its cache below a folder."""
    environment = {**os.environ, "XDG_CACHE_HOME": str(folder), "LOCALAPPDATA": str(folder)}
    environment.pop(VARIABLE, None)
    command = [sys.executable, "-c", code]
    return subprocess.run(
        command, env={**environment, **variables}, capture_output=True, text=True, check=True
    ).stdout.split()


@pytest.fixture
def small(tmp_path):
    """A package with the core's cure, and a kernel that calls one of another file."""
    package = tmp_path / "small"
    package.mkdir()
    shutil.copy(_numba_cache.__file__, package)
    for name, text in PACKAGE.items():
        (package / name).write_text(text)
    return package


def test_an_edited_helper_gives_a_new_number_and_an_unchanged_one_a_hit(small, tmp_path):
    def start():
        return answer("import small.total", tmp_path, PYTHONPATH=str(tmp_path))

    assert start() == ["7.0", "0"]
    assert start() == ["7.0", "1"]
    helper = small / "helper.py"
    helper.write_text(helper.read_text().replace("2.0", "20.0"))
    assert start() == ["61.0", "0"]
    assert start() == ["61.0", "1"]


def test_the_core_selects_its_folder_even_where_numba_was_imported_first(tmp_path):
    expected = tmp_path / "railjoule" / f"numba-{source_hash(Path(_numba_cache.__file__).parent)}"
    code = "import {first}, railjoule.core, numba, os; print(os.environ['{variable}'], numba.config.CACHE_DIR)"
    for first in ("railjoule.core", "numba"):
        assert answer(code.format(first=first, variable=VARIABLE), tmp_path) == [str(expected)] * 2


def test_the_users_own_folder_stays(tmp_path):
    own = str(tmp_path / "own")
    code = f"import railjoule.core, numba, os; print(os.environ['{VARIABLE}'], numba.config.CACHE_DIR)"
    assert answer(code, tmp_path, **{VARIABLE: own}) == [own] * 2


MISSES = """
import gc
from numba.core.dispatcher import Dispatcher
from railjoule.core import load_scenario, solve
solve(load_scenario("liashenko-ii"))
kernels = [one for one in gc.get_objects() if isinstance(one, Dispatcher) and one.__module__.startswith("railjoule")]
print(sum(len(one.stats.cache_hits) for one in kernels), sum(len(one.stats.cache_misses) for one in kernels))
"""


def test_a_second_process_compiles_nothing(tmp_path):
    """As no kernel of the solver takes a function; the cache is the one that this process fills."""
    solve(load_scenario("liashenko-ii"))
    hits, misses = answer(MISSES, tmp_path, **{VARIABLE: os.environ[VARIABLE]})
    assert int(hits) > 0
    assert int(misses) == 0


@pytest.mark.parametrize("change", ["edited", "renamed", "added"])
def test_the_hash_changes_with_any_source(tmp_path, change):
    (tmp_path / "inner").mkdir()
    source = tmp_path / "inner" / "kernel.py"
    source.write_text("x = 1\n")
    before = source_hash(tmp_path)
    assert before == source_hash(tmp_path)
    if change == "edited":
        source.write_text("x = 2\n")
    elif change == "renamed":
        source.rename(tmp_path / "kernel.py")
    else:
        (tmp_path / "other.py").touch()
    assert source_hash(tmp_path) != before
    assert len(before) == 16


def test_a_home_that_cannot_be_written_to_is_replaced(monkeypatch, tmp_path):
    """By a new folder that is this user's alone: what lies in a cache is run."""
    blocked = tmp_path / "file"
    blocked.touch()
    for variable in ("XDG_CACHE_HOME", "LOCALAPPDATA"):
        monkeypatch.setenv(variable, str(blocked))
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    root = cache_root()
    assert root.parent == tmp_path
    assert root.stat().st_mode & 0o077 == 0
    assert cache_root() != root


@pytest.mark.parametrize("variable", [VARIABLE, "XDG_CACHE_HOME"])
def test_a_folder_that_takes_no_files_is_told_in_one_sentence(tmp_path, variable):
    file = tmp_path / "file"
    file.write_text("no folder")
    code = f"import railjoule.core, os; print(os.environ['{VARIABLE}'])"
    environment = {**os.environ, "XDG_CACHE_HOME": str(tmp_path), "LOCALAPPDATA": str(tmp_path)}
    environment.pop(VARIABLE, None)
    environment[variable] = str(file / "below")
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
    assert str(file) not in done.stdout
    (told,) = done.stderr.splitlines()
    assert told.startswith("railjoule cannot keep its compiled kernels (")
    assert str(file) in told


def test_a_folder_that_is_lost_while_kernels_compile_ends_nothing(small, tmp_path):
    code = "import small, shutil, small.helper; shutil.rmtree(small.FOLDER); print(small.helper.resistance(3.0))"
    assert answer(code, tmp_path, PYTHONPATH=str(tmp_path)) == ["6.0"]
