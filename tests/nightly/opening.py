"""Measure the cost of opening a page: processor time of the server, bytes, and waits of other pages.

`python -m tests.nightly.opening` serves on this machine only, and returns 1 if a measurement misses its bar. The bytes
are compressed, and without those of the websocket.
"""

import argparse
import asyncio
import statistics
import sys
import urllib.request
from collections.abc import Iterator

from playwright.sync_api import sync_playwright

from tests.benchmarks.measurement import Measurement
from tests.browser.chromium import ARGUMENTS, browser_path
from tests.browser.server import Server, serving
from tests.browser.visitor import Visitor
from tests.nightly.soak import COMMAND, MOVED_S, SLIDER

SETTLE_S, MOVE_EVERY_S, REQUESTS = 1.5, 0.25, 5


async def opening_cpu_s(server: Server, pages: int) -> list[float]:
    """Return the processor time of each of some pages that open one after the other [s]."""
    spent = []
    for _ in range(pages):
        before = server.cpu_s()
        page = Visitor(server.drive_url)
        await page.open()
        await asyncio.sleep(SETTLE_S)
        spent.append(server.cpu_s() - before)
        await page.close()
    return spent


async def open_at_once(server: Server, pages: int) -> tuple[list[float], list[float]]:
    """Return the times until pages have opened at once, and of the moves of another page in that time [s]."""
    mover, others = Visitor(server.drive_url), [Visitor(server.drive_url) for _ in range(pages)]
    await mover.open()
    slider, moves = mover.slider(SLIDER), list[float]()
    await mover.move(slider, MOVED_S, "figures")
    await asyncio.sleep(SETTLE_S)
    opening = asyncio.gather(*(page.open() for page in others))
    while not opening.done():
        moves.append(await mover.move(slider, MOVED_S + 1 + len(moves) % 2, "figures"))
        await asyncio.sleep(MOVE_EVERY_S)
    await opening
    for page in (mover, *others):
        await page.close()
    return [page.opened_s for page in others], moves


def in_browser(server: Server) -> Iterator[Measurement]:
    """Open the page in Chromium, first with an empty cache, and yield bytes and processor time."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=browser_path(), args=ARGUMENTS)
        context = browser.new_context(viewport={"width": 1280, "height": 900})
        megabytes, spent = [], []
        for _ in range(4):
            before, page, received = server.cpu_s(), context.new_page(), list[float]()
            client = context.new_cdp_session(page)
            client.send("Network.enable")
            client.on("Network.loadingFinished", lambda event, to=received: to.append(event["encodedDataLength"]))
            page.goto(server.drive_url)
            page.locator(".rj-chart-speed:visible canvas").first.wait_for(timeout=60_000)
            page.wait_for_timeout(1000 * SETTLE_S)
            megabytes.append(sum(received) / 1e6)
            spent.append(server.cpu_s() - before)
            page.close()
        browser.close()
    yield Measurement("bytes of a page in Chromium, empty cache", megabytes[0], "MB", at_most=3.0)
    yield Measurement("bytes of a page in Chromium, filled cache", max(megabytes[1:]), "MB", at_most=0.3)
    yield Measurement("processor, a page in Chromium with figures", statistics.median(spent[1:]), "s", at_most=0.9)


def measurements(pages: int) -> Iterator[Measurement]:
    """Yield all measurements."""
    with serving(*COMMAND) as server:
        # the first pages load the compiled code
        asyncio.run(opening_cpu_s(server, 2))
        before = server.cpu_s()
        for _ in range(REQUESTS):
            urllib.request.urlopen(server.drive_url).close()
        asked = (server.cpu_s() - before) / REQUESTS
        yield Measurement("processor, a request without a page", asked, "s", at_most=0.1)
        spent = asyncio.run(opening_cpu_s(server, pages))
        yield Measurement("processor, an open page, median", statistics.median(spent), "s", at_most=0.6)
        opened, moves = asyncio.run(open_at_once(server, pages))
        yield Measurement(f"{pages} pages opened at once, the last", max(opened), "s", at_most=6.0)
        yield Measurement("a move of another page, median", statistics.median(moves), "s", at_most=0.5)
        yield from in_browser(server)


def main() -> int:
    """Print all measurements; return 1 if one of them misses its bar."""
    parser = argparse.ArgumentParser(prog="python -m tests.nightly.opening", description=__doc__)
    parser.add_argument("--pages", type=int, default=10, help="pages that open; default: 10")
    missed = 0
    for row in measurements(parser.parse_args().pages):
        print(row.line, flush=True)
        missed += row.missed
    return missed > 0


if __name__ == "__main__":
    sys.exit(main())
