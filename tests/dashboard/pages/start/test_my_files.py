"""My files on Start: what the browser is told, and what it may ask."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from railjoule.core.workspace import Workspace
from railjoule.dashboard.pages.start.my_files import FileList
from railjoule.dashboard.state.files import FilesModel, serve_files_of
from railjoule.dashboard.state.scenario import ScenarioModel

SCENARIO = '[vehicle]\npreset = "metro-81-7036"\n[line]\npreset = "liashenko-ii"\n[timetable]\ntravel_time_s = 100\n'


@pytest.fixture
def files(tmp_path: Path) -> Iterator[FilesModel]:
    workspace = Workspace(tmp_path / "own")
    workspace.save("scenarios", "my-run", SCENARIO)
    workspace.save("runs", "monday", "time_s,speed_kmh\n0,0\n1,3.6\n")
    serve_files_of(workspace)
    files = FilesModel(ScenarioModel())
    files.look()
    yield files
    serve_files_of(None)


def test_rows_say_what_a_press_does(files: FilesModel) -> None:
    shown = FileList(files, lambda: None, lambda *_: None)
    assert [(row["name"], row["label"], row["opens"]) for row in shown.files] == [
        ("my-run", "Scenario", "Open"),
        ("monday", "Run", "Open on Measured runs:"),
    ]
    assert shown.folder == str(files.workspace.folder)  # type: ignore[union-attr]


def test_what_is_open_and_what_has_changed_are_marked(files: FilesModel) -> None:
    opened: list[bool] = []
    shown = FileList(files, lambda: opened.append(True), lambda *_: None)
    shown._take({"what": "open", "kind": "scenarios", "name": "my-run"})
    shown.show()
    assert opened == [True]
    assert (shown.files[0]["open"], shown.files[0]["stale"]) == (True, False)
    assert files.workspace is not None
    (files.workspace.folder / "scenarios/my-run.toml").write_text("title = 'by hand'\n")
    files.look()
    shown.show()
    assert shown.files[0]["stale"]


def test_a_run_is_handed_to_measured_runs(files: FilesModel) -> None:
    shown: list[tuple[str, bytes]] = []
    before = files.scenario.scenario()
    FileList(files, lambda: None, lambda *run: shown.append(run))._take(
        {"what": "open", "kind": "runs", "name": "monday"}
    )
    assert shown == [("monday.csv", b"time_s,speed_kmh\n0,0\n1,3.6\n")]
    assert files.scenario.scenario() == before


@pytest.mark.parametrize(
    "message",
    [
        {},
        {"what": "delete"},
        {"what": "delete", "kind": "scenarios", "name": "../my-run"},
        {"what": "delete", "kind": "../own/scenarios", "name": "my-run"},
        {"what": "open", "kind": "runs", "name": "monday"},
        {"what": "look", "kind": "scenarios", "name": "my-run"},
        {"what": "restore", "kind": ["scenarios"], "name": {"my-run": 1}},
        {"what": "rename", "kind": "scenarios", "name": "my-run"},
        {"what": "rename", "kind": "scenarios", "name": "my-run", "text": "../../x"},
        {"what": "add", "file": "../../x.toml", "text": 5},
        {"what": "add"},
        {"what": "undo"},
    ],
)
def test_a_message_that_asks_for_nothing_there_changes_nothing(files: FilesModel, message: dict[str, object]) -> None:
    before, scenario = files.listing, files.scenario.scenario()
    FileList(files, lambda: None, lambda *_: None)._hear(message)
    files.look()
    assert files.listing == before
    assert files.scenario.scenario() == scenario
