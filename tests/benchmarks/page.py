"""How long the page takes from a slider's move to its charts drawn anew, and what a move costs the server.

`python -m tests.benchmarks --pages` drives the served page in Chromium with software rendering. What is timed is one
arrow key on the travel time: from the key, as the browser gets it, to the first canvas or 3D scene drawn after it, and
to the last one before half a second of rest.
"""

import statistics
from collections.abc import Iterator

from playwright.sync_api import Page, sync_playwright

from railjoule.dashboard.page_list import PAGES
from tests.benchmarks.measurement import Measurement
from tests.browser.chromium import ARGUMENTS, browser_path
from tests.browser.server import Server, serving
from tests.browser.user import User

MOVES, SETTLE_MS, QUIET_MS = 40, 2500, 700
SLIDER = "Travel time, s"
WITHOUT = ("Start", "Learn", "Papers")
"""Pages on which the travel time changes nothing."""
OPENED = {"Motor": "Open Suburban, flat 5 km", "Line": "Open Metro, ten stations"}
"""Pages that ask for another scenario than the first one, and the button that brings it."""
WATCH = """
window.rjKey = 0; window.rjDrawn = [];
addEventListener('keydown', () => { window.rjKey = performance.now(); window.rjDrawn = []; }, true);
const watch = (kind, name) => {
  const drawn = kind.prototype[name];
  kind.prototype[name] = function (...rest) {
    requestAnimationFrame(() => window.rjDrawn.push(performance.now()));
    return drawn.apply(this, rest);
  };
};
watch(CanvasRenderingContext2D, 'clearRect');
watch(WebGLRenderingContext, 'drawElements');
watch(WebGL2RenderingContext, 'drawElements');
"""
LATENCY = "() => [window.rjDrawn[0] - window.rjKey, window.rjDrawn.at(-1) - window.rjKey]"


def pages() -> Iterator[Measurement]:
    """Move the slider on each page; yields medians and 95th percentiles [ms]."""
    with serving("-m", "railjoule.dashboard", "serve") as server, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=browser_path(), args=ARGUMENTS)
        try:
            for name in (page for page in PAGES if page not in WITHOUT):
                with browser.new_context() as context, User.on(context, server.drive_url, size=(1280, 900)) as user:
                    user.page.add_init_script(WATCH)
                    user.load()
                    if name != "Drive":
                        user.turn_to(name)
                    if name in OPENED:
                        user.page.get_by_role("button", name=OPENED[name]).click()
                    user.rest(SETTLE_MS)
                    yield from _measured(name, user.page, server, user)
        finally:
            browser.close()


def _measured(name: str, page: Page, server: Server, user: User) -> Iterator[Measurement]:
    first, last = [], []
    user.slider(SLIDER).focus()
    before = server.cpu_s()
    for move in range(MOVES):
        page.keyboard.press("ArrowRight" if move % 10 < 5 else "ArrowLeft")
        page.wait_for_function("window.rjDrawn.length > 0")
        page.wait_for_timeout(QUIET_MS)
        begun, ended = page.evaluate(LATENCY)
        first.append(begun)
        last.append(ended)
    cpu_ms = 1000 * (server.cpu_s() - before) / MOVES
    worst = sorted(first)[int(0.95 * MOVES)]
    yield Measurement(f"{name}: key to first repaint, median", statistics.median(first), "ms", at_most=300)
    yield Measurement(f"{name}: key to first repaint, 95th percentile", worst, "ms", at_most=450)
    yield Measurement(f"{name}: key to last repaint, median", statistics.median(last), "ms")
    yield Measurement(f"{name}: server, a move", cpu_ms, "ms CPU", at_most=30)
