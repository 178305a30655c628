"""The papers' printed numbers, read from the assets."""

import tomllib
from importlib.resources import files
from typing import Any

from railjoule.core.validation.table import Erratum


def printed_numbers(name: str) -> dict[str, Any]:
    """Return a fresh copy of what a paper prints, as its file `assets/papers/<name>.toml` has it."""
    # printed numbers are data of the assets, with their place in the paper, and never constants of the code
    return tomllib.loads((files("railjoule.assets") / "papers" / f"{name}.toml").read_text(encoding="utf-8"))


def citation(paper: dict[str, Any]) -> str:
    """Return authors, title, journal and year of a paper in one line."""
    return f"{paper['authors']}: {paper['title']}, {paper['journal']}, {paper['year']}"


def errata(paper: dict[str, Any]) -> tuple[Erratum, ...]:
    """Return what must be corrected in a paper."""
    return tuple(Erratum(**entry) for entry in paper["erratum"])
