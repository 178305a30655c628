"""`python -m tests.tell_tested` writes assets/docs/tested.md: what was tested, when, with which numbers, and how again.

It takes the table that `python -m tests.trust --results FILE` has written, the calls that `python -m tests.check_many
--results FILE` has and the samples of `python -m tests.trust.soak`, and counts the tests of the gate.
"""

import argparse
import platform
import re
import subprocess
import sys
import tempfile
from collections import Counter
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path

from tests import check_many
from tests.trust import soak
from tests.trust.floors import FLOORS, ROOT

TARGET = ROOT / "assets" / "docs" / "tested.md"
PACKAGES = ("numba", "numpy", "panel", "bokeh", "tornado")
PART = re.compile(r"^tests/(?P<part>[a-z]+)(?:/|\.py|_)[^:]*: (?P<count>\d+)$", re.MULTILINE)


def counted() -> Counter[str]:
    """Return how many tests the gate has, by the folder that they lie in."""
    command = [sys.executable, "-m", "pytest", "--collect-only", "-q", "-q", "-n0", "tests"]
    told = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    found: Counter[str] = Counter()
    for one in PART.finditer(told):
        found[one["part"]] += int(one["count"])
    return found


def commit() -> str:
    """Return the commit that was tested, in short."""
    command = ["git", "rev-parse", "--short", "HEAD"]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout.strip()


def text(trust: str, rows: list[check_many.Row], seeds: range, samples: list[soak.Sample], tests: Counter[str]) -> str:
    """Return the page."""
    releases = ", ".join(f"{name} {version(name)}" for name in PACKAGES)
    parts = "\n".join(f"| tests/{name} | {count:,} |" for name, count in sorted(tests.items()))
    faults = trust.count("| FAULT |")
    return f"""# What is tested

Of commit {commit()}, {datetime.now(UTC):%d %B %Y}, with Python {platform.python_version()}, {releases}.
`python -m tests.tell_tested` writes this page from the results of the commands below.

## The gate

`./run test` runs {sum(tests.values()):,} tests, and the checks of style, types and imports.

| where | tests |
| --- | ---: |
{parts}

## Random scenarios through every strategy

`python -m tests.check_many --count 20000 --minutes 480` drives random valid scenarios with every strategy, and checks
each run by formulas that share no code with the solvers. It goes on where it was broken off.

{check_many.table(rows)}

{check_many.verdict(rows, seeds)}

## Hours

`python -m tests.trust.soak --minutes 120 --samples FILE --picture assets/pictures/soak.png` serves pages that come and
go, with other work on the same processors:

{soak.summary(samples)}

![Memory, times of answers, open files and pages over the time](../pictures/soak.png)

## Reliability and security

`python -m tests.trust` repeats the rows of the review of 22 November 2026 on a server of its own, over the loopback
alone; its quick rows are tests of the gate. {faults} of {trust.count("| good |") + faults} rows are faulty.

{trust.strip()}

The lowest allowed releases of {len(FLOORS)} packages are held against the advisories in `tests/trust/floors.py`;
`python -m tests.try_floors` installs and tries the lowest releases that are allowed.
"""


def main() -> None:
    """Write the page."""
    parser = argparse.ArgumentParser(prog="python -m tests.tell_tested", description=__doc__)
    parser.add_argument("--trust", type=Path, required=True, metavar="FILE", help="the table of tests.trust")
    many = Path(tempfile.gettempdir()) / "check_many.jsonl"
    parser.add_argument("--many", type=Path, default=many, metavar="FILE", help="the calls of tests.check_many")
    parser.add_argument("--soak", type=Path, required=True, metavar="FILE", help="the samples of tests.trust.soak")
    parser.add_argument("--count", type=int, default=20_000, help="how many scenarios were asked for")
    asked = parser.parse_args()
    seeds = range(asked.count)
    rows = check_many.kept_rows(asked.many, seeds)
    trust, samples = asked.trust.read_text(encoding="utf-8"), soak.read(asked.soak)
    TARGET.write_text(text(trust, rows, seeds, samples, counted()), encoding="utf-8")
    print(f"{TARGET.relative_to(ROOT)}: {len(rows):,} calls")


if __name__ == "__main__":
    main()
