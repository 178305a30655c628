"""Read text files that a user names, with clear words when it fails."""

from pathlib import Path

from railjoule.core.errors import ScenarioError

# the 100,000 sections that a line may have, in lines of 100 characters
LARGEST_FILE_BYTES = 10_000_000
LONGEST_SHOWN_PATH = 200


def read_text(path: Path) -> str:
    """Return the text of a UTF-8 file of at most 10 MB, with or without a byte order mark.

    Raises
    ------
    ScenarioError
        If the file is missing, too large or no text.
    """
    return decoded(read_bytes(path), path.name)


def read_bytes(path: Path, largest_bytes: int = LARGEST_FILE_BYTES) -> bytes:
    """Return what a file of at most `largest_bytes` holds.

    Raises
    ------
    ScenarioError
        If the file is missing or too large.
    """
    try:
        with path.open("rb") as file:
            content = file.read(largest_bytes + 1)  # never all of it: a device has no end
    except FileNotFoundError:
        raise ScenarioError(f"{_shown(path)}: there is no such file.") from None
    except OSError as error:
        raise ScenarioError(f"{_shown(path)}: {error.strerror or error}.") from None
    except ValueError:
        raise ScenarioError(f"{_shown(path)!r}: not a valid file name.") from None
    if len(content) > largest_bytes:
        raise ScenarioError(f"{path.name}: larger than the {largest_bytes / 1e6:g} MB allowed.")
    return content


def decoded(content: bytes, name: str) -> str:
    """Return the text of a file's content; errors as of `read_text`."""
    if len(content) > LARGEST_FILE_BYTES:
        raise ScenarioError(f"{name}: larger than the {LARGEST_FILE_BYTES / 1e6:g} MB allowed.")
    try:
        # -sig: spreadsheet programs put a byte order mark first, which would become a part of the first key or column
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise ScenarioError(f"{name}: not UTF-8 text.") from None


def _shown(path: Path) -> str:
    """Return the name of a path, of a very long one its beginning."""
    text = str(path)
    return text if len(text) <= LONGEST_SHOWN_PATH else text[: LONGEST_SHOWN_PATH - 3] + "..."
