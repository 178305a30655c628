"""The folder of scenario files, and that nothing outside of it is read or written."""

import os
import sys
from pathlib import Path

import pytest

from railjoule.core import RailjouleError, load_scenario
from railjoule.core.scenario import format_scenario
from railjoule.dashboard import scenario_folder
from railjoule.dashboard.scenario_folder import (
    LONGEST_NAME,
    FileExistsInFolderError,
    FolderError,
    Listing,
    ScenarioFolder,
    checked_name,
    default_folder,
)

TRAM = format_scenario(load_scenario("tram-950m"))
WITH_TABLE = '[vehicle]\npreset = "tram-105n"\n[line]\nfile = {}\n[timetable]\ntravel_time_s = 300\n'
SECRET = "secret-of-another-folder"
NO_LINKS = pytest.mark.skipif(sys.platform == "win32", reason="links need rights there")


@pytest.fixture
def folder(tmp_path: Path) -> ScenarioFolder:
    (tmp_path / "secret.toml").write_text(f'title = "{SECRET}"\n{TRAM}', encoding="utf-8")
    (tmp_path / "own").mkdir()
    return ScenarioFolder(tmp_path / "own")


def put(folder: ScenarioFolder, name: str, text: str = TRAM) -> Path:
    path = folder.path / name
    path.write_text(text, encoding="utf-8")
    return path


def test_a_folder_that_is_not_there_is_empty_and_made_at_the_first_save(tmp_path: Path) -> None:
    folder = ScenarioFolder(tmp_path / "a" / "b")
    assert folder.listing() == Listing()
    assert folder.save("tram", TRAM) == "tram"
    assert [file.name for file in folder.listing().files] == ["tram"]
    assert folder.label == "b"


def test_files_are_listed_with_title_or_reason(folder: ScenarioFolder) -> None:
    put(folder, "tram.v2.toml")
    put(folder, "Broken.toml", TRAM.replace("travel_time_s = 95.0", "travel_time_s = -1"))
    put(folder, "text.toml", "no TOML")
    put(folder, "other.csv", "a,b\n")
    put(folder, ".hidden.toml")
    (folder.path / "inner.toml").mkdir()
    files = folder.listing().files
    assert [(file.name, file.title, file.refusal.partition(" ")[0]) for file in files] == [
        ("Broken", "", "timetable.travel_time_s"),
        ("text", "", "not"),
        ("tram.v2", "Tram, flat 950 m", ""),
    ]
    assert files[2].changed_s == pytest.approx((folder.path / "tram.v2.toml").stat().st_mtime)


def test_an_unchanged_folder_is_not_read_again(folder: ScenarioFolder, monkeypatch: pytest.MonkeyPatch) -> None:
    put(folder, "tram.toml")
    before = folder.listing()
    monkeypatch.setattr(folder, "open", lambda _: pytest.fail("read again"))
    assert folder.listing() is before
    put(folder, "notes.csv", "a\n")
    assert folder.listing() == before


def test_a_refused_file_is_read_again_once_a_table_that_it_names_is_there(folder: ScenarioFolder) -> None:
    put(
        folder,
        "own.toml",
        '[vehicle]\npreset = "tram-105n"\n[line]\nfile = "s.csv"\n[timetable]\ntravel_time_s = 300\n',
    )
    assert folder.listing().files[0].refusal == "'s.csv': there is no such file in the folder."
    put(folder, "s.csv", "length_m,gradient_permille\n2000,0\n")
    assert folder.listing().files[0].refusal == ""
    assert folder.open("own").line.length_m == 2000


