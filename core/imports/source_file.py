"""Files that an import reads: as bytes, as text, as JSON."""

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, NoReturn, overload

from railjoule.core.errors import EncodingError, ScenarioError
from railjoule.core.imports.encoding import decoded
from railjoule.core.imports.findings import Finding
from railjoule.core.scenario._sentences import shorten
from railjoule.core.scenario.text_file import read_bytes

# a whole network's speed limits with the shape of each line are about 30 MB
LARGEST_BYTES = 50_000_000


@dataclass(frozen=True)
class SourceFile:
    """A file by its name and what it holds, so that an uploaded one is read like one on disk.

    Parameters
    ----------
    name : str
        What errors call it.
    content : bytes
        What it holds.
    encoding : str
        Its code page where it is a text that is not UTF-8; empty where that is to be found.
    """

    name: str
    content: bytes
    encoding: str = ""

    @classmethod
    def read(cls, path: str | Path, encoding: str = "") -> "SourceFile":
        """Read a file of at most 50 MB.

        Raises
        ------
        ScenarioError
            If it is missing or too large.
        """
        path = Path(path)
        return cls(path.name, read_bytes(path, LARGEST_BYTES), encoding)


def text_of(source: SourceFile) -> tuple[str, list[Finding]]:
    """Return the text of a file, and how its characters were read where that is in doubt.

    Raises
    ------
    ScenarioError
        If it is larger than 50 MB or no text, or its code page is in doubt.
    """
    content = source.content
    if len(content) > LARGEST_BYTES:
        raise ScenarioError(f"{source.name}: larger than the {LARGEST_BYTES / 1e6:g} MB allowed.")
    text, findings = decoded(source.name, content, source.encoding)
    if "\0" in text:
        raise ScenarioError(f"{source.name}: not a text file: it holds the character NUL.")
    return text, findings


def unicode_text_of(source: SourceFile, form: str) -> str:
    """Return the text of a file in a format that is UTF-8 by definition, or in the code page that the user names.

    Raises
    ------
    ScenarioError
        If it is in neither, larger than 50 MB or no text.
    """
    text, findings = text_of(source)
    if findings:
        raise EncodingError(source.name, f"which {form} is by definition")
    return text


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
    text = unicode_text_of(source, "JSON")
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
