"""README.md tells the truth: its examples run, and its tables name what there is."""

import json
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from railjoule.core.scenario import STRATEGY_NAMES, load_scenario, preset_names
from railjoule.core.strategies import STRATEGIES

ROOT = Path(__file__).parents[1]
TEXT = (ROOT / "README.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```(\w+)\n(.*?)```", TEXT, re.DOTALL)


def blocks(language: str) -> list[str]:
    return [block for kind, block in BLOCKS if kind == language]


COMMANDS = [line for block in blocks("sh") for line in block.splitlines() if line.startswith("railjoule ")]


def run_python(arguments: list[str], folder: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, *arguments],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )


def test_first_block_is_the_two_commands():
    assert BLOCKS[0] == ("sh", "./run serve\n./run test\n")


def test_python_example_prints_what_is_shown(tmp_path):
    (example,), (shown,) = blocks("python"), blocks("text")
    run = run_python(["-c", example], tmp_path)
    assert run.stderr == ""
    assert run.stdout == shown


@pytest.fixture
def folder(tmp_path):
    """A folder with the scenario file that README shows."""
    (example,) = blocks("toml")
    (tmp_path / "metro.toml").write_text(example, encoding="utf-8")
    return tmp_path


def test_scenario_example_is_valid(folder):
    scenario = load_scenario(folder / "metro.toml")
    assert scenario.vehicle.preset == "metro-81-7036"
    assert scenario.line.stations[0].dwell_s == 25


@pytest.mark.parametrize("command", COMMANDS)
def test_command_runs(command, folder):
    _, *arguments = shlex.split(command)
    run = run_python(["-m", "railjoule.dashboard", *arguments], folder)
    assert (run.returncode, run.stderr) == (0, "")
    assert run.stdout
    if "--json" in arguments:
        assert json.loads(run.stdout)["gap"] < 1e-6
    if "--trajectory" in arguments:
        assert (folder / "run.csv").stat().st_size > 1000


def test_bad_input_ends_as_told(folder):
    arguments = ["solve", "metro.toml", "--set", "timetable.travel_time_s=30"]
    run = run_python(["-m", "railjoule.dashboard", *arguments], folder)
    assert run.returncode == 2
    assert run.stderr.count("\n") == 1


def test_commands_without_an_example_exist(folder):
    for command in ("serve", "benchmark"):
        assert f"`railjoule {command}`" in TEXT
        assert run_python(["-m", "railjoule.dashboard", command, "--help"], folder).returncode == 0


def test_strategies_are_those_that_exist():
    table = TEXT.partition("## Strategies")[2].partition("##")[0]
    named = re.findall(r"^\| `(\w+)`", table, re.MULTILINE)
    assert named == list(STRATEGIES)
    assert set(named) <= set(STRATEGY_NAMES)


def test_presets_are_those_that_exist():
    table = TEXT.partition("## Where the presets' numbers come from")[2].partition("##")[0]
    named = re.findall(r"`([\w-]+)`", table)
    named = [f"liashenko{name}" if name.startswith("-") else name for name in named]
    assert sorted(named) == sorted([*preset_names("vehicles"), *preset_names("lines")])


def test_shipped_scenarios_are_those_that_exist():
    sentence = TEXT.partition("The shipped scenarios are ")[2].partition(". ")[0]
    assert re.findall(r"`([\w-]+)`", sentence) == list(preset_names("scenarios"))
