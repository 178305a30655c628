"""Saving to My files, beside every page."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from railjoule.core.workspace import Workspace
from railjoule.dashboard.keep.keeping import Keeping
from railjoule.dashboard.keep.lifeline import Lifeline
from railjoule.dashboard.shell.saving_own import SavingOwn
from railjoule.dashboard.shell.sidebar import own_option, scenario_options
from railjoule.dashboard.state.files import serve_files_of
from railjoule.dashboard.state.workbench import Workbench
from railjoule.dashboard.work.runs import RunsRequest, compute_runs


@pytest.fixture
def workspace(tmp_path: Path) -> Iterator[Workspace]:
    made = Workspace(tmp_path / "own")
    serve_files_of(made)
    yield made
    serve_files_of(None)


@pytest.fixture
def saving(workspace: Workspace) -> SavingOwn:
    state = Workbench()
    keeping = Keeping(state, Lifeline())
    keeping.begin("")
    made = SavingOwn(state, keeping)
    made._turn()
    return made


def save(saving: SavingOwn, kind: str, name: str, what: str = "save") -> str:
    """Save something; return what was told."""
    saving.form._hear({"what": what, "kind": kind, "name": name})
    return str(saving.form.refusal or saving.form.told)


def test_without_a_workspace_there_is_no_button() -> None:
    state = Workbench()
    assert not SavingOwn(state, Keeping(state, Lifeline())).view.visible


def test_a_scenario_is_saved_with_its_changes_and_the_page_keeps_its_own(
    saving: SavingOwn, workspace: Workspace
) -> None:
    state, keeping = saving.state, saving.keeping
    state.scenario.load_percent = 30.0
    state.scenario.edit({"line.reverse": True})
    state.ticked = ["eoc"]
    keeping.note()
    before = state.scenario.scenario()
    assert save(saving, "scenarios", "my run") == "Saved as scenario my run."
    assert workspace.scenario("my run") == before
    assert state.scenario.scenario() == before
    assert (dict(state.scenario.changes), state.ticked) == ({}, ["eoc"])
    assert state.files.current is not None
    assert scenario_options(state)["my run (my files)"] == own_option(state) == "own/my run"
    keeping.undo()
    assert state.scenario.preset == "metro-with-limit"
    assert state.scenario.opened is None
    assert state.scenario.changes["line.reverse"] is True


def test_the_name_of_another_file_is_refused_until_replacing_is_asked_for(
    saving: SavingOwn, workspace: Workspace
) -> None:
    workspace.save("scenarios", "taken", "title = 'x'\n")
    saving.state.files.look()
    assert save(saving, "scenarios", "Taken") == "There is a scenario 'taken' already."
    assert saving.form.can_replace
    assert save(saving, "scenarios", "other", "replace") == "Saved as scenario other."
    assert save(saving, "scenarios", "Taken") == "There is a scenario 'taken' already."
    assert save(saving, "scenarios", "Taken", "replace") == "Saved as scenario taken."
    assert workspace.names("scenarios") == ("other", "taken")


def test_the_same_name_is_saved_over(saving: SavingOwn, workspace: Workspace) -> None:
    save(saving, "scenarios", "my run")
    saving.state.scenario.travel_time_s = 190.0
    assert save(saving, "scenarios", "my run") == "Saved as scenario my run."
    assert workspace.scenario("my run").travel_time_s == 190
    (workspace.folder / "scenarios/my run.toml").write_text("title = 'by hand'\n")
    assert save(saving, "scenarios", "my run") == "my run was changed in its folder since it was opened."


def test_parts_of_a_scenario_are_saved(saving: SavingOwn, workspace: Workspace) -> None:
    assert save(saving, "vehicles", "my metro") == "Saved as vehicle my metro."
    assert save(saving, "lines", "my line") == "Saved as line my line."
    scenario = saving.state.scenario.scenario()
    assert workspace.document("vehicles", "my metro")["tare_kg"] == scenario.vehicle.tare_kg
    assert len(workspace.document("lines", "my line")["sections"]) == len(scenario.line.sections)
    assert saving.state.files.current is None


def test_the_run_that_is_shown_is_saved(saving: SavingOwn, workspace: Workspace) -> None:
    assert save(saving, "runs", "monday") == "There is no run yet."
    state = saving.state
    state.runs = compute_runs(RunsRequest(state.scenario.scenario(), state.drawn, False))
    assert save(saving, "runs", "monday") == "Saved as run monday."
    assert workspace.text("runs", "monday").count("\n") == len(state.run.to_dataframe()) + 1  # type: ignore[union-attr]


@pytest.mark.parametrize("name", ["", "../x", "tram-950m", "x" * 1000])
def test_a_name_that_cannot_be_changes_nothing(saving: SavingOwn, workspace: Workspace, name: str) -> None:
    assert save(saving, "scenarios", name).startswith("name ")
    assert not saving.form.can_replace
    assert workspace.listing().files == ()
    assert saving.state.scenario.opened is None


def test_a_kind_that_is_none_is_not_asked_for(saving: SavingOwn, workspace: Workspace) -> None:
    assert save(saving, "../runs", "x") == ""
    assert workspace.listing().files == ()
