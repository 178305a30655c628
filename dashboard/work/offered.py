"""Files that the server has written for one browser, which fetches each of them once."""

import atexit
import secrets
import shutil
import tempfile
import threading
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

MOST = 20
"""So many wait to be fetched; the oldest goes."""


@dataclass(frozen=True)
class OfferedFile:
    """A file, and what it is called where it is saved."""

    path: Path
    name: str

    def drop(self) -> None:
        """Delete it."""
        with suppress(OSError):
            self.path.unlink()


class Offered:
    """The files that wait; nobody can guess the token of another one's."""

    def __init__(self) -> None:
        self._files: dict[str, OfferedFile] = {}
        self._lock = threading.Lock()
        self._folder: str | None = None

    def new_path(self, suffix: str) -> Path:
        """Return where a file is to be written."""
        with self._lock:
            if self._folder is None:
                self._folder = tempfile.mkdtemp(prefix="railjoule-")
                # it goes when the process ends
                atexit.register(shutil.rmtree, self._folder, ignore_errors=True)
            return Path(self._folder) / f"{secrets.token_hex(8)}{suffix}"

    def offer(self, path: Path, name: str) -> str:
        """Return the token under which a file can be fetched."""
        token = secrets.token_urlsafe(24)
        with self._lock:
            self._files[token] = OfferedFile(path, name)
            oldest = [self._files.pop(next(iter(self._files))) for _ in range(len(self._files) - MOST)]
        for file in oldest:
            file.drop()
        return token

    def take(self, token: str) -> OfferedFile | None:
        """Return the file of a token, which no longer waits; None where there is none."""
        with self._lock:
            return self._files.pop(token, None)


OFFERED = Offered()
"""Those of this server."""
