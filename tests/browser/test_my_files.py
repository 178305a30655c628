"""The folder of scenario files, by mouse: listed, opened, saved, replaced on request; a download without a folder."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Locator, expect

from browser.findings import assert_nothing_grave
from browser.user import User
from railjoule.core import load_scenario, save_scenario

LINK = "?v=1&page=Start"
CANARY = "<img src=x onerror='window.pwned=true'>"


@pytest.fixture(scope="module")
def user(user: User, folder: Path) -> Iterator[User]:
    """One user for all tests of this file, who begins on Start."""
    expect(user.page.get_by_text("Nothing saved yet.")).to_be_visible()
    yield user
    for file in folder.iterdir():
        file.unlink()


def button(user: User, name: str) -> Locator:
    return user.page.get_by_role("button", name=name, exact=True)


def row(user: User, name: str) -> Locator:
    return user.page.get_by_role("table", name="My files").get_by_role("row").filter(has_text=name)


def save(user: User, name: str) -> None:
    """Save the scenario under a name."""
    # Files has a field of this name, too
    field = user.page.get_by_label("Name", exact=True).filter(visible=True)
    if not field.count():
        button(user, "Save scenario").click()
    field.fill(name)
    button(user, "Save").click()


def told(user: User, sentence: str) -> None:
    expect(user.page.get_by_role("status").get_by_text(sentence, exact=True)).to_be_visible()


def test_a_scenario_is_saved_listed_and_opened_again(user: User, folder: Path) -> None:
    user.turn_to("Drive")
    save(user, "my run")
    told(user, "Saved as my run.toml.")
    user.choose("Metro, profile II")
    user.turn_to("Start")
    # a copy has its own name as its title
    expect(row(user, "my run").get_by_role("cell", name="my run", exact=True)).to_be_visible()
    button(user, "Open my run").click()
    expect(user.question("Drive")).to_be_visible()
    expect(user.scenario("my run")).to_be_visible()
    assert load_scenario(folder / "my run.toml").travel_time_s == 170
    # the folder's name is all that the page shows of its place
    assert str(folder.parent) not in user.page.content()


def test_a_file_is_replaced_only_when_that_is_asked_for(user: User, folder: Path) -> None:
    user.type("Travel time, s", "180")
    expect(user.page.get_by_text("1 field changed")).to_be_visible()
    save(user, "my run")
    expect(user.page.get_by_role("alert").filter(has_text="There is a file my run.toml already.")).to_be_visible()
    button(user, "Replace it").click()
    told(user, "Saved as my run.toml.")
    expect(user.page.get_by_text("Unchanged")).to_be_visible()
    assert load_scenario(folder / "my run.toml").travel_time_s == 180
    button(user, "Close").click()


def test_files_put_into_the_folder_appear_and_a_broken_one_says_why(user: User, folder: Path) -> None:
    user.turn_to("Start")
    (folder / "broken.toml").write_text("x =", encoding="utf-8")
    save_scenario(load_scenario("tram-950m").replace(title=CANARY), folder / "canary.toml")
    expect(row(user, "broken")).to_contain_text("Cannot be opened: not a valid TOML file")
    expect(button(user, "Open broken")).to_have_count(0)
    expect(row(user, "canary")).to_contain_text(CANARY)
    assert_nothing_grave(user)
    button(user, "Open canary").click()
    expect(user.scenario(CANARY)).to_be_visible()
    assert user.page.evaluate("window.pwned") is None


def test_the_list_fits_a_narrow_window(user: User) -> None:
    user.turn_to("Start")
    with user.resized(390, 844):
        user.wait_until(lambda: user.page.evaluate("document.documentElement.scrollWidth") <= 390)
        box = row(user, "broken").bounding_box()
        assert box is not None
        assert box["x"] + box["width"] <= 390
