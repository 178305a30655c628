"""`python -m tests.benchmarks` prints measured times beside their bars; it is no part of the test run.

It measures the solver and the command line; `--pages` measures the dashboard in a browser instead.
"""

import argparse
import sys
from collections.abc import Iterator

from tests.benchmarks.command_line import command_line
from tests.benchmarks.measurement import Measurement
from tests.benchmarks.solvers import frontiers, long_line, profile_two, surface


def measurements(in_browser: bool) -> Iterator[Measurement]:
    """Yield all measurements, one by one."""
    if in_browser:
        from tests.benchmarks.page import pages  # noqa: PLC0415  (needs a browser, which the others do not)

        yield from pages()
        return
    for benchmark in (profile_two, long_line, surface, frontiers, command_line):
        yield from benchmark()


def main() -> int:
    """Print all measurements; return 1 if one of them misses its bar."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks", description=__doc__)
    parser.add_argument("--pages", action="store_true", help="the dashboard in a browser instead")
    missed = 0
    for measured in measurements(parser.parse_args().pages):
        missed += measured.missed
        print(measured.line, flush=True)
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
