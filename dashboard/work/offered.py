"""Files that the server has written for one browser, which fetches each of them once."""

import atexit
import secrets
import shutil
import tempfile
import threading
from dataclasses import dataclass
from pathlib import Path

MOST = 20
"""So many wait to be fetched; the oldest goes."""


@dataclass(frozen=True)
class OfferedFile:
    """A file that waits to be fetched.

    Parameters
    ----------
    path : Path
    name : str
        Its name where the browser saves it.
    """

    path: Path
    name: str

    def drop(self) -> None:
        """Delete it."""
        self.path.unlink(missing_ok=True)


class Offered:
    """The files that wait, each under a random token."""

    def __init__(self) -> None:
        self._files: dict[str, OfferedFile] = {}
        self._lock = threading.Lock()
        self._folder: Path | None = None

    def new_path(self, suffix: str) -> Path:
        """Return where a file is to be written, in a folder that is deleted when this process ends."""
        with self._lock:
            if self._folder is None:
                self._folder = Path(tempfile.mkdtemp(prefix="railjoule-"))
                atexit.register(shutil.rmtree, self._folder, ignore_errors=True)
            return self._folder / f"{secrets.token_hex(8)}{suffix}"

    def offer(self, path: Path, name: str) -> str:
        """Return the token under which a file of `new_path` can be fetched."""
        token = secrets.token_urlsafe(24)
        with self._lock:
            self._files[token] = OfferedFile(path, Path(name).name)
            oldest = [self._files.pop(old) for old in list(self._files)[:-MOST]]
        for file in oldest:
            file.drop()
        return token

    def take(self, token: str) -> OfferedFile | None:
        """Return the file of a token, which no longer waits; None where there is none."""
        with self._lock:
            return self._files.pop(token, None)


OFFERED = Offered()
"""Those of this server."""
