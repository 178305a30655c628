"""A short look at many pages; `python -m tests.trust.load` looks longer."""

import asyncio
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor

import pytest

from tests.browser.server import Server, serving
from tests.trust.load import memory_mb, one_round
from tests.trust.opening import COMMAND

PAGES, SECONDS = 6, 6.0
MEMORY_OF_A_PAGE_MB = 25


@pytest.fixture(scope="module")
def server() -> Iterator[Server]:
    with serving(*COMMAND) as running:
        yield running


def run(coroutine):
    # Playwright keeps a loop running in the thread of the tests
    with ThreadPoolExecutor(1) as thread:
        return thread.submit(asyncio.run, coroutine).result()


def test_many_pages_lose_nothing(server: Server) -> None:
    # once before, so that the server has loaded the compiled code
    run(one_round(server, PAGES, 2.0))
    rest = memory_mb(server)
    found = run(one_round(server, PAGES, SECONDS))
    assert len(found.moves_s) >= PAGES
    assert (found.lost, found.unsettled, found.errors) == (0, 0, [])
    assert (found.memory_mb - rest) / PAGES < MEMORY_OF_A_PAGE_MB
