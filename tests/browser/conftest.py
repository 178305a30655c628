"""A served dashboard, a real browser, and pages that fail on any error or foreign request."""

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, BrowserContext, expect, sync_playwright

from browser.chromium import ARGUMENTS, browser_path
from browser.server import Server, serving
from browser.user import DRIVE, User

expect.set_options(timeout=60_000)


QUIET = re.compile(
    r"[-0-9]+ [:0-9]+ \w+ session=[0-9a-f]{8} page=[-\w]+ duration_s=\d+\.\d{3}( cells=\d+)? (ok|refused)"
    r"|(?:[-0-9]+ [:0-9]+ )?Launching server at http://[.\d]+:\d+"
    # Bokeh sends the browser a model twice when Explore opens after other pages; nothing is lost
    r"|BokehUserWarning: reference already known '\w+'"
    r"|Scenario files: .*"
    # tests connect from other origins, and without a token
    r"|.* (403 GET /ws |Refusing websocket connection from Origin ).*"
)
"""Log of a server without failures."""
MESSAGE_OF_CLOSED_PAGE = re.compile(
    r"^\S+ \S+ (?:error handling message|Uncaught exception GET /).*\n(?:(?!\d{4}-\d\d-\d\d ).*\n)*?"
    r".*assert self\._session is not None\n.*\nAssertionError\n",
    re.MULTILINE,
)
"""Bokeh's report of a message that arrives as its page is closed; nothing is lost.

A ping that finds the websocket closed lets Bokeh forget the session (https://github.com/bokeh/bokeh/pull/13655) before
the end of the connection is handled, and that end, or a message that waited, asks for the session.
"""


@pytest.fixture(scope="package")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of scenario files of the server, empty but while the tests of `test_my_files` run."""
    made = tmp_path_factory.mktemp("user") / "Our trams"
    made.mkdir()
    return made


@pytest.fixture(scope="package")
def server(tmp_path_factory: pytest.TempPathFactory, folder: Path) -> Iterator[Server]:
    """The server of all tests that neither configure nor end it; its log is quiet to the end."""
    log = tmp_path_factory.mktemp("server") / "log"
    with serving("-m", "railjoule.dashboard", "serve", "--folder", str(folder), log=log) as running:
        yield running
        text = MESSAGE_OF_CLOSED_PAGE.sub("", log.read_text())
        assert [line for line in text.splitlines() if not QUIET.fullmatch(line)] == []


@pytest.fixture(scope="package")
def chromium() -> Iterator[Browser]:
    path = browser_path()
    if not path or not Path(path).exists():
        pytest.fail("There is no Chromium: install it, or name one in RAILJOULE_BROWSER; the page cannot be tested.")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=ARGUMENTS)
        yield browser
        browser.close()


@pytest.fixture(scope="package")
def window(chromium: Browser, server: Server) -> Iterator[BrowserContext]:
    """A desktop window with light colours; what its first page has loaded and compiled serves all that follow."""
    context = chromium.new_context(viewport={"width": 1280, "height": 900}, color_scheme="light")
    # their process lives as long as one of them is open
    context.new_page().goto(f"{server.url}health")
    yield context
    context.close()


@pytest.fixture(scope="package")
def phone(chromium: Browser) -> Iterator[BrowserContext]:
    """A narrow window that is touched."""
    context = chromium.new_context(viewport={"width": 390, "height": 844}, has_touch=True, is_mobile=True)
    # as above
    context.new_page()
    yield context
    context.close()


@pytest.fixture(scope="package")
def opened(server: Server, window: BrowserContext) -> Iterator[User]:
    """The window of all tests that need none of their own."""
    with User.on(window, server.url + DRIVE) as someone:
        yield someone


@pytest.fixture(scope="module")
def user(request: pytest.FixtureRequest, opened: User) -> Iterator[User]:
    """One user for all tests of a file, who begins with the file's `LINK`, or on Drive."""
    failed = request.session.testsfailed
    opened.go(getattr(request.module, "LINK", DRIVE))
    yield opened
    if request.session.testsfailed > failed:
        # nothing that a test has left open stands before the next file
        opened.load()
    opened.check()
