"""Texts in TOML from anybody: what would keep the parser busy for long is refused before it begins.

The standard library's parser takes time and memory with the square of the parts of a dotted key.
"""

import re
import tomllib
from typing import Any

from railjoule.core.errors import ScenarioError

# two more than needed, so that a wrong key of ordinary depth is reported as unknown, with a proposal, by the model
MOST_KEY_PARTS = 6
"""The deepest key of a scenario has 4."""
NESTED_TOO_DEEPLY = "not a valid scenario: its tables or lists are nested too deeply."
# All repetitions are possessive (++, *+): they never give back what they took, so that a text built to make the
# expression try all splittings still takes time in proportion to its length.
PART = r"""(?:[A-Za-z0-9_-]++|"(?:[^"\\\n]|\\.)*+"|'[^'\n]*+')"""
CHAIN = re.compile(rf"{PART}(?:[ \t]*+\.[ \t]*+{PART}){{{MOST_KEY_PARTS}}}")
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
        What errors call it.

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
    if not any(line.count(".") >= MOST_KEY_PARTS and CHAIN.search(line) for line in text.split("\n")):
        return
    for token in TOKEN.finditer(text):
        if token["chain"]:
            number = text.count("\n", 0, token.start()) + 1
            raise ScenarioError(
                f"{source}: not a valid scenario: a key in line {number} has more than {MOST_KEY_PARTS} parts with "
                "dots between them."
            )
