"""pyproject.toml packs everything that the program needs; setuptools finds nothing in mapped folders by itself."""

import ast
import re
import subprocess
import sys
import tomllib
from collections.abc import Iterable
from importlib.metadata import entry_points
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
SETUPTOOLS = PROJECT["tool"]["setuptools"]
FOLDERS = {package: ROOT / folder for package, folder in SETUPTOOLS["package-dir"].items()}
UNPACKED = {"docs", "pictures"}
"""Folders of what only README and the documentation show: they stay out of the wheel."""


def packages_on_disk() -> set[str]:
    return {
        ".".join((package, *path.parent.relative_to(folder).parts))
        for package, folder in FOLDERS.items()
        for path in folder.rglob("*.py")
        if UNPACKED.isdisjoint(path.relative_to(folder).parts)
    }


def test_every_package_is_listed():
    assert set(SETUPTOOLS["packages"]) == packages_on_disk()
    assert SETUPTOOLS["packages"] == sorted(SETUPTOOLS["packages"])


def test_every_data_file_is_packed():
    packed = {
        path
        for package, patterns in SETUPTOOLS["package-data"].items()
        for pattern in patterns
        for path in FOLDERS[package].glob(pattern)
    }
    data = {
        path
        for folder in FOLDERS.values()
        for path in folder.rglob("*")
        if path.is_file() and path.suffix not in {".py", ".pyc"} and UNPACKED.isdisjoint(path.relative_to(folder).parts)
    }
    assert data - packed == set()


def test_what_only_readme_and_documentation_show_stays_out():
    assert SETUPTOOLS["exclude-package-data"]["railjoule.assets"] == [f"{name}/*" for name in sorted(UNPACKED)]


def test_command_is_installed():
    (command,) = entry_points(group="console_scripts", name="railjoule")
    assert command.value == PROJECT["project"]["scripts"]["railjoule"]
    assert callable(command.load())


EXTRAS = PROJECT["project"]["optional-dependencies"]
COMMAND_LINE = (
    *(
        f"command/{name}"
        for name in ("cli", "cluster", "commands", "imports", "measurements", "summary", "sweeps", "terminal")
    ),
    "keep/dropped",
    "look/comparisons",
    "look/words",
)
"""Modules of the dashboard that need nothing of the page."""


def imported_packages(paths: Iterable[Path]) -> set[str]:
    """Return the packages of others that files import anywhere."""
    found: set[str] = set()
    for path in paths:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                found |= {alias.name.partition(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.level == 0:
                found.add(str(node.module).partition(".")[0])
    return found - sys.stdlib_module_names - {"railjoule"}


def declared(requirements: Iterable[str]) -> set[str]:
    """Return the packages that requirements name, as they are imported."""
    return {Requirement(text).name.replace("-", "_") for text in requirements}


DEPENDENCIES = declared(PROJECT["project"]["dependencies"])
IMPORTED_AS = {"pyyaml": "yaml"}
"""Packages that are imported by another name."""
OF_THE_CORE = ("cluster", "excel", "parquet", "plot", "yaml")
SELDOM = {IMPORTED_AS.get(name, name) for extra in OF_THE_CORE for name in declared(EXTRAS[extra])}
"""Packages that read or write a kind of file, or find a cluster, each imported where that is asked for."""
NOTEBOOK = ROOT / "dashboard" / "notebook.py"
CLUSTER = ROOT / "dashboard" / "command" / "cluster.py"


def test_dependencies_are_those_that_the_core_and_the_command_line_use():
    dashboard = ROOT / "dashboard"
    paths = [*(ROOT / "core").rglob("*.py"), *(dashboard / f"{name}.py" for name in COMMAND_LINE)]
    assert imported_packages(paths) == DEPENDENCIES | SELDOM


def test_the_extra_of_the_page_has_what_it_needs_beside_them():
    paths = set((ROOT / "dashboard").rglob("*.py")) - {NOTEBOOK, CLUSTER}
    assert declared(EXTRAS["page"]) == imported_packages(paths) - DEPENDENCIES


def test_the_extra_of_notebooks_has_what_they_need_beside_the_page():
    used = imported_packages([NOTEBOOK]) - DEPENDENCIES - declared(EXTRAS["page"])
    assert declared(EXTRAS["notebook"]) == used | {"railjoule"}
    assert "railjoule[page]" in EXTRAS["notebook"]


def test_the_tests_have_notebooks_and_with_them_the_page():
    assert {"railjoule[notebook]", "railjoule[excel]", "railjoule[yaml]"} <= set(EXTRAS["test"])


REQUIREMENTS = [
    Requirement(text)
    for text in [*PROJECT["project"]["dependencies"], *(text for extra in EXTRAS.values() for text in extra)]
    if Requirement(text).name != "railjoule"
]
BOUNDED = {"bokeh", "panel", "panel-material-ui"}
"""Packages whose private API is used: see dashboard/library_workarounds.py."""


def test_dependencies_have_lower_bounds_and_those_with_private_api_in_use_upper_ones():
    bounds = {one.name: sorted(bound.operator for bound in one.specifier) for one in REQUIREMENTS}
    assert bounds == {name: ["<", ">="] if name in BOUNDED else [">="] for name in bounds}
    assert bounds.keys() >= BOUNDED


def test_the_constraints_are_names_and_releases_within_the_bounds():
    lines = (ROOT / "constraints.txt").read_text(encoding="utf-8").splitlines()
    listed = [re.fullmatch(r"([A-Za-z0-9._-]+)==([0-9][0-9a-z.]*)", line) for line in lines if line[:1] != "#"]
    assert all(listed)
    releases = {canonicalize_name(found[1]): found[2] for found in listed if found}
    assert len(releases) == len(listed)
    for one in REQUIREMENTS:
        assert releases[canonicalize_name(one.name)] in one.specifier, one


def test_the_package_has_its_version():
    import railjoule  # noqa: PLC0415

    assert railjoule.__version__ == PROJECT["project"]["version"]
    with pytest.raises(AttributeError, match="no attribute 'versions'"):
        _ = railjoule.versions


def test_a_checkout_of_the_same_name_does_not_hide_the_installed_package(tmp_path):
    (tmp_path / "railjoule" / "core").mkdir(parents=True)
    (tmp_path / "railjoule" / "core" / "__init__.py").write_text("raise SystemExit('the checkout was imported')")
    subprocess.run([sys.executable, "-c", "import railjoule.core"], cwd=tmp_path, check=True)
