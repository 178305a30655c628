"""`python -m tests.trust` tries each row of the review of trust again, and prints them in one table.

Loopback only, one server at a time, some minutes in all. What opening a page costs and the load of many pages are in
modules of their own. `--quick` leaves out what the gate leaves out.
"""

import argparse
import sys
from pathlib import Path

# as for pytest: what drives a server lies beside the tests of the browser
sys.path.insert(0, str(Path(__file__).parents[1]))

from browser.server import serving

from tests.trust import commands, floors, pages, served, texts
from tests.trust.rows import table


def main() -> int:
    """Print the table; return 1 if any row is not as it must be."""
    parser = argparse.ArgumentParser(prog="python -m tests.trust", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="the rows of the gate alone")
    parser.add_argument("--results", type=Path, metavar="FILE", help="write the table to a file too")
    asked = parser.parse_args()
    lines: list[str] = []

    def tell(line: str) -> None:
        lines.append(line)
        print(line, flush=True)

    with serving(*served.COMMAND) as server:
        every = (*served.rows(server), *texts.ROWS, *commands.ROWS, *floors.ROWS, *pages.ROWS)
        good = table((row for row in every if row.quick or not asked.quick), tell)
    if asked.results is not None:
        asked.results.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
