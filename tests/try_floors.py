"""`python -m tests.try_floors` installs the lowest releases that pyproject.toml allows, and tries them.

`ADVISORIES` has the lowest releases without a known advisory, from the packages' release notes and GitHub's advisory
database; a test compares them with pyproject.toml and constraints.txt.

Once a week, not in the gate: it makes a virtual environment of its own and needs an index of packages for some
minutes. What cannot be installed on this machine, such as releases without a wheel for this Python, is told.
"""

import argparse
import shutil
import subprocess
import sys
import tempfile
import tomllib
import venv
from collections.abc import Iterable, Mapping
from itertools import chain
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from packaging.version import Version

ROOT = Path(__file__).resolve().parents[1]
ADVISORIES = {
    "tornado": ("6.6.1", "CVE-2026-82397 and before it CVE-2026-49853/4/5, CVE-2026-31958, CVE-2025-67724/5/6"),
    "bokeh": ("3.8.2", "CVE-2026-21883: websockets of other origins"),
    "jinja2": ("3.1.6", "CVE-2025-27516: sandbox"),
    "requests": ("2.32.4", "CVE-2024-47081: netrc"),
    "urllib3": ("2.6.3", "CVE-2026-21441: decompression of redirects"),
    "pillow": ("11.3.0", "CVE-2025-48379: DDS"),
    "certifi": ("2024.7.4", "CVE-2024-39689"),
    "idna": ("3.7", "CVE-2024-3651"),
    "setuptools": ("78.1.1", "CVE-2025-47273"),
    "tqdm": ("4.66.3", "CVE-2024-34062"),
    "pyarrow": ("14.0.1", "CVE-2023-47248: reads of untrusted files"),
}
"""The lowest release of a package without a known advisory, and the last advisories before it."""
LONGEST_S = 1800
SMOKE = """
import railjoule.core as core
scenario = core.load_scenario("liashenko-ii")
run = core.solve(scenario)
assert not core.check_run(scenario, run).broken
print("solved", round(run.energy_kwh, 3))
from railjoule.dashboard.app import make_page
make_page().server_doc()
print("page made")
"""
"""The core solves and checks, and the dashboard makes a page."""


def lowest_releases(lines: Iterable[str]) -> dict[str, str]:
    """Return the lowest allowed release of each package that requirements state one for."""
    found = {}
    for requirement in map(Requirement, lines):
        floors = [one.version for one in requirement.specifier if one.operator in {">=", "=="}]
        if floors:
            found[str(canonicalize_name(requirement.name))] = floors[0]
    return found


def allowed_floors() -> dict[str, str]:
    """Return the lowest releases that pyproject.toml allows, of the build and all extras too."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    extras = project["project"]["optional-dependencies"].values()
    return lowest_releases(chain(project["build-system"]["requires"], project["project"]["dependencies"], *extras))


def constrained_releases() -> dict[str, str]:
    """Return the releases of constraints.txt."""
    lines = (ROOT / "constraints.txt").read_text(encoding="utf-8").splitlines()
    return lowest_releases(line for line in lines if "==" in line)


def known_advisories(releases: Mapping[str, str]) -> list[str]:
    """Return a sentence for each release with a known advisory."""
    return [
        f"{name} {releases[name]} is below {lowest} ({advisory})"
        for name, (lowest, advisory) in ADVISORIES.items()
        if name in releases and Version(releases[name]) < Version(lowest)
    ]


def runtime_floors() -> list[str]:
    """Return the lowest allowed releases of what the core and the page need, as pip takes them."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = project["optional-dependencies"]
    wanted = {line.split(">=")[0].strip().lower() for line in (*project["dependencies"], *extras["page"])}
    return [
        f"{name}=={least}"
        for name, least in sorted(allowed_floors().items())
        if name in {one.replace("_", "-") for one in wanted}
    ]


def main() -> int:
    """Install and try; return 0 if all went well."""
    parser = argparse.ArgumentParser(prog="python -m tests.try_floors", description=__doc__)
    parser.add_argument("--list", action="store_true", help="print the releases, and try nothing")
    floors = runtime_floors()
    if parser.parse_args().list:
        print("\n".join(floors))
        return 0
    with tempfile.TemporaryDirectory() as place:
        venv.create(place, with_pip=True)
        python = str(Path(place) / ("Scripts" if sys.platform == "win32" else "bin") / "python")
        # pip builds where the sources are, and an editable install has its files there
        source = Path(place) / "source"
        for part in ("package", "core", "dashboard", "assets"):
            shutil.copytree(ROOT / part, source / part)
        for name in ("pyproject.toml", "README.md", "LICENSE"):
            shutil.copy(ROOT / name, source)
        install = [python, "-m", "pip", "install", "--quiet", str(source), *floors]
        for what, command in (("installing", install), ("trying", [python, "-c", SMOKE])):
            if subprocess.run(command, cwd=place, timeout=LONGEST_S, check=False).returncode:
                print(f"{what} the floors failed; the lines above say why.", file=sys.stderr)
                return 1
    print("the floors are good:", ", ".join(floors))
    return 0


if __name__ == "__main__":
    sys.exit(main())
