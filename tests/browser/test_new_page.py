"""A page that a newcomer adds as `.github/CONTRIBUTING.md` says: its room and its name, opened by mouse."""

import re
from pathlib import Path

import pytest
from playwright.sync_api import Browser, expect

from browser.findings import assert_nothing_grave
from browser.server import serving
from browser.user import PATIENCE_MS, User

GUIDE = Path(__file__).parents[2] / ".github" / "CONTRIBUTING.md"
NAME, ROOM = "Per km", "per_km"
SERVE = """
import sys
import railjoule.dashboard.pages as rooms
rooms.__path__.append({folder!r})
from railjoule.dashboard import page_list
# the line that a newcomer adds to NAMES
page_list.PAGES[{name!r}] = page_list.entry_of({name!r})
from railjoule.dashboard.command.cli import main
sys.exit(main(["serve", *sys.argv[1:]]))
"""


def example() -> dict[str, str]:
    """Return the files of the example by name."""
    block = rf"^`dashboard/pages/{ROOM}/(\w+\.py)`:\n\n```python\n(.*?)^```$"
    return dict(re.findall(block, GUIDE.read_text(), re.MULTILINE | re.DOTALL))


def number_in(text: str) -> float:
    """Return the number that a text with its unit begins with."""
    return float(re.match(r"[\d.]+", text).group())  # type: ignore[union-attr]


@pytest.mark.nightly
def test_a_page_is_a_room_and_a_name(chromium: Browser, tmp_path: Path) -> None:
    files = example()
    assert sorted(files) == ["__init__.py", "view.py"]
    assert f'add `"{NAME}"` to `NAMES`' in GUIDE.read_text()
    (tmp_path / ROOM).mkdir()
    for name, text in files.items():
        (tmp_path / ROOM / name).write_text(text)
    with (
        serving("-c", SERVE.format(folder=str(tmp_path), name=NAME)) as server,
        User.at(chromium, server.url, on_drive=False) as user,
    ):
        bar = user.page.get_by_role("navigation", name="Pages")
        bar.get_by_role("button", name="Drive", exact=True).click()
        user.see_drive()
        energy = number_in(user.number("Energy from the supply"))
        bar.get_by_role("button", name=NAME, exact=True).click()
        expect(user.page.locator(".head h1:visible")).to_have_text("How much energy does each kilometre take?")
        # the first shipped scenario is 3 km long
        expect(user.figure_value("Energy over a kilometre")).to_be_visible(timeout=PATIENCE_MS)
        told = number_in(user.number("Energy over a kilometre"))
        assert 0.1 * energy < told < energy
        assert_nothing_grave(user)