def test_more_files_than_are_listed_are_counted(folder: ScenarioFolder, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(scenario_folder, "MOST_LISTED", 2)
    for name in "abc":
        put(folder, f"{name}.toml")
    listing = folder.listing()
    assert ([file.name for file in listing.files], listing.more) == (["a", "b"], 1)


@pytest.mark.parametrize(
    "name", ["../secret", "/secret", "..\\secret", "secret\0", ".hidden", "", "inner/../../secret"]
)
def test_no_name_leads_out_of_the_folder(folder: ScenarioFolder, name: str) -> None:
    put(folder, ".hidden.toml", f'title = "{SECRET}"')
    with pytest.raises(RailjouleError) as refusal:
        folder.open(name)
    assert SECRET not in str(refusal.value)
    with pytest.raises(FolderError):
        folder.save(name, TRAM, replace=True)


@pytest.mark.parametrize("name", ["../secret.toml", "/etc/passwd", ".hidden.csv", "own/../x.csv"])
def test_a_scenario_names_no_file_outside_its_folder(folder: ScenarioFolder, name: str) -> None:
    put(folder, ".hidden.csv", "length_m\n1000\n")
    put(
        folder,
        "own.toml",
        f'[vehicle]\npreset = "tram-105n"\n[line]\nfile = {name!r}\n[timetable]\ntravel_time_s = 300\n',
    )
    with pytest.raises(RailjouleError, match="there is no such file in the folder"):
        folder.open("own")


@NO_LINKS
def test_links_are_neither_listed_read_nor_replaced(folder: ScenarioFolder, tmp_path: Path) -> None:
    (folder.path / "link.toml").symlink_to(tmp_path / "secret.toml")
    assert folder.listing().files == ()
    with pytest.raises(FolderError, match="there is no such file in the folder"):
        folder.open("link")
    with pytest.raises(FolderError, match=r"link\.toml is a link, which is not replaced; choose another name\."):
        folder.save("link", TRAM, replace=True)
    assert SECRET in (tmp_path / "secret.toml").read_text()


@NO_LINKS
def test_a_file_that_becomes_a_link_while_it_is_opened_is_not_followed(
    folder: ScenarioFolder, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (folder.path / "link.toml").symlink_to(tmp_path / "secret.toml")
    monkeypatch.setattr(folder, "_visible", lambda: {"link.toml": (0, 0, 0)})
    with pytest.raises(FolderError, match=r"link\.toml cannot be read"):
        folder.open("link")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes with names")
def test_a_pipe_is_not_listed_and_not_waited_for(folder: ScenarioFolder, monkeypatch: pytest.MonkeyPatch) -> None:
    os.mkfifo(folder.path / "pipe.toml")
    assert folder.listing().files == ()
    monkeypatch.setattr(folder, "_visible", lambda: {"pipe.toml": (0, 0, 0)})
    with pytest.raises(FolderError, match=r"pipe\.toml is not a file\."):
        folder.open("pipe")


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere such a name cannot be made")
def test_a_name_that_could_mislead_is_listed_with_the_reason(folder: ScenarioFolder) -> None:
    put(folder, "tram\u202etxt.toml")
    (Path(os.fsdecode(os.fsencode(folder.path) + b"/\xff.toml"))).write_text(TRAM)
    files = folder.listing().files
    assert {file.name for file in files} == {"tram\ufffdtxt", "\ufffd"}
    assert {file.refusal for file in files} == {"Its name has characters that cannot be shown."}


def test_a_file_is_replaced_only_on_request_and_as_a_whole(
    folder: ScenarioFolder, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = put(folder, "tram.toml", "before")
    with pytest.raises(FileExistsInFolderError, match=r"There is a file tram\.toml already\."):
        folder.save("tram", TRAM)
    assert path.read_text() == "before"

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as broken:
        broken.setattr(os, "fsync", full)
        with pytest.raises(FolderError, match=r"^tram\.toml cannot be saved: No space left on device\.$"):
            folder.save("tram", TRAM, replace=True)
    assert path.read_text() == "before"
    assert folder.save("tram", TRAM, replace=True) == "tram"
    assert [one.name for one in folder.path.iterdir()] == ["tram.toml"]
    assert folder.open("tram") == load_scenario("tram-950m")


def test_a_folder_that_is_a_file_is_one_sentence_without_its_path(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    folder = ScenarioFolder(tmp_path / "file")
    for act in (folder.listing, lambda: folder.save("x", TRAM)):
        with pytest.raises(FolderError) as refusal:
            act()
        assert str(tmp_path) not in str(refusal.value)


def test_sizes_are_bounded(folder: ScenarioFolder, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(scenario_folder, "LONGEST_TEXT", 200)
    put(folder, "long.toml", "#" * 201)
    assert folder.listing().files[0].refusal == "long.toml: larger than the limit of 0.0002 MB."
    with pytest.raises(FolderError, match=r"x\.toml: more than the limit of 0\.0002 MB\."):
        folder.save("x", "#" * 201)


@pytest.mark.parametrize("name", ["my-metro", "Örlikon 2", "線 1", "a" * LONGEST_NAME, "it's (a & b)", "म 3 मी"])
def test_a_name_stays_as_it_is(name: str) -> None:
    assert checked_name(name) == name


def test_spaces_around_a_name_and_its_suffix_are_removed_and_its_marks_composed() -> None:
    assert checked_name("  Zu\u0308rich ") == "Z\u00fcrich"
    assert checked_name("metro.toml") == "metro"


@pytest.mark.parametrize(
    ("name", "sentence"),
    [
        ("   ", "name is empty"),
        ("a/b", "must not have '/'"),
        ("a\\b", r"must not have '\\'"),
        ("a\nb", r"must not have '\n'"),
        (".hidden", "must not have '.'"),
        ("C:metro", "must not have ':'"),
        ("metro\u202elmot", r"must not have '\u202e'"),
        ("\ud800", r"must not have '\ud800'"),
        ("-set", "must begin with a letter or a digit"),
        ("Con", "Windows reserves it"),
        ("a" * 1000, "is too long: 1000 characters of at most 80"),
    ],
)
def test_a_name_that_a_file_system_could_refuse_is_one_sentence(name: str, sentence: str) -> None:
    with pytest.raises(FolderError) as error:
        checked_name(name)
    assert sentence in str(error.value)
    assert str(error.value).isprintable()


def test_the_default_folder_is_in_the_data_directory_of_the_platform(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(Path, "home", lambda: tmp_path)
    monkeypatch.delenv("XDG_DATA_HOME")
    monkeypatch.delenv("LOCALAPPDATA")
    for platform, base in (
        ("linux", ".local/share"),
        ("darwin", "Library/Application Support"),
        ("win32", "AppData/Local"),
    ):
        monkeypatch.setattr(sys, "platform", platform)
        assert default_folder() == tmp_path / base / "railjoule" / "scenarios"
    monkeypatch.setenv("LOCALAPPDATA", str(tmp_path / "local"))
    assert default_folder() == tmp_path / "local" / "railjoule" / "scenarios"
