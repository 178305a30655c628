"""Files that are there as a whole or not at all: a full disk or a lost process leaves the old one as it was."""

import errno
import os
import secrets
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path


@contextmanager
def written(path: str | Path) -> Iterator[Path]:
    """Yield a place to write to beside a file; its content becomes the file's once all went well.

    Parameters
    ----------
    path : str or Path
        Of the file, new or old; of a link, what it leads to.

    Raises
    ------
    OSError
        If the file cannot be written; what was there before is unchanged then, and nothing lies beside it.
    """
    target, place = _target_and_place(path)
    try:
        yield place
        with place.open("rb+") as file:
            # a name on the disk before its content would be an empty file after a loss of power
            os.fsync(file.fileno())
        with suppress(FileNotFoundError):
            shutil.copymode(target, place)
        place.replace(target)
    finally:
        place.unlink(missing_ok=True)


def require_writable(path: str | Path) -> None:
    """Raise OSError where `written` could not begin: for who computes for long before there is anything to write."""
    _, place = _target_and_place(path)
    place.touch()
    place.unlink()


def _target_and_place(path: str | Path) -> tuple[Path, Path]:
    target = Path(path).resolve()
    if target.is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    # in the same folder, as a move is atomic only within a file system; libraries take the format from the ending
    return target, target.with_name(f".{target.stem[:100]}.{secrets.token_hex(4)}{target.suffix}")


def write_text(path: str | Path, text: str) -> None:
    """Write a text as UTF-8; parameters and errors as `written`."""
    with written(path) as place:
        place.write_text(text, encoding="utf-8")
