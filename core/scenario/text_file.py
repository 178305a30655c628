"""Text files that a user names, and TOML from anybody: slow input is refused before it is parsed.

The standard library's parser takes time and memory with the square of the parts of a dotted key.
"""

import re
import tomllib
from pathlib import Path
from typing import Any

from railjoule.core.errors import ScenarioError

# the 100,000 sections that a line may have, in lines of 100 characters
MAX_FILE_BYTES = 10_000_000
LONGEST_SHOWN_PATH = 200


def read_text(path: Path) -> str:
    """Return the text of a UTF-8 file of at most 10 MB, with or without a byte order mark.

    Raises
    ------
    ScenarioError
        If the file is missing, too large or no text.
    """
    return decoded(read_bytes(path), path.name)


def read_bytes(path: Path, max_bytes: int = MAX_FILE_BYTES) -> bytes:
    """Read a file of at most `max_bytes`.

    Raises
    ------
    ScenarioError
        If the file is missing or too large.
    """
    try:
        with path.open("rb") as file:
            content = file.read(max_bytes + 1)  # never all of it: a device has no end
    except FileNotFoundError:
        raise ScenarioError(f"{_shown(path)}: there is no such file.") from None
    except OSError as error:
        raise ScenarioError(f"{_shown(path)}: {error.strerror or error}.") from None
    except ValueError:
        raise ScenarioError(f"{_shown(path)!r}: not a valid file name.") from None
    if len(content) > max_bytes:
        raise ScenarioError(f"{path.name}: larger than the {max_bytes / 1e6:g} MB allowed.")
    return content


def decoded(content: bytes, name: str) -> str:
    """Return the text of a file's content; errors as of `read_text`."""
    if len(content) > MAX_FILE_BYTES:
        raise ScenarioError(f"{name}: larger than the {MAX_FILE_BYTES / 1e6:g} MB allowed.")
    try:
        # -sig: spreadsheet programs put a byte order mark first, which would become a part of the first key or column
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise ScenarioError(f"{name}: not UTF-8 text.") from None


def _shown(path: Path) -> str:
    """Return the name of a path, of a very long one its beginning."""
    text = str(path)
    return text if len(text) <= LONGEST_SHOWN_PATH else text[: LONGEST_SHOWN_PATH - 3] + "..."


# two more than needed, so that a wrong key of ordinary depth is reported as unknown, with a proposal, by the model
MAX_KEY_PARTS = 6
"""The deepest key of a scenario has 4."""
NESTED_TOO_DEEPLY = "not a valid scenario: its tables or lists are nested too deeply."
# All repetitions are possessive (++, *+): they never give back what they took, so that a text built to make the
# expression try all splittings still takes time in proportion to its length.
PART = r"""(?:[A-Za-z0-9_-]++|"(?:[^"\\\n]|\\.)*+"|'[^'\n]*+')"""
CHAIN = re.compile(rf"{PART}(?:[ \t]*+\.[ \t]*+{PART}){{{MAX_KEY_PARTS}}}")
TOKEN = re.compile(
    # of several quotes at the end of a long string the last three end it
    r'"""(?:[^"\\]|\\(?s:.)|"(?!""))*+"{3,5}'
    r"|'''(?:[^']|'(?!''))*+'{3,5}"
    rf"|(?P<chain>{CHAIN.pattern})"
    r"""|"(?:[^"\\\n]|\\.)*+"|'[^'\n]*+'|\#[^\n]*+|[A-Za-z0-9_-]++"""
)


class TomlError(ScenarioError):
    """A text that is no TOML."""


def read_toml(text: str, source: str) -> dict[str, Any]:
    """Return the tables of a text.

    Parameters
    ----------
    text : str
        The TOML.
    source : str
        Its name in errors.

    Raises
    ------
    TomlError
        If it is none.
    ScenarioError
        If a key has too many parts, or lists and tables are nested too deeply.
    """
    require_short_keys(text, source)
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise TomlError(f"{source}: not a valid TOML file: {error}.") from None
    except RecursionError:
        raise ScenarioError(f"{source}: {NESTED_TOO_DEEPLY}") from None
    # its int() refuses integers of more than 4300 digits with an error that is no TOMLDecodeError
    except ValueError:  # the one that the standard library's parser lets through
        raise ScenarioError(f"{source}: not a valid TOML file: a number in it has too many digits.") from None


def require_short_keys(text: str, source: str) -> None:
    """Raise ScenarioError if a key or the name of a table has too many parts, wherever it stands but in strings."""
    # nearly every text ends here; only those with many dots in one line are looked at token by token
    if not any(line.count(".") >= MAX_KEY_PARTS and CHAIN.search(line) for line in text.split("\n")):
        return
    for token in TOKEN.finditer(text):
        if token["chain"]:
            number = text.count("\n", 0, token.start()) + 1
            raise ScenarioError(
                f"{source}: not a valid scenario: a key in line {number} has more than {MAX_KEY_PARTS} parts with "
                "dots between them."
            )
