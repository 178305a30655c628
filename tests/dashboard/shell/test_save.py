"""Saving the scenario from the sidebar."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from railjoule.dashboard.browser import Browser
from railjoule.dashboard.keep.keeping import Keeping
from railjoule.dashboard.parts.html import stack
from railjoule.dashboard.scenario_folder import ScenarioFolder
from railjoule.dashboard.shell.share import SaveScenario
from railjoule.dashboard.state.files import serve_folder
from railjoule.dashboard.workbench import Workbench


@pytest.fixture
def folder(tmp_path: Path) -> Iterator[ScenarioFolder]:
    made = ScenarioFolder(tmp_path / "own")
    serve_folder(made)
    yield made
    serve_folder(None)


def make() -> SaveScenario:
    state = Workbench()
    browser = Browser()
    keeping = Keeping(state, browser)
    keeping.begin("")
    made = SaveScenario(state, browser, keeping, stack(stack(), stack()))
    made.press()
    return made


def save(saving: SaveScenario, name: str, what: str = "save") -> str:
    """Save the scenario; return the message."""
    saving.name.value = name
    saving.save(replace=what == "replace")
    return str(saving.refusal or saving.status)


def test_a_scenario_is_saved_with_its_changes_and_the_page_keeps_its_own(folder: ScenarioFolder) -> None:
    saving = make()
    state, keeping = saving.state, saving.keeping
    assert saving.name.value == "metro-profile-ii-i"
    state.scenario.load_percent = 30.0
    state.scenario.edit({"line.reverse": True})
    state.ticked = ["eoc"]
    keeping.note()
    before = state.scenario.scenario()
    assert save(saving, "my run") == "Saved as my run.toml."
    # its title differs from the original's in pins, links and reports
    assert folder.open("my run") == before.replace(title="my run") == state.scenario.scenario()
    assert (dict(state.scenario.changes), state.ticked) == ({}, ["eoc"])
    assert saving.name.value == state.files.current == "my run"
    keeping.undo()
    assert state.scenario.preset == "metro-with-limit"
    assert state.scenario.opened is None
    assert state.scenario.changes["line.reverse"] is True
    assert state.files.current == ""


def test_a_file_is_replaced_only_when_that_is_asked_for(folder: ScenarioFolder) -> None:
    saving = make()
    save(saving, "my run")
    saving.state.scenario.travel_time_s = 190.0
    assert save(saving, "my run") == "There is a file my run.toml already."
    assert saving.replace.visible
    assert folder.open("my run").travel_time_s == 170
    assert save(saving, "my run", "replace") == "Saved as my run.toml."
    assert not saving.replace.visible
    assert folder.open("my run").travel_time_s == 190


@pytest.mark.parametrize("name", ["", "../x", "x" * 1000])
def test_a_name_that_cannot_be_changes_nothing(folder: ScenarioFolder, name: str) -> None:
    saving = make()
    assert save(saving, name).startswith("name ")
    assert not saving.replace.visible
    assert folder.listing().files == ()
    assert saving.state.scenario.opened is None


def test_another_scenario_removes_the_message(folder: ScenarioFolder) -> None:
    saving = make()
    save(saving, "my run")
    saving.state.scenario.choose("tram-950m")
    assert saving.status == ""
    assert saving.name.value == "tram-flat-950-m"


def test_a_title_of_its_own_stays(folder: ScenarioFolder) -> None:
    saving = make()
    saving.state.scenario.edit({"title": "Line 4, evening"})
    save(saving, "my run")
    assert folder.open("my run").title == "Line 4, evening"
    saving.state.scenario.travel_time_s = 190.0
    save(saving, "my run", "replace")
    assert folder.open("my run").title == "Line 4, evening"
