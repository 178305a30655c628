"""Citations of railjoule and of the papers that a run is based on, as BibTeX."""

import tomllib
from collections.abc import Iterable, Mapping
from importlib.metadata import PackageNotFoundError, version
from importlib.resources import files
from typing import Any


def printed_numbers(name: str) -> dict[str, Any]:
    """Return a fresh copy of the content of `assets/papers/<name>.toml`."""
    # printed numbers are data of the assets, with their place in the paper, and never constants of the code
    return tomllib.loads((files("railjoule.assets") / "papers" / f"{name}.toml").read_text(encoding="utf-8"))


def package_version() -> str:
    """Return the installed version of railjoule, or `unknown` for a checkout that is not installed."""
    try:
        return version("railjoule")
    except PackageNotFoundError:
        return "unknown"


def bibtex(papers: Iterable[str]) -> str:
    """Return the BibTeX entries of railjoule and of some papers by their names."""
    entries = [
        _entry(
            "software",
            "railjoule",
            {
                "title": "railjoule: energy-optimal driving of one electric rail vehicle",
                "author": "{The railjoule developers}",
                "version": package_version(),
            },
        )
    ]
    for name in papers:
        about = printed_numbers(name)
        authors = " and ".join(about["authors"])
        fields = {"author": authors} | {key: about[key] for key in ("title", "journal", "year", "doi") if key in about}
        entries.append(_entry("article", name.replace("-", ""), fields))
    return "\n".join(entries)


def _entry(kind: str, key: str, fields: Mapping[str, Any]) -> str:
    lines = "".join(f"  {name} = {{{value}}},\n" for name, value in fields.items())
    return f"@{kind}{{{key},\n{lines}}}"
