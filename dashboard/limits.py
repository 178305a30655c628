"""Input size limits in one table: on the page Help, by `railjoule limits`, and in the docs.

A larger request is refused in a sentence before it begins. The bounds of the solvers are `railjoule.core.budget`'s.
"""

from collections.abc import Callable
from dataclasses import dataclass

from railjoule.core.budget import LIBRARY, PAGE, Budget
from railjoule.core.scenario.text_file import MAX_FILE_BYTES, MAX_KEY_PARTS

LONGEST_TEXT = 2_000_000
"""Characters of a text on the page."""
LONGEST_LINK = 2_000_000
"""Characters of an address."""
MAX_FIELDS, MOST_KEYS, DEEPEST = 500, 500, 12
"""Values of a link, keys of a table in it, and tables and lists one in the other; the deepest real ones are 5."""
MOST_ITEMS = 500
"""Entries of a list of fields on the page."""
MAX_STEPS = 100
"""Steps back that a page remembers."""
LARGEST_RUN_BYTES = 8_000_000
"""Of a recorder's file; ten samples a second of eight columns are 2 MB an hour."""
LARGEST_STUDY_BYTES = 64_000_000
"""Of the file of a study: about 600,000 runs of five fields."""
LONGEST_NOTE, LONGEST_AUTHOR = 2_000, 100
"""Characters of an author's note in a report, and of the author's name."""
MOST_CLASSES, MOST_STUDENTS = 50, 200
"""Open classes of a server, and students of each."""
RUNS_KEPT, RESULT_REST_S = 3, 1.0
"""Runs of a student that a class keeps, and the time between two results of a student [s]."""
LONGEST_NAME = 40
"""Characters of a student's name."""
MOST_AWAY_S = 4 * 3600.0
"""A class is closed when no page of its lecturer has been open for this time [s]."""
NONE = "-"


@dataclass(frozen=True)
class Limit:
    """One bound: of what, in the library and the terminal, and on a page; NONE where there is none."""

    of: str
    library: str
    page: str


def limits() -> tuple[Limit, ...]:
    """Return all bounds on what may be asked for, as texts with their units."""
    cells = [Limit("Cells of the mesh", *_both(lambda budget: budget.cell_count))]
    cells += [
        Limit(
            f"Cells of the mesh, strategy {name}", f"{LIBRARY.strategy_cells[name]:,}", f"{PAGE.strategy_cells[name]:,}"
        )
        for name in LIBRARY.strategy_cells
    ]
    return (
        *cells,
        Limit("Cells, optimum of a drive that takes power idling", *_both(lambda budget: budget.idling_cells)),
        Limit("Boxes of speed of its proof", *_both(lambda budget: budget.chain_boxes)),
        Limit("Rows of any list of a scenario", *_both(lambda budget: budget.row_count)),
        Limit("Plan that is driven in closed loop, s", *_both(lambda budget: int(budget.loop_time_s))),
        Limit("Steps of time in closed loop", *_both(lambda budget: budget.loop_steps)),
        Limit("Scenario file", _megabytes(MAX_FILE_BYTES), _megabytes(LONGEST_TEXT)),
        Limit("Report that is opened", _megabytes(MAX_FILE_BYTES), _megabytes(MAX_FILE_BYTES)),
        Limit("Characters of the note in a report", f"{LONGEST_NOTE:,}", f"{LONGEST_NOTE:,}"),
        Limit("File of a line, a train or a measured run", NONE, _megabytes(LARGEST_RUN_BYTES)),
        Limit("File of a study that is opened", NONE, _megabytes(LARGEST_STUDY_BYTES)),
        Limit("File of a study that is dropped", NONE, _megabytes(LARGEST_RUN_BYTES)),
        Limit("Parts of a dotted key", str(MAX_KEY_PARTS), str(MAX_KEY_PARTS)),
        Limit("Characters of a link", NONE, f"{LONGEST_LINK:,}"),
        Limit("Values of a link", NONE, f"{MAX_FIELDS:,}"),
        Limit("Keys of a table in a link", NONE, f"{MOST_KEYS:,}"),
        Limit("Tables and lists in each other in a link", NONE, f"{DEEPEST:,}"),
        Limit("Open classes of a server", NONE, str(MOST_CLASSES)),
        Limit("Students of a class", NONE, str(MOST_STUDENTS)),
        Limit("Time between two results of a student, s", NONE, f"{RESULT_REST_S:g}"),
        Limit("Characters of a student's name", NONE, str(LONGEST_NAME)),
        Limit("Hours that a class stays without its lecturer's page", NONE, f"{MOST_AWAY_S / 3600:g}"),
        Limit("Steps back", NONE, f"{MAX_STEPS:,}"),
    )


def _both(of: Callable[[Budget], int]) -> tuple[str, str]:
    return f"{of(LIBRARY):,}", f"{of(PAGE):,}"


def _megabytes(count: int) -> str:
    return f"{count / 1e6:g} MB"


def markdown() -> str:
    """Return the page of the documentation."""
    rows = "\n".join(f"| {limit.of} | {limit.library} | {limit.page} |" for limit in limits())
    return (
        "# Limits\n\n"
        "A larger request is refused in a sentence that names the bound, before anything is computed. A page has\n"
        "lower bounds, as all visitors of a server share its processors and its memory. `railjoule limits` prints\n"
        "this table, and the page Help shows it; `python -m railjoule.dashboard.limits` writes this file.\n\n"
        f"| of | library and terminal | page |\n| --- | ---: | ---: |\n{rows}\n"
    )


if __name__ == "__main__":
    print(markdown(), end="")


STUDIES = (".nc",)
FILE_SUFFIXES = (".csv", ".tsv", ".txt", ".xlsx", ".json", ".gpx")
"""Endings of the names of files of lines, trains and runs."""


def too_large(name: str) -> str:
    """Return why a file of this name is not read."""
    return f"{name}: larger than the {LARGEST_RUN_BYTES / 1e6:g} MB that a file may have."


def large_study(name: str) -> str:
    """Return why a dropped study is not read, and the way to open it."""
    limit = f"{LARGEST_RUN_BYTES / 1e6:g} MB"
    return (
        f"{name}: larger than the {limit} that can be dropped; \u201cOpen a study\u201d on Explore reads larger ones."
    )
