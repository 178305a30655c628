"""Files that an import reads: as bytes, as text, as JSON."""

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, NoReturn, overload

from railjoule.core.errors import ScenarioError
from railjoule.core.imports.findings import Finding
from railjoule.core.scenario._sentences import shorten
from railjoule.core.scenario.text_file import read_bytes

# a whole network's speed limits with the shape of each line are about 30 MB
LARGEST_BYTES = 50_000_000
UTF_16_MARKS = (b"\xff\xfe", b"\xfe\xff")


@dataclass(frozen=True)
class SourceFile:
    """A file by its name and what it holds, so that an uploaded one is read like one on disk."""

    name: str
    content: bytes

    @classmethod
    def read(cls, path: str | Path) -> "SourceFile":
        """Read a file of at most 50 MB.

        Raises
        ------
        ScenarioError
            If it is missing or too large.
        """
        path = Path(path)
        return cls(path.name, read_bytes(path, LARGEST_BYTES))


def text_of(source: SourceFile) -> tuple[str, list[Finding]]:
    """Return the text of a file, and how its characters were read where that is in doubt.

    Raises
    ------
    ScenarioError
        If it is larger than 50 MB or no text.
    """
    content = source.content
    if len(content) > LARGEST_BYTES:
        raise ScenarioError(f"{source.name}: larger than the {LARGEST_BYTES / 1e6:g} MB allowed.")
    findings = []
    try:
        text = content.decode("utf-16" if content.startswith(UTF_16_MARKS) else "utf-8-sig")
    except UnicodeDecodeError:
        # what spreadsheet programs of Western Europe write; it has a character for every byte
        text = content.decode("cp1252", errors="replace")
        findings = [Finding("reading", f"{source.name}: not UTF-8, and so read as Windows-1252 (Latin-1).")]
    if "\0" in text:
        raise ScenarioError(f"{source.name}: not a text file: it holds the character NUL.")
    return text, findings


@overload
def json_of(source: SourceFile) -> dict[str, Any]: ...


@overload
def json_of(source: SourceFile, lists: Literal[True]) -> dict[str, Any] | list[Any]: ...


def json_of(source: SourceFile, lists: bool = False) -> dict[str, Any] | list[Any]:
    """Return the table that a JSON file holds, or where lists are taken the list.

    Raises
    ------
    ScenarioError
        If it is no JSON, or holds something else.
    """
    text, _ = text_of(source)
    try:
        value = json.loads(text, parse_constant=_refuse_constant)
    except json.JSONDecodeError as error:
        raise ScenarioError(f"{source.name}: not JSON: {error.msg} in line {error.lineno}.") from None
    except RecursionError:
        raise ScenarioError(f"{source.name}: its lists or tables are nested too deeply.") from None
    except _ConstantError as error:
        raise ScenarioError(f"{source.name}: {error} is not a number that can be used.") from None
    except ValueError:  # of an integer with more than 4300 digits
        raise ScenarioError(f"{source.name}: a number in it has too many digits.") from None
    if not isinstance(value, dict | list if lists else dict):
        raise ScenarioError(f"{source.name}: must be a JSON object, {{...}}.")
    return value


class _ConstantError(Exception):
    """NaN or an infinity in JSON."""


def _refuse_constant(name: str) -> NoReturn:
    raise _ConstantError(name)


def counted(count: int, what: str) -> str:
    """Return '1 row' or '3 rows'."""
    return f"{count} {what}{'' if count == 1 else 's'}"


def shown_list(names: Iterator[str] | list[str], most: int = 8) -> str:
    """Return names with commas between them, of a long list or name the beginning."""
    names = [shorten(name) for name in names]
    more = len(names) - most
    return ", ".join(names[:most]) + (f" and {more} more" if more > 0 else "")
