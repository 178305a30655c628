"""The keys of compiled kernels, and where they are saved."""

import logging
import os
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

from railjoule.core import kernel_cache
from railjoule.core.compilation import require_compiled
from railjoule.core.kernel_cache import VARIABLE, KernelLocator, cache_folder, module_files, module_hash, source_hash

HELPER = '''"""A helper."""

G = 9.81


def weight(m):
    """Return N."""
    return m * G
'''
KERNEL = """from railjoule.core.inner.helper import weight


def force(m):
    return weight(m)
"""


CACHES = (
    kernel_cache._path,
    kernel_cache._source,
    kernel_cache._store,
    kernel_cache.module_hash,
    kernel_cache.cache_folder,
)


@pytest.fixture
def package(tmp_path, monkeypatch):
    """A package in the place of the core: `kernel` imports `helper`, and `other` imports nothing."""
    core = tmp_path / "core"
    (core / "inner").mkdir(parents=True)
    for name, text in (
        ("__init__", ""),
        ("inner/__init__", ""),
        ("inner/helper", HELPER),
        ("kernel", KERNEL),
        ("other", "def nothing():\n    return 0\n"),
    ):
        (core / f"{name}.py").write_text(text)
    monkeypatch.setattr(kernel_cache, "CORE", core)
    monkeypatch.setenv(VARIABLE, str(tmp_path / "cache"))
    return core


def keys():
    """Return the keys of both modules, read anew."""
    for known in CACHES:
        known.cache_clear()
    return module_hash("railjoule.core.kernel"), module_hash("railjoule.core.other")


@pytest.fixture(autouse=True)
def forget():
    """Read the real sources again after each test."""
    yield
    for known in CACHES:
        known.cache_clear()


def test_a_changed_constant_in_an_imported_module_changes_only_the_keys_that_depend_on_it(package):
    kernel, other = keys()
    helper = package / "inner" / "helper.py"
    helper.write_text(helper.read_text().replace("9.81", "9.80665"))
    changed, same = keys()
    assert changed != kernel
    assert same == other


@pytest.mark.parametrize(
    ("old", "new"),
    [("A helper.", "Another helper."), ("Return N.", "Return the weight [N]."), ("G = 9.81", "# m/s2\nG = 9.81")],
)
def test_a_changed_comment_or_docstring_changes_no_key(package, old, new):
    before = keys(), source_hash(package)
    helper = package / "inner" / "helper.py"
    text = helper.read_text()
    assert old in text
    helper.write_text(text.replace(old, new))
    assert keys() == before[0]
    assert source_hash(package) == before[1]


@pytest.mark.parametrize("change", ["edited", "renamed", "added"])
def test_the_hash_of_a_package_changes_with_any_code(package, change):
    before = source_hash(package)
    source = package / "other.py"
    if change == "edited":
        source.write_text("def nothing():\n    return 1\n")
    elif change == "renamed":
        source.rename(package / "another.py")
    else:
        (package / "new.py").touch()
    kernel_cache._source.cache_clear()
    assert source_hash(package) != before
    assert len(before) == 16


def test_a_file_is_parsed_once(package, monkeypatch):
    keys()
    monkeypatch.setattr(kernel_cache, "_parse", lambda _: pytest.fail("parsed again"))
    keys()


def test_a_spoilt_store_of_hashes_is_made_again(package):
    before = keys()
    (cache_folder() / kernel_cache.STORE).write_text("{ no json")
    assert keys() == before


def test_a_kernel_does_not_depend_on_the_whole_core():
    files = {path.relative_to(kernel_cache.CORE).as_posix() for path in module_files("railjoule.core.physics.cell")}
    assert {"compiled.py", "physics/resistance.py"} <= files
    assert not files & {"__init__.py", "compilation/__init__.py", "strategies/__init__.py"}


def test_other_packages_keep_numbas_own_places():
    assert KernelLocator.from_function(textwrap.dedent, textwrap.__file__) is None


def test_the_kernels_of_two_former_versions_are_kept(tmp_path):
    kernel_cache._make_folder.cache_clear()
    for number in range(4):
        folder = tmp_path / "solver" / f"{number}"
        folder.mkdir(parents=True)
        os.utime(folder, (number, number))
    kernel_cache._make_folder(tmp_path / "solver" / "new")
    assert sorted(path.name for path in (tmp_path / "solver").iterdir()) == ["3", "new"]


def test_folders_of_the_first_release_are_removed(tmp_path, monkeypatch):
    for variable in ("XDG_CACHE_HOME", "LOCALAPPDATA"):
        monkeypatch.setenv(variable, str(tmp_path))
    for name in ("numba-0123456789abcdef", "kernels"):
        (tmp_path / "railjoule" / name).mkdir(parents=True)
    kernel_cache.remove_old_formats()
    assert [path.name for path in (tmp_path / "railjoule").iterdir()] == ["kernels"]


MISSES = """
import gc
from numba.core.dispatcher import Dispatcher
from railjoule.core import load_scenario, solve
solve(load_scenario("liashenko-ii"))
kernels = [one for one in gc.get_objects() if isinstance(one, Dispatcher) and one.__module__.startswith("railjoule")]
print(sum(len(one.stats.cache_hits) for one in kernels), sum(len(one.stats.cache_misses) for one in kernels))
"""


def output(code, **variables):
    """Return the words that a new process prints."""
    environment = {**os.environ, **variables}
    command = [sys.executable, "-c", code]
    return subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout.split()


def test_a_second_process_compiles_nothing():
    """No kernel of the solver takes a function: it would never find its compiled form again."""
    require_compiled()
    hits, misses = map(int, output(MISSES))
    assert hits > 0
    assert misses == 0


def test_the_users_own_folder_is_taken_and_numbas_settings_stay(tmp_path):
    code = "import numba; from railjoule.core import kernel_cache as k; print(k.cache_folder(), numba.config.CACHE_DIR)"
    own = str(tmp_path / "own")
    assert output(code, **{VARIABLE: own}) == [own, own]


@pytest.mark.parametrize("variable", [VARIABLE, "XDG_CACHE_HOME"])
def test_a_folder_that_takes_no_files_is_replaced_and_logged_in_one_line(tmp_path, monkeypatch, caplog, variable):
    """By a new folder of this user alone: what lies in a cache is run."""
    file = tmp_path / "file"
    file.touch()
    # empty, so that what is set here does not outlive this test
    monkeypatch.setenv(VARIABLE, "")
    monkeypatch.setenv(variable, str(file / "below"))
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    kernel_cache.cache_folder.cache_clear()
    with caplog.at_level(logging.WARNING):
        folder = cache_folder()
    assert folder.parent == tmp_path
    assert folder.stat().st_mode & 0o077 == 0
    assert Path(os.environ[VARIABLE]) == folder
    (record,) = caplog.records
    assert str(file) in record.getMessage()
