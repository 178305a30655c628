"""The pages of assets/docs tell the truth: their examples run, and their tables name what there is."""

import json
import os
import re
import shlex
import shutil
import tomllib
from functools import partial

import numpy as np
import pytest
from builders import PLAIN
from documents import ROOT, blocks, run_python, text_of

from railjoule.core import solve
from railjoule.core.scenario import STRATEGY_NAMES, load_scenario, preset_names, scenario_from_document
from railjoule.core.scenario.document import change_document
from railjoule.core.strategies import STRATEGIES, prepare_task
from railjoule.dashboard.command.imports import READERS
from railjoule.dashboard.page_list import PAGES
from railjoule.dashboard.pages.help.view import PROOF

COMMANDS_PAGE = text_of("howto/commands")
COMMANDS = [
    line for block in blocks(COMMANDS_PAGE, "sh") for line in block.splitlines() if line.startswith("railjoule ")
]
(SCENARIO,) = blocks(text_of("howto/scenario"), "toml")
(ADDED_STRATEGY,) = blocks(text_of("howto/add_strategy"), "python")
(ADDED_DRIVE,) = blocks(text_of("howto/add_drive"), "python")
(CHANGES_FOR_THE_DRIVE,) = blocks(text_of("howto/add_drive"), "diff")


def test_notebook_example_draws_what_is_told():
    """Its last two lines are what a notebook shows: three charts of one run, and three runs in one."""
    names = {}
    (example,) = blocks(text_of("tutorials/notebook"), "python")
    *lines, one, several = example.splitlines()
    exec("\n".join(lines), names)
    assert [curve.vdims[0].name for curve in eval(one, names)] == ["speed", "energy", "effort"]
    assert [curve.label for curve in eval(several, names)] == ["Optimal", "Bellman", "Fastest"]


@pytest.fixture
def folder(tmp_path):
    """A folder with the scenario file that is shown, and the assets that commands name."""
    (tmp_path / "assets").symlink_to(ROOT / "assets")
    (tmp_path / "metro.toml").write_text(SCENARIO, encoding="utf-8")
    return tmp_path


def test_scenario_example_is_valid(folder):
    scenario = load_scenario(folder / "metro.toml")
    assert scenario.vehicle.preset == "metro-81-7036"
    assert scenario.line.stations[0].dwell_s == 25


def test_vehicle_and_line_that_are_added_make_a_scenario():
    vehicle, line = (tomllib.loads(block) for block in blocks(text_of("howto/add_vehicle"), "toml"))
    document = {"vehicle": vehicle, "line": line, "timetable": {"average_speed_kmh": 40}}
    run = solve(scenario_from_document(document))
    assert run.distance_m == 1200
    assert run.speed_ms[run.position_m >= 800].max() * 3.6 <= 60 + 1e-9


def test_the_strategy_that_is_added_keeps_its_timetable():
    names = {}
    exec(ADDED_STRATEGY, names)
    scenario = load_scenario("liashenko-ii")
    run = names["slowed"](prepare_task(scenario))
    assert run.travel_time_s == pytest.approx(scenario.travel_time_s)
    assert run.energy_kwh > solve(scenario).energy_kwh


@pytest.fixture(scope="module")
def with_the_drive(tmp_path_factory):
    """A copy of the core with the drive that the page adds: its new file, and its changes of others."""
    root = tmp_path_factory.mktemp("with-drive") / "railjoule"
    for name in ("core", "assets"):
        shutil.copytree(ROOT / name, root / name, ignore=shutil.ignore_patterns("__pycache__"))
    (root / ADDED_DRIVE.splitlines()[0].removeprefix("# ")).write_text(ADDED_DRIVE, encoding="utf-8")
    for change in CHANGES_FOR_THE_DRIVE.split("--- ")[1:]:
        name, hunks = change.split("\n", 1)
        text = (root / name).read_text(encoding="utf-8")
        for hunk in hunks.split("@@\n"):
            lines = hunk.splitlines(keepends=True)
            old = "".join(line[1:] for line in lines if line[0] in " -")
            assert text.count(old) == 1, f"the page changes lines of {name} that are not there:\n{old}"
            text = text.replace(old, "".join(line[1:] for line in lines if line[0] in " +"))
        (root / name).write_text(text, encoding="utf-8")
    return root.parent


SOLVE_DOCUMENTS = """
import json, sys
from railjoule.core import solve
from railjoule.core.scenario import scenario_from_document
found = {}
for name, document in json.loads(sys.argv[1]).items():
    for strategy in ("optimal", "bellman"):
        run = solve(scenario_from_document(document), strategy)
        found[f"{name}, {strategy}"] = [run.energy_kwh, run.gap, run.energy.imbalance]
print(json.dumps(found))
"""


