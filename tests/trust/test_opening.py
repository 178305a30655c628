"""A short look at what opening a page costs; `python -m tests.trust.opening` looks longer."""

import asyncio
import statistics
import urllib.request
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor

import pytest

from tests.browser.server import Server, serving
from tests.trust.opening import COMMAND, Crowd, costs, crowd

PAGES = 3
FIRST_CPU_S = 0.1
"""An answer that makes no page; one that does takes several times as much."""
OPEN_CPU_S, MOVE_S = 2.0, 2.5
"""Loose: the machine of a gate has other work, which the processor's own time is not free of either."""


@pytest.fixture(scope="module")
def server() -> Iterator[Server]:
    with serving(*COMMAND) as running:
        yield running


def run(coroutine):
    # Playwright keeps a loop running in the thread of the tests
    with ThreadPoolExecutor(1) as thread:
        return thread.submit(asyncio.run, coroutine).result()


def test_whoever_asks_for_a_page_and_does_not_open_it_costs_next_to_nothing(server: Server) -> None:
    urllib.request.urlopen(server.drive_url).close()
    before = server.cpu_s()
    for _ in range(5):
        with urllib.request.urlopen(server.drive_url) as answer:
            text = answer.read().decode()
    assert (server.cpu_s() - before) / 5 < FIRST_CPU_S
    # all that is of the page itself comes by its websocket
    assert "@token@" not in text
    assert "Travel time, s" not in text


def test_a_page_opens_at_a_bounded_cost(server: Server) -> None:
    assert statistics.median(run(costs(server, PAGES))) < OPEN_CPU_S


def test_pages_that_open_at_once_leave_an_open_page_its_moves(server: Server) -> None:
    found: Crowd = run(crowd(server, PAGES))
    assert len(found.answered_s) == PAGES
    assert statistics.median(found.moves_s) < MOVE_S
