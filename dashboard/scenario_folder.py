"""One folder of scenario files: list them, read one, write one atomically.

No name leads out of the folder: names have no path, and hidden files and links are left out.
"""

import os
import stat
import sys
import unicodedata
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from railjoule.core.budget import PAGE, within
from railjoule.core.errors import RailjouleError
from railjoule.core.scenario import Scenario, parse_scenario
from railjoule.core.scenario._base import without_misleading
from railjoule.core.scenario._sentences import show
from railjoule.core.scenario.text_file import MAX_FILE_BYTES, decoded
from railjoule.core.written import write_text
from railjoule.dashboard.limits import LONGEST_TEXT

SUFFIX = ".toml"
MOST_LISTED = 200
LONGEST_NAME = 80
SIGNS = " -_()+,&'"
"""Characters of a saved name beside letters and digits."""
RESERVED = {"con", "prn", "aux", "nul", *(f"{port}{number}" for port in ("com", "lpt") for number in range(10))}
"""Names that Windows reserves for devices."""
Stamp = tuple[int, int, int]
"""Time of the last change [ns], size [bytes] and number on the disk of a file."""


class FolderError(RailjouleError):
    """A file of the folder that cannot be read or written."""


class FileExistsInFolderError(FolderError):
    """A file that is replaced only on request."""


@dataclass(frozen=True)
class ListedFile:
    """A scenario file: its name without suffix, its last change, its title, or the reason why it cannot be read."""

    name: str
    stamp: Stamp
    title: str = ""
    refusal: str = ""

    @property
    def changed_s(self) -> float:
        """Time of the last change, in seconds since 1970."""
        return self.stamp[0] / 1e9


@dataclass(frozen=True)
class Listing:
    """The files of a folder by name, and how many more it has than are listed."""

    files: tuple[ListedFile, ...] = ()
    more: int = 0


class ScenarioFolder:
    """A folder of scenario files; it is made when the first one is saved."""

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path).expanduser().resolve()
        self._stamps: dict[str, Stamp] = {}
        self._listing = Listing()

    @property
    def label(self) -> str:
        """The name of the folder, without its path."""
        return _shown(self.path.name)

    def listing(self) -> Listing:
        """Return the scenario files; an unchanged folder is not read again. Raises FolderError if it is unreadable."""
        stamps = self._visible()
        if stamps != self._stamps:
            names = sorted((name for name in stamps if name.endswith(SUFFIX)), key=str.casefold)
            files = tuple(self._listed(name.removesuffix(SUFFIX), stamps[name]) for name in names[:MOST_LISTED])
            self._listing, self._stamps = Listing(files, len(names) - len(files)), stamps
        return self._listing

    def open(self, name: str) -> Scenario:
        """Return the scenario of a file; raises RailjouleError if there is none, or anything in it is wrong."""
        with within(PAGE):
            return parse_scenario(self._read(f"{name}{SUFFIX}", LONGEST_TEXT), name, self._beside)

    def save(self, name: str, text: str, replace: bool = False) -> str:
        """Write a file atomically, and return its name; a file of that name is replaced only on request.

        Raises
        ------
        FileExistsInFolderError
            If there is a file of that name, and it is not to be replaced.
        RailjouleError
            If the name or the text cannot be saved, or the disk refuses.
        """
        name = checked_name(name)
        target = self.path / f"{name}{SUFFIX}"
        if len(text) > LONGEST_TEXT:
            raise FolderError(f"{target.name}: more than the limit of {LONGEST_TEXT / 1e6:g} MB.")
        with _named(f"{target.name} cannot be saved"):
            self.path.mkdir(parents=True, exist_ok=True)
            if target.is_symlink():
                raise FolderError(f"{target.name} is a link, which is not replaced; choose another name.")
            if target.exists() and not replace:
                raise FileExistsInFolderError(f"There is a file {target.name} already.")
            write_text(target, text)
        return name

    def _visible(self) -> dict[str, Stamp]:
        """Return all files but hidden ones and links, by name."""
        with _named("The folder cannot be read"):
            try:
                entries = [entry for entry in os.scandir(self.path) if entry.is_file(follow_symlinks=False)]
                found = {entry.name: entry.stat(follow_symlinks=False) for entry in entries}
            except FileNotFoundError:  # of the folder before the first save, or of a file that went in the meantime
                return {}
        return {
            name: (one.st_mtime_ns, one.st_size, one.st_ino) for name, one in found.items() if not name.startswith(".")
        }

    def _listed(self, name: str, stamp: Stamp) -> ListedFile:
        # an unchanged file is not read again, unless it was refused: a table that it names may have changed
        known = next((file for file in self._listing.files if (file.name, file.stamp) == (name, stamp)), None)
        if known is not None and not known.refusal:
            return known
        if (shown := _shown(name)) != name:
            return ListedFile(shown, stamp, refusal="Its name has characters that cannot be shown.")
        try:
            return ListedFile(name, stamp, self.open(name).title)
        except RailjouleError as refusal:
            return ListedFile(name, stamp, refusal=str(refusal).removeprefix(f"{name}: "))

    def _read(self, file_name: str, most_bytes: int) -> str:
        if file_name not in self._visible():
            raise FolderError(f"{show(file_name)}: there is no such file in the folder.")
        flags = os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
        with _named(f"{file_name} cannot be read"), open(os.open(self.path / file_name, flags), "rb") as file:
            # the name may have become that of a pipe since
            if not stat.S_ISREG(os.fstat(file.fileno()).st_mode):
                raise FolderError(f"{file_name} is not a file.")
            content = file.read(most_bytes + 1)
        if len(content) > most_bytes:
            raise FolderError(f"{file_name}: larger than the limit of {most_bytes / 1e6:g} MB.")
        return decoded(content, file_name)

    def _beside(self, file_name: str) -> str:
        """Return the text of a table that a scenario names."""
        return self._read(file_name, MAX_FILE_BYTES)


