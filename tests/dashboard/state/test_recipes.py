"""A walk over all pages: the copied program, the copied command and the report give the number that the page shows."""

import json
import subprocess
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from railjoule.core import load_scenario, solve
from railjoule.core.scenario import format_scenario, parse_scenario
from railjoule.core.studies.sweep import MemoryResults, make_study, sweep
from railjoule.dashboard.command.cli import main
from railjoule.dashboard.page_list import PAGES
from railjoule.dashboard.page_work import PageWorks
from railjoule.dashboard.report.findings import REALITY_SHARE, ReportRequest, compute_findings
from railjoule.dashboard.report.work import Reporting
from railjoule.dashboard.state.recipes import (
    FILE,
    Program,
    Recipe,
    as_command,
    as_python,
    as_toml,
    page_recipe,
    page_run,
    toml_value,
)
from railjoule.dashboard.work.runs import RunsRequest, compute_runs
from railjoule.dashboard.workbench import Workbench

SHORT_METRO = {"line": {"sections": [{"length_m": 1000.0}]}, "timetable.travel_time_s": 75.0}
SHORT_TRAM = {"line": {"sections": [{"length_m": 300.0}]}, "timetable.travel_time_s": 45.0}


@dataclass(frozen=True)
class Case:
    """A page, what is set on it, where its number stands, and whether a scenario file says all of it."""

    page: str
    preset: str
    number: Callable[[Workbench], Any]
    edits: dict[str, Any] = field(default_factory=dict)
    prepare: Callable[[Workbench], None] = lambda _: None
    name: str = ""
    has_command: bool = True


def plan(state: Workbench) -> Any:
    return state.run


def slide(state: Workbench) -> None:
    state.scenario.load_percent = 30.0


def drive_fastest(state: Workbench) -> None:
    state.chosen = "fastest"


def drive_enoc(state: Workbench) -> None:
    state.chosen, state.scenario.acceleration_time_s = "enoc", 25.0


def meet_a_stop(state: Workbench) -> None:
    state.day.on = True
    state.day.actual_load_percent = 80.0
    state.day.drop("stop", 500.0)


def turn_to_events(state: Workbench) -> None:
    state.pages["What if"].tab = "events"


def have_the_day_as_planned(state: Workbench) -> None:
    state.day.on = True
    state.day.as_planned()


def set_limits(state: Workbench) -> None:
    state.pages["Set speeds"].set([60.0, 50.0], [500.0])
    state.pages["Set speeds"].found = False


def loosen_the_loop(state: Workbench) -> None:
    state.pages["Motor"].bandwidth_rads = 5.0
    state.pages["Motor"].max_current_a = 380.0


def choke_the_inverter(state: Workbench) -> None:
    assert state.pages["Motor"].max_current_a is not None
    state.pages["Motor"].max_current_a *= 0.9


def fix_an_arrival(state: Workbench) -> None:
    state.pages["Line"].edit({2: {"earliest_arrival_s": 350.0, "latest_arrival_s": 350.0}})


