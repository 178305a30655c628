"""Files that the server has written for one browser, which fetches each of them once."""

import atexit
import re
import secrets
import shutil
import tempfile
import threading
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

MOST = 20
"""So many of one process wait to be fetched; the oldest goes."""
TOKEN = re.compile(r"[\w-]+")
"""No path leads out of the folder."""
NEW, WAITING, TAKEN = "new", "waiting", "taken"


def new_folder() -> Path:
    """Return a folder for files that wait, which goes when this process ends."""
    folder = tempfile.mkdtemp(prefix="railjoule-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return Path(folder)


@dataclass(frozen=True)
class OfferedFile:
    """A file that somebody fetches, alone in its folder; its name is what it is called where it is saved."""

    path: Path

    @property
    def name(self) -> str:
        """What it is called."""
        return self.path.name

    def drop(self) -> None:
        """Delete it."""
        shutil.rmtree(self.path.parent, ignore_errors=True)


class Offered:
    """The files that wait; nobody can guess the token of another one's.

    They wait in a folder, as the process that is asked for a file need not be the one that has written it.
    """

    def __init__(self) -> None:
        self._tokens: list[str] = []
        self._lock = threading.Lock()
        self._folder: Path | None = None

    def share(self, folder: Path) -> None:
        """Let files wait in a folder that other processes have too, and that one of those deletes."""
        self._folder = folder

    def new_path(self, suffix: str) -> Path:
        """Return where a file is to be written."""
        return self._place(NEW) / f"{secrets.token_hex(8)}{suffix}"

    def offer(self, path: Path, name: str) -> str:
        """Return the token under which a file of `new_path` can be fetched."""
        token = secrets.token_urlsafe(24)
        own = path.with_name(token)
        own.mkdir()
        path.rename(own / Path(name).name)
        # whole at once: another process may look at any time
        own.rename(self._place(WAITING) / token)
        with self._lock:
            self._tokens.append(token)
            oldest, self._tokens = self._tokens[:-MOST], self._tokens[-MOST:]
        for gone in oldest:
            if (file := self.take(gone)) is not None:
                file.drop()
        return token

    def take(self, token: str) -> OfferedFile | None:
        """Return the file of a token, which no longer waits; None where there is none."""
        if not TOKEN.fullmatch(token):
            return None
        taken = self._place(TAKEN) / token
        # of several who ask at the same time, one moves it
        with suppress(OSError):
            (self._place(WAITING) / token).rename(taken)
            (path,) = taken.iterdir()
            return OfferedFile(path)
        return None

    def _place(self, name: str) -> Path:
        with self._lock:
            if self._folder is None:
                self._folder = new_folder()
            place = self._folder / name
            place.mkdir(exist_ok=True)
            return place


OFFERED = Offered()
"""Those of this server."""