def test_the_drive_that_is_added_drives(with_the_drive):
    """Without one of its losses it is the drive that has the other alone; not compiled, which would take minutes."""
    mixed = {"model": "mixed_loss", "efficiency": 0.8, "loss_w_per_n2": 4e-5}
    copper = {"motors": 1, "gear_ratio": 1.0, "wheel_diameter_m": 2.0, "torque_per_amp_nm": 1.0, "resistance_ohm": 4e-5}
    drives = {
        "mixed": mixed,
        "efficiency": {"model": "constant_efficiency", "traction_efficiency": 0.8},
        "mixed as efficiency": {**mixed, "loss_w_per_n2": 0.0},
        "copper": {"model": "copper_loss", **copper},
        "mixed as copper": {**mixed, "efficiency": 1.0},
    }
    short = {
        "line.sections": [{"length_m": 300.0, "gradient_permille": -8.0}],
        "timetable.travel_time_s": 45.0,
        "solver.mesh_m": 20.0,
    }
    documents = {
        name: change_document(PLAIN, {**short, "vehicle.drive": {**drive, "recuperation_factor": 0.6}})
        for name, drive in drives.items()
    }
    environment = {**os.environ, "PYTHONPATH": str(with_the_drive), "NUMBA_DISABLE_JIT": "1"}
    run = run_python(["-c", SOLVE_DOCUMENTS, json.dumps(documents)], with_the_drive, environment)
    assert run.stderr == ""
    found = json.loads(run.stdout)
    for other in ("efficiency", "copper"):
        for strategy in ("optimal", "bellman"):
            energy = found[f"{other}, {strategy}"][0]
            assert found[f"mixed as {other}, {strategy}"][0] == pytest.approx(energy, rel=1e-6)
            assert found[f"mixed, {strategy}"][0] > energy
    assert found["mixed, optimal"][1] < 1e-6
    assert all(abs(imbalance) < 1e-9 for _, _, imbalance in found.values())


def test_the_drive_that_is_added_gives_its_derivatives():
    """Compiled, against central differences of its own power; F v / 0.8 + 1e-6 F^2 and 0.8 F v - 1e-6 F^2 by hand."""
    names = {}
    exec(ADDED_DRIVE.replace("cache=True", ""), names)
    parameters = np.array([0.8, 1e-6])
    for kernel, by_hand in (("driving_power", 1e5 / 0.8 + 100.0), ("generated_power", 0.8e5 - 100.0)):
        power = partial(names[kernel], parameters)
        p, p_f, p_v, p_ff, p_fv, p_vv = power(1e4, 10.0)
        assert p == pytest.approx(by_hand)
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


def test_the_table_of_a_line_is_imported_as_told(tmp_path):
    page = text_of("howto/imports")
    (table,), (command,) = blocks(page, "csv"), blocks(page, "console")
    (tmp_path / "gradients.csv").write_text(table, encoding="utf-8")
    run = run_python(["-m", "railjoule.dashboard", *shlex.split(command)[1:]], tmp_path)
    assert run.returncode == 0
    assert "nothing from 800 to 900 m" in run.stderr
    document = {"vehicle": {"preset": "metro-81-7036"}, "timetable": {"travel_time_s": 180}}
    line = scenario_from_document({**document, "line": {"file": "line.csv"}}, folder=tmp_path).line
    assert [section.gradient_permille for section in line.sections] == [2.5, -4, 0]


def test_imports_are_those_that_exist():
    named = re.findall(r"^\| `import ([\w-]+)`", text_of("howto/imports"), re.MULTILINE)
    assert sorted(named) == sorted(READERS)


def test_bad_input_ends_as_told(folder):
    arguments = ["solve", "metro.toml", "--set", "timetable.travel_time_s=30"]
    run = run_python(["-m", "railjoule.dashboard", *arguments], folder)
    assert run.returncode == 2
    assert run.stderr.count("\n") == 1


def test_commands_without_an_example_exist(folder):
    for command in ("serve", "benchmark"):
        assert f"`railjoule {command}`" in COMMANDS_PAGE
        assert run_python(["-m", "railjoule.dashboard", command, "--help"], folder).returncode == 0


def test_strategies_are_those_that_exist():
    table = text_of("explanation/strategies").partition("\n## ")[0]
    named = re.findall(r"^\| `(\w+)`", table, re.MULTILINE)
    assert named == list(STRATEGIES)
    assert set(named) <= set(STRATEGY_NAMES)


def test_presets_are_those_that_exist():
    table = text_of("reference/presets")
    named = re.findall(r"`([\w-]+)`", table)
    named = [f"liashenko{name}" if name.startswith("-") else name for name in named]
    assert sorted(named) == sorted([*preset_names("vehicles"), *preset_names("lines")])


def test_shipped_scenarios_are_those_that_exist():
    sentence = COMMANDS_PAGE.partition("The shipped scenarios are ")[2].partition(". ")[0]
    assert re.findall(r"`([\w-]+)`", sentence) == list(preset_names("scenarios"))


def test_help_tells_what_the_table_of_meshes_does():
    """What a finer mesh changes at most, in per cent, of cells of 20, 10 and 5 m; the table's last column is of 2 m."""
    _, table = text_of("explanation/mesh").split("| drive, scenario | 20 m | 10 m | 5 m | 2 m |", 1)
    rows = [re.findall(r"([\d.]+) %", line) for line in table.splitlines() if line.count(" % |") == 4]
    assert len(rows) == 6
    most = [max(column, key=float) for column in zip(*rows, strict=True)]
    told = next(text for title, text in PROOF if title == "What a finer mesh changes")
    for length_m, percent in zip((20, 10, 5), most[:3], strict=True):
        assert f"{percent} % below that over {length_m} m" in told


def test_pages_are_those_that_exist():
    table = text_of("howto/dashboard").partition("| page | what it shows |")[2].partition("\n\n")[0]
    assert re.findall(r"^\| ([A-Z][\w -]*\w) \|", table, re.MULTILINE) == list(PAGES)
