"""The list of the folder on Start."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from railjoule.core import load_scenario, save_scenario
from railjoule.dashboard.pages.start.page import EMPTY, files_html
from railjoule.dashboard.scenario_folder import ScenarioFolder
from railjoule.dashboard.state.files import FilesModel, serve_folder
from railjoule.dashboard.state.scenario import ScenarioModel


@pytest.fixture
def files(tmp_path: Path) -> Iterator[FilesModel]:
    (tmp_path / "own").mkdir()
    serve_folder(ScenarioFolder(tmp_path / "own"))
    yield FilesModel(ScenarioModel())
    serve_folder(None)


def test_an_empty_folder_says_how_files_come_to_be_there(files: FilesModel) -> None:
    assert EMPTY not in files_html(files)
    files.look()
    assert EMPTY in files_html(files)


def test_files_are_listed_by_name_title_and_date_and_never_with_a_path(files: FilesModel, tmp_path: Path) -> None:
    save_scenario(load_scenario("tram-950m"), tmp_path / "own" / "tram.toml")
    (tmp_path / "own" / "<b>.toml").write_text("x", encoding="utf-8")
    files.look()
    files.open("tram", lambda: None, lambda _: None)
    html = files_html(files)
    assert html.count("data-ask=") == 1
    assert 'data-ask="open_saved" data-name="tram"' in html
    assert "Tram, flat 950 m" in html
    assert html.count(">open<") == 1
    assert "&lt;b&gt;" in html
    assert "Cannot be opened: not a valid TOML file" in html
    assert "the folder own<" in html
    assert str(tmp_path) not in html


def test_an_unreadable_folder_is_one_sentence(files: FilesModel) -> None:
    files.refusal = "The folder cannot be read: Permission denied."
    assert '<p class="error" role="alert">The folder cannot be read: Permission denied.</p>' in files_html(files)
