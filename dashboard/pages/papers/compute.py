"""The papers' printed numbers and claims beside ours: computed now, or as they were computed for this release.

They depend only on the core and the assets and take half a minute, so they are shipped;
`python -m railjoule.dashboard.renew_papers` renews the file after a change of either.
"""

import hashlib
import json
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

import railjoule.core
from railjoule.core.kernel_cache import source_hash
from railjoule.core.validation import COMPARISONS, Claim, Row, Table, Validation
from railjoule.core.validation.table import FigureData

SHIPPED = ("papers", "computed.json")
ASSETS = ("vehicles", "lines", "scenarios", "papers")
"""Folders of the assets whose TOML files the comparisons read; the last has the printed numbers."""


@dataclass(frozen=True, eq=False)
class PaperTables:
    """What is compared of a paper so far.

    Parameters
    ----------
    name : str
        The paper's, as on the command line.
    validation : Validation
        With the tables and claims that are done.
    step_count : int
        Number of tables and claims in all.
    """

    name: str
    validation: Validation
    step_count: int

    @property
    def done_count(self) -> int:
        """Number of tables and claims that are done."""
        return len(self.validation.tables) + len(self.validation.claims)

    @property
    def complete(self) -> bool:
        """Whether all tables and claims are there."""
        return self.done_count == self.step_count


def compute_papers(names: tuple[str, ...]) -> Iterator[dict[str, PaperTables]]:
    """Yield the comparisons of the named papers as their tables come."""
    done: dict[str, PaperTables] = {}
    for name in names:
        comparison = COMPARISONS[name]()
        for step in comparison.steps():
            done = {**done, name: PaperTables(name, step, comparison.step_count)}
            yield done


def compute_figures(name: str) -> Iterator[tuple[FigureData, ...]]:
    """Yield the rebuilt figures of a paper, one more each time."""
    done: tuple[FigureData, ...] = ()
    for printed in COMPARISONS[name]().figures:
        done = (*done, printed.compute())
        yield done


@dataclass(frozen=True, eq=False)
class ShippedTables:
    """What was computed of all papers before.

    Parameters
    ----------
    papers : mapping
        By name.
    is_current : bool
        Whether this code has computed it, from these assets.
    """

    papers: dict[str, PaperTables]
    is_current: bool


@cache
def shipped_tables() -> ShippedTables:
    """Return the comparisons of the file that is shipped."""
    kept = json.loads(files("railjoule.assets").joinpath(*SHIPPED).read_text(encoding="utf-8"))
    papers = {name: _paper(name, paper) for name, paper in kept["papers"].items() if name in COMPARISONS}
    return ShippedTables(papers, kept["inputs"] == input_hash())


def input_hash() -> str:
    """Return digits that change with any source of the core and any vehicle, line, scenario or printed number."""
    digest = hashlib.sha256(source_hash(Path(railjoule.core.__file__).parent).encode())
    for folder in ASSETS:
        for entry in sorted((files("railjoule.assets") / folder).iterdir(), key=lambda entry: entry.name):
            if entry.name.endswith(".toml"):
                digest.update(f"{folder}/{entry.name}".encode())
                digest.update(entry.read_bytes())
    return digest.hexdigest()[:16]


def _paper(name: str, kept: dict[str, Any]) -> PaperTables:
    comparison = COMPARISONS[name]()
    tables = tuple(
        Table(table["title"], tuple(Row(**row) for row in table["rows"]), table["place"], table["reference"])
        for table in kept["tables"]
    )
    claims = tuple(Claim(**claim) for claim in kept["claims"])
    validation = Validation(name, comparison.citation, tables, comparison.errata, claims)
    return PaperTables(name, validation, len(tables) + len(claims))
