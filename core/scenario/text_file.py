"""Text files that a user names, TOML from anybody, and tables in CSV: sections of a line, efficiency maps.

Slow TOML is refused before it is parsed: the standard library's parser takes time and memory with the square of the
parts of a dotted key.
"""

import csv
import re
import tomllib
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from railjoule.core.errors import ScenarioError
from railjoule.core.scenario._sentences import show, suggestion
from railjoule.core.scenario.drive import MIN_POINTS

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
        raise ScenarioError(f"{path.name}: larger than the {max_bytes / 1e6:g} MB permitted.")
    return content


def decoded(content: bytes, name: str) -> str:
    """Return the text of a file's content; errors as of `read_text`."""
    if len(content) > MAX_FILE_BYTES:
        raise ScenarioError(f"{name}: larger than the {MAX_FILE_BYTES / 1e6:g} MB permitted.")
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


MAP_COLUMNS = ("torque_nm", "speed_rads", "efficiency")
Folder = Path | Callable[[str], str]
"""The files that a scenario names: their folder, or a function that reads the text of one by its name."""


def read_rows(key: str, name: str, folder: Folder | None, columns: Iterable[str]) -> list[dict[str, float]]:
    """Return the rows of a CSV file by column; empty cells are left out.

    Parameters
    ----------
    key : str
        The scenario's key that names the file, such as 'line.file'.
    name : str
        The file, relative to `folder`.
    folder : Path, callable or None
        The files that a scenario may name; None where it may name none.
    columns : iterable of str
        Columns that it may have.

    Raises
    ------
    ScenarioError
        If the file cannot be read, a column is unknown, or a cell is not a number.
    """
    known = tuple(columns)
    # a scenario that came as a text, as on the page, may not name files: they would be the server's
    if folder is None:
        raise ScenarioError(f"{key} = {name!r} can only be read from a scenario file on disk.")
    text = read_text(folder / name) if isinstance(folder, Path) else folder(name)
    try:
        rows = list(csv.reader(text.splitlines()))
    except csv.Error as error:
        raise ScenarioError(f"{key} {name!r}: not a table in CSV: {error}.") from None
    if not rows:
        raise ScenarioError(f"{key} {name!r} is empty.")
    header = [column.strip() for column in rows[0]]
    for column in header:
        if column not in known:
            hint = suggestion(column, known)
            end = "" if hint.endswith("?") else "."
            raise ScenarioError(f"{key} {name!r}: unknown column {show(column)}, {hint}{end}")
    # a row becomes a dictionary, in which the second of two columns of a name would replace the first without a word
    if len(set(header)) < len(header):
        raise ScenarioError(f"{key} {name!r}: a column appears twice.")
    # numbered from 2, as an editor counts the lines of a file with a header; a blank line is an empty row
    return [_row(header, row, f"{key} {name!r}, row {number}") for number, row in enumerate(rows[1:], 2) if row]


def _row(header: list[str], row: list[str], place: str) -> dict[str, float]:
    if len(row) != len(header):
        raise ScenarioError(f"{place}: {len(row)} cells under {len(header)} columns.")
    values = {}
    for column, cell in zip(header, row, strict=True):
        if cell.strip():
            try:
                values[column] = float(cell)
            except ValueError:
                raise ScenarioError(f"{place}: {column} = {show(cell.strip())} must be a number.") from None
    return values


def read_map(name: str, folder: Folder | None) -> list[list[float]]:
    """Read the points of an efficiency map; arguments and errors as in `read_rows`.

    Raises
    ------
    ScenarioError
        If a column is missing, a cell is empty, or there are too few points.
    """
    points = []
    for number, row in enumerate(read_rows("drive.file", name, folder, MAP_COLUMNS), 1):
        missing = [column for column in MAP_COLUMNS if column not in row]
        if missing:
            raise ScenarioError(f"drive.file {name!r}: point {number} has no {missing[0]}.")
        points.append([row[column] for column in MAP_COLUMNS])
    # the model has the same bound, but here the sentence can name the file
    if len(points) < MIN_POINTS:
        raise ScenarioError(f"drive.file {name!r} has {len(points)} of at least {MIN_POINTS} points.")
    return points
