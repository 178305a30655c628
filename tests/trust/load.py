"""Many open pages that all move: how long their answers take, what is lost, and what they take of the server.

`python -m tests.trust.load --pages 100 --seconds 120 --rounds 3` serves on this machine alone, opens the
pages, moves one slider of each every two seconds, closes them and begins anew. Pages, seconds and rounds are bounded.
The client takes a processor too: where it shares them with the server, its own share is told.
"""

import argparse
import asyncio
import random
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, field

import psutil

from tests.benchmarks.measurement import Measurement
from tests.browser.server import Server, serving
from tests.browser.visitor import Visitor
from tests.trust.opening import COMMAND, MOVED_S, SLIDER, told

MOST_PAGES, MOST_SECONDS, MOST_ROUNDS = 300, 600, 5
EVERY_S, OPENING_AT_ONCE = 2.0, 5
SETTLE_S = 3.0
MB = 1e6


@dataclass
class Round:
    """What some pages found while they were open."""

    moves_s: list[float] = field(default_factory=list)
    lost: int = 0
    """Moves without an answer, and pages that were closed."""
    unsettled: int = 0
    """Pages whose address does not hold the last move."""
    errors: list[str] = field(default_factory=list)
    opened_s: list[float] = field(default_factory=list)
    cores: float = 0.0
    memory_mb: float = 0.0


def memory_mb(server: Server) -> float:
    """Return what all processes of the server have for themselves, and their shares of what they have in common."""
    return sum(one.memory_full_info().pss for one in server.processes()) / MB


async def moving(page: Visitor, seconds: float, found: Round) -> None:
    """Move the slider of a page again and again."""
    slider, value, until = page.slider(SLIDER), MOVED_S, time.perf_counter() + seconds
    await asyncio.sleep(random.random() * EVERY_S)
    while time.perf_counter() < until:
        started = time.perf_counter()
        value = MOVED_S + 0.1 * random.randrange(1, 200) if value == MOVED_S else MOVED_S
        try:
            found.moves_s.append(await page.move(slider, value, "figures"))
        except (TimeoutError, AssertionError):
            found.lost += 1
        await asyncio.sleep(max(EVERY_S - (time.perf_counter() - started), 0.0))
    await asyncio.sleep(SETTLE_S)
    found.lost += not page.is_open
    found.unsettled += f"travel_time_s={value:.10g}" not in page.text


async def one_round(server: Server, pages: int, seconds: float) -> Round:
    """Open pages, let them move, and close them."""
    found, visitors = Round(), [Visitor(server.drive_url) for _ in range(pages)]
    places = asyncio.Semaphore(OPENING_AT_ONCE)

    async def opened(page: Visitor) -> None:
        async with places:
            await page.open()

    await asyncio.gather(*map(opened, visitors))
    await asyncio.sleep(SETTLE_S)
    used, started = server.cpu_s(), time.perf_counter()
    moves = asyncio.gather(*(moving(page, seconds, found) for page in visitors))
    await asyncio.sleep(seconds)
    found.cores = (server.cpu_s() - used) / (time.perf_counter() - started)
    await moves
    found.memory_mb = memory_mb(server)
    found.opened_s = [page.opened_s for page in visitors]
    found.errors = [error for page in visitors for error in page.failures]
    for page in visitors:
        await page.close()
    return found


def rows(number: int, found: Round, rest_mb: float, pages: int, client_cores: float) -> Iterator[Measurement]:
    """Yield what one round has found."""
    ordered = sorted(found.moves_s)

    def rank(share: float) -> float:
        return 1000 * ordered[int(share * (len(ordered) - 1))]

    begin = f"round {number}: "
    yield Measurement(f"{begin}moves answered", len(ordered), "", at_least=1)
    yield Measurement(f"{begin}a move, median", rank(0.5), "ms")
    yield Measurement(f"{begin}a move, 95th percentile", rank(0.95), "ms", at_most=500)
    yield Measurement(f"{begin}a move, longest", rank(1.0), "ms")
    yield Measurement(f"{begin}moves and pages lost", found.lost, "", at_most=0)
    yield Measurement(f"{begin}addresses without the last move", found.unsettled, "", at_most=0)
    yield Measurement(f"{begin}errors", len(found.errors), "", at_most=0)
    yield Measurement(f"{begin}a page opened, longest", max(found.opened_s), "s")
    yield Measurement(f"{begin}processors taken by the server", found.cores, "")
    yield Measurement(f"{begin}processors taken by this client", client_cores, "")
    yield Measurement(f"{begin}memory of a page", (found.memory_mb - rest_mb) / pages, "MB", at_most=25)


def measurements(pages: int, seconds: float, rounds: int, pause_s: float) -> Iterator[Measurement]:
    """Yield all numbers."""
    with serving(*COMMAND) as server:
        # what the first pages alone have to load
        asyncio.run(one_round(server, 2, EVERY_S))
        rest_mb, peaks = memory_mb(server), []
        yield Measurement("memory at rest", rest_mb, "MB")
        for number in range(1, rounds + 1):
            own, started = psutil.Process().cpu_times(), time.perf_counter()
            found = asyncio.run(one_round(server, pages, seconds))
            now = psutil.Process().cpu_times()
            client = (now.user + now.system - own.user - own.system) / (time.perf_counter() - started)
            yield from rows(number, found, rest_mb, pages, client)
            peaks.append(found.memory_mb)
            if number < rounds:
                time.sleep(pause_s)
        if rounds > 1:
            # the first fills caches and the allocator's arenas
            yield Measurement("memory of the last round against the one before", peaks[-1] / peaks[-2], "", at_most=1.1)


def main() -> int:
    """Print all measurements; return 1 if one of them misses its bar."""
    parser = argparse.ArgumentParser(prog="python -m tests.trust.load", description=__doc__)
    parser.add_argument("--pages", type=int, default=100, help=f"open pages, {MOST_PAGES} at most")
    parser.add_argument("--seconds", type=float, default=120.0, help=f"of moves a round, {MOST_SECONDS} at most")
    parser.add_argument("--rounds", type=int, default=1, help=f"{MOST_ROUNDS} at most")
    parser.add_argument("--pause", type=float, default=100.0, help="seconds between rounds, for closed pages to end")
    asked = parser.parse_args()
    if not 1 <= asked.pages <= MOST_PAGES or not EVERY_S <= asked.seconds <= MOST_SECONDS:
        parser.error(f"--pages is from 1 to {MOST_PAGES}, --seconds from {EVERY_S:g} to {MOST_SECONDS}")
    if not 1 <= asked.rounds <= MOST_ROUNDS or not 0 <= asked.pause <= MOST_SECONDS:
        parser.error(f"--rounds is from 1 to {MOST_ROUNDS}, --pause from 0 to {MOST_SECONDS}")
    found = measurements(asked.pages, asked.seconds, asked.rounds, asked.pause)
    return sum(row.missed for row in map(told, found)) > 0


if __name__ == "__main__":
    sys.exit(main())
