"""A user's own files, by mouse: saved, opened, renamed, duplicated, deleted and taken back."""

import re
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, BrowserContext, Locator, expect

from browser.server import Server, serving
from browser.user import User
from railjoule.core.workspace import Workspace

COMMAND = ("-m", "railjoule.dashboard", "serve")
CANARY = "<img src=x onerror='window.pwned=true'>"
VEHICLE = 'name = "My metro"\npreset = "metro-81-7036"\ntare_kg = 190_000\n'
RUN = "time_s,speed_kmh\n0,0\n1,3.6\n2,7.2\n"


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Workspace:
    return Workspace(tmp_path_factory.mktemp("user") / "own")


@pytest.fixture(scope="module")
def own_server(workspace: Workspace) -> Iterator[Server]:
    with serving(*COMMAND, "--workspace", str(workspace.folder)) as running:
        yield running


@pytest.fixture(scope="module")
def user(own_server: Server, window: BrowserContext) -> Iterator[User]:
    """One user for all tests of this file, who begins on Start."""
    with User.on(window, own_server.url, on_drive=False) as someone:
        expect(someone.page.get_by_text("Nothing saved yet.")).to_be_visible()
        yield someone


def button(user: User, name: str) -> Locator:
    return user.page.get_by_role("button", name=name, exact=True)


def row(user: User, name: str) -> Locator:
    return user.page.get_by_role("table", name="My files").get_by_role("row").filter(has=button(user, f"Rename {name}"))


def names(user: User) -> list[str]:
    return [text.strip() for text in user.page.locator(".own-files tbody .name").all_inner_texts()]


def save(user: User, kind: str, name: str) -> None:
    """Save something under a name."""
    if not user.page.get_by_label("What", exact=True).is_visible():
        button(user, "Save to My files").click()
    user.page.get_by_label("What", exact=True).select_option(label=kind)
    user.page.get_by_label("Name", exact=True).fill(name)
    button(user, "Save").click()


def told(user: User, sentence: str) -> None:
    expect(user.page.get_by_role("status").get_by_text(sentence, exact=True)).to_be_visible()


def test_a_scenario_is_saved_and_opened_again(user: User, workspace: Workspace) -> None:
    save(user, "Scenario", "my run")
    told(user, "Saved as scenario my run.")
    expect(row(user, "my run")).to_contain_text("Scenario")
    expect(user.page.get_by_role("combobox", name="Scenario")).to_contain_text("my run (my files)")
    user.turn_to("Drive")
    user.choose("Metro, profile II")
    user.turn_to("Start")
    button(user, "Open my run").click()
    expect(user.scenario("Metro, profile II + I")).to_be_visible()
    expect(user.page.get_by_role("combobox", name="Scenario")).to_contain_text("my run (my files)")
    assert workspace.scenario("my run").travel_time_s == 170


def test_a_change_is_saved_under_the_same_name(user: User, workspace: Workspace) -> None:
    user.type("Travel time, s", "180")
    expect(user.page.get_by_text("1 field changed")).to_be_visible()
    save(user, "Scenario", "my run")
    told(user, "Saved as scenario my run.")
    expect(user.page.get_by_text("Unchanged")).to_be_visible()
    assert workspace.scenario("my run").travel_time_s == 180
    # what the page shows stays: it is what was saved
    assert user.page.get_by_role("textbox", name="Travel time, s, as a number").input_value() == "180.0"


def test_a_change_by_hand_is_seen_and_not_written_over_unasked(user: User, workspace: Workspace) -> None:
    path = workspace.folder / "scenarios/my run.toml"
    path.write_text(path.read_text().replace("180", "200"))
    user.turn_to("Start")
    expect(row(user, "my run")).to_contain_text("changed in its folder since it was opened")
    save(user, "Scenario", "my run")
    refused = user.page.get_by_role("alert").filter(has_text="my run was changed in its folder since it was opened.")
    expect(refused).to_be_visible()
    assert workspace.scenario("my run").travel_time_s == 200
    user.rest(1000)
    button(user, "Replace it").click()
    told(user, "Saved as scenario my run.")
    assert workspace.scenario("my run").travel_time_s == 180
    expect(row(user, "my run")).not_to_contain_text("changed in its folder")
    # what was replaced is not lost
    kept = [path.read_text() for path in (workspace.folder / ".deleted").iterdir()]
    assert any("travel_time_s = 200" in text for text in kept)


@pytest.mark.parametrize(
    ("name", "sentence"),
    [
        ("../canary", "name = '../canary' must not have '.'"),
        ("tram-950m", "name = 'tram-950m' is that of a shipped scenario; choose another one."),
        ("CON", "Windows reserves it for a device."),
        (" ", "name is empty"),
        ("x" * 150, "is too long: 150 characters of at most 80"),
    ],
)
def test_a_name_that_cannot_be_is_told_beneath_its_field(
    user: User, workspace: Workspace, name: str, sentence: str
) -> None:
    before = workspace.listing()
    save(user, "Scenario", name)
    expect(user.page.get_by_role("alert").filter(has_text=sentence)).to_be_visible()
    expect(button(user, "Replace it")).to_be_hidden()
    assert workspace.listing() == before


def test_files_are_renamed_duplicated_deleted_and_taken_back(user: User, workspace: Workspace) -> None:
    button(user, "Rename my run").click()
    field = user.page.get_by_role("textbox", name="New name of my run")
    expect(field).to_be_focused()
    field.fill("a/b")
    button(user, "Save the new name of my run").click()
    expect(user.page.locator(".own-files").get_by_role("alert")).to_contain_text("must not have '/'")
    expect(field).to_have_value("a/b")
    field.fill("evening")
    field.press("Enter")
    button(user, "Duplicate evening").click()
    expect(row(user, "evening copy")).to_be_visible()
    button(user, "Delete evening").click()
    expect(row(user, "evening")).to_have_count(0)
    undo = button(user, "Undo deleting evening")
    expect(undo).to_be_focused()
    undo.press("Enter")
    expect(row(user, "evening")).to_be_visible()
    assert names(user) == ["evening", "evening copy"]
    assert workspace.names("scenarios") == ("evening", "evening copy")


