"""The papers' printed numbers and claims beside those of railjoule, as they were computed for this release.

They depend only on the core and the assets and take half a minute, so they are shipped; `railjoule validate` computes
them again, and `python -m railjoule.dashboard.renew_papers` renews the file after a change of either.
"""

import hashlib
import json
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

import railjoule.core
from railjoule.core.kernel_cache import source_hash
from railjoule.core.validation import COMPARISONS, Claim, Row, Table, Validation

AUTHORS = {"ftorek": "Ftorek", "liashenko": "Liashenko", "rawicki": "Rawicki", "shtompel": "Shtompel"}
SHIPPED = ("papers", "computed.json")
ASSETS = ("vehicles", "lines", "scenarios", "papers")
"""Folders of the assets whose TOML files the comparisons read; the last has the printed numbers."""


@dataclass(frozen=True, eq=False)
class ShippedTables:
    """Comparisons of all papers that were computed before.

    Parameters
    ----------
    papers : mapping
        By name.
    is_current : bool
        Whether this code has computed it, from these assets.
    """

    papers: dict[str, Validation]
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


def _paper(name: str, kept: dict[str, Any]) -> Validation:
    comparison = COMPARISONS[name]()
    tables = tuple(
        Table(table["title"], tuple(Row(**row) for row in table["rows"]), table["place"], table["reference"])
        for table in kept["tables"]
    )
    claims = tuple(Claim(**claim) for claim in kept["claims"])
    return Validation(name, comparison.citation, tables, comparison.errata, claims)
