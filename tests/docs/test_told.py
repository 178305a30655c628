"""The pages of assets/docs tell the truth: their examples run, and their tables name what there is."""

import itertools
import json
import re
import shlex
import shutil
import tomllib

import pytest
from commands import answer, complaint
from documents import ROOT, blocks, blocks_in, text_of
from validated import validate_once

from railjoule.core import compare, solve
from railjoule.core.scenario import load_scenario, preset_names, scenario_from_document
from railjoule.core.scenario.document import merged
from railjoule.core.strategies import STRATEGIES
from railjoule.dashboard.command.arguments import FORMATS
from railjoule.dashboard.command.cli import OK, main
from railjoule.dashboard.page_list import PAGES
from tests.builders import PLAIN

COMMANDS_PAGE = text_of("howto/commands")
COMMANDS = [line for block in blocks(COMMANDS_PAGE, "sh") for line in block.splitlines()]
SHOWN_OUTPUT = {
    first.text.splitlines()[0]: second.text.splitlines()
    for first, second in itertools.pairwise(blocks_in(COMMANDS_PAGE))
    if (first.kind, second.kind) == ("sh", "text")
}
"""Output that the page shows, by the first command of the block above it; an ellipsis stands for any text."""
SCENARIO_PAGE = text_of("howto/scenario")
SCENARIO, *OTHERS = blocks(SCENARIO_PAGE, "toml")
PARTS = [text for text in OTHERS if "[timetable]" not in text and "[line]" not in text]
"""Blocks that show only parts of a vehicle."""
EVERY_STRATEGY = {
    "solver.mesh_m": 50.0,
    "solver.tolerance": 0.01,
    "line.sections": [{"length_m": 2000}],
    "timetable.travel_time_s": 180.0,
}
REFUSED = {
    "line.speed_limits": {"line.speed_limits": [{"from_m": 600, "to_m": 900, "limit_kmh": 45}]},
    "line.stations": {"line.stations": [{"position_m": 1000, "dwell_s": 20}]},
    "line.neutral_sections": {"line.neutral_sections": [{"from_m": 500, "to_m": 600}]},
    "line.passing_points": {"line.passing_points": [{"position_m": 800, "speed_kmh": 45}]},
    "line.traction_limits": {"line.traction_limits": [{"from_m": 0, "to_m": 500, "max_power_kw": 800}]},
    "line.rail_conditions": {
        "vehicle.adhesion": {"driven_mass_share": 0.5},
        "line.rail_conditions": [{"from_m": 0, "to_m": 500, "condition": "wet"}],
    },
    "vehicle.resistance.starting_n_per_kn": {
        "vehicle.resistance.starting_n_per_kn": 2.0,
        "vehicle.resistance.starting_ends_at_kmh": 5.0,
    },
    "timetable.entry_speed_kmh": {"timetable.entry_speed_kmh": 20},
    "timetable.exit_speed_kmh": {"timetable.exit_speed_kmh": 20},
}
"""Changes of a scenario that set a key of the table of refusals."""


