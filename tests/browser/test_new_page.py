"""The page that the guide "Add a page" adds: its package and its name, opened by mouse."""

import re
from pathlib import Path

import pytest
from documents import blocks, text_of
from playwright.sync_api import BrowserContext, expect

from browser.findings import assert_nothing_grave
from browser.server import serving
from browser.user import PATIENCE_MS, User

NAME, ROOM = "Load", "load"
SERVE = """
import sys
import railjoule.dashboard.pages as rooms
rooms.__path__.append({folder!r})
from railjoule.dashboard import page_list
# the row that the guide adds
page_list.PAGES[{name!r}] = page_list.PageEntry("How much energy does the load need?", strategies="")
from railjoule.dashboard.command.cli import main
sys.exit(main(["serve", *sys.argv[1:]]))
"""


def number_in(text: str) -> float:
    """Return the number that a text with its unit begins with."""
    return float(re.match(r"[\d.]+", text).group())  # type: ignore[union-attr]


@pytest.mark.nightly
def test_the_page_of_the_guide_opens_and_follows_its_field(window: BrowserContext, tmp_path: Path) -> None:
    (tmp_path / ROOM).mkdir()
    for block in blocks(text_of("howto/add_page"), "python"):
        name = block.splitlines()[0].removeprefix(f"# dashboard/pages/{ROOM}/")
        (tmp_path / ROOM / name).write_text(block, encoding="utf-8")
    with (
        serving("-c", SERVE.format(folder=str(tmp_path), name=NAME)) as server,
        User.on(window, server.url) as user,
    ):
        bar = user.page.get_by_role("navigation", name="Pages")
        bar.get_by_role("button", name="Drive", exact=True).click()
        user.see_drive()
        energy = number_in(user.number("Energy from the supply"))
        bar.get_by_role("button", name=NAME, exact=True).click()
        expect(user.page.locator(".head h1:visible")).to_have_text("How much energy does the load need?")
        expect(user.figure_value("Full train")).to_be_visible(timeout=PATIENCE_MS)
        assert number_in(user.number("Full train")) > energy
        expect(user.page.get_by_role("textbox", name="Loads from empty to full")).to_have_value("5")
        assert_nothing_grave(user)
