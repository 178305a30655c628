"""What a user does with the page, and what she sees."""

import contextlib
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from urllib.parse import urljoin, urlsplit
from zipfile import ZipFile

from playwright.sync_api import BrowserContext, Locator, Page, expect

from browser import idle
from browser.idle import LOOK_MS
from browser.sight import Sight
from railjoule.dashboard.page_list import PAGES

PATIENCE_MS = 90_000
GROUNDS = {"light": "rgb(244, 246, 248)", "dark": "rgb(14, 18, 23)"}
"""Of the page, as in look.md."""
GROUND = "colour => getComputedStyle(document.body).backgroundColor === colour"
HARMLESS = ("Upload error",)
"""The browser refuses a file too large to send."""
DRIVE = "?v=1&page=Drive"
GO = """(link) => new Promise((done) => {
  addEventListener("hashchange", () => done(), {once: true});
  location.hash = link;
})"""
"""Opens a link, and ends once the page has told its server."""
MADE = "names => names.filter((name) => Bokeh.documents[0].get_model_by_name(`page ${name}`)).length"
MOST_MADE = 3
"""A window that has more pages of the bar is opened anew: all that looks for an element goes through all of them."""


class User:
    """Someone in front of one open page; errors and foreign requests are kept for the end."""

    def __init__(self, page: Page, url: str) -> None:
        self.page, self.url = page, url
        self.errors: list[str] = []
        self.foreign: list[str] = []
        page.set_default_timeout(PATIENCE_MS)
        idle.watch(page)
        page.on("console", lambda message: message.type == "error" and self.errors.append(message.text))
        # with the place: a message of a packed library tells nothing
        page.on("pageerror", lambda error: self.errors.append(f"{error}\n{error.stack}"))
        page.on("request", lambda request: self._note(request.url))

    @classmethod
    @contextlib.contextmanager
    def on(
        cls,
        context: BrowserContext,
        url: str,
        size: tuple[int, int] | None = None,
        dark: bool = False,
    ) -> Iterator["User"]:
        """Open the page, and check at the end that nothing went wrong in the browser.

        `size` is that of the window [px], where it is not that of the context.
        """
        page = context.new_page()
        if size is not None:
            page.set_viewport_size({"width": size[0], "height": size[1]})
        if dark:
            page.emulate_media(color_scheme="dark")
        user = cls(page, url)
        try:
            user.load()
            if "page=Drive" in url:
                user.see_drive()
            yield user
            user.check()
        finally:
            user.page.close()

    def check(self) -> None:
        """Check that nothing has gone wrong in the browser since the last time."""
        grave = [error for error in self.errors if not error.startswith(HARMLESS)]
        foreign = [*self.foreign]
        self.errors.clear()
        self.foreign.clear()
        assert (grave, foreign) == ([], [])

    def _note(self, address: str) -> None:
        parts = urlsplit(address)
        if parts.scheme in {"http", "https", "ws", "wss"} and parts.netloc != urlsplit(self.url).netloc:
            self.foreign.append(address)

    def load(self) -> None:
        """Open the page and wait until it has loaded."""
        self.page.goto(self.url)
        self.page.locator("html.rj-started").wait_for(timeout=PATIENCE_MS)

    def see_drive(self) -> None:
        """Wait for the first numbers and figures of Drive."""
        expect(self.figure_value("Energy from the supply")).not_to_be_empty(timeout=PATIENCE_MS)
        expect(self.page.locator(".rj-chart-speed:visible canvas").first).to_be_visible(timeout=PATIENCE_MS)
        self.settled()

    def slow_down(self, times: float) -> None:
        """Let the browser compute this many times slower, as on an old computer."""
        self.page.context.new_cdp_session(self.page).send("Emulation.setCPUThrottlingRate", {"rate": times})

    def settled(self) -> None:
        """Wait until the server has answered, nothing is computed, and the charts in sight are drawn."""
        idle.wait_until_idle(self.page, PATIENCE_MS)

    def figure_value(self, label: str) -> Locator:
        """Return the number under a label."""
        return self.page.locator(".figure:visible", has_text=label).locator(".value").first

    def number(self, label: str) -> str:
        """Return the text of the number under a label."""
        return self.figure_value(label).inner_text()

    def slider(self, name: str) -> Locator:
        """Return a slider by its label."""
        return self.page.get_by_role("slider", name=name, exact=True)

    def push(self, name: str, steps: int) -> None:
        """Move a slider with the arrow keys."""
        self.slider(name).focus()
        for _ in range(abs(steps)):
            self.page.keyboard.press("ArrowRight" if steps > 0 else "ArrowLeft")
        self.settled()

    def reach(self, target: Locator, most_steps: int = 80) -> None:
        """Move the focus to an element with the Tab key."""
        for _ in range(most_steps):
            if target.evaluate("one => one.getRootNode().activeElement === one"):
                return
            self.page.keyboard.press("Tab")
        raise AssertionError(f"the Tab key does not reach {target}")

    def type(self, name: str, text: str) -> None:
        """Type into the text field of a number."""
        field = self.page.get_by_role("textbox", name=f"{name}, as a number", exact=True)
        field.fill(text)
        field.press("Enter")
        self.settled()

    def see_number(self, field: Locator, number: float, within: float) -> None:
        """Wait until a field shows a number, as it does some time after the drag that sets it."""

        def shown() -> float:
            return float(field.input_value().replace("\u202f", "").replace("\u2212", "-") or "nan")

        self.wait_until(lambda: abs(shown() - number) <= within)

    def prefer(self, colours: str) -> None:
        """Let the system ask for light or for dark colours, and wait until the page has them."""
        self.page.emulate_media(color_scheme=colours)
        self.page.wait_for_function(GROUND, arg=GROUNDS[colours])
        self.page.wait_for_function(
            "dark => Bokeh.documents[0].roots()[0].data.dark_theme === dark", arg=colours == "dark"
        )

    def picture(self, chart: str) -> bytes:
        """Return the picture of a chart."""
        return self.page.locator(f".rj-chart-{chart}:visible").screenshot()

    def choose(self, title: str) -> None:
        """Choose a shipped scenario."""
        self.page.get_by_role("combobox", name="Scenario").select_option(label=title)
        expect(self.scenario(title)).to_be_visible()
        self.settled()

    def question(self, page: str) -> Locator:
        """Return the question of a page while it is in sight; its sketch has the same before."""
        return self.page.locator(".head h1:visible, .hero h1:visible").get_by_text(PAGES[page].question, exact=True)

    def scenario(self, title: str) -> Locator:
        """Return the name of the scenario beneath the heading of the page in sight."""
        return self.page.locator(".head:visible .scenario").get_by_text(title, exact=True)

    def go(self, link: str = DRIVE) -> None:
        """Show what a new window shows at a link: mostly in this one, without the seconds that opening one takes."""
        self.settled()
        self.page.mouse.move(5, 5)
        self.url = urljoin(self.url, link)
        if self.page.evaluate(MADE, list(PAGES)) > MOST_MADE:
            self.load()
        else:
            self.page.evaluate(GO, link.replace("?", "#"))
        if link.startswith(DRIVE):
            self.see_drive()
        self.settled()

    @contextlib.contextmanager
    def resized(self, width: int, height: int) -> Iterator[None]:
        """Look at the page in a window of another size [px]."""
        size = self.page.viewport_size
        assert size is not None
        self.page.set_viewport_size({"width": width, "height": height})
        try:
            yield
        finally:
            self.page.set_viewport_size(size)
            self.settled()

    def turn_to(self, page: str) -> None:
        """Turn to another page, and wait until all charts in sight are drawn and nothing moves into place any more."""
        open_page(self, page)
        self.settled()
        self.wait_until(lambda: not Sight(self.page, page).undrawn)

    def open_file(self, path: Path) -> None:
        """Open a scenario file."""
        with self.page.expect_file_chooser() as chooser:
            self.page.get_by_role("button", name="Open file").click()
        chooser.value.set_files(path)
        self.settled()

    def press(self, chart: str, tool: str) -> None:
        """Press a tool of a chart with the mouse, which makes its toolbar visible."""
        place = self.page.locator(f".rj-chart-{chart}:visible")
        place.hover()
        place.get_by_title(tool, exact=True).click()

    def save_numbers(self) -> tuple[str, dict[str, str]]:
        """Save the numbers of the page in sight; return the name of the file, and the texts in it by their names."""
        button = self.page.get_by_role("button", name="Save numbers of figures and tables as CSV")
        with self.page.expect_download() as download:
            button.locator("visible=true").click()
        with ZipFile(download.value.path()) as packed:
            texts = {name: packed.read(name).decode() for name in packed.namelist()}
        return download.value.suggested_filename, texts

    def see_change(self, chart: str, before: bytes) -> None:
        """Wait until a chart looks otherwise than before."""
        self.wait_until(lambda: self.picture(chart) != before)

    def wait_until(self, holds: Callable[[], bool]) -> None:
        """Wait until something holds, but not longer than for anything else."""
        deadline = time.monotonic() + PATIENCE_MS / 1000
        while not holds():
            assert time.monotonic() < deadline, f"it does not hold within {PATIENCE_MS / 1000} s"
            self.page.wait_for_timeout(LOOK_MS)

    def alert(self) -> str:
        """Wait for the only message in sight; return it."""
        expect(self._alerts).to_have_count(1)
        return self._alerts.inner_text()

    def see_no_alert(self) -> None:
        """Wait until no message is in sight."""
        expect(self._alerts).to_have_count(0)

    @property
    def _alerts(self) -> Locator:
        return self.page.get_by_role("alert").locator("visible=true")


def open_page(user: User, name: str) -> None:
    """Turn to a page by mouse, through the list of its group or the menu of narrow screens where it stands there."""
    bar = user.page.get_by_role("navigation", name="Pages")
    menu = bar.get_by_role("button", name="Pages, ")
    group = PAGES[name].group
    if menu.is_visible() and name != "Start":
        menu.click()
    elif group:
        bar.get_by_role("button", name=group, exact=True).first.click()
    # a group may be called as one of its pages
    bar.locator(f"[data-page='{name}']").locator("visible=true").first.click()
    expect(user.question(name)).to_be_visible()
