"""A server over hours, with pages that come and go: its memory, files, threads and times of answers, as a picture.

`python -m tests.trust.soak --minutes 120 --samples soak.csv --picture soak.png` serves on this machine alone. Each of a
bounded number of places has a page that is opened, moved for some time, left, and opened anew. `--draw` draws samples
that are there already.
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

from bokeh.embed import file_html
from bokeh.layouts import column
from bokeh.plotting import figure
from bokeh.resources import INLINE
from playwright.sync_api import sync_playwright

from tests.browser.chromium import ARGUMENTS, browser_path
from tests.browser.server import Server, serving
from tests.browser.visitor import Visitor
from tests.trust.load import memory_mb
from tests.trust.opening import COMMAND, MOVED_S, SLIDER

MOST_MINUTES, MOST_PLACES = 600, 50
STAYS_S = (20.0, 240.0)
"""How long a page is open, at least and at most."""
EVERY_S = (1.0, 5.0)
"""Time between two moves of a page."""
SEED = 1


@dataclass(frozen=True)
class Sample:
    """What was found since the sample before, and of the server now."""

    minutes: float
    opened: int
    """Pages opened since the beginning."""
    open_now: int
    moves: int
    median_ms: float
    p95_ms: float
    longest_ms: float
    lost: int
    """Since the beginning: moves without an answer, and pages that could not be opened or were closed."""
    memory_mb: float
    files: int
    threads: int
    cores: float


@dataclass
class Visits:
    """What the pages have found so far."""

    opened: int = 0
    open_now: int = 0
    lost: int = 0
    moves_s: list[float] = field(default_factory=list)


async def visits(server: Server, found: Visits, chance: random.Random, until_s: float) -> None:
    """Open a page, move it, leave it, and begin anew, until the time is over."""
    while time.monotonic() < until_s:
        page = Visitor(server.drive_url)
        try:
            await page.open()
        except Exception as error:
            found.lost += 1
            print(f"a page could not be opened: {error!r}", flush=True)
            await asyncio.sleep(EVERY_S[1])
            continue
        found.opened += 1
        found.open_now += 1
        await one_visit(page, found, chance, min(until_s, time.monotonic() + chance.uniform(*STAYS_S)))
        found.open_now -= 1
        await page.close()


async def one_visit(page: Visitor, found: Visits, chance: random.Random, until_s: float) -> None:
    """Move the slider of a page until it is left."""
    slider, value = page.slider(SLIDER), MOVED_S
    while time.monotonic() < until_s:
        await asyncio.sleep(chance.uniform(*EVERY_S))
        # short of the time with which a page opens: nothing answers a move that changes nothing
        value = MOVED_S + chance.randrange(1, 20) if value == MOVED_S else MOVED_S
        try:
            found.moves_s.append(await page.move(slider, value, "figures"))
        except (TimeoutError, AssertionError) as error:
            found.lost += 1
            print(f"a move had no answer: {error!r}", flush=True)
            return


def sample(server: Server, found: Visits, began_s: float, cores: float) -> Sample:
    """Return what is to be told now, and begin to count moves anew."""
    moves, found.moves_s = sorted(found.moves_s), []

    def rank(share: float) -> float:
        return 1000 * moves[int(share * (len(moves) - 1))] if moves else 0.0

    processes = server.processes()
    return Sample(
        (time.monotonic() - began_s) / 60,
        found.opened,
        found.open_now,
        len(moves),
        rank(0.5),
        rank(0.95),
        rank(1.0),
        found.lost,
        memory_mb(server),
        sum(one.num_fds() for one in processes),
        sum(one.num_threads() for one in processes),
        cores,
    )


async def soak(server: Server, minutes: float, places: int, every_s: float, path: Path) -> list[Sample]:
    """Let pages come and go, and write a row of samples as often as asked."""
    chance, found, began_s = random.Random(SEED), Visits(), time.monotonic()
    until_s, samples = began_s + 60 * minutes, list[Sample]()
    tasks = [asyncio.create_task(visits(server, found, chance, until_s)) for _ in range(places)]
    with path.open("w", newline="", encoding="utf-8") as stream:
        rows = csv.DictWriter(stream, [one.name for one in fields(Sample)])
        rows.writeheader()
        while time.monotonic() < until_s:
            used, since_s = server.cpu_s(), time.monotonic()
            await asyncio.sleep(min(every_s, max(until_s - since_s, 0.0)))
            cores = (server.cpu_s() - used) / (time.monotonic() - since_s)
            samples.append(sample(server, found, began_s, cores))
            rows.writerow({name: f"{value:.6g}" for name, value in asdict(samples[-1]).items()})
            # what is there stays where this is ended
            stream.flush()
    await asyncio.gather(*tasks)
    return samples


def read(path: Path) -> list[Sample]:
    """Return the samples of a file."""
    kinds = {one.name: int if one.type is int else float for one in fields(Sample)}
    with path.open(newline="", encoding="utf-8") as stream:
        return [Sample(**{name: kinds[name](value) for name, value in row.items()}) for row in csv.DictReader(stream)]


def draw(samples: Sequence[Sample], path: Path) -> None:
    """Draw samples over time, as PNG."""
    shown = (
        ("Memory of all processes, MB", ("memory_mb",)),
        ("Answer to a move, ms", ("median_ms", "p95_ms")),
        ("Open files and threads", ("files", "threads")),
        ("Pages open", ("open_now",)),
    )
    figures = []
    for title, names in shown:
        f = figure(width=760, height=190, title=title, x_axis_label="Minutes", tools="", toolbar_location=None)
        for name, colour in zip(names, ("#1b5e8c", "#c2571a"), strict=False):
            minutes, values = [one.minutes for one in samples], [getattr(one, name) for one in samples]
            f.line(minutes, values, color=colour, line_width=1.5, legend_label=name.replace("_", " "))
        f.y_range.start = 0
        f.legend.location, f.legend.orientation = "bottom_left", "horizontal"
        f.legend.background_fill_alpha = 0.3
        figures.append(f)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=browser_path(), args=ARGUMENTS)
        page = browser.new_page(viewport={"width": 776, "height": 800})
        page.set_content(file_html(column(figures), INLINE, "soak"))
        page.locator("canvas").last.wait_for()
        page.wait_for_timeout(1000)
        page.screenshot(path=path, full_page=True)
        browser.close()


def summary(samples: Sequence[Sample]) -> str:
    """Return in three lines what the samples come to."""
    half, p95 = samples[len(samples) // 2], sorted(one.p95_ms for one in samples)
    return (
        f"{samples[-1].minutes:.0f} minutes, {samples[-1].opened} pages opened, {sum(one.moves for one in samples):,} "
        f"moves, {samples[-1].lost} lost;\n"
        f"95th percentile of a sample: {p95[len(p95) // 2]:.0f} ms in the median, {p95[-1]:.0f} ms at most;\n"
        f"memory: {samples[0].memory_mb:.0f} MB first, {half.memory_mb:.0f} MB half way, "
        f"{samples[-1].memory_mb:.0f} MB last; open files: {samples[0].files}, {half.files} and {samples[-1].files}."
    )


def is_steady(samples: Sequence[Sample]) -> bool:
    """Return whether nothing was lost and the memory has stayed flat in the second half."""
    half, last = samples[len(samples) // 2], samples[-1]
    return last.lost == 0 and last.memory_mb < 1.1 * half.memory_mb


def main() -> int:
    """Soak and draw; return 1 if anything was lost or the memory has grown."""
    parser = argparse.ArgumentParser(prog="python -m tests.trust.soak", description=__doc__)
    parser.add_argument("--minutes", type=float, default=120.0, help=f"{MOST_MINUTES} at most")
    parser.add_argument("--places", type=int, default=6, help=f"pages open at a time, {MOST_PLACES} at most")
    parser.add_argument("--every", type=float, default=30.0, help="seconds between samples")
    parser.add_argument("--samples", type=Path, required=True, metavar="FILE", help="CSV to write, or to draw")
    parser.add_argument("--picture", type=Path, metavar="FILE", help="PNG to draw")
    parser.add_argument("--draw", action="store_true", help="only draw the samples that are there")
    asked = parser.parse_args()
    if not 0 < asked.minutes <= MOST_MINUTES or not 1 <= asked.places <= MOST_PLACES or not 1 <= asked.every <= 600:
        parser.error(f"--minutes up to {MOST_MINUTES}, --places from 1 to {MOST_PLACES}, --every from 1 to 600")
    if asked.draw:
        samples = read(asked.samples)
    else:
        with serving(*COMMAND) as server:
            samples = asyncio.run(soak(server, asked.minutes, asked.places, asked.every, asked.samples))
    if asked.picture is not None:
        draw(samples, asked.picture)
    print(summary(samples))
    return not is_steady(samples)


if __name__ == "__main__":
    sys.exit(main())
