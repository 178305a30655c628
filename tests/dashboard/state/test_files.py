"""My files on one page: what is asked of a workspace, and what comes of it."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from panel.io.state import set_curdoc
from turns import Page

from railjoule.core import RailjouleError, load_scenario
from railjoule.core.scenario import format_scenario
from railjoule.core.workspace import Kind, OwnFile, Workspace
from railjoule.dashboard.state.files import FilesModel, serve_files_of
from railjoule.dashboard.state.scenario import ScenarioModel
from railjoule.dashboard.state.workbench import Workbench

VEHICLE = 'preset = "metro-81-7036"\ntare_kg = 190_000\n'
SCENARIO = (
    '[vehicle]\npreset = "my-metro"\nload_factor = 0.5\n'
    '[line]\npreset = "liashenko-ii"\n[timetable]\ntravel_time_s = 100\n'
)


@pytest.fixture
def workspace(tmp_path: Path) -> Iterator[Workspace]:
    made = Workspace(tmp_path / "own")
    made.save("vehicles", "my-metro", VEHICLE)
    made.save("scenarios", "my-run", SCENARIO)
    serve_files_of(made)
    yield made
    serve_files_of(None)


@pytest.fixture
def files(workspace: Workspace) -> FilesModel:
    files = FilesModel(ScenarioModel())
    files.look()
    return files


def names(files: FilesModel) -> list[str]:
    return [file.name for file in files.listing.files]


def open_named(files: FilesModel, kind: Kind, name: str) -> None:
    file = files.named(kind, name)
    assert file is not None
    files.open(file)


def test_a_server_without_a_workspace_has_no_files() -> None:
    files = Workbench().files
    assert not files.there
    files.look()
    assert names(files) == []
    files.rename(OwnFile("runs", "a", ".csv", (0, 0, 0)), "b")
    assert files.refusal == "This server keeps no files."


def test_a_scenario_is_opened_whole(files: FilesModel, workspace: Workspace) -> None:
    open_named(files, "scenarios", "my-run")
    assert files.scenario.base.vehicle.tare_kg == 190_000
    assert files.current is not None
    assert files.current.name == "my-run"
    # its address needs no other file
    assert files.scenario.toml is not None
    assert "my-metro" not in files.scenario.toml
    vehicle = workspace.find("vehicles", "my-metro")
    assert vehicle is not None
    workspace.delete(vehicle)
    files.scenario.edit({"line.reverse": True})
    assert files.scenario.scenario().vehicle.tare_kg == 190_000


def test_a_step_back_finds_the_file_again(files: FilesModel) -> None:
    open_named(files, "scenarios", "my-run")
    toml = files.scenario.toml
    files.scenario.choose("liashenko-ii")
    assert files.current is None
    assert toml is not None
    files.scenario.open(toml, "back")
    assert files.current is not None


def test_a_vehicle_is_used_with_the_load_as_far_as_it_carries_it(files: FilesModel, workspace: Workspace) -> None:
    files.scenario.choose("liashenko-ii")
    before = files.scenario.scenario()
    open_named(files, "vehicles", "my-metro")
    assert files.scenario.scenario().vehicle.tare_kg == 190_000
    assert files.scenario.scenario().vehicle.load_factor == before.vehicle.load_factor
    files.scenario.load_percent = 110.0
    workspace.save("vehicles", "small", f"{VEHICLE}crush_load_factor = 1.0\n")
    files.look()
    open_named(files, "vehicles", "small")
    assert files.scenario.scenario().vehicle.load_factor == 1.0
    files.scenario.take_back("vehicle")
    assert files.scenario.scenario().vehicle.tare_kg == before.vehicle.tare_kg


def test_a_scenario_that_is_dropped_may_name_own_presets(files: FilesModel) -> None:
    text = files.whole(SCENARIO, "dropped.toml")
    files.scenario.open(text, "dropped.toml")
    assert files.scenario.scenario().vehicle.tare_kg == 190_000
    assert files.whole("title = 'x'", "x") == "title = 'x'"
    with pytest.raises(RailjouleError, match=r"x.toml: timetable.travel_time_s = -1 must be"):
        files.whole(SCENARIO.replace("100", "-1"), "x.toml")


def test_a_line_is_used(files: FilesModel) -> None:
    files.add("own line.toml", "sections = [{ length_m = 1200 }]\n")
    open_named(files, "lines", "own line")
    assert files.scenario.scenario().line.length_m == 1200


def test_what_cannot_be_opened_changes_nothing_and_is_told(files: FilesModel, workspace: Workspace) -> None:
    before = files.scenario.scenario()
    workspace.save("scenarios", "broken", SCENARIO.replace("travel_time_s = 100", "travel_time_s = 10"))
    workspace.save("scenarios", "far", SCENARIO.replace("travel_time_s = 100", "travel_time_s = -1"))
    files.look()
    open_named(files, "scenarios", "far")
    assert files.refusal.startswith("far: timetable.travel_time_s = -1 must be")
    file = files.named("scenarios", "broken")
    assert file is not None
    workspace.delete(file)
    files.open(file)
    assert files.refusal.startswith("broken.toml in ")
    assert "No such file" in files.refusal
    assert files.scenario.scenario() == before
    # the list has been looked at again
    assert "broken" not in names(files)


def test_files_are_renamed_duplicated_deleted_and_taken_back(files: FilesModel) -> None:
    open_named(files, "scenarios", "my-run")
    files.rename(files.named("scenarios", "my-run"), "evening")  # type: ignore[arg-type]
    assert files.current is not None
    assert files.current.name == "evening"
    files.duplicate(files.named("scenarios", "evening"))  # type: ignore[arg-type]
    assert names(files) == ["evening", "evening copy", "my-metro"]
    files.rename(files.named("scenarios", "evening copy"), "Evening")  # type: ignore[arg-type]
    assert files.refusal == "There is a scenario 'evening' already."
    files.delete(files.named("scenarios", "evening"))  # type: ignore[arg-type]
    assert (names(files), files.refusal) == (["evening copy", "my-metro"], "")
    assert files.is_changed
    files.restore()
    assert names(files) == ["evening", "evening copy", "my-metro"]
    assert files.deleted is None
    assert not files.is_changed


def test_files_that_are_brought_are_checked(files: FilesModel) -> None:
    files.add("a.csv", "time_s,speed_kmh\n0,0\n1,3.6\n")
    files.add("b.toml", SCENARIO)
    assert names(files) == ["b", "my-run", "my-metro", "a"]
    for name, text, sentence in (
        ("b.toml", SCENARIO, "There is a scenario 'b' already."),
        ("../c.toml", VEHICLE.replace("190_000", "0"), "c: tare_kg = 0 must be"),
        ("c.d.toml", SCENARIO, "must not have '.'"),
        ("c.txt", "x", "only .toml and .csv"),
    ):
        files.add(name, text)
        assert sentence in files.refusal
    assert names(files) == ["b", "my-run", "my-metro", "a"]
    # of a path only the name counts
    files.add("../../c.toml", VEHICLE)
    assert files.named("vehicles", "c") is not None


def test_a_scenario_is_saved_with_the_name_of_its_own_vehicle(files: FilesModel, workspace: Workspace) -> None:
    open_named(files, "scenarios", "my-run")
    known = files.current
    assert known is not None
    files.scenario.travel_time_s = 120.0
    scenario = files.scenario.scenario()
    saved: list[str] = []
    failures: list[RailjouleError] = []

    def take(_: OwnFile, toml: str) -> None:
        saved.append(toml)

    for replaces in (None, known.stamp):
        files.save("scenarios", "my-run", lambda: scenario, replaces, take, failures.append)
    assert [str(error) for error in failures] == ["There is a scenario 'my-run' already."]
    assert saved == [format_scenario(scenario)]
    assert 'preset = "my-metro"' in workspace.text("scenarios", "my-run")
    assert workspace.scenario("my-run") == scenario


def test_a_change_by_hand_is_seen(files: FilesModel, workspace: Workspace) -> None:
    open_named(files, "scenarios", "my-run")
    assert not files.is_changed
    (workspace.folder / "scenarios/my-run.toml").write_text(SCENARIO.replace("100", "101"))
    (workspace.folder / "scenarios/by hand.toml").write_text(SCENARIO)
    files.look()
    assert files.is_changed
    assert "by hand" in names(files)
    failures: list[RailjouleError] = []
    known = files.current
    assert known is not None
    files.save("scenarios", "my-run", lambda: SCENARIO, known.stamp, lambda *_: None, failures.append)
    assert [str(error) for error in failures] == ["my-run was changed in its folder since it was opened."]


def test_a_folder_that_cannot_be_read_is_told_until_it_can(files: FilesModel, workspace: Workspace) -> None:
    folder = workspace.folder / "runs"
    folder.symlink_to(workspace.folder / "vehicles", target_is_directory=True)
    files.look()
    assert files.refusal == "runs is a link, which is not followed."
    # what was read before stays in sight
    assert names(files) == ["my-run", "my-metro"]
    files.refusal = "Something else."
    files.look()
    assert files.refusal == "Something else."
    folder.unlink()
    files.look()
    assert files.refusal == "Something else."
    folder.symlink_to(workspace.folder / "vehicles", target_is_directory=True)
    files.look()
    folder.unlink()
    files.look()
    assert files.refusal == ""


def test_the_disk_is_waited_for_in_a_thread(workspace: Workspace) -> None:
    page = Page()
    with set_curdoc(page.document):
        files = FilesModel(ScenarioModel())
        files.look()
        assert names(files) == []
    page.take_turn()
    assert names(files) == ["my-run", "my-metro"]


def test_a_scenario_too_large_for_the_page_is_told(files: FilesModel, workspace: Workspace) -> None:
    large = load_scenario("liashenko-ii", {"solver.mesh_m": 0.05})
    workspace.save("scenarios", "fine", format_scenario(large))
    files.look()
    open_named(files, "scenarios", "fine")
    assert "the page takes at most 20,000" in files.refusal