CASES = (
    Case("Start", "liashenko-i", plan, prepare=slide),
    Case("Drive", "liashenko-i", plan, prepare=slide),
    Case("Drive", "liashenko-i", lambda s: s.pages["Drive"].actual.actual, prepare=meet_a_stop, name="actual run"),
    Case("Compare", "liashenko-i", plan, prepare=drive_fastest),
    Case("Trade-off", "liashenko-0", plan, prepare=drive_enoc),
    Case("What if", "tram-950m-stop", lambda s: s.pages["What if"].reality.following.actual),
    Case(
        "What if",
        "ftorek-300s",
        lambda s: s.pages["What if"].reality.following.actual,
        {**SHORT_METRO, "simulation.kind": "field_oriented"},
        name="of a file that asks for the loop",
    ),
    Case(
        "What if",
        "tram-950m-stop",
        lambda s: s.pages["What if"].rides.rides["computer"].actual,
        prepare=turn_to_events,
        name="events",
    ),
    Case(
        "What if",
        "liashenko-i",
        lambda s: s.pages["What if"].rides.rides["computer"].actual,
        {"disturbance.coordinate_error_m": 5.0, "disturbance.departure_delay_s": 9.0},
        turn_to_events,
        name="without events",
    ),
    Case(
        "Drive",
        "tram-950m-stop",
        lambda s: s.pages["Drive"].actual.actual,
        prepare=have_the_day_as_planned,
        name="actual run as planned",
    ),
    Case("Set speeds", "liashenko-i", lambda s: s.pages["Set speeds"].run.run, prepare=set_limits),
    Case("Set speeds", "liashenko-i", lambda s: s.pages["Set speeds"].run.run, name="searched"),
    Case("Motor", "ftorek-300s", lambda s: s.pages["Motor"].run.actual, SHORT_METRO, loosen_the_loop),
    Case("Motor", "liashenko-i", plan, name="without machine"),
    Case("Motor", "tram-950m", lambda s: s.pages["Motor"].run.actual, SHORT_TRAM, name="tram"),
    Case(
        "Motor",
        "tram-950m",
        lambda s: s.pages["Motor"].run.actual,
        SHORT_TRAM,
        choke_the_inverter,
        "limits tried",
        has_command=False,
    ),
    Case("Line", "metro-10-stations", lambda s: s.pages["Line"].runs.best.run, has_command=False),
    Case(
        "Line",
        "metro-10-stations",
        lambda s: s.pages["Line"].runs.best.run,
        prepare=fix_an_arrival,
        name="fixed arrival",
        has_command=False,
    ),
    Case("Explore", "liashenko-i", plan, prepare=slide),
    Case("Files", "liashenko-i", plan, prepare=slide),
)
OTHERS = ("Learn", "Papers")
"""Pages of no scenario of the user's."""
AS_START = ("Help",)
"""Pages without a result: their program is that of Start."""


@pytest.fixture(params=CASES, ids=[" ".join(filter(None, [case.page, case.name])) for case in CASES])
def case(request: pytest.FixtureRequest) -> Case:
    found: Case = request.param
    return found


@pytest.fixture
def state(case: Case, monkeypatch: pytest.MonkeyPatch) -> Workbench:
    """The workbench of a case with its page in sight; all work is done in the test's own turn, studies are left out."""

    def nothing(*_: Any) -> Iterator[Any]:
        yield from ()

    for name in ("load.steps", "chance.steps", "events.compute_late_arrivals"):
        monkeypatch.setattr(f"railjoule.dashboard.pages.what_if.{name}", nothing)
    state = Workbench()
    state.scenario.choose(case.preset)
    for page in ("What if", "Drive", "Set speeds", "Motor", "Line"):
        PageWorks(state.pages[page])
    if case.edits:
        state.scenario.edit(case.edits)
    case.prepare(state)
    state.runs = compute_runs(RunsRequest(state.scenario.scenario(), (state.chosen,)))
    state.page = case.page
    return state


def reported(request: ReportRequest) -> list[float]:
    """Return the energies that a report leads with: of its run, and of what becomes of it where it tells that [kWh]."""
    findings = next(found for found in compute_findings(request) if found.share >= REALITY_SHARE)
    assert "reality" not in findings.refusals
    reality = [] if findings.reality is None else [findings.reality.actual.energy_kwh]
    return [findings.run.energy_kwh, *reality]


def test_every_page_is_walked() -> None:
    assert set(Workbench().pages) == set(PAGES)
    assert {case.page for case in CASES} | {*OTHERS, *AS_START} == set(PAGES)


