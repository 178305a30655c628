"""The result of an import: tables of a scenario file, findings, and contents that are not used."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import tomli_w
from pydantic import BaseModel, ConfigDict

from railjoule.core.errors import ChoiceError, ScenarioError
from railjoule.core.scenario._sentences import show, shown_list

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
    stretch_m : tuple of float or None
        The ends of a gap, in the file's chainage [m].
    other_unit : OtherUnit or None
        Of a question about a number: the answer that is likely.
    """

    kind: FindingKind
    sentence: str
    stretch_m: tuple[float, float] | None = None
    other_unit: OtherUnit | None = None


@dataclass(frozen=True)
class FromFile:
    """The content of a file by its name, with findings, and sentences on contents that are not used."""

    source: str
    findings: tuple[Finding, ...] = field(default=(), kw_only=True)
    unused: tuple[str, ...] = field(default=(), kw_only=True)


@dataclass(frozen=True)
class Imported(FromFile):
    """The content of files as tables of a scenario file."""

    document: Mapping[str, Any]

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


@dataclass
class Notes:
    """Findings while a file is read; each sentence begins with `source`."""

    source: str
    findings: list[Finding] = field(default_factory=list)
    unused: list[str] = field(default_factory=list)

    def add(self, kind: FindingKind, sentence: str, stretch_m: tuple[float, float] | None = None) -> None:
        """Add a finding."""
        self.findings.append(Finding(kind, f"{self.source}: {sentence}", stretch_m))

    def add_unused(self, sentence: str) -> None:
        """Add a sentence on contents that are not used; an empty one is ignored."""
        if sentence:
            self.unused.append(f"{self.source}: {sentence}")

    def add_unknown_keys(self, table: Foreign, prefix: str = "") -> None:
        """Add the keys of a table that are not known here, if there are any."""
        if names := list(table.model_extra or {}):
            self.add_unused(f"{prefix}{shown_list(names, 20)}.")

    def version(self, key: str, text: str, known: tuple[str, str]) -> tuple[int, ...]:
        """Return a version from the first to the last that is known; for any other one ask, and return the last."""
        first, last = map(_numbers, known)
        if first <= _numbers(text) <= last:
            return _numbers(text)
        words = f"its {key} is {show(text)}" if text else f"it has no {key}"
        reading = f"what is known of it was read as {known[1]} has it"
        self.add("question", f"{words}, and {' to '.join(known)} are known: {reading}.")
        return last

    def chosen(self, names: Sequence[str], wanted: str | None, what: str) -> int:
        """Return the number of the wanted thing of a file, or of the only one; the others are added as not used.

        Raises
        ------
        ChoiceError
            If there are several and none is wanted.
        ScenarioError
            If there is no such thing.
        """
        if wanted is None and len(names) > 1:
            raise ChoiceError(self.source, what, tuple(names))
        if wanted is not None and wanted not in names:
            raise ScenarioError(f"{self.source}: {what} = {show(wanted)} must be one of {shown_list(list(names))}.")
        index = 0 if wanted is None else names.index(wanted)
        if others := [*names[:index], *names[index + 1 :]]:
            self.add_unused(f"{what}s not read: {shown_list(others)}.")
        return index


def _numbers(version: str) -> tuple[int, ...]:
    """Return the first two numbers of a version; nothing if it has none."""
    found = re.search(r"(\d{1,4})\.(\d{1,4})", version)
    return tuple(map(int, found.groups())) if found else ()


def without_name(sentence: str, name: str) -> str:
    """Strip the file from the begin of a sentence, for places that name it already."""
    rest = sentence.removeprefix(f"{name}: ").removeprefix(f"{name}, ")
    return rest[:1].upper() + rest[1:]
