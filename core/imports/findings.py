"""What an import tells of a file: what it made of it, what it noticed, and what it did not use."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

import tomli_w

FindingKind = Literal["assumption", "question", "reading", "order", "gap", "overlap"]
"""An assumption that was made, a number in doubt, how a cell was read, rows out of order, stretches
that no row or several rows describe."""


@dataclass(frozen=True)
class OtherUnit:
    """What a number in doubt may have been meant as.

    Parameters
    ----------
    key : str
        The key of the table, with dots.
    factor : float
        What the number is to be multiplied with.
    given, meant : str
        The number as it stands and as it may be meant, with its unit.
    """

    key: str
    factor: float
    given: str
    meant: str


@dataclass(frozen=True)
class Finding:
    """One thing that the reader of a file should know.

    Parameters
    ----------
    kind : str
        What it is about.
    sentence : str
        It in words, with the file and the rows.
    rows : tuple of int
        The rows of the file, counted as a spreadsheet does.
    from_m, to_m : float or None
        Where on the line it is, in the file's chainage [m].
    other_unit : OtherUnit or None
        Of a question about a number: the answer that is likely.
    """

    kind: FindingKind
    sentence: str
    rows: tuple[int, ...] = ()
    from_m: float | None = None
    to_m: float | None = None
    other_unit: OtherUnit | None = None


@dataclass(frozen=True)
class Imported:
    """What was read from files, as tables of a scenario file.

    Parameters
    ----------
    source : str
        The names of the files.
    document : mapping
        Tables and keys as in a scenario file.
    findings : tuple of Finding
        What the reader should know.
    unused : tuple of str
        What the files hold and the tables do not, each in words.
    """

    source: str
    document: Mapping[str, Any]
    findings: tuple[Finding, ...] = field(default=(), kw_only=True)
    unused: tuple[str, ...] = field(default=(), kw_only=True)

    @property
    def sentences(self) -> tuple[str, ...]:
        """All findings in words, then what was not used."""
        return (*(finding.sentence for finding in self.findings), *self.unused)

    def to_toml(self) -> str:
        """Return the tables as TOML, with the files' names above them and what was assumed."""
        assumed = [finding.sentence for finding in self.findings if finding.kind == "assumption"]
        # a name of a file may hold a line break, behind which it would be read as TOML
        lines = [_printable(f"# {line}") for line in (f"Imported from {self.source}.", *assumed)]
        return "\n".join([*lines, "", tomli_w.dumps(self.document)])


@dataclass
class Notes:
    """What is noticed while a file is read."""

    findings: list[Finding] = field(default_factory=list)
    unused: list[str] = field(default_factory=list)


def without_name(sentence: str, name: str) -> str:
    """Return a sentence without the file that it begins with, for where that is told already."""
    rest = sentence.removeprefix(f"{name}: ").removeprefix(f"{name}, ")
    return rest[:1].upper() + rest[1:]


def _printable(text: str) -> str:
    return "".join(character if character.isprintable() else " " for character in text)
