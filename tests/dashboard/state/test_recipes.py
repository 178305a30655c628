import json
import subprocess
from pathlib import Path

import pytest

from railjoule.core import load_scenario, solve
from railjoule.core.scenario import format_scenario, parse_scenario
from railjoule.dashboard.command.cli import main
from railjoule.dashboard.state.recipes import FILE, as_command, as_python, as_toml, recipe_of, toml_value
from railjoule.dashboard.state.workbench import Workbench


@pytest.fixture
def state() -> Workbench:
    state = Workbench()
    state.scenario.choose("liashenko-i")
    state.scenario.param.update(travel_time_s=100.0, load_percent=30.0)
    return state


def energy_of_python(text: str, capsys: pytest.CaptureFixture[str]) -> float:
    """Return the energy that a program prints [kWh]."""
    exec(compile(text, "snippet", "exec"), {})
    return float(capsys.readouterr().out)


def energy_of_command(text: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> float:
    """Return the energy that a command line prints, read by a shell [kWh]."""
    script = f"railjoule() {{ printf '%s\\0' \"$@\"; }}\n{text}"
    words = subprocess.run(["sh", "-c", script], cwd=folder, check=True, capture_output=True).stdout.decode()
    arguments = [str(folder / word) if word == FILE else word for word in words.split("\0")[:-1]]
    assert main([*arguments, "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    return float(result["actual"]["energy_kwh"] if "actual" in result else result["energy_kwh"])


def test_an_edited_preset(state: Workbench, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    state.scenario.edit(
        {"vehicle.auxiliary_power_kw": 40.0, "line.speed_limits": [{"from_m": 300.0, "to_m": 500.0, "limit_kmh": 50.0}]}
    )
    recipe = recipe_of(state)
    energy = solve(state.scenario.scenario()).energy_kwh
    assert energy_of_python(as_python(recipe), capsys) == energy
    # the command reads changes over the file, not over the scenario: the same to rounding
    assert energy_of_command(as_command(recipe), tmp_path, capsys) == pytest.approx(energy, rel=1e-9)
    assert solve(parse_scenario(as_toml(recipe))).energy_kwh == pytest.approx(energy, rel=1e-9)


def test_the_scenario_of_a_file(state: Workbench, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    title = 'It\'s "mine" \\ $HOME """ `x`'
    state.scenario.open(format_scenario(load_scenario("liashenko-i").with_(title=title)), "x")
    state.scenario.load_percent = 40.0
    recipe = recipe_of(state)
    energy = solve(state.scenario.scenario()).energy_kwh
    assert energy_of_python(as_python(recipe), capsys) == energy
    assert energy_of_command(as_command(recipe), tmp_path, capsys) == pytest.approx(energy, rel=1e-9)
    assert parse_scenario(as_toml(recipe)).title == title


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (True, "true"),
        (0.3, "0.3"),
        ('a"b\x7f', '"a\\"b\\u007f"'),
        ([1.0, {"a b": None, "c": [False]}], "[1.0, {c = [false]}]"),
    ],
)
def test_values_as_toml(value: object, text: str) -> None:
    assert toml_value(value) == text
