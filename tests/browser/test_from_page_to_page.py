"""From every page to every other, as a user goes: what belongs there is there, in sight and further down."""

import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import BrowserContext, expect

from browser.findings import grave_findings
from browser.idle import LOOK_MS
from browser.layout import layout_faults
from browser.server import Server, serving
from browser.sight import Sight
from browser.user import User, open_page
from railjoule.core.scenario import preset_names
from railjoule.dashboard.page_list import PAGES

THERE_WITHIN_S = 45.0
FIRST_RUN_WITHIN_MS, COMPILED_WITHIN_MS = 30_000, 240_000
COMMAND = ("-m", "railjoule.dashboard", "serve")
WITHOUT_NUMBER = {"Explore", "Files", "Help"}
WITHOUT_CHART = {"Start", "Learn", "Papers", "Files", "Help"}
"""In the first view: on Learn they stand beneath the lessons that are played, where the way down finds them."""
NAMES = tuple(PAGES)
SUBURBAN, STATIONS = "ftorek-300s", "metro-10-stations"
"""One whose motor is known, and one with stations: together they have all charts."""
FORMS = ("Explore", "Files", "Help")
"""Pages that hold a form or a text: nothing that another page leaves behind can keep them from being drawn."""
LACKING: dict[str, set[str]] = {SUBURBAN: set(), STATIONS: {"Motor"}}
"""Pages that say what the scenario lacks."""
SCROLLED = """() => {
  const main = railjoule.deep(".main-content")[0], before = main.scrollTop;
  main.scrollBy({top: 0.8 * main.clientHeight, behavior: "instant"});
  return main.scrollTop > before;
}"""


def every_pair(names: tuple[str, ...]) -> Iterator[str]:
    """Yield a walk from the first name back to it that goes from each name to each other exactly once."""
    for k, name in enumerate(names):
        for other in names[k + 2 :]:
            yield from (other, name)
        yield from names[k + 1 : k + 2]
    yield from names[-2::-1]


def whole_walk() -> tuple[str, ...]:
    """Return a walk from Start: from every page with results to every other, then to each form and back to Drive."""
    with_results = tuple(name for name in NAMES if name not in FORMS)
    return (NAMES[0], *every_pair(with_results), *(name for form in FORMS for name in (form, "Drive")))


def arrive(user: User, name: str, preset: str = SUBURBAN) -> None:
    """Go to a page, and wait for its large number and for a chart."""
    open_page(user, name)
    lacking = name in LACKING[preset]
    deadline = time.monotonic() + THERE_WITHIN_S
    while True:
        sight = Sight(user.page, name)
        counted = lacking or name in WITHOUT_NUMBER or sight.number
        charted = lacking or name in WITHOUT_CHART or len(sight.undrawn) < len(sight.charts)
        if sight.heading and counted and charted:
            return
        assert time.monotonic() < deadline, (name, sight.heading, sight.number, sight.undrawn)
        user.page.wait_for_timeout(LOOK_MS)


def scroll_to_the_end(user: User, name: str) -> None:
    """Go down a page step by step; all charts in sight are drawn at each."""
    while True:
        deadline = time.monotonic() + THERE_WITHIN_S
        while undrawn := Sight(user.page, name).undrawn:
            assert time.monotonic() < deadline, (name, undrawn)
            user.page.wait_for_timeout(LOOK_MS)
        if not user.page.evaluate(SCROLLED):
            return


def faults_down_to_the_end(user: User, name: str) -> dict[str, Any]:
    """Look at a page with or without its sidebar, go down to its end, and return what is wrong with its layout."""
    has_sidebar = PAGES[name].has_sidebar
    expect(user.page.get_by_role("combobox", name="Scenario")).to_be_visible(visible=has_sidebar)
    expect(user.page.get_by_role("button", name="Close drawer")).to_be_visible(visible=has_sidebar)
    scroll_to_the_end(user, name)
    return layout_faults(user, name)


@pytest.mark.nightly
def test_from_every_page_to_every_other(server: Server, window: BrowserContext) -> None:
    faults: dict[str, Any] = {}
    with User.on(window, f"{server.url}?v=1&preset={SUBURBAN}") as user:
        known = set()
        for name in whole_walk()[1:]:
            arrive(user, name, SUBURBAN)
            if name not in known:
                known.add(name)
                faults |= faults_down_to_the_end(user, name)
    assert faults == {}


@pytest.mark.nightly
def test_dark_from_start_to_every_page(server: Server, window: BrowserContext) -> None:
    faults: dict[str, Any] = {}
    with User.on(window, f"{server.url}?v=1&preset={STATIONS}", dark=True) as user:
        for name in NAMES[1:]:
            arrive(user, name, STATIONS)
            faults |= faults_down_to_the_end(user, name)
            if grave := grave_findings(user.page):
                faults[f"{name}, axe"] = grave
    assert faults == {}


@pytest.mark.cold
def test_a_fresh_machine_shows_runs_while_the_solver_compiles(window: BrowserContext, tmp_path: Path) -> None:
    environment = {"NUMBA_CACHE_DIR": str(tmp_path), "PYTHONWARNINGS": "ignore"}
    with (
        serving(*COMMAND, environment=environment, warm=False) as server,
        User.on(window, server.url) as user,
    ):
        note, cards = user.page.get_by_text("The solver is being compiled"), user.page.locator(".card")
        expect(note).to_be_visible()
        assert cards.count() == len(preset_names("scenarios"))
        expect(user.page.locator(".hero .key b").first).to_be_visible(timeout=FIRST_RUN_WITHIN_MS)
        # a page that needs compiled code says so, and fills itself
        open_page(user, "Compare")
        expect(note).to_be_visible()
        expect(note).to_have_count(0, timeout=COMPILED_WITHIN_MS)
        arrive(user, "Compare")
        arrive(user, "Start")
        expect(cards.get_by_text("kWh").last).to_be_visible(timeout=COMPILED_WITHIN_MS)