def test_notebook_example_draws_what_is_told():
    """Its last two lines are what a notebook shows: three charts of one run, and three runs in one."""
    names = {}
    (example,) = blocks(text_of("tutorials/notebook"), "python")
    *lines, one, several = example.splitlines()
    exec("\n".join(lines), names)
    assert [curve.vdims[0].name for curve in eval(one, names)] == ["speed", "energy", "effort"]
    assert [curve.label for curve in eval(several, names)] == ["Optimal", "Bellman", "Fastest"]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The folder in which commands run, with the scenario file that is shown and the assets that they name."""
    monkeypatch.chdir(tmp_path)
    validate_once(monkeypatch)
    (tmp_path / "assets").symlink_to(ROOT / "assets")
    (tmp_path / "metro.toml").write_text(SCENARIO, encoding="utf-8")
    return tmp_path


def test_scenario_example_is_valid(folder):
    scenario = load_scenario(folder / "metro.toml")
    assert scenario.vehicle.preset == "metro-81-7036"
    assert scenario.line.stations[0].dwell_s == 25


def test_strategies_refuse_what_the_page_lists():
    """Each row of the table of refusals, on a level line of 2 km that all strategies accept without the key."""
    table = SCENARIO_PAGE.partition("## Strategies that refuse a key")[2]
    heading, _, *rows = [line.split("|")[1:-1] for line in table.splitlines() if line.startswith("|")]
    names = [cell.strip(" `") for cell in heading[1:]]
    assert sorted(names) == sorted(STRATEGIES)
    assert {row[0].strip(" `") for row in rows} == REFUSED.keys()
    for key, *marks in rows:
        scenario = load_scenario("ftorek-300s").replace({**EVERY_STRATEGY, **REFUSED[key.strip(" `")]})
        refused = compare(scenario, names).refused.keys()
        assert refused == {name for name, mark in zip(names, marks, strict=True) if mark.strip()}, key
    assert compare(load_scenario("ftorek-300s").replace(EVERY_STRATEGY), names).refused == {}


@pytest.mark.parametrize("text", PARTS)
def test_parts_of_a_vehicle_are_read_over_another(text):
    vehicle = tomllib.loads(text)
    scenario = scenario_from_document(merged(PLAIN, vehicle))
    assert scenario != scenario_from_document(PLAIN)
    assert solve(scenario, "fastest").travel_time_s > 0


def test_vehicle_and_line_that_are_added_make_a_scenario():
    vehicle, line = (tomllib.loads(block) for block in blocks(text_of("howto/add_vehicle"), "toml"))
    document = {"vehicle": vehicle, "line": line, "timetable": {"average_speed_kmh": 40}}
    run = solve(scenario_from_document(document))
    assert run.distance_m == 1200
    assert run.speed_ms[run.position_m >= 800].max() * 3.6 <= 60 + 1e-9


FEWER = {
    "--sample 4096": "--sample 64",
    "--probability 0.95 --candidates 8": "--probability 0.6 --candidates 3 --set montecarlo.runs=150",
    "--prove-seconds 20": "--prove-seconds 2",
    "--sections result proof": "--sections proof",
    "montecarlo.runs=500": "montecarlo.runs=50",
    "-o stops.csv": "-o stops.csv --set montecarlo.runs=50",
}
"""Less work in the gate, a tenth of the time for the same command; the night runs it as it is printed."""


def shortened(command):
    for printed, fewer in FEWER.items():
        command = command.replace(printed, fewer)
    return command


@pytest.mark.parametrize(
    "command",
    [
        *map(shortened, COMMANDS),
        *(pytest.param(one, marks=pytest.mark.nightly) for one in COMMANDS if shortened(one) != one),
    ],
)
def test_command_runs(command, folder, capsys):
    _, *arguments = shlex.split(command)
    if arguments[0] == "check":  # what the command before it has written
        (before,) = (line for line in COMMANDS if f"--trajectory {arguments[1]}" in line)
        answer(capsys, *shlex.split(before)[1:])
    printed = answer(capsys, *arguments)
    assert printed
    lines = re.sub(r"[\u00a0\u202f\u2009]", " ", printed).splitlines()
    for shown in SHOWN_OUTPUT.get(command, ()):
        assert any(line.startswith(shown.partition("…")[0]) for line in lines), shown
    if "--json" in arguments:
        assert json.loads(printed)["proven"]
    if "--trajectory" in arguments:
        assert (folder / "run.csv").stat().st_size > 1000


def test_the_tables_of_a_line_are_imported_as_told(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    page = text_of("howto/imports")
    for name, table in zip(("gradients", "stations", "heights"), blocks(page, "csv"), strict=True):
        (tmp_path / f"{name}.csv").write_text(table, encoding="utf-8")
    for command in blocks(page, "console"):
        assert main(shlex.split(command)[1:]) == OK
    assert "nothing from 800 to 900 m" in capsys.readouterr().err
    # 23:58:00 to 00:01:30
    assert load_scenario(tmp_path / "scenario.toml").travel_time_s == 210
    profile = tomllib.loads((tmp_path / "profile.toml").read_text(encoding="utf-8"))["line"]["sections"]
    assert [section.get("gradient_permille", 0) for section in profile] == [8, 0, -13, 14.25]
    document = {"vehicle": {"preset": "metro-81-7036"}, "timetable": {"travel_time_s": 180}}
    line = scenario_from_document({**document, "line": {"file": "line.csv"}}, folder=tmp_path).line
    assert [section.gradient_permille for section in line.sections] == [2.5, -4, 0]


def test_the_tables_of_ones_own_line_lead_to_a_solved_scenario(tmp_path, monkeypatch, capsys):
    """The commands of the walk in a terminal, in the order of the page, beside copies of the files that it names."""
    page = text_of("own_line")
    for name in re.findall(r"`(example-\w+\.csv)`", page):
        shutil.copy(ROOT / "assets" / "imports" / name, tmp_path)
    monkeypatch.chdir(tmp_path)
    printed = []
    for command in "".join(blocks(page, "sh")).splitlines():
        assert main(shlex.split(command)[1:]) == OK
        printed.append(capsys.readouterr().out)
    made, solved, measured, line, solved_by_options = printed
    assert "12.00 km, 24 sections, 761.0 s" in made
    assert "proven optimal" in solved
    assert "example-recorder.csv" in measured
    assert "12.00 km, 24 sections" in line
    assert solved_by_options.splitlines()[1:4] == solved.splitlines()[1:4]


def test_imports_are_those_that_exist():
    named = re.findall(r"^\| `import ([\w-]+)`", text_of("howto/imports"), re.MULTILINE)
    assert sorted(named) == sorted(FORMATS)


def test_a_train_of_a_data_sheet_is_made_solved_and_its_assumptions_weighed(tmp_path, monkeypatch, capsys):
    """The commands of the questions, in the order of the page."""
    monkeypatch.chdir(tmp_path)
    (block,) = (one for one in blocks(text_of("howto/faq"), "sh") if "data-sheet" in one)
    printed = []
    for command in block.splitlines():
        assert main(shlex.split(command)[1:]) == OK
        printed.append(capsys.readouterr().out)
    made, solved, weighed = printed
    assert made.startswith("railcar.toml: Train from a data sheet, 60.0 t")
    assert "proven optimal" in solved
    assert weighed.rstrip().endswith("assumptions")


def test_bad_input_ends_as_told(folder, capsys):
    assert complaint(capsys, "solve", "metro.toml", "--set", "timetable.travel_time_s=30")


def test_commands_without_an_example_exist(capsys):
    for command in ("serve", "benchmark"):
        assert f"`railjoule {command}`" in COMMANDS_PAGE
        assert answer(capsys, command, "--help")


def test_presets_are_those_that_exist():
    table = text_of("reference/presets")
    named = re.findall(r"`([\w-]+)`", table)
    named = [f"liashenko{name}" if name.startswith("-") else name for name in named]
    assert sorted(named) == sorted([*preset_names("vehicles"), *preset_names("lines")])


def test_pages_are_those_that_exist():
    table = text_of("howto/dashboard").partition("| page | what it shows |")[2].partition("\n\n")[0]
    assert re.findall(r"^\| ([A-Z][\w -]*\w) \|", table, re.MULTILINE) == list(PAGES)
