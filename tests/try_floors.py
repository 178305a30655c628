"""`python -m tests.try_floors` installs the lowest releases that pyproject.toml allows, and tries them.

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
from pathlib import Path

from tests.trust.floors import ROOT, allowed

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


def runtime_floors() -> list[str]:
    """Return the lowest allowed releases of what the core and the page need, as pip takes them."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = project["optional-dependencies"]
    wanted = {line.split(">=")[0].strip().lower() for line in (*project["dependencies"], *extras["page"])}
    return [
        f"{name}=={least}"
        for name, least in sorted(allowed().items())
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
            done = subprocess.run(command, cwd=place, timeout=LONGEST_S, check=False)
            if done.returncode:
                print(f"{what} the floors failed; the lines above say why.", file=sys.stderr)
                return 1
    print("the floors are good:", ", ".join(floors))
    return 0


if __name__ == "__main__":
    sys.exit(main())
