"""`python -m tests.browser.pictures` makes README's pictures from the running dashboard, in light and dark colours."""

import sys
from pathlib import Path

from playwright.sync_api import BrowserContext, sync_playwright

# as pytest finds them
sys.path.insert(0, str(Path(__file__).parents[1]))

from browser.chromium import ARGUMENTS, browser_path
from browser.server import Server, serving
from browser.user import User

FOLDER = Path(__file__).parents[2] / "assets" / "pictures"
PAGES = ("Drive", "Motor")
SIZE = (1280, 860)


def picture_path(name: str, dark: bool) -> Path:
    """Return the file of a page's picture."""
    return FOLDER / f"{name.lower().replace(' ', '-')}-{'dark' if dark else 'light'}.png"


def take_picture(context: BrowserContext, server: Server, name: str, dark: bool) -> bytes:
    """Open a page in a new tab, and return its picture as PNG."""
    with User.on(context, server.drive_url, SIZE, dark) as user:
        if name == "Motor":
            user.choose("Suburban, flat 5 km")
        user.turn_to(name)
        return user.page.screenshot()


def main() -> None:
    """Write one picture of each page and colour."""
    FOLDER.mkdir(exist_ok=True)
    with serving("-m", "railjoule.dashboard", "serve") as server, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=browser_path(), args=ARGUMENTS)
        for dark in (False, True):
            for name in PAGES:
                with browser.new_context() as context:
                    picture_path(name, dark).write_bytes(take_picture(context, server, name, dark))
        browser.close()


if __name__ == "__main__":
    main()
