"""Rows that need a browser or many minutes: they run the tests that hold them."""

import subprocess
import sys
from collections.abc import Callable

from tests.trust.rows import Found, Row

LONGEST_S = 900


def tests(*words: str) -> Callable[[], Found]:
    """Return what finds how tests of the gate end."""

    def find() -> Found:
        command = [sys.executable, "-m", "pytest", "-q", "-n0", "-p", "no:cacheprovider", *words]
        done = subprocess.run(command, capture_output=True, text=True, timeout=LONGEST_S, check=False)
        last = (done.stdout.strip().splitlines() or ["no output"])[-1]
        return Found(last.strip("= "), done.returncode == 0)

    return find


AWAY, LINKS = "tests/browser/test_away.py", "tests/browser/test_hostile_links.py"
ROWS = (
    Row(
        "3",
        "a change 60 ms before kill -9; back on the same port",
        "the change is lost",
        tests(AWAY, "-k", "dies"),
        False,
    ),
    Row("3", "SIGSTOP of 9 s before a browser", "no mark, stale numbers look new", tests(AWAY, "-k", "still"), False),
    Row("5", "five hostile links, another page moves", "dead server, 23.7 GB", tests(LINKS), False),
    Row(
        "5",
        "markup in titles, files and links",
        "0 executed",
        tests("tests/browser/test_keep.py"),
        False,
    ),
)