def checked_name(text: str) -> str:
    """Return a name that every file system takes; raises FolderError for any other."""
    name = unicodedata.normalize("NFC", text[: 4 * LONGEST_NAME]).strip(" ")
    name = name.removesuffix(SUFFIX)
    if not name:
        raise FolderError("name is empty; it needs at least one letter or digit.")
    if len(text) > LONGEST_NAME:
        raise FolderError(f"name = {show(name)} is too long: {len(text)} characters of at most {LONGEST_NAME}.")
    wrong = next((sign for sign in name if sign not in SIGNS and unicodedata.category(sign)[0] not in "LNM"), None)
    if wrong is not None:
        signs = " ".join(SIGNS.strip())
        raise FolderError(
            f"name = {show(name)} must not have {wrong!r}: letters, digits, spaces and {signs} are permitted."
        )
    if not name[0].isalnum():
        raise FolderError(f"name = {show(name)} must begin with a letter or a digit.")
    if name.casefold() in RESERVED:
        raise FolderError(f"name = {show(name)} must be another one: Windows reserves it for a device.")
    return name


def default_folder() -> Path:
    """Return the folder of scenario files in the user's data directory."""
    if sys.platform == "darwin":
        base = Path.home() / "Library" / "Application Support"
    elif sys.platform == "win32":
        base = Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local")
    else:
        base = Path(os.environ.get("XDG_DATA_HOME") or Path.home() / ".local" / "share")
    return base / "railjoule" / "scenarios"


def _shown(name: str) -> str:
    """Return the name of a file as text: not each is UTF-8, and some characters change how a name reads."""
    return without_misleading(os.fsencode(name).decode("utf-8", "replace"))


@contextmanager
def _named(what: str) -> Iterator[None]:
    """Turn an error of the disk into a sentence."""
    try:
        yield
    except OSError as error:
        raise FolderError(f"{what}: {error.strerror or error}.") from None
