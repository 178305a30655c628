"""A folder of a user's own files: what can be had from it, and that nothing else can."""

import multiprocessing
import os
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from railjoule.core import RailjouleError, ScenarioError, load_scenario
from railjoule.core import workspace as module
from railjoule.core.scenario import format_scenario, parse_scenario, preset_text
from railjoule.core.workspace import (
    DELETED,
    MOST_DELETED,
    ChangedMeanwhileError,
    NameTakenError,
    OwnFile,
    Workspace,
    WorkspaceError,
    default_folder,
    kind_of,
    text_of,
)

VEHICLE = 'preset = "metro-81-7036"\ntare_kg = 190_000\n'
LINE = "sections = [{ length_m = 900, gradient_permille = 2 }]\n"
SCENARIO = (
    '[vehicle]\npreset = "my-metro"\nload_factor = 0.5\n[line]\npreset = "my-line"\n[timetable]\ntravel_time_s = 100\n'
)
WRONG_NAMES = (
    "../canary",
    "../../canary",
    "a/../../canary",
    "/canary",
    "..",
    ".canary",
    "a\0b",
    "x" * 1000,
    "\u202ecanary",
)


@pytest.fixture
def workspace(tmp_path: Path) -> Workspace:
    made = Workspace(tmp_path / "own")
    made.save("vehicles", "my-metro", VEHICLE)
    made.save("lines", "my-line", LINE)
    made.save("scenarios", "my-run", SCENARIO)
    return made


def names(workspace: Workspace) -> list[tuple[str, str]]:
    return [(file.kind, file.name) for file in workspace.listing().files]


