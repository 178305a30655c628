"""A short look at many pages over two processes; `python -m tests.trust.load` looks longer."""

import asyncio
import signal
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor

import psutil
import pytest

from tests.browser.server import Server, serving
from tests.trust.load import memory_mb, one_round
from tests.trust.opening import command

PROCESSES, PAGES, SECONDS = 2, 6, 6.0
MEMORY_OF_A_PAGE_MB = 25
GONE_WITHIN_S = 20


@pytest.fixture(scope="module")
def server() -> Iterator[Server]:
    with serving(*command(PROCESSES)) as running:
        yield running


def run(coroutine):
    # Playwright keeps a loop running in the thread of the tests
    with ThreadPoolExecutor(1) as thread:
        return thread.submit(asyncio.run, coroutine).result()


def workers(server: Server) -> list[psutil.Process]:
    return [one for one in server.processes()[1:] if "spawn_main" in " ".join(one.cmdline())]


def test_pages_of_two_processes_lose_nothing(server: Server) -> None:
    # twice, so that both processes have loaded the compiled code
    run(one_round(server, PAGES, 2.0))
    run(one_round(server, PAGES, 2.0))
    rest, used = memory_mb(server), [one.cpu_times().user for one in workers(server)]
    found = run(one_round(server, PAGES, SECONDS))
    assert len(found.moves_s) >= PAGES
    assert (found.lost, found.unsettled, found.errors) == (0, 0, [])
    assert (found.memory_mb - rest) / PAGES < MEMORY_OF_A_PAGE_MB
    # both have had pages: each takes some tenths of a second
    spent = [one.cpu_times().user - before for one, before in zip(workers(server), used, strict=True)]
    assert len(spent) == PROCESSES
    assert min(spent) > 0.3 * max(spent)


def test_all_processes_end_with_the_one_in_front(server: Server) -> None:
    members = workers(server)
    server.process.terminate()
    assert server.process.wait(GONE_WITHIN_S) == -signal.SIGTERM
    gone, alive = psutil.wait_procs(members, GONE_WITHIN_S)
    assert (len(gone), alive) == (PROCESSES, [])


def test_they_end_too_where_that_one_is_killed() -> None:
    with serving(*command(PROCESSES)) as server:
        members = workers(server)
        server.process.kill()
        gone, alive = psutil.wait_procs(members, GONE_WITHIN_S)
    assert (len(gone), alive) == (PROCESSES, [])
