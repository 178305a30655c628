"""The folder of scenario files as one page sees it."""

from collections.abc import Iterator
from pathlib import Path
from threading import current_thread

import pytest
from panel.io.state import set_curdoc
from turns import Page

from railjoule.core import RailjouleError, load_scenario, save_scenario
from railjoule.dashboard.scenario_folder import Listing, ScenarioFolder
from railjoule.dashboard.state.files import FilesModel, serve_folder
from railjoule.dashboard.state.scenario import ScenarioModel


@pytest.fixture
def folder(tmp_path: Path) -> Iterator[ScenarioFolder]:
    save_scenario(load_scenario("tram-950m"), tmp_path / "tram.toml")
    made = ScenarioFolder(tmp_path)
    serve_folder(made)
    yield made
    serve_folder(None)


@pytest.fixture
def files(folder: ScenarioFolder) -> FilesModel:
    files = FilesModel(ScenarioModel())
    files.look()
    return files


def open_file(files: FilesModel, name: str) -> str:
    """Open a file; return why not, empty if it is open."""
    refusals: list[RailjouleError] = []
    files.open(name, lambda: None, refusals.append)
    return str(refusals[0]) if refusals else ""


def test_a_server_without_a_folder_has_no_files() -> None:
    files = FilesModel(ScenarioModel())
    before = files.scenario.scenario()
    files.look()
    assert open_file(files, "tram") == ""
    files.save("x", before, False, lambda *_: pytest.fail("saved"), lambda _: None)
    assert (files.listing, files.scenario.scenario()) == (None, before)


def test_a_file_is_opened_and_a_step_to_another_scenario_forgets_its_name(files: FilesModel) -> None:
    assert open_file(files, "tram") == ""
    assert files.scenario.scenario() == load_scenario("tram-950m")
    assert files.current == "tram"
    kept = files.scenario.keep()
    files.scenario.choose("liashenko-ii")
    assert files.current == ""
    files.scenario.open(kept["toml"], "a step back")
    assert files.current == "tram"


@pytest.mark.parametrize("name", ["../tram", "none", ""])
def test_a_file_that_is_not_there_changes_nothing(files: FilesModel, name: str) -> None:
    before = files.scenario.scenario()
    assert open_file(files, name) == f"'{name}.toml': there is no such file in the folder."
    assert files.scenario.scenario() == before
    assert files.current == ""


def test_a_scenario_that_no_train_can_run_is_refused_and_not_saved(files: FilesModel, folder: ScenarioFolder) -> None:
    refusals: list[RailjouleError] = []
    steep = load_scenario("tram-950m").replace(**{"line.sections": [{"length_m": 950, "gradient_permille": 200}]})
    files.save("steep", steep, False, lambda *_: pytest.fail("saved"), refusals.append)
    assert str(refusals[0]).startswith("steep: ")
    assert [file.name for file in folder.listing().files] == ["tram"]


def test_an_unreadable_folder_is_one_sentence_until_it_can_be_read(
    files: FilesModel, folder: ScenarioFolder, tmp_path: Path
) -> None:
    folder.path = tmp_path / "tram.toml"
    files.look()
    assert files.refusal == "The folder cannot be read: Not a directory."
    folder.path = tmp_path
    files.look()
    assert files.refusal == ""
    assert isinstance(files.listing, Listing)


def test_the_disk_is_waited_for_in_a_thread(folder: ScenarioFolder, monkeypatch: pytest.MonkeyPatch) -> None:
    files, threads, listing = FilesModel(ScenarioModel()), list[str](), folder.listing
    monkeypatch.setattr(folder, "listing", lambda: threads.append(current_thread().name) or listing())
    page = Page()
    with set_curdoc(page.document):
        files.look()
    page.take_turn()
    assert threads[0].startswith("railjoule-files")
    assert files.listing is not None
