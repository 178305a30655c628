"""`python -m tests.benchmarks` prints measured numbers beside their bars; it is no part of the test run.

`--scenarios 20000` adds the solver's fate on so many random scenarios, which takes some minutes.
"""

import argparse
import sys
from collections.abc import Iterator

from tests.benchmarks.command_line import command_line
from tests.benchmarks.measurement import Measurement
from tests.benchmarks.population import population
from tests.benchmarks.solvers import frontiers, long_line, profile_two, surface


def measurements(scenarios: int) -> Iterator[Measurement]:
    """Yield all measurements, one by one."""
    for benchmark in (profile_two, long_line, surface, frontiers, command_line):
        yield from benchmark()
    if scenarios:
        yield from population(scenarios)


def main() -> int:
    """Print all measurements; return 1 if one of them misses its bar."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks", description=__doc__)
    parser.add_argument("--scenarios", type=int, default=0, help="random scenarios to solve")
    missed = 0
    for measured in measurements(parser.parse_args().scenarios):
        verdict = "" if not measured.bar else "holds" if measured.holds else "MISSED"
        missed += not measured.holds
        print(f"{measured.name:62}{measured.value:12,.3g} {measured.unit:10} {measured.bar:16} {verdict}", flush=True)
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
