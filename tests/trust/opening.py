"""What it costs to open a page: the server's processor time, bytes, and how long others wait meanwhile.

`python -m tests.trust.opening` serves on this machine alone, opens a bounded number of pages and prints a table. Times
of the processor are those of all processes of the server; where other programs take the processors too, trust them
rather than the waits.
"""

import argparse
import asyncio
import statistics
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass

from playwright.sync_api import sync_playwright

from tests.benchmarks.measurement import Measurement
from tests.browser.chromium import ARGUMENTS, browser_path
from tests.browser.server import Server, free_port, serving
from tests.browser.visitor import Visitor
from tests.trust.relay import Relay

MOST_PAGES = 50
SETTLE_S, MOVE_EVERY_S = 1.5, 0.25
SLIDER = "Travel time, s"
MOVED_S = 150.0
"""Where the slider of the page stands that moves, which the first scenario can be driven in [s]."""
MB = 1e6
COMMAND = ("-m", "railjoule.dashboard", "serve", "--no-workspace")


@dataclass(frozen=True)
class Crowd:
    """Pages that are opened at once, and the moves of one that is open already."""

    answered_s: list[float]
    moves_s: list[float]


async def costs(server: Server, pages: int) -> list[float]:
    """Return the processor time of each of some pages, opened one after the other [s]."""
    found = []
    for _ in range(pages):
        before = server.cpu_s()
        page = Visitor(server.drive_url)
        await page.open()
        await asyncio.sleep(SETTLE_S)
        found.append(server.cpu_s() - before)
        await page.close()
    return found


async def crowd(server: Server, pages: int) -> Crowd:
    """Open pages at once beside one whose slider moves."""
    mover, others = Visitor(server.drive_url), [Visitor(server.drive_url) for _ in range(pages)]
    await mover.open()
    slider, moves = mover.slider(SLIDER), list[float]()
    await mover.move(slider, MOVED_S, "figures")
    await asyncio.sleep(SETTLE_S)
    opening = asyncio.gather(*(page.open() for page in others))
    started = time.perf_counter()
    while not opening.done() and time.perf_counter() - started < 60:
        moves.append(await mover.move(slider, MOVED_S + 1 + len(moves) % 2, "figures"))
        await asyncio.sleep(MOVE_EVERY_S)
    await opening
    for page in (mover, *others):
        await page.close()
    return Crowd([page.opened_s for page in others], moves)


def in_browser(server: Server, relay: Relay, pages: int) -> Iterator[Measurement]:
    """Open the page in Chromium, first with nothing kept, then again, and count bytes and processor time."""
    server.wait()
    url = f"http://127.0.0.1:{relay.port}/?v=1&page=Drive"
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=browser_path(), args=ARGUMENTS)
        try:
            context = browser.new_context(viewport={"width": 1280, "height": 900})
            received, spent = [], []
            for _ in range(pages + 1):
                relay.taken()
                before = server.cpu_s()
                page = context.new_page()
                page.goto(url)
                page.locator(".rj-chart-speed:visible canvas").first.wait_for(timeout=60_000)
                page.wait_for_timeout(1000 * SETTLE_S)
                received.append(relay.taken() / MB)
                spent.append(server.cpu_s() - before)
                page.close()
        finally:
            browser.close()
    yield Measurement("bytes of a page in Chromium, cold", received[0], "MB", at_most=3.0)
    yield Measurement("bytes of a page in Chromium, warm", max(received[1:]), "MB", at_most=0.3)
    yield Measurement("processor, a page in Chromium with figures", statistics.median(spent[1:]), "s", at_most=0.9)


def measurements(pages: int, browser: bool) -> Iterator[Measurement]:
    """Yield all numbers."""
    listened = free_port()
    with Relay.to(listened) as relay:
        origin = ("--origin", f"127.0.0.1:{relay.port}")
        with serving(*COMMAND, *origin, port=listened) as server:
            # what the first pages alone have to load
            asyncio.run(costs(server, 2))
            spent = asyncio.run(costs(server, pages))
            yield Measurement("processor, an open page, median", statistics.median(spent), "s", at_most=0.6)
            yield Measurement("processor, an open page, highest", max(spent), "s")
            found = asyncio.run(crowd(server, pages))
            yield Measurement(f"{pages} pages opened at once, last answer", max(found.answered_s), "s", at_most=6.0)
            yield Measurement("a move meanwhile, median", statistics.median(found.moves_s), "s", at_most=0.5)
            yield Measurement("a move meanwhile, longest", max(found.moves_s), "s", at_most=0.5)
            if browser:
                yield from in_browser(server, relay, max(2, pages // 3))


def main() -> int:
    """Print all measurements; return 1 if one of them misses its bar."""
    parser = argparse.ArgumentParser(prog="python -m tests.trust.opening", description=__doc__)
    parser.add_argument("--pages", type=int, default=10, help=f"pages opened, {MOST_PAGES} at most")
    parser.add_argument("--no-browser", action="store_true", help="without what Chromium tells: bytes and figures")
    asked = parser.parse_args()
    if not 2 <= asked.pages <= MOST_PAGES:
        parser.error(f"--pages is from 2 to {MOST_PAGES}")
    rows = measurements(asked.pages, browser_path() is not None and not asked.no_browser)
    return sum(row.missed for row in map(told, rows)) > 0


def told(row: Measurement) -> Measurement:
    """Print a row, and return it."""
    print(row.line, flush=True)
    return row


if __name__ == "__main__":
    sys.exit(main())