def everything(folder: Path) -> dict[str, bytes]:
    """All files below a folder, but for the lock."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file() and path.name != ".lock"
    }


def test_a_folder_that_is_not_there_is_empty(tmp_path):
    workspace = Workspace(tmp_path / "own")
    assert workspace.listing().files == ()
    with pytest.raises(ScenarioError, match="there is no preset 'x' among the scenarios"):
        workspace.text("scenarios", "x")
    assert not (tmp_path / "own").exists()


def test_what_was_saved_is_listed_and_read(workspace, tmp_path):
    assert names(workspace) == [("scenarios", "my-run"), ("vehicles", "my-metro"), ("lines", "my-line")]
    assert workspace.text("scenarios", "my-run") == SCENARIO
    assert set(everything(tmp_path)) == {
        "own/scenarios/my-run.toml",
        "own/vehicles/my-metro.toml",
        "own/lines/my-line.toml",
    }


# ---- names resolve like presets


def test_own_names_resolve_like_presets(workspace):
    scenario = load_scenario("my-run", {"vehicle.load_factor": 0.25}, own=workspace)
    assert (scenario.vehicle.tare_kg, scenario.vehicle.load_factor, scenario.line.length_m) == (190_000, 0.25, 900)
    # of the shipped vehicle on which it is based
    assert scenario.vehicle.traction == load_scenario("liashenko-ii").vehicle.traction
    assert scenario.line.name == "my-line"


def test_what_was_read_is_whole(workspace):
    scenario = workspace.scenario("my-run")
    workspace.delete(workspace.find("vehicles", "my-metro"))
    assert scenario.with_(**{"vehicle.load_factor": 0.1}).vehicle.tare_kg == 190_000
    assert parse_scenario(format_scenario(scenario)) == scenario


def test_a_saved_scenario_names_own_presets_again(workspace):
    scenario = workspace.scenario("my-run").with_(**{"vehicle.tare_kg": 195_000.0, "timetable.travel_time_s": 120})
    text = format_scenario(scenario, workspace)
    assert 'preset = "my-metro"' in text
    assert 'preset = "my-line"' in text
    assert len(text) < 300
    assert parse_scenario(text, own=workspace) == scenario


def test_a_drive_of_another_kind_over_an_own_vehicle(workspace):
    scenario = workspace.scenario("my-run").with_(drive={"model": "constant_efficiency", "traction_efficiency": 0.8})
    assert parse_scenario(format_scenario(scenario, workspace), own=workspace) == scenario


def test_whole_parts_of_a_scenario_make_presets(workspace):
    scenario = load_scenario("metro-with-limit", {"vehicle.tare_kg": 180_000.0})
    workspace.save("vehicles", "light", text_of("vehicles", scenario))
    workspace.save("lines", "both", text_of("lines", scenario))
    text = '[vehicle]\npreset = "light"\nload_factor = 0.5\n[line]\npreset = "both"\n[timetable]\ntravel_time_s = 170\n'
    again = parse_scenario(text, own=workspace)
    assert again.vehicle == scenario.vehicle.model_copy(update={"preset": None})
    assert again.line == scenario.line


def test_a_shipped_name_is_the_shipped_one_and_cannot_be_taken(workspace, tmp_path):
    for name in ("metro-81-7036", "Metro-81-7036"):
        with pytest.raises(NameTakenError, match="is that of a shipped vehicle; choose another one"):
            workspace.save("vehicles", name, VEHICLE)
    (tmp_path / "own/scenarios/liashenko-ii.toml").write_text("title = 'mine'\n")
    assert load_scenario("liashenko-ii", own=workspace) == load_scenario("liashenko-ii")
    assert workspace.listing().left_out == (("scenarios/liashenko-ii.toml", "a shipped scenario has this name"),)


def test_an_unknown_name_is_told_with_those_that_are_alike(workspace):
    with pytest.raises(ScenarioError, match="no preset 'my-metr' among the vehicles, did you mean 'my-metro'"):
        parse_scenario(SCENARIO.replace("my-metro", "my-metr"), own=workspace)


def test_a_mistake_in_an_own_file_names_the_file(workspace):
    file = workspace.find("vehicles", "my-metro")
    workspace.save("vehicles", "my-metro", VEHICLE.replace("190_000", "-5"), file.stamp)
    with pytest.raises(ScenarioError, match=r"my-run: my-metro: tare_kg = -5 must be"):
        workspace.scenario("my-run")


def test_a_line_may_be_a_table(workspace, tmp_path):
    (tmp_path / "own/lines/table.csv").write_text("length_m,gradient_permille\n400,3\n500,-3\n")
    scenario = parse_scenario(SCENARIO.replace("my-line", "table"), own=workspace)
    assert [section.gradient_permille for section in scenario.line.sections] == [3, -3]
    assert scenario.line.name == "table"


def test_of_two_lines_of_a_name_the_first_kind_counts_and_the_other_is_told(workspace, tmp_path):
    (tmp_path / "own/lines/my-line.csv").write_text("length_m\n400\n")
    assert workspace.listing().left_out == (("lines/my-line.csv", "my-line.toml has the same name"),)
    assert workspace.document("lines", "my-line")["sections"][0]["length_m"] == 900


# ---- nothing outside


@pytest.fixture
def canary(workspace, tmp_path):
    """A file outside the workspace, which must neither be read nor changed."""
    path = tmp_path / "canary.toml"
    path.write_text("secret = 'canary'\n")
    (tmp_path / "canary.csv").write_text("length_m\n12345\n")
    before = everything(tmp_path)
    yield path
    assert everything(tmp_path) == before


@pytest.mark.parametrize("name", WRONG_NAMES)
def test_names_that_lead_elsewhere_are_refused_everywhere(workspace, canary, name):
    file = workspace.find("scenarios", "my-run")
    strange = OwnFile("scenarios", name, ".toml", file.stamp)
    acts = (
        lambda: workspace.save("scenarios", name, SCENARIO),
        lambda: workspace.rename(file, name),
        lambda: workspace.text("scenarios", name),
        lambda: workspace.scenario(name),
        lambda: workspace.document("vehicles", name),
        lambda: parse_scenario(SCENARIO.replace('"my-metro"', repr(name).replace("'", '"')), own=workspace),
        lambda: workspace.beside("scenarios")(f"{name}.csv"),
        lambda: workspace.read(strange),
        lambda: workspace.delete(strange),
        lambda: workspace.duplicate(strange),
        lambda: workspace.rename(strange, "other"),
    )
    for act in acts:
        with pytest.raises(RailjouleError) as error:
            act()
        assert "secret" not in str(error.value)


def test_a_scenario_names_no_file_outside_its_folder(workspace, canary, tmp_path):
    text = '[vehicle]\npreset = "my-metro"\n[line]\nfile = "{}"\n[timetable]\ntravel_time_s = 100\n'
    for name in ("../../canary.csv", str(tmp_path / "canary.csv"), "..\\\\..\\\\canary.csv", "../lines/my-line.toml"):
        with pytest.raises(RailjouleError, match="must be the name of a file in"):
            parse_scenario(text.format(name), folder=workspace.beside("scenarios"), own=workspace)


def test_a_scenario_may_name_a_table_beside_it(workspace, tmp_path):
    (tmp_path / "own/scenarios/table.csv").write_text("length_m\n700\n")
    text = '[vehicle]\npreset = "my-metro"\n[line]\nfile = "table.csv"\n[timetable]\ntravel_time_s = 100\n'
    workspace.save("scenarios", "by-table", text)
    assert workspace.scenario("by-table").line.length_m == 700


@pytest.mark.skipif(sys.platform == "win32", reason="links need rights there")
def test_links_are_not_followed(workspace, canary, tmp_path):
    link = tmp_path / "own/scenarios/link.toml"
    link.symlink_to(canary)
    try:
        assert ("scenarios", "link") not in names(workspace)
        assert workspace.listing().left_out == (("scenarios/link.toml", "it is a link, which is not followed"),)
        for act in (
            lambda: workspace.text("scenarios", "link"),
            lambda: workspace.beside("scenarios")("link.toml"),
            lambda: workspace.read(OwnFile("scenarios", "link", ".toml", (0, 0, 0))),
            lambda: workspace.save("scenarios", "link", SCENARIO),
        ):
            with pytest.raises(RailjouleError):
                act()
        assert link.is_symlink()
    finally:
        link.unlink()


@pytest.mark.skipif(sys.platform == "win32", reason="links need rights there")
@pytest.mark.parametrize("kind", ["scenarios", "runs"])
def test_a_folder_that_is_a_link_is_not_followed(tmp_path, kind):
    outside = tmp_path / "outside"
    outside.mkdir()
    (outside / "canary.toml").write_text("secret = 'canary'\n")
    (tmp_path / "own").mkdir()
    (tmp_path / "own" / kind).symlink_to(outside)
    workspace = Workspace(tmp_path / "own")
    for act in (workspace.listing, lambda: workspace.save(kind, "x", "")):
        with pytest.raises(WorkspaceError, match="is a link, which is not followed"):
            act()
    assert [path.name for path in outside.iterdir()] == ["canary.toml"]


@pytest.mark.skipif(sys.platform == "win32", reason="links need rights there")
@pytest.mark.parametrize("name", [".lock", ".deleted"])
def test_what_the_workspace_keeps_for_itself_is_no_way_out(workspace, tmp_path, name):
    (tmp_path / "own/.lock").unlink()
    (tmp_path / "own" / name).symlink_to(tmp_path / "outside")
    with pytest.raises(WorkspaceError):
        workspace.delete(workspace.find("scenarios", "my-run"))
    assert not (tmp_path / "outside").exists()
    assert ("scenarios", "my-run") in names(workspace)


def test_a_broken_vehicle_keeps_no_scenario_from_being_saved(workspace):
    scenario = workspace.scenario("my-run")
    workspace.save("vehicles", "a broken one", "tare_kg = -1\n")
    assert 'preset = "my-metro"' in text_of("scenarios", scenario, workspace)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes with names")
def test_a_pipe_is_no_file_and_nobody_waits_for_it(workspace, tmp_path):
    os.mkfifo(tmp_path / "own/scenarios/pipe.toml")
    assert workspace.listing().left_out == (("scenarios/pipe.toml", "it is no file"),)
    with pytest.raises(WorkspaceError, match="is no file"):
        workspace.read(OwnFile("scenarios", "pipe", ".toml", (0, 0, 0)))


# ---- saving


def test_a_name_is_given_once_whatever_its_capitals(workspace):
    for name in ("my-run", "MY-RUN", "My-Run"):
        with pytest.raises(NameTakenError, match="There is a scenario 'my-run' already"):
            workspace.save("scenarios", name, "title = 'other'")
    assert workspace.text("scenarios", "my-run") == SCENARIO


def test_a_file_is_replaced_by_who_has_seen_it_and_the_former_one_is_kept(workspace, tmp_path):
    file = workspace.find("scenarios", "my-run")
    saved = workspace.save("scenarios", "my-run", "title = 'two'\n", file.stamp)
    assert workspace.text("scenarios", "my-run") == "title = 'two'\n"
    assert saved.stamp != file.stamp
    assert [path.read_text() for path in (tmp_path / "own" / DELETED).iterdir()] == [SCENARIO]
    with pytest.raises(ChangedMeanwhileError, match="my-run was changed in its folder"):
        workspace.save("scenarios", "my-run", "title = 'three'\n", file.stamp)
    workspace.delete(saved)
    with pytest.raises(ChangedMeanwhileError, match="my-run is no longer in its folder"):
        workspace.save("scenarios", "my-run", "title = 'three'\n", saved.stamp)


def test_a_change_by_hand_is_noticed(workspace, tmp_path):
    file = workspace.find("scenarios", "my-run")
    (tmp_path / "own/scenarios/my-run.toml").write_text(SCENARIO.replace("100", "101"))
    assert workspace.find("scenarios", "my-run").stamp != file.stamp
    with pytest.raises(ChangedMeanwhileError):
        workspace.save("scenarios", "my-run", SCENARIO, file.stamp)
    assert workspace.scenario("my-run").travel_time_s == 101


def test_a_disk_that_refuses_leaves_everything_as_it_was(workspace, tmp_path, monkeypatch):
    before = everything(tmp_path)
    file = workspace.find("scenarios", "my-run")

    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(module.os, "fsync", full)
    for replaces in (None, file.stamp):
        with pytest.raises(WorkspaceError, match=r"nothing was changed in .*: No space left on device"):
            workspace.save("scenarios", "my-run" if replaces else "new", "title = 'x'", replaces)
    assert everything(tmp_path) == before


@pytest.mark.skipif(sys.platform == "win32" or os.geteuid() == 0, reason="the superuser may write everywhere")
def test_a_folder_for_reading_alone(workspace, tmp_path):
    before = everything(tmp_path)
    (tmp_path / "own/scenarios").chmod(0o500)
    try:
        with pytest.raises(WorkspaceError, match=r"nothing was changed in .*Permission denied"):
            workspace.save("scenarios", "new", SCENARIO)
        assert workspace.text("scenarios", "my-run") == SCENARIO
    finally:
        (tmp_path / "own/scenarios").chmod(0o700)
    assert everything(tmp_path) == before


def test_a_place_that_is_a_file_is_told(tmp_path):
    (tmp_path / "own").write_text("")
    with pytest.raises(WorkspaceError, match=r"(Not a directory|File exists)"):
        Workspace(tmp_path / "own").save("scenarios", "x", SCENARIO)


def test_texts_that_cannot_be_saved(workspace, monkeypatch):
    with pytest.raises(WorkspaceError, match="its text is not UTF-8"):
        workspace.save("scenarios", "x", "title = '\ud800'")
    monkeypatch.setattr(module, "LARGEST_FILE_BYTES", 20)
    with pytest.raises(WorkspaceError, match="more than the 2e-05 MB allowed"):
        workspace.save("scenarios", "x", "#" * 21)
    monkeypatch.setattr(module, "MOST_FILES", 1)
    with pytest.raises(WorkspaceError, match="there are 1 scenarios already"):
        workspace.save("scenarios", "x", "#")


def test_what_has_no_name_to_be_had_by_is_told(workspace, tmp_path):
    folder = tmp_path / "own/scenarios"
    for name in ("two.dots.toml", "\u202elmot.toml", "dir.toml", "note.txt", ".hidden.toml"):
        (folder / name).mkdir() if name == "dir.toml" else (folder / name).write_text("")
    left_out = dict(workspace.listing().left_out)
    assert set(left_out) == {"scenarios/two.dots.toml", "scenarios/\u202elmot.toml", "scenarios/dir.toml"}
    assert "must not have '.'" in left_out["scenarios/two.dots.toml"]
    assert ("scenarios", "my-run") in names(workspace)


# ---- renaming, duplicating, deleting


def test_a_file_is_renamed_with_its_comments(workspace):
    text = f"# by hand\n{SCENARIO}"
    file = workspace.save("scenarios", "first", text)
    renamed = workspace.rename(file, "First")
    assert workspace.text("scenarios", "First") == text
    with pytest.raises(NameTakenError, match="There is a scenario 'my-run' already"):
        workspace.rename(renamed, "My-Run")
    with pytest.raises(NameTakenError, match="shipped scenario"):
        workspace.rename(renamed, "tram-950m")
    assert workspace.rename(renamed, "First").name == "First"


def test_a_duplicate_has_a_name_of_its_own(workspace):
    file = workspace.find("vehicles", "my-metro")
    assert [workspace.duplicate(file).name for _ in range(3)] == [
        "my-metro copy",
        "my-metro copy 2",
        "my-metro copy 3",
    ]
    assert workspace.text("vehicles", "my-metro copy 3") == VEHICLE
    long = workspace.save("vehicles", "x" * 80, VEHICLE)
    assert workspace.duplicate(long).name == "x" * 75 + " 2"


def test_what_was_deleted_comes_back_as_it_was(workspace, tmp_path):
    file = workspace.find("scenarios", "my-run")
    deleted = workspace.delete(file)
    assert ("scenarios", "my-run") not in names(workspace)
    assert workspace.restore(deleted) == file
    deleted = workspace.delete(file)
    workspace.save("scenarios", "my-run", "title = 'other'")
    assert workspace.restore(deleted).name == "my-run 2"
    assert workspace.text("scenarios", "my-run 2") == SCENARIO
    with pytest.raises(WorkspaceError, match="No such file"):
        workspace.restore(deleted)


def test_the_last_hundred_deleted_files_are_kept(workspace, tmp_path):
    for number in range(MOST_DELETED + 5):
        workspace.delete(workspace.save("runs", "run", f"time_s\n{number}\n"))
    kept = [path.read_text() for path in (tmp_path / "own" / DELETED).iterdir()]
    assert len(kept) == MOST_DELETED
    assert "time_s\n104\n" in kept
    assert "time_s\n0\n" not in kept


# ---- at the same time


def _save_in_a_process(arguments: tuple[str, int]) -> str:
    folder, number = arguments
    try:
        return Workspace(folder).save("runs", "race", f"time_s\n{number}\n" * 1000).name
    except NameTakenError:
        return "taken"


def test_of_several_who_save_a_new_name_one_wins(tmp_path):
    folder = tmp_path / "own"
    workspace = Workspace(folder)

    def save(number: int) -> str:
        try:
            return workspace.save("runs", "threads", f"time_s\n{number}\n" * 1000).name
        except NameTakenError:
            return "taken"

    with ThreadPoolExecutor(8) as pool:
        assert sorted(pool.map(save, range(16))) == ["taken"] * 15 + ["threads"]
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        outcomes = pool.map(_save_in_a_process, [(str(folder), number) for number in range(8)], chunksize=1)
    assert sorted(outcomes) == ["race"] + ["taken"] * 7
    for name in ("threads", "race"):
        lines = workspace.text("runs", name).splitlines()
        assert len(lines) == 2000
        assert len(set(lines)) == 2


def test_who_reads_while_others_write_finds_a_whole_file(tmp_path):
    workspace = Workspace(tmp_path / "own")
    file = workspace.save("runs", "run", "0" * 100_000)

    def write(digit: int) -> None:
        for _ in range(10):
            try:
                workspace.save("runs", "run", str(digit) * 100_000, workspace.find("runs", "run").stamp)
            except ChangedMeanwhileError:
                continue

    with ThreadPoolExecutor(4) as pool:
        writing = [pool.submit(write, digit) for digit in range(1, 4)]
        while not all(one.done() for one in writing):
            text, _ = workspace.read(file)
            assert len(text) == 100_000
            assert len(set(text)) == 1
    for one in writing:
        one.result()


# ---- what a file is

RUN = "time_s,speed_kmh\n0,0\n1,3.6\n"


@pytest.mark.parametrize(
    ("name", "text", "kind"),
    [
        ("a.toml", SCENARIO, "scenarios"),
        ("a.toml", VEHICLE, "vehicles"),
        ("a.toml", preset_text("vehicles", "tram-105n"), "vehicles"),
        ("a.toml", LINE, "lines"),
        ("a.toml", 'preset = "liashenko-ii"\nreverse = true\n', "lines"),
        ("A.CSV", "length_m,gradient_permille\n400,3\n", "lines"),
        ("a.csv", RUN, "runs"),
    ],
)
def test_a_file_is_told_by_its_content(workspace, name, text, kind):
    assert kind_of(name, text, workspace) == (kind, Path(name).suffix.lower())


@pytest.mark.parametrize(
    ("name", "text", "sentence"),
    [
        ("a.txt", "x", "'a.txt': only .toml and .csv files can be added."),
        ("a.toml", "x =", "a.toml: not a valid TOML file"),
        ("a.toml", SCENARIO.replace("100", "-1"), "a.toml: timetable.travel_time_s = -1 must be"),
        ("a.toml", SCENARIO.replace("my-metro", "none"), "there is no preset 'none' among the vehicles"),
        ("a.toml", VEHICLE.replace("190_000", "-1"), "a: tare_kg = -1 must be"),
        ("a.toml", "nonsense = 1", "a: "),
        ("a.csv", "length_m\nx\n", "length_m = 'x' must be a number"),
        ("a.csv", "time_s\n1\n2\n", "neither a line's sections"),
        ("a.csv", "", "neither a line's sections"),
        ("a.csv", "hello, world\nthis, is\na, letter\n", "neither a line's sections"),
        ("a.csv", "a,b\n1,2\n3\n", "neither a line's sections"),
    ],
)
def test_a_file_that_is_nothing_is_told(workspace, name, text, sentence):
    with pytest.raises(RailjouleError) as error:
        kind_of(name, text, workspace)
    assert sentence in str(error.value)


# ---- where it is


def test_the_default_folder_is_the_platforms(monkeypatch, tmp_path):
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    assert default_folder() == tmp_path / "railjoule"
    monkeypatch.delenv("XDG_DATA_HOME")
    monkeypatch.setenv("HOME", str(tmp_path))
    assert default_folder() == tmp_path / ".local/share/railjoule"
    monkeypatch.setattr(sys, "platform", "darwin")
    assert default_folder() == tmp_path / "Library/Application Support/railjoule"
    monkeypatch.setattr(sys, "platform", "win32")
    monkeypatch.setenv("LOCALAPPDATA", str(tmp_path / "local"))
    assert default_folder() == tmp_path / "local/railjoule"


def test_shipped_files_can_be_saved_under_another_name(workspace):
    for kind, name in (("vehicles", "tram-105n"), ("lines", "metro-10-stations")):
        workspace.save(kind, f"my {name}", preset_text(kind, name))
        assert workspace.document(kind, f"my {name}")["name"]


def test_kept_studies_are_listed_by_name_and_put_away(workspace, tmp_path):
    assert workspace.studies() == ()
    path = workspace.study_path("Winter")
    path.write_bytes(b"rows")
    workspace.study_path("autumn").write_bytes(b"rows")
    assert workspace.studies() == ("autumn", "Winter")
    workspace.delete_study("Winter")
    assert workspace.studies() == ("autumn",)
    with pytest.raises(WorkspaceError, match="nothing was changed"):
        workspace.delete_study("Winter")
    with pytest.raises(RailjouleError):
        workspace.study_path("../outside")