def test_all_that_leaves_a_page_gives_its_number(
    case: Case, state: Workbench, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    energy_kwh, recipe = case.number(state).energy_kwh, page_recipe(state)
    assert energy_of_program(as_python(recipe), capsys) == pytest.approx(energy_kwh, rel=1e-9)
    asked: list[ReportRequest] = []
    reporting = Reporting(state)
    monkeypatch.setattr(reporting.report, "ask", asked.append)
    reporting.model.param.trigger("wanted")
    (request,) = asked
    if not case.has_command:
        assert recipe.program_note
        assert as_command(recipe).startswith(f"# No command line gives this: {recipe.program_note}\n")
        assert request.note.startswith(recipe.program_note)
        return
    assert recipe.program_note == request.note == ""
    assert energy_of_command(as_command(recipe), tmp_path, capsys) == pytest.approx(energy_kwh, rel=1e-9)
    assert reported(request)[-1] == pytest.approx(energy_kwh, rel=1e-9)


def energy_of_program(text: str, capsys: pytest.CaptureFixture[str]) -> float:
    """Return the energy that a program prints [kWh]."""
    exec(compile(text, "program", "exec"), {})
    return float(capsys.readouterr().out)


def energy_of_command(text: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> float:
    """Return the energy that a command line prints, read by a shell [kWh]."""
    script = f"railjoule() {{ printf '%s\\0' \"$@\"; }}\n{text}"
    words = subprocess.run(["sh", "-c", script], cwd=folder, check=True, capture_output=True).stdout.decode()
    arguments = [str(folder / word) if word == FILE else word for word in words.split("\0")[:-1]]
    assert main([*arguments, "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    return float(result["actual"]["energy_kwh"] if "actual" in result else result["energy_kwh"])


def test_a_name_cannot_become_a_command() -> None:
    recipe = Recipe("x", None, {}, program=Program({}, "", ""), program_note="Harbour\nrm -r .\r\x0b\u2028x")
    lines = as_command(recipe).splitlines()
    assert len(lines) == 2
    assert all(line.startswith("# ") for line in lines)


def test_the_lessons_are_a_program(capsys: pytest.CaptureFixture[str]) -> None:
    state = Workbench()
    learn = state.pages["Learn"]
    PageWorks(state.pages["Learn"])
    state.page = "Learn"
    learn.coasting = 120.0
    exec(compile(as_python(page_recipe(state)), "program", "exec"), {})
    printed = capsys.readouterr().out.splitlines()
    shown = [
        f"{lesson}, {name}: {run.energy_kwh} kWh"
        for lesson, result in learn.lessons.items()
        for name, run in result.runs.items()
    ]
    assert sorted(printed) == sorted(shown)
    assert as_command(page_recipe(state)).startswith("# No command line gives this: ")


def test_a_study_is_a_program(capsys: pytest.CaptureFixture[str]) -> None:
    state = Workbench()
    state.scenario.choose("liashenko-i")
    made = make_study(state.scenario.scenario(), {"vehicle.load_factor": (0.0, 1.0)}, 3, seed=4)
    state.pages["Explore"].sweep = MemoryResults(made)
    state.page = "Explore"
    recipe = page_recipe(state)
    found: dict[str, Any] = {}
    exec(compile(as_python(recipe), "program", "exec"), found)
    same = sweep(state.scenario.scenario(), {"vehicle.load_factor": (0.0, 1.0)}, 3, seed=4)
    assert np.array_equal(found["table"].columns["energy_kwh"], same.columns["energy_kwh"])
    assert "energy_kwh" in capsys.readouterr().out
    assert as_command(recipe).startswith("# No command line gives this: ")


def test_the_papers_are_a_command() -> None:
    state = Workbench()
    state.page = "Papers"
    assert as_command(page_recipe(state)) == "railjoule validate\n"
    assert not page_run(state).program.of_scenario
    compile(as_python(page_recipe(state)), "program", "exec")


@pytest.fixture
def slid() -> Workbench:
    """Return a workbench whose sliders were moved."""
    state = Workbench()
    state.scenario.choose("liashenko-i")
    state.scenario.param.update(travel_time_s=100.0, load_percent=30.0)
    return state


def test_an_edited_preset(slid: Workbench, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    slid.scenario.edit(
        {"vehicle.auxiliary_power_kw": 40.0, "line.speed_limits": [{"from_m": 300.0, "to_m": 500.0, "limit_kmh": 50.0}]}
    )
    recipe = page_recipe(slid)
    energy = solve(slid.scenario.scenario()).energy_kwh
    assert energy_of_program(as_python(recipe), capsys) == energy
    # the command reads changes over the file, not over the scenario: the same to rounding
    assert energy_of_command(as_command(recipe), tmp_path, capsys) == pytest.approx(energy, rel=1e-9)
    assert solve(parse_scenario(as_toml(recipe))).energy_kwh == pytest.approx(energy, rel=1e-9)


def test_the_scenario_of_a_file(slid: Workbench, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    title = 'It\'s "mine" \\ $HOME """ `x`'
    slid.scenario.open(format_scenario(load_scenario("liashenko-i").replace(title=title)), "x")
    slid.scenario.load_percent = 40.0
    recipe = page_recipe(slid)
    energy = solve(slid.scenario.scenario()).energy_kwh
    assert energy_of_program(as_python(recipe), capsys) == energy
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
