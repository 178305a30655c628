"""A guide that is followed to the letter works: in Python, on the command line, with the check and on the page.

Each guide is carried out on a copy of the sources. Nothing is compiled there: that would take minutes.
"""

import json
import os
import re
import shutil
import subprocess
import tomllib
from functools import partial
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest
import tomli_w
from builders import PLAIN
from documents import ROOT, blocks, run_python, text_of

from railjoule.core.check.drives import LOSS_MODELS
from railjoule.core.drive.kernels import MAKERS
from railjoule.core.scenario.document import change_document

(ADDED_DRIVE,) = blocks(text_of("howto/add_drive"), "python")
SHORT = {
    "line.sections": [{"length_m": 300.0, "gradient_permille": -8.0}],
    "timetable.travel_time_s": 45.0,
    "solver.mesh_m": 20.0,
}
"""A line so short that it is solved without compiled kernels."""


def carried_out(guide: str, root: Path) -> Path:
    """Copy the sources to a folder, and apply the new files and the changes in the text of a guide."""
    for name in ("core", "dashboard", "assets", ".github"):
        shutil.copytree(ROOT / name, root / name, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(ROOT / "package" / "__init__.py", root)
    shutil.copy(ROOT / "pyproject.toml", root)
    for added in blocks(guide, "python"):
        path = root / added.splitlines()[0].removeprefix("# ")
        path.parent.mkdir(exist_ok=True)
        path.write_text(added, encoding="utf-8")
    for change in "".join(blocks(guide, "diff")).split("--- ")[1:]:
        name, hunks = change.split("\n", 1)
        text = (root / name).read_text(encoding="utf-8")
        for hunk in hunks.split("@@\n"):
            lines = hunk.splitlines(keepends=True)
            old = "".join(line[1:] for line in lines if line[0] in " -")
            assert text.count(old) == 1, f"the page changes lines of {name} that are not there:\n{old}"
            text = text.replace(old, "".join(line[1:] for line in lines if line[0] in " +"))
        (root / name).write_text(text, encoding="utf-8")
    return root


@pytest.fixture(scope="module")
def with_the_drive(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the sources with the drive of its guide."""
    return carried_out(text_of("howto/add_drive"), tmp_path_factory.mktemp("with-drive") / "railjoule").parent


@pytest.fixture(scope="module")
def with_the_strategy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the sources with the strategy of its guide, and a scenario beside it."""
    folder = carried_out(text_of("howto/add_strategy"), tmp_path_factory.mktemp("with-strategy") / "railjoule").parent
    (folder / "short.toml").write_text(tomli_w.dumps(change_document(PLAIN, SHORT)), encoding="utf-8")
    return folder


@pytest.fixture(scope="module")
def with_the_page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the sources with the page of its guide."""
    return carried_out(text_of("howto/add_page"), tmp_path_factory.mktemp("with-page") / "railjoule").parent


@pytest.fixture(scope="module")
def after_the_first_hour(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the sources with the change of the first hour, and a scenario beside it."""
    # the change is indented, as part of a step
    text = re.sub(r"^ {3}", "", (ROOT / ".github" / "CONTRIBUTING.md").read_text(encoding="utf-8"), flags=re.MULTILINE)
    folder = carried_out(text, tmp_path_factory.mktemp("first-hour") / "railjoule").parent
    (folder / "short.toml").write_text(tomli_w.dumps(change_document(PLAIN, SHORT)), encoding="utf-8")
    return folder


def run_in(folder: Path, *arguments: str, jit: bool = False) -> subprocess.CompletedProcess[str]:
    """Run Python with the changed sources; with compiled kernels only where those have not changed."""
    environment = {**os.environ, "PYTHONPATH": str(folder), "NUMBA_DISABLE_JIT": str(int(not jit))}
    return run_python([*arguments], folder, environment)


def answer(folder: Path, *arguments: str, jit: bool = False) -> str:
    """Return what Python prints, which has nothing to complain of."""
    run = run_in(folder, *arguments, jit=jit)
    assert (run.returncode, run.stderr) == (0, "")
    return run.stdout


IN_PYTHON = """
import json, sys
from railjoule.core import load_scenario, solve
run = solve(load_scenario("short.toml"), "slowed", check=True)
print(json.dumps([run.strategy, run.travel_time_s, run.check.ok, run.energy_kwh, run.lower_bound_kwh]))
"""


def test_the_added_strategy_runs_in_python_and_passes_the_check(with_the_strategy: Path) -> None:
    name, time, ok, energy, bound = json.loads(answer(with_the_strategy, "-c", IN_PYTHON))
    assert (name, ok) == ("slowed", True)
    assert time == pytest.approx(45.0)
    assert energy > bound


FREE = "simulation.target_braking=false"
"""The sensors of target braking lie farther before a stop than the short line is long."""


def test_the_added_strategy_runs_on_the_command_line(with_the_strategy: Path) -> None:
    railjoule = partial(answer, with_the_strategy, "-m", "railjoule.dashboard")
    assert "Slowed" in railjoule("solve", "short.toml", "--strategy", "slowed", "--check").splitlines()[0]
    assert "Slowed" in railjoule("simulate", "short.toml", "--set", "strategy=slowed", FREE)
    compared = json.loads(railjoule("compare", "short.toml", "--json"))
    assert "slowed" in [run["strategy"] for run in compared["results"]]


ON_THE_PAGE = """
import json
from railjoule.core import load_scenario
from railjoule.dashboard.look.theme import strategies_css
from railjoule.dashboard.charts.dress import line_style
from railjoule.dashboard.look.tokens import DARK, LIGHT
from railjoule.dashboard.shell.strategies import StrategyList
from railjoule.dashboard.workbench import Workbench
rows = StrategyList(Workbench()).html
print(json.dumps([rows, LIGHT["slowed"], DARK["slowed"], line_style("slowed")["line_dash"], strategies_css()]))
"""


def test_the_sidebar_lists_the_added_strategy(with_the_strategy: Path) -> None:
    rows, light, dark, dash, css = json.loads(answer(with_the_strategy, "-c", ON_THE_PAGE))
    row = rows.partition('data-name="slowed"')[2].partition('<div class="strategy"')[0]
    assert '<label class="name" for="slowed">Slowed</label>' in row
    assert "stroke slowed" in row
    assert "data-term='slowed'" in row
    assert (light, dark, dash) == ("#6B5B00", "#D7C46A", [10, 2, 2, 2])
    assert ".stroke.slowed { stroke: var(--rj-slowed)" in css


LISTED = """
import json
from railjoule.dashboard.shell.strategies import StrategyList
from railjoule.dashboard.workbench import Workbench
print(json.dumps(StrategyList(Workbench()).html))
"""


def test_the_change_of_the_first_hour_is_seen_in_a_terminal_and_on_the_page(after_the_first_hour: Path) -> None:
    command = ("-m", "railjoule.dashboard", "solve", "short.toml", "--strategy", "fastest")
    assert answer(after_the_first_hour, *command).splitlines()[0].endswith(": Shortest time")
    rows = json.loads(answer(after_the_first_hour, "-c", LISTED))
    assert ">Shortest time</label>" in rows
    assert ">Fastest</label>" not in rows


GATE = ("tests/dashboard/look/test_glossary.py", "tests/dashboard/look/test_tokens.py")


@pytest.mark.nightly
def test_the_added_strategy_passes_the_tests_of_its_look(with_the_strategy: Path) -> None:
    """The gate's own tests, read from here, on the changed sources."""
    answer(with_the_strategy, "-m", "pytest", "-q", "-p", "no:cacheprovider", *(str(ROOT / name) for name in GATE))


# changed sources have no compiled code: the short line is interpreted to its end, which takes less than to compile
PATIENT = """
import railjoule.core.compiled
railjoule.core.compiled.PATIENCE_S = 600.0
"""
SOLVE_DOCUMENTS = f"""{PATIENT}
import json, sys
from railjoule.core import solve
from railjoule.core.scenario import scenario_from_document
found = {{}}
for name, document in json.loads(sys.argv[1]).items():
    for strategy in ("optimal", "bellman"):
        run = solve(scenario_from_document(document), strategy, check=True)
        found[f"{{name}}, {{strategy}}"] = [run.energy_kwh, run.gap, run.energy.imbalance]
print(json.dumps(found))
"""
COARSE = 0.02
MIXED = {"model": "mixed_loss", "efficiency": 0.8, "loss_w_per_n2": 4e-5}


def with_drive(drive: dict[str, object]) -> dict[str, object]:
    """Return a document of the short line with a drive."""
    # over the given mesh: a finer one takes minutes to interpret
    drives = {"vehicle.drive": {**drive, "recuperation_factor": 0.6}, "solver.tolerance": COARSE}
    return change_document(PLAIN, {**SHORT, **drives})


COPPER = {"motors": 1, "gear_ratio": 1.0, "wheel_diameter_m": 2.0, "torque_per_amp_nm": 1.0, "resistance_ohm": 4e-5}
SINGLE = {
    "efficiency": ({"model": "constant_efficiency", "traction_efficiency": 0.8}, {"loss_w_per_n2": 0.0}),
    "copper": ({"model": "copper_loss", **COPPER}, {"efficiency": 1.0}),
}
"""Each drive with one of the losses only, and what the added drive is then."""


@pytest.mark.parametrize("other", ["efficiency", pytest.param("copper", marks=pytest.mark.nightly)])
def test_the_added_drive_runs_and_passes_the_check(with_the_drive: Path, other: str) -> None:
    """Without one of its losses it is the drive that has only the other."""
    single, without = SINGLE[other]
    drives = {"mixed": MIXED, "other": single, "mixed as other": {**MIXED, **without}}
    documents = {name: with_drive(drive) for name, drive in drives.items()}
    found = json.loads(answer(with_the_drive, "-c", SOLVE_DOCUMENTS, json.dumps(documents)))
    for strategy in ("optimal", "bellman"):
        energy = found[f"other, {strategy}"][0]
        assert found[f"mixed as other, {strategy}"][0] == pytest.approx(energy, rel=1e-6)
        assert found[f"mixed, {strategy}"][0] > energy
    assert found["mixed, optimal"][1] < COARSE
    assert all(abs(imbalance) < 1e-9 for _, _, imbalance in found.values())


COMMAND_LINE = f"""{PATIENT}
import sys
from railjoule.dashboard.command.cli import main
sys.exit(main(sys.argv[1:]))
"""
FIELDS = """
import json
from railjoule.dashboard.editor.fields_of import parts_of
print(json.dumps([part.key.rpartition(".")[2] for part in parts_of("vehicle.drive", "mixed_loss")]))
"""


def test_the_editor_has_fields_for_the_added_drive(with_the_drive: Path) -> None:
    assert {"efficiency", "loss_w_per_n2"} <= set(json.loads(answer(with_the_drive, "-c", FIELDS)))


def test_the_added_drive_runs_on_the_command_line(with_the_drive: Path) -> None:
    (with_the_drive / "mixed.toml").write_text(tomli_w.dumps(with_drive(MIXED)), encoding="utf-8")
    solved = json.loads(answer(with_the_drive, "-c", COMMAND_LINE, "solve", "mixed.toml", "--json", "--check"))
    assert solved["check"]["ok"]
    assert solved["proven"]


WITHOUT_A_FORMULA = f"""{PATIENT}
import sys
from railjoule.core.check.drives import LOSS_MODELS
from railjoule.dashboard.command.cli import main
del LOSS_MODELS["mixed_loss"]
sys.exit(main(sys.argv[1:]))
"""


def test_a_drive_without_a_formula_in_the_check_is_refused_in_a_sentence(with_the_drive: Path) -> None:
    (with_the_drive / "mixed.toml").write_text(tomli_w.dumps(with_drive(MIXED)), encoding="utf-8")
    run = run_in(with_the_drive, "-c", WITHOUT_A_FORMULA, "solve", "mixed.toml", "--check", "--strategy", "fastest")
    assert run.returncode == 2
    assert "drive.model = 'mixed_loss' has no formula in the check" in run.stderr
    assert run.stderr.count("\n") == 1


def test_every_drive_has_a_formula_in_the_check() -> None:
    assert LOSS_MODELS.keys() == {get_args(kind.model_fields["model"].annotation)[0] for kind in MAKERS}


def test_the_drive_that_is_added_gives_its_derivatives() -> None:
    """Compiled, against central differences of its own power; F v / 0.8 and - 0.8 F v, each + 1e-6 F^2, by hand."""
    # its number and its parameters are in the changed sources only
    code = ADDED_DRIVE.replace("cache=True", "").replace("import MIXED_LOSS, PowerTerms", "import PowerTerms")
    names: dict[str, Any] = {"MIXED_LOSS": 5, "MixedLoss": object}
    exec(code.replace("from railjoule.core.scenario.drive import MixedLoss\n", ""), names)
    for braking, by_hand in ((False, 1e5 / 0.8 + 100.0), (True, -0.8e5 + 100.0)):
        power = partial(names["power"], np.array([0.8, 1e-6]), braking)
        p, p_f, p_v, p_ff, p_fv, p_vv = power(1e4, 10.0)
        assert p == pytest.approx(by_hand)
        for exact, index, df, dv in ((p_f, 0, 1.0, 0), (p_v, 0, 0, 1e-3), (p_ff, 1, 1.0, 0), (p_fv, 1, 0, 1e-3)):
            after, before = (power(1e4 + sign * df, 10.0 + sign * dv)[index] for sign in (1, -1))
            assert exact == pytest.approx((after - before) / (2 * (df + dv)), rel=1e-6)
        assert p_vv == 0


COARSE_EDITS = {**SHORT, "solver.tolerance": 0.02}
OPEN_THE_PAGE = """
import json, sys
from railjoule.core import load_scenario, solve
from railjoule.dashboard.browser import Browser
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.page_host import PageHost
from railjoule.dashboard.page_work import PageWorks
from railjoule.dashboard.workbench import Workbench
edits = json.loads(sys.argv[1])
short = {key: value for key, value in edits.items() if key != "line.sections"}
desk = Workbench()
page = desk.pages["Load"]
PageWorks(desk.pages["Load"])
view = PageHost(desk.pages["Load"], Browser(started=True, charts_in_sight=["load_energy"]), Palette(dark=False))
desk.scenario.choose("tram-950m")
desk.scenario.edit({"line": {"sections": edits["line.sections"]}, **short})
page.count = 2
desk.page = "Load"
scenario = desk.scenario.scenario()
loads = [solve(scenario.replace({"vehicle.load_factor": load}), "optimal").energy_kwh for load in (0.0, 1.0)]
drawn = page.host.plots["load_energy"].sources["optimum"].data
seen = [list(map(float, drawn["x"])), list(map(float, drawn["y"])), page.host.figures.object, view.message.visible]
desk.scenario.edit({"timetable.travel_time_s": 20.0})
print(json.dumps([loads, *seen, desk.models["load"].keep(), str(page.failure), view.message.visible]))
"""


def test_the_added_page_computes_draws_keeps_and_refuses(with_the_page: Path) -> None:
    found = json.loads(answer(with_the_page, "-c", OPEN_THE_PAGE, json.dumps(COARSE_EDITS), jit=True))
    energies, x, y, number, is_failed, kept, failure, is_failed_then = found
    assert energies[1] > energies[0] > 0
    assert x == [0.0, 100.0]
    assert y == pytest.approx(energies)
    assert f"{energies[1]:.3f}" in number
    assert "data-term='load-factor'" in number
    assert kept == {"count": 2}
    assert not is_failed
    assert is_failed_then
    assert "shortest" in failure


def test_the_added_page_is_listed_and_packed(with_the_page: Path) -> None:
    listed = "import json; from railjoule.dashboard.page_list import PAGES; print(json.dumps(list(PAGES)))"
    names = json.loads(answer(with_the_page, "-c", listed))
    table = (with_the_page / "railjoule/assets/docs/howto/dashboard.md").read_text(encoding="utf-8")
    assert re.findall(r"^\| (Papers|Load|Help) \|", table, re.MULTILINE) == names[-3:] == ["Papers", "Load", "Help"]
    packed = tomllib.loads((with_the_page / "railjoule/pyproject.toml").read_text(encoding="utf-8"))
    assert "railjoule.dashboard.pages.load" in packed["tool"]["setuptools"]["packages"]
