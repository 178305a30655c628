"""Computes the papers' comparisons for the file that is shipped: `python -m railjoule.dashboard.renew_papers`."""

import json
from dataclasses import asdict, replace
from importlib.resources import files
from pathlib import Path
from typing import Any

from railjoule.core.validation import COMPARISONS, Table
from railjoule.dashboard.pages.papers.compute import SHIPPED, input_hash

DIGITS = 10
"""Significant digits of our numbers in the file."""


def as_kept(table: Table) -> dict[str, Any]:
    """Return a table as the file has it."""
    rows = tuple(replace(row, value=float(f"{row.value:.{DIGITS}g}")) for row in table.rows)
    return asdict(replace(table, rows=rows))


def computed_papers() -> dict[str, Any]:
    """Compute all papers, and return the content of the file."""
    papers = {}
    for name, compare in COMPARISONS.items():
        validation = compare().validation()
        papers[name] = {
            "tables": [as_kept(table) for table in validation.tables],
            "claims": [asdict(claim) for claim in validation.claims],
        }
    return {"inputs": input_hash(), "papers": papers}


if __name__ == "__main__":
    # an editable install maps each file by a link
    target = Path(str(files("railjoule.assets").joinpath(*SHIPPED))).resolve()
    target.write_text(json.dumps(computed_papers(), indent=1) + "\n", encoding="utf-8")
