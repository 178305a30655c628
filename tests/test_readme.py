"""README.md tells the truth: its examples run, and its tables name what there is."""

import json
import re
import shlex
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest

from railjoule.core import solve
from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.drive.power_terms import PowerTerms
from railjoule.core.scenario import STRATEGY_NAMES, load_scenario, preset_names, scenario_from_document
from railjoule.core.strategies import STRATEGIES, prepare_task
from railjoule.dashboard.models.pages import PAGES

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
    example, (shown,) = blocks("python")[0], blocks("text")
    run = run_python(["-c", example], tmp_path)
    assert run.stderr == ""
    assert run.stdout == shown


@pytest.fixture
def folder(tmp_path):
    """A folder with the scenario file that README shows."""
    example = blocks("toml")[0]
    (tmp_path / "metro.toml").write_text(example, encoding="utf-8")
    return tmp_path


def test_scenario_example_is_valid(folder):
    scenario = load_scenario(folder / "metro.toml")
    assert scenario.vehicle.preset == "metro-81-7036"
    assert scenario.line.stations[0].dwell_s == 25


def test_vehicle_and_line_that_are_added_make_a_scenario():
    vehicle, line = (tomllib.loads(block) for block in blocks("toml")[1:])
    document = {"vehicle": vehicle, "line": line, "timetable": {"average_speed_kmh": 40}}
    run = solve(scenario_from_document(document))
    assert run.distance_m == 1200
    assert run.speed_ms[run.position_m >= 800].max() * 3.6 <= 60 + 1e-9


def test_the_strategy_that_is_added_keeps_its_timetable():
    names = {}
    exec(blocks("python")[1], names)
    scenario = load_scenario("liashenko-ii")
    run = names["slowed"](prepare_task(scenario))
    assert run.travel_time_s == pytest.approx(scenario.travel_time_s)
    assert run.energy_kwh > solve(scenario).energy_kwh


def test_the_drive_that_is_added_gives_its_derivatives():
    """Against central differences of its own power; F v / 0.8 + 1e-6 F^2 by hand."""
    _, kernels = blocks("python")[2].split("# core/drive/mixed_loss.py")
    names = {"njit": njit, "FloatArray": FloatArray, "PowerTerms": PowerTerms}
    exec(kernels.replace("cache=True", ""), names)
    parameters = np.array([0.8, 1e-6])

    def power(effort, speed):
        return names["driving_power"](parameters, effort, speed)

    p, p_f, p_v, p_ff, p_fv, p_vv = power(1e4, 10.0)
    assert p == pytest.approx(1e5 / 0.8 + 100.0)
    for exact, index, df, dv in ((p_f, 0, 1.0, 0), (p_v, 0, 0, 1e-3), (p_ff, 1, 1.0, 0), (p_fv, 1, 0, 1e-3)):
        after, before = (power(1e4 + sign * df, 10.0 + sign * dv)[index] for sign in (1, -1))
        assert exact == pytest.approx((after - before) / (2 * (df + dv)), rel=1e-6)
    assert p_vv == 0


@pytest.mark.parametrize("command", COMMANDS)
def test_command_runs(command, folder):
    _, *arguments = shlex.split(command)
    if arguments[0] == "check":  # what the command before it has written
        (before,) = (line for line in COMMANDS if f"--trajectory {arguments[1]}" in line)
        run_python(["-m", "railjoule.dashboard", *shlex.split(before)[1:]], folder)
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


def test_pages_are_those_that_exist():
    table = TEXT.partition("| page | what it shows |")[2].partition("\n\n")[0]
    assert re.findall(r"^\| ([A-Z][\w -]*\w) \|", table, re.MULTILINE) == list(PAGES)


def test_pictures_are_there():
    named = re.findall(r"assets/pictures/[\w-]+\.png", TEXT)
    assert named
    assert all((ROOT / name).read_bytes().startswith(b"\x89PNG") for name in named)
