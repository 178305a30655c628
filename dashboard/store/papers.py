"""The papers' printed numbers beside ours, table by table."""

from collections.abc import Iterator
from dataclasses import dataclass

from railjoule.core.validation import COMPARISONS, Validation


@dataclass(frozen=True, eq=False)
class PaperTables:
    """What is compared of a paper so far.

    Parameters
    ----------
    name : str
        The paper's, as on the command line.
    validation : Validation
        With the tables that are done.
    table_count : int
        How many there will be.
    """

    name: str
    validation: Validation
    table_count: int

    @property
    def complete(self) -> bool:
        """Whether all tables are there."""
        return len(self.validation.tables) == self.table_count


def compute_papers(names: tuple[str, ...]) -> Iterator[dict[str, PaperTables]]:
    """Yield the comparisons of the named papers as their tables come."""
    done: dict[str, PaperTables] = {}
    for name in names:
        comparison = COMPARISONS[name]()
        for step in comparison.steps():
            done = {**done, name: PaperTables(name, step, len(comparison.tables))}
            yield done
