"""Versions and commit of the program that made a result, and the documentation that was built beside it."""

import importlib.metadata
import json
import platform
import shlex
import subprocess
import sys
from functools import cache
from pathlib import Path

import railjoule.core
from railjoule.core.citation import bibtex, package_version

PACKAGES = ("numpy", "scipy", "numba", "bokeh")
GIT_S = 5.0
"""Longest wait for git [s]."""


@cache
def commit() -> str:
    """Return the commit that railjoule was installed from or is run from; empty where it is not known."""
    package = _distribution("railjoule")
    origin = package and package.read_text("direct_url.json")
    installed = json.loads(origin or "{}").get("vcs_info", {}).get("commit_id", "")
    return str(installed) or _checkout_commit(Path(railjoule.core.__file__).resolve().parents[1])


def _checkout_commit(folder: Path) -> str:
    """Return the commit of a checkout, marked where files have changed since; empty for other folders."""
    # the folder itself, as an installation may lie within a repository of its user
    if not (folder / ".git").exists():
        return ""
    command = ["git", "-C", str(folder), "describe", "--always", "--dirty", "--exclude=*", "--abbrev=12"]
    try:
        found = subprocess.run(command, capture_output=True, text=True, timeout=GIT_S, check=False)
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return found.stdout.strip() if found.returncode == 0 else ""


def versions() -> dict[str, str]:
    """Return the versions of railjoule, of the packages that its numbers depend on, and of Python."""
    numbers = {"railjoule": package_version(), **({"commit": commit()} if commit() else {})}
    installed = {found.name: found.version for found in map(_distribution, PACKAGES) if found is not None}
    return {**numbers, **installed, "Python": platform.python_version()}


def _distribution(name: str) -> importlib.metadata.Distribution | None:
    try:
        return importlib.metadata.distribution(name)
    except importlib.metadata.PackageNotFoundError:
        return None


def file_attributes() -> dict[str, str]:
    """Return version, commit, command and citation as attributes of a file that the command line writes."""
    attributes = {"version": package_version(), "commit": commit(), "citation": bibtex([])}
    command = shlex.join(["railjoule", *sys.argv[1:]])
    return {f"railjoule_{name}": text for name, text in {**attributes, "command": command}.items() if text}


def about_text(command: str, citation: str) -> str:
    """Return the text that goes with result files: versions, the command that makes them again, and the citation."""
    program = "\n".join(f"{name} {number}" for name, number in versions().items())
    return (
        f"{program}\n\nThe same numbers by the command line:\n\n{command.strip()}\n\nTo cite:\n\n{citation.strip()}\n"
    )


# an editable install maps each file by a link; an installed package has no such folder
FOLDER = Path(__file__).resolve().parents[1] / "build" / "docs"
"""The folder in a checkout that `./run docs` writes to."""
FRONT = "index.html"


def is_built(folder: Path | str = FOLDER) -> bool:
    """Return whether a folder has the front page of the documentation."""
    return (Path(folder) / FRONT).is_file()
