"""Serve for hours, with pages that open, move and close: memory, files, and times of answers.

`python -m tests.nightly.soak --minutes 120 --samples soak.csv` serves on this machine only; `--pages 100 --minutes 2`
is a test of load. It returns 1 if a move has no answer, a page fails, or the memory grows in the second half.
"""

import argparse
import asyncio
import csv
import random
import sys
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path

from tests.browser.server import Server, serving
from tests.browser.visitor import Visitor

COMMAND = ("-m", "railjoule.dashboard", "serve")
SLIDER, MOVED_S = "Travel time, s", 150.0
"""The slider that moves, and a travel time that the first scenario allows [s]."""
OPEN_S, MOVE_EVERY_S = (20.0, 240.0), (1.0, 5.0)
"""Least and greatest time for which a page is open, and between two of its moves [s]."""
MEMORY_GROWTH = 1.1


@dataclass(frozen=True)
class Sample:
    """The server now, and the moves since the sample before; `opened` and `lost` count from the beginning."""

    minutes: float
    opened: int
    lost: int
    moves: int
    median_ms: float
    p95_ms: float
    memory_mb: float
    files: int


@dataclass
class Visits:
    """Counts of all pages."""

    opened: int = 0
    lost: int = 0
    moves_s: list[float] = field(default_factory=list)


async def visit(server: Server, found: Visits, chance: random.Random, until_s: float) -> None:
    """Open pages one after the other, and move a slider of each, until the time is over."""
    while time.monotonic() < until_s:
        page, leaves_s = Visitor(server.drive_url), time.monotonic() + chance.uniform(*OPEN_S)
        try:
            await page.open()
            found.opened += 1
            slider, value = page.slider(SLIDER), MOVED_S
            while time.monotonic() < min(leaves_s, until_s):
                await asyncio.sleep(chance.uniform(*MOVE_EVERY_S))
                # a value below that of a new page, as an unchanged value has no answer
                value = MOVED_S + chance.randrange(1, 20) if value == MOVED_S else MOVED_S
                found.moves_s.append(await page.move(slider, value, "figures"))
        except (OSError, TimeoutError, AssertionError) as error:
            found.lost += 1
            print(f"a page or a move is lost: {error!r}", flush=True)
            await asyncio.sleep(MOVE_EVERY_S[1])
        found.lost += len(page.failures)
        await page.close()


def sample(server: Server, found: Visits, minutes: float) -> Sample:
    """Return a sample, and count the moves from zero again."""
    moves, found.moves_s = sorted(found.moves_s) or [0.0], []
    median, p95 = (1000 * moves[int(share * (len(moves) - 1))] for share in (0.5, 0.95))
    processes = server.processes()
    memory = sum(one.memory_full_info().pss for one in processes) / 1e6
    files = sum(one.num_fds() for one in processes)
    return Sample(minutes, found.opened, found.lost, len(moves), median, p95, memory, files)


async def soak(server: Server, minutes: float, pages: int, every_s: float, path: Path) -> list[Sample]:
    """Open and close pages, and write a row of the table at each interval."""
    chance, found, began_s = random.Random(1), Visits(), time.monotonic()
    until_s, samples = began_s + 60 * minutes, list[Sample]()
    tasks = [asyncio.create_task(visit(server, found, chance, until_s)) for _ in range(pages)]
    with path.open("w", newline="", encoding="utf-8") as stream:
        rows = csv.DictWriter(stream, [one.name for one in fields(Sample)])
        rows.writeheader()
        while time.monotonic() < until_s:
            await asyncio.sleep(min(every_s, max(until_s - time.monotonic(), 0.0)))
            samples.append(sample(server, found, (time.monotonic() - began_s) / 60))
            rows.writerow({name: f"{value:.6g}" for name, value in asdict(samples[-1]).items()})
            stream.flush()
    await asyncio.gather(*tasks)
    return samples


def is_steady(samples: Sequence[Sample]) -> bool:
    """Return whether nothing is lost and the memory is constant in the second half."""
    half, last = samples[len(samples) // 2], samples[-1]
    return last.lost == 0 and last.memory_mb < MEMORY_GROWTH * half.memory_mb


def main() -> int:
    """Run, write the table, and print its first, middle and last row."""
    parser = argparse.ArgumentParser(prog="python -m tests.nightly.soak", description=__doc__)
    parser.add_argument("--minutes", type=float, default=120.0, help="default: 120")
    parser.add_argument("--pages", type=int, default=6, help="pages that are open at a time; default: 6")
    parser.add_argument("--every", type=float, default=30.0, help="seconds between samples; default: 30")
    parser.add_argument("--samples", type=Path, required=True, metavar="FILE", help="the table to write, CSV")
    asked = parser.parse_args()
    with serving(*COMMAND) as server:
        samples = asyncio.run(soak(server, asked.minutes, asked.pages, asked.every, asked.samples))
    for row in (samples[0], samples[len(samples) // 2], samples[-1]):
        print(row)
    return not is_steady(samples)


if __name__ == "__main__":
    sys.exit(main())