def test_a_vehicle_is_saved_and_chosen_in_the_editor(user: User, workspace: Workspace) -> None:
    workspace.save("vehicles", "my metro", VEHICLE)
    save(user, "Line", "my line")
    told(user, "Saved as line my line.")
    expect(row(user, "my metro")).to_be_visible()
    user.turn_to("Drive")
    user.choose("Metro, profile II")
    button(user, "Edit scenario").click()
    user.page.get_by_role("button", name=re.compile("Presets")).click()
    # a field that was changed says so in its label
    vehicle, line = (user.page.get_by_label(re.compile(f"^{name}( changed)?$")) for name in ("Vehicle", "Line"))
    vehicle.select_option(label="my metro (my files)")
    expect(vehicle).to_have_value("")
    expect(user.page.get_by_text("Vehicle \u00b7 My metro")).to_be_visible()
    line.select_option(label="my line (my files)")
    expect(user.page.get_by_text("2.30 km, \u221230 to +17")).to_be_visible()
    button(user, "Close the editor").click()
    # the address has them whole
    workspace.delete(workspace.find("vehicles", "my metro"))  # type: ignore[arg-type]
    user.page.reload()
    user.page.locator("html.rj-started").wait_for()
    expect(user.page.get_by_text("Vehicle \u00b7 My metro")).to_be_visible()
    user.see_no_alert()


def test_files_that_are_brought(user: User, workspace: Workspace, tmp_path: Path) -> None:
    scenario = (
        f'title = "{CANARY}"\n[vehicle]\npreset = "metro-81-7036"\n[line]\npreset = "liashenko-ii"\n[timetable]\n'
    )
    brought = {
        "monday.csv": (RUN, ""),
        "canary.toml": (f"{scenario}travel_time_s = 100\n", ""),
        "broken.toml": (f"{scenario}travel_time_s = -1\n", "broken.toml: timetable.travel_time_s = -1 must be"),
        "table.csv": ("hello\n", "neither a line's sections"),
        "monday 2.toml": ("x =", "not a valid TOML file"),
    }
    user.turn_to("Start")
    for name, (text, sentence) in brought.items():
        (tmp_path / name).write_text(text)
        with user.page.expect_file_chooser() as chosen:
            button(user, "Add a file to My files").click()
        chosen.value.set_files(tmp_path / name)
        alert = user.page.locator(".own-files").get_by_role("alert")
        expect(alert).to_contain_text(sentence) if sentence else expect(row(user, name.split(".")[0])).to_be_visible()
    assert workspace.text("runs", "monday") == RUN
    assert "broken" not in names(user)
    button(user, "Open canary").click()
    expect(user.scenario(CANARY)).to_be_visible()
    assert user.page.evaluate("window.pwned") is None
    save(user, "Run that is shown", "tuesday")
    told(user, "Saved as run tuesday.")
    assert workspace.text("runs", "tuesday").startswith("position_m,")


def test_a_run_is_opened_on_measured_runs(user: User) -> None:
    user.turn_to("Start")
    button(user, "Open on Measured runs: tuesday").click()
    expect(user.question("Measured runs")).to_be_visible()
    expect(user.page.get_by_text("tuesday.csv, run 1 of 1").first).to_be_visible()
    # the run that this program solved: what was measured is what its model needs
    expect(user.figure_value("Measured")).to_have_text(re.compile(r"\d"))
    user.page.get_by_role("button", name="Remove this run").click()
    user.page.get_by_role("combobox", name="From My files").click()
    user.page.get_by_role("menuitem", name="tuesday").click()
    expect(user.page.get_by_text("tuesday.csv, run 1 of 1").first).to_be_visible()
    user.turn_to("Start")


def test_another_page_sees_what_was_saved(
    user: User, own_server: Server, chromium: Browser, workspace: Workspace
) -> None:
    with User.at(chromium, own_server.url, width=390, height=844, dark=True, on_drive=False) as other:
        expect(row(other, "evening")).to_be_visible()
        workspace.save("runs", "by hand", RUN)
        expect(row(other, "by hand")).to_be_visible()
        assert other.page.evaluate("document.documentElement.scrollWidth") <= 390


def test_a_folder_that_cannot_be_written_is_told_and_nothing_is_lost(user: User, workspace: Workspace) -> None:
    folder, away = workspace.folder / "vehicles", workspace.folder / "away"
    if folder.exists():
        folder.rename(away)
    folder.symlink_to("/tmp", target_is_directory=True)
    save(user, "Vehicle with powertrain", "another")
    alert = user.page.get_by_role("alert").filter(has_text="vehicles is a link, which is not followed.")
    expect(alert.first).to_be_visible()
    assert not (Path("/tmp") / "another.toml").exists()
    folder.unlink()
    away.rename(folder)
    button(user, "Save").click()
    told(user, "Saved as vehicle another.")


def test_a_server_without_a_workspace_shows_none(chromium: Browser) -> None:
    with serving(*COMMAND, "--no-workspace") as bare, User.at(chromium, bare.url, on_drive=False) as user:
        expect(user.page.get_by_role("heading", name="First steps")).to_be_visible()
        time.sleep(1)
        expect(user.page.get_by_text("My files").locator("visible=true")).to_have_count(0)
