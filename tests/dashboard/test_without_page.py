"""The command line works where only the core's packages are installed: `pip install railjoule` without extras."""

import json
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from packaging.requirements import Requirement

PROJECT = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text(encoding="utf-8"))["project"]
PAGE = sorted(Requirement(text).name.replace("-", "_") for text in PROJECT["optional-dependencies"]["page"])
RUN = """
import io, json, sys
from contextlib import redirect_stderr, redirect_stdout

class Refused:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in PAGE:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)

PAGE, commands = json.loads(sys.argv[1])
sys.meta_path.insert(0, Refused())
from railjoule.dashboard.command.cli import main

answers = []
for command in commands:
    with redirect_stdout(io.StringIO()) as out, redirect_stderr(io.StringIO()) as err:
        answers.append((main(command), out.getvalue(), err.getvalue()))
print(json.dumps(answers))
"""


@pytest.fixture(scope="module")
def run_file(tmp_path_factory: pytest.TempPathFactory) -> str:
    return str(tmp_path_factory.mktemp("run") / "run.csv")


def answers(*commands: list[str]) -> list[tuple[int, str, str]]:
    """Return the exit status, output and complaint of commands in a process that cannot import the page's packages."""
    told = json.dumps([PAGE, commands])
    process = subprocess.run([sys.executable, "-c", RUN, told], capture_output=True, text=True, timeout=300, check=True)
    return [tuple(answer) for answer in json.loads(process.stdout)]


def test_the_packages_of_the_page_are_known() -> None:
    assert {"bokeh", "jinja2", "panel", "panel_material_ui", "param"} <= set(PAGE)


def test_every_command_of_the_core_works(run_file: str) -> None:
    commands = [
        ["solve", "liashenko-0", "--check", "--trajectory", run_file],
        ["check", run_file, "--scenario", "liashenko-0"],
        ["compare", "liashenko-0"],
        ["simulate", "liashenko-0", "--set", "disturbance.coordinate_error_m=5"],
        ["simulate", "tram-950m-stop"],
        ["simulate", "ftorek-300s", "--set", "simulation.kind=field_oriented", "solver.mesh_m=100"],
        ["study", "tradeoff", "liashenko-0", "-o", run_file.replace("run.csv", "table.csv")],
        ["validate", "rawicki"],
        ["--version"],
    ]
    for command, (status, out, err) in zip(commands, answers(*commands), strict=True):
        assert (status, err) == (0, ""), command
        assert out


def test_page_and_report_say_what_to_install(tmp_path: Path) -> None:
    served, reported = answers(["serve"], ["report", "liashenko-0", "-o", str(tmp_path / "report.html")])
    for what, (status, out, err) in (("the dashboard", served), ("a report", reported)):
        assert (status, out) == (2, "")
        assert err.startswith(f"railjoule: {what} needs ")
        assert err.endswith(", which is not installed: pip install 'railjoule[page]'.\n")
    assert not (tmp_path / "report.html").exists()
