"""The result of an import: tables of a scenario file, findings, and contents that are not used."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import tomli_w
from pydantic import BaseModel, ConfigDict

from railjoule.core.scenario._sentences import shown_list

FindingKind = Literal["assumption", "question", "reading", "order", "gap", "overlap"]
"""An assumption that was made, a number in doubt, how a cell was read, rows out of order, stretches
that no row or several rows describe."""


@dataclass(frozen=True)
class OtherUnit:
    """The likely meaning of a number in doubt.

    Parameters
    ----------
    key : str
        The key of the table, with dots.
    factor : float
        Factor on the number.
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
        Its subject.
    sentence : str
        It in words, with the file and the rows.
    rows : tuple of int
        The rows of the file, counted as a spreadsheet does.
    from_m, to_m : float or None
        Its place on the line, in the file's chainage [m].
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
    """The content of files as tables of a scenario file, with findings, and sentences on contents that are not used."""

    source: str
    document: Mapping[str, Any]
    findings: tuple[Finding, ...] = field(default=(), kw_only=True)
    unused: tuple[str, ...] = field(default=(), kw_only=True)

    @property
    def sentences(self) -> tuple[str, ...]:
        """All findings in words, then what was not used."""
        return (*(finding.sentence for finding in self.findings), *self.unused)

    def to_toml(self) -> str:
        """Format the tables as TOML, below the files' names and the assumptions."""
        assumed = [finding.sentence for finding in self.findings if finding.kind == "assumption"]
        comments = [f"# {line}" for line in (f"Imported from {self.source}.", *assumed)]
        # a name of a file may hold a line break, behind which it would be read as TOML
        lines = ["".join(sign if sign.isprintable() else " " for sign in line) for line in comments]
        return "\n".join([*lines, "", tomli_w.dumps(self.document)])


class Foreign(BaseModel):
    """A table of a file that others define; unknown keys are collected, to be listed as not used."""

    # hide_input: `validated` shows it itself, and shortened
    model_config = ConfigDict(frozen=True, extra="allow", hide_input_in_errors=True)


def unknown_keys(table: Foreign, prefix: str = "") -> str:
    """List the keys of a table that are not known here, in a sentence; empty if there are none."""
    names = list(table.model_extra or {})
    return f"{prefix}{shown_list(names, 20)}." if names else ""


@dataclass
class Notes:
    """Findings while a file is read; each sentence begins with `source`."""

    source: str
    findings: list[Finding] = field(default_factory=list)
    unused: list[str] = field(default_factory=list)

    def add(
        self,
        kind: FindingKind,
        sentence: str,
        rows: Sequence[int] = (),
        from_m: float | None = None,
        to_m: float | None = None,
    ) -> None:
        """Add a finding."""
        self.findings.append(Finding(kind, f"{self.source}: {sentence}", tuple(rows), from_m, to_m))

    def add_unused(self, sentence: str) -> None:
        """Add a sentence on contents that are not used; an empty one is ignored."""
        if sentence:
            self.unused.append(f"{self.source}: {sentence}")


def without_name(sentence: str, name: str) -> str:
    """Strip the file from the begin of a sentence, for places that name it already."""
    rest = sentence.removeprefix(f"{name}: ").removeprefix(f"{name}, ")
    return rest[:1].upper() + rest[1:]
