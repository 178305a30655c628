"""A user's own vehicles, lines, scenarios and measured runs: TOML and CSV files in one folder.

    scenarios/NAME.toml   vehicles/NAME.toml   lines/NAME.toml or NAME.csv (its sections)   runs/NAME.csv
    studies/NAME.study

Nothing outside the folder is read or written, whatever a name says. A file is replaced as a whole or not at all, and
what was deleted or replaced lies in `.deleted`, the last hundred of it.
"""

import csv
import itertools
import os
import secrets
import stat
import sys
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, get_args

import tomli_w
from pydantic import ValidationError

from railjoule.core.errors import RailjouleError, ScenarioError
from railjoule.core.scenario import (
    Line,
    Scenario,
    Vehicle,
    format_scenario,
    parse_scenario,
    preset_document,
    preset_names,
)
from railjoule.core.scenario._sentences import sentence_of, show
from railjoule.core.scenario.document import fill_map, fill_sections, merged, whole_line, whole_vehicle
from railjoule.core.scenario.file_names import LONGEST_NAME, checked_name, same_name_key
from railjoule.core.scenario.presets import require_name
from railjoule.core.scenario.sections_csv import read_sections
from railjoule.core.scenario.text_file import LARGEST_FILE_BYTES, decoded
from railjoule.core.scenario.toml_text import read_toml

try:
    import fcntl
except ImportError:  # Windows: two processes that write at the same time are then told apart by their names alone
    fcntl = None  # type: ignore[assignment]

Kind = Literal["scenarios", "vehicles", "lines", "runs"]
KINDS: tuple[Kind, ...] = get_args(Kind)
SUFFIXES: Mapping[Kind, tuple[str, ...]] = {
    "scenarios": (".toml",),
    "vehicles": (".toml",),
    "lines": (".toml", ".csv"),
    "runs": (".csv",),
}
"""Of each kind; a new file has the first one, where its text does not ask for the other."""
WORDS: Mapping[Kind, str] = {"scenarios": "scenario", "vehicles": "vehicle", "lines": "line", "runs": "run"}
VEHICLE_KEYS = set(Vehicle.model_fields) - set(Line.model_fields) | {"drive"}
"""What only a vehicle has; both have a name and a preset."""
STUDIES, STUDY_SUFFIX = "studies", ".study"
"""The folder of kept studies, each a file of `railjoule.core.studies.sweep.SweepFile`."""
MOST_FILES = 1000
"""Of a kind: the page lists them all."""
DELETED, LOCK, TEMPORARY = ".deleted", ".lock", ".new-"
MOST_DELETED = 100
Stamp = tuple[int, int, int]
"""When a file was changed [ns], its size [bytes] and its number on the disk: another content has another one."""


class WorkspaceError(RailjouleError):
    """A file of a workspace that cannot be had, or not be written; the text says why."""


class NameTakenError(WorkspaceError):
    """A name that another file bears already."""


class ChangedMeanwhileError(WorkspaceError):
    """A file that somebody else has changed since it was read."""


@dataclass(frozen=True)
class OwnFile:
    """A file of a workspace, as it was when it was looked at."""

    kind: Kind
    name: str
    suffix: str
    stamp: Stamp

    @property
    def changed_s(self) -> float:
        """When it was last changed, in seconds since 1970."""
        return self.stamp[0] / 1e9


@dataclass(frozen=True)
class Listing:
    """What is in a workspace: its files, and why others in its folders are none of them, by their place."""

    files: tuple[OwnFile, ...] = ()
    left_out: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True)
class Deleted:
    """A file that was deleted, and what it is called until it is taken back."""

    file: OwnFile
    place: str


class Workspace:
    """A folder with files of a user's own; it need not be there before something is saved.

    Parameters
    ----------
    folder : Path
    """

    def __init__(self, folder: str | Path) -> None:
        # resolved once: were the folder itself exchanged for a link later, that would lead out of it
        self.folder = Path(folder).expanduser().resolve()
        self._thread_lock = threading.Lock()

    def __repr__(self) -> str:
        return f"Workspace({str(self.folder)!r})"

    def listing(self) -> Listing:
        """Return all files, by kind and name.

        Raises
        ------
        WorkspaceError
            If a folder cannot be read.
        """
        files: list[OwnFile] = []
        left_out: list[tuple[str, str]] = []
        for kind in KINDS:
            known: dict[str, OwnFile] = {}
            for suffix in SUFFIXES[kind]:
                for name, file, reason in self._look_at(kind, suffix):
                    other = known.get(same_name_key(name))
                    if file is None or other is not None:
                        told = reason or f"{other.name}{other.suffix} has the same name" if other else reason
                        left_out.append((f"{kind}/{name}{suffix}", told))
                    else:
                        known[same_name_key(name)] = file
            files += sorted(known.values(), key=lambda file: same_name_key(file.name))
        return Listing(tuple(files), tuple(left_out))

    def find(self, kind: Kind, name: str) -> OwnFile | None:
        """Return the file of a name, however it is written in capitals; None where there is none."""
        key = same_name_key(name)
        return next(
            (file for file in self.listing().files if file.kind == kind and same_name_key(file.name) == key), None
        )

    # ---- what a scenario may name

    def names(self, kind: Kind) -> tuple[str, ...]:
        """Return the names of all files of a kind, sorted."""
        return tuple(file.name for file in self.listing().files if file.kind == kind)

    def text(self, kind: Kind, name: str) -> str:
        """Return the text of a file.

        Raises
        ------
        ScenarioError
            If it is no text or too large.
        WorkspaceError
            If there is none, or it cannot be read.
        """
        return self.read(self._there(kind, name))[0]

    def document(self, kind: Literal["vehicles", "lines"], name: str) -> dict[str, Any]:
        """Return a vehicle or line as a nested dictionary: checked, with a name, and without `preset` or `file`.

        Raises
        ------
        RailjouleError
            If there is none, or anything is wrong in it.
        """
        file = self._there(kind, name)
        if file.suffix == ".csv":
            document: dict[str, Any] = {"sections": read_sections(f"{name}{file.suffix}", self.beside(kind))}
        else:
            document = read_toml(self.read(file)[0], name)
        return whole_document(kind, document, name, self.beside(kind))

    def beside(self, kind: Kind) -> Callable[[str], str]:
        """Return what reads a file in the folder of a kind, by its full name."""

        def read(file_name: str) -> str:
            # a name with a folder in it, or of what is no file here, is refused before anything is opened
            plain = file_name == Path(file_name).name and "\\" not in file_name and file_name.isprintable()
            if not plain or file_name.startswith("."):
                raise WorkspaceError(f"file = {show(file_name)} must be the name of a file in {kind}.")
            return self._read(kind, self._folder(kind) / file_name)[0]

        return read

    def scenario(self, name: str, changes: Mapping[str, Any] | None = None) -> Scenario:
        """Return a scenario, whole: what becomes of the files later does not change it.

        Raises
        ------
        RailjouleError
            If there is none, or anything is wrong in it.
        """
        return parse_scenario(self.text("scenarios", name), name, self.beside("scenarios"), changes, self)

    # ---- files

    def read(self, file: OwnFile) -> tuple[str, Stamp]:
        """Return the text of a file, and its stamp.

        Raises
        ------
        RailjouleError
            If it is not there any more, no text, or too large.
        """
        return self._read(file.kind, self._path(file))

    def save(self, kind: Kind, name: str, text: str, replaces: Stamp | None = None, suffix: str = "") -> OwnFile:
        """Write a file as a whole, or leave everything as it was.

        Parameters
        ----------
        kind, name, text : str
        replaces : Stamp, optional
            That of the file of this name which is to be replaced; without it the name must be new.
        suffix : str, optional
            Of a new file, one of the kind's; by default the first.

        Raises
        ------
        NameTakenError, ChangedMeanwhileError
            If there is a file of that name, or it is another one by now.
        RailjouleError
            If the name or the text cannot be saved, or the disk refuses.
        """
        name = self._new_name(kind, name)
        content = _content(name, text)
        with self._alone(kind, name):
            other = self.find(kind, name)
            if other is not None and replaces is None:
                raise NameTakenError(f"There is a {WORDS[kind]} {other.name!r} already.")
            if replaces is not None and (other is None or other.stamp != replaces):
                raise ChangedMeanwhileError(
                    f"{name} {'was changed' if other else 'is no longer'} in its folder since it was opened."
                )
            if other is None and sum(file.kind == kind for file in self.listing().files) >= MOST_FILES:
                raise WorkspaceError(f"{name}: there are {MOST_FILES} {kind} already, as many as there may be.")
            target = self._path(other) if other else self._folder(kind) / f"{name}{suffix or SUFFIXES[kind][0]}"
            self._write(target, content, other)
            return self._stamped(kind, target)

    def rename(self, file: OwnFile, name: str) -> OwnFile:
        """Give a file another name.

        Raises
        ------
        NameTakenError
            If another file bears it.
        RailjouleError
            If it is no name, or the file is not there any more.
        """
        name = self._new_name(file.kind, name)
        with self._alone(file.kind, file.name):
            other = self.find(file.kind, name)
            if other is not None and same_name_key(file.name) != same_name_key(name):
                raise NameTakenError(f"There is a {WORDS[file.kind]} {other.name!r} already.")
            target = self._path(file).with_name(f"{name}{file.suffix}")
            # where capitals make no other name, the file itself is what is there
            if other is None:
                _put_where_nothing_is(self._path(file), target)
            else:
                self._path(file).rename(target)
            return self._stamped(file.kind, target)

    def duplicate(self, file: OwnFile) -> OwnFile:
        """Copy a file, comments included, under a name of its own; errors as of `save`."""
        text, _ = self.read(file)
        return self.save(file.kind, self._free_name(file.kind, f"{file.name} copy"), text, suffix=file.suffix)

    def delete(self, file: OwnFile) -> Deleted:
        """Put a file away; `restore` takes it back.

        Raises
        ------
        WorkspaceError
            If it is not there any more, or the disk refuses.
        """
        with self._alone(file.kind, file.name):
            place = self._deleted_folder() / f"{file.kind}-{secrets.token_hex(4)}-{file.name}{file.suffix}"
            self._path(file).rename(place)
            self._forget_oldest()
        return Deleted(file, place.name)

    def restore(self, deleted: Deleted) -> OwnFile:
        """Take back a file that was deleted, under another name where its own was given away; errors as of `delete`."""
        file = deleted.file
        with self._alone(file.kind, file.name):
            name = file.name if self.find(file.kind, file.name) is None else self._free_name(file.kind, file.name)
            target = self._folder(file.kind) / f"{name}{file.suffix}"
            _put_where_nothing_is(self._deleted_folder() / deleted.place, target)
            return self._stamped(file.kind, target)

    # ---- studies, which are no text and of any size

    def studies(self) -> tuple[str, ...]:
        """Return the names of all kept studies, sorted; raises WorkspaceError if their folder cannot be read."""
        with _told(f"{STUDIES} cannot be read"):
            try:
                entries = [entry for entry in os.scandir(self._folder(STUDIES)) if entry.is_file(follow_symlinks=False)]
            except FileNotFoundError:
                return ()
        names = [entry.name.removesuffix(STUDY_SUFFIX) for entry in entries if entry.name.endswith(STUDY_SUFFIX)]
        return tuple(sorted((name for name in names if not name.startswith(".")), key=same_name_key)[:MOST_FILES])

    def study_path(self, name: str) -> Path:
        """Return where the study of a name is kept.

        Raises
        ------
        RailjouleError
            If it is no name, or the folder cannot be made.
        """
        name = checked_name(name)
        with _told(f"{STUDIES} cannot be made"):
            return self._folder(STUDIES, make=True) / f"{name}{STUDY_SUFFIX}"

    def delete_study(self, name: str) -> None:
        """Put a kept study away among the deleted files; raises RailjouleError if there is none, or it cannot be."""
        path = self.study_path(name)
        with self._thread_lock, _told(f"{name}: nothing was changed in {STUDIES}"):
            path.rename(self._deleted_folder() / f"{STUDIES}-{secrets.token_hex(4)}-{path.name}")
            self._forget_oldest()

    # ---- within

    def _there(self, kind: Kind, name: str) -> OwnFile:
        require_name(kind, name, self.names(kind))  # type: ignore[arg-type]
        return next(file for file in self.listing().files if (file.kind, file.name) == (kind, name))

    def _new_name(self, kind: Kind, text: str) -> str:
        name = checked_name(text)
        shipped = () if kind == "runs" else preset_names(kind)
        # a shipped name means the same on every machine, so that it cannot be given to something else
        if same_name_key(name) in map(same_name_key, shipped):
            raise NameTakenError(f"name = {show(name)} is that of a shipped {WORDS[kind]}; choose another one.")
        return name

    def _free_name(self, kind: Kind, name: str) -> str:
        known = {same_name_key(other) for other in self.names(kind)}
        tries = (f"{name[: LONGEST_NAME - 5].rstrip()} {number}" for number in itertools.count(2))
        first = name[:LONGEST_NAME].rstrip()
        return next(one for one in itertools.chain([first], tries) if same_name_key(one) not in known)

    def _folder(self, kind: str | None, make: bool = False) -> Path:
        """Return the folder of a kind, which lies within the workspace; without a kind that of the deleted files."""
        path = self.folder / (kind or DELETED)
        if make:
            path.mkdir(parents=True, exist_ok=True)
        if path.is_symlink() or path.resolve() != path:
            raise WorkspaceError(f"{path.name} is a link, which is not followed.")
        return path

    def _deleted_folder(self) -> Path:
        return self._folder(None, make=True)

    def _path(self, file: OwnFile) -> Path:
        # whoever made the value: what lies in the workspace has such a name
        if checked_name(file.name) != file.name or file.suffix not in SUFFIXES[file.kind]:
            raise WorkspaceError(f"{show(file.name + file.suffix)} is no file of a workspace.")
        return self._folder(file.kind) / f"{file.name}{file.suffix}"

    def _stamped(self, kind: Kind, path: Path) -> OwnFile:
        return OwnFile(kind, path.stem, path.suffix, _stamp(path.lstat()))

    def _look_at(self, kind: Kind, suffix: str) -> Iterator[tuple[str, OwnFile | None, str]]:
        """Yield name, file and why it is none, for all that lies in the folder of a kind and has its suffix."""
        count = 0
        shipped = {same_name_key(name) for name in (() if kind == "runs" else preset_names(kind))}
        with _told(f"{kind} cannot be read"):
            try:
                entries = sorted(os.scandir(self._folder(kind)), key=lambda entry: entry.name)
            except FileNotFoundError:
                return
        for entry in entries:
            if not entry.name.endswith(suffix) or entry.name.startswith("."):
                continue
            name, file, reason = entry.name.removesuffix(suffix), None, ""
            try:
                if checked_name(name) != name:
                    reason = "its name has spaces around it, or accents that stand by themselves"
                elif entry.is_symlink():
                    reason = "it is a link, which is not followed"
                elif same_name_key(name) in shipped:
                    reason = f"a shipped {WORDS[kind]} has this name"
                elif count >= MOST_FILES:
                    reason = f"there are more than {MOST_FILES}"
                elif entry.is_file(follow_symlinks=False):
                    file, count = OwnFile(kind, name, suffix, _stamp(entry.stat(follow_symlinks=False))), count + 1
                else:
                    reason = "it is no file"
            except ScenarioError as refusal:
                reason = str(refusal).rstrip(".")
            except OSError:  # it went while it was looked at
                continue
            yield name, file, reason

    def _read(self, kind: Kind, path: Path) -> tuple[str, Stamp]:
        flags = os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
        # without following a link, and without waiting for whoever writes to a pipe
        with _told(f"{path.name} in {kind} cannot be read"), open(os.open(path, flags), "rb") as file:
            found = os.fstat(file.fileno())
            if path.is_symlink() or not stat.S_ISREG(found.st_mode):
                raise WorkspaceError(f"{path.name} in {kind} is no file.")
            content = file.read(LARGEST_FILE_BYTES + 1)
        return decoded(content, path.name), _stamp(found)

    def _write(self, target: Path, content: bytes, replaced: OwnFile | None) -> None:
        """Put a content in the place of a file: it is there as a whole, on the disk, before it has the name."""
        folder = self._folder(target.parent.name, make=True)
        temporary = folder / f"{TEMPORARY}{secrets.token_hex(8)}"
        try:
            with temporary.open("xb") as file:
                file.write(content)
                file.flush()
                os.fsync(file.fileno())
            if replaced is None:
                _put_where_nothing_is(temporary, target)
            else:
                self._keep(target, replaced)
                temporary.replace(target)
        finally:
            with suppress(OSError):
                temporary.unlink()
        _settle(folder)

    def _keep(self, path: Path, file: OwnFile) -> None:
        """Keep what is about to be replaced among the deleted files."""
        place = self._deleted_folder() / f"{file.kind}-{secrets.token_hex(4)}-{file.name}{file.suffix}"
        try:
            os.link(path, place)
        except OSError:  # a file system without hard links
            place.write_bytes(path.read_bytes())
        self._forget_oldest()

    def _forget_oldest(self) -> None:
        kept = [(entry.stat(follow_symlinks=False).st_ctime_ns, entry.path) for entry in os.scandir(self._folder(None))]
        for _, path in sorted(kept)[:-MOST_DELETED]:
            with suppress(OSError):
                os.unlink(path)

    @contextmanager
    def _alone(self, kind: Kind, name: str) -> Iterator[None]:
        """Let nobody else of this program change the workspace, and tell what the disk refuses."""
        with self._thread_lock, _told(f"{name}: nothing was changed in {kind}"):
            self._folder(kind, make=True)
            flags = os.O_CREAT | os.O_RDWR | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)
            with open(os.open(self.folder / LOCK, flags, 0o666), "rb") as lock:
                if fcntl is not None:
                    # a network's file system may know no locks
                    with suppress(OSError):
                        fcntl.flock(lock, fcntl.LOCK_EX)
                yield


def whole_document(
    kind: Literal["vehicles", "lines"], document: dict[str, Any], name: str, beside: Callable[[str], str] | None = None
) -> dict[str, Any]:
    """Return the document of a vehicle or line with what it names filled in, once it is checked.

    Parameters
    ----------
    kind : str
    document : dict
        As its file has it; `preset` may name a shipped one on which it is based.
    name : str
        That of its file: its own, where it says no other.
    beside : callable, optional
        Reads a CSV file that it names.

    Raises
    ------
    ScenarioError
        If anything is wrong in it.
    """
    try:
        base = document.pop("preset", None)
        if base is not None:
            require_name(kind, str(base), preset_names(kind))
            document = merged(preset_document(kind, base), document)
        if kind == "lines":
            fill_sections(document, beside)
        elif isinstance(document.get("drive"), dict):
            fill_map(document["drive"], beside)
    except ScenarioError as error:
        raise ScenarioError(f"{name}: {error}") from None
    document["name"] = document.get("name") or name
    model = Vehicle if kind == "vehicles" else Line
    try:
        model.model_validate(document)
    except ValidationError as error:
        raise ScenarioError(sentence_of(error, model, name)) from None
    return document


def text_of(kind: Kind, scenario: Scenario, own: Workspace | None = None) -> str:
    """Return the file of a scenario, or of its vehicle or line as a whole; with `own` it names own presets."""
    if kind == "scenarios":
        return format_scenario(scenario, own)
    return tomli_w.dumps(whole_vehicle(scenario.vehicle) if kind == "vehicles" else whole_line(scenario.line))


def kind_of(file_name: str, text: str, own: Workspace | None = None) -> tuple[Kind, str]:
    """Return what a file is, and its suffix, once it is checked.

    Parameters
    ----------
    file_name : str
        Its name, with a suffix.
    text : str
    own : Workspace, optional
        What it may name beside shipped presets.

    Raises
    ------
    RailjouleError
        If it is nothing that a workspace holds, or anything is wrong in it.
    """
    suffix = Path(file_name).suffix.lower()
    if suffix == ".csv":
        return _kind_of_table(file_name, text), suffix
    if suffix != ".toml":
        raise WorkspaceError(f"{show(file_name)}: only .toml and .csv files can be added.")
    document = read_toml(text, file_name)
    if "vehicle" in document or "line" in document or "timetable" in document:
        parse_scenario(text, file_name, None if own is None else own.beside("scenarios"), own=own)
        return "scenarios", suffix
    kind: Literal["vehicles", "lines"] = "vehicles" if VEHICLE_KEYS & set(document) else "lines"
    whole_document(kind, document, Path(file_name).stem, None if own is None else own.beside(kind))
    return kind, suffix


def _kind_of_table(file_name: str, text: str) -> Kind:
    """Tell a line's sections from a run, which is any table of at least two columns of numbers and two rows."""
    try:
        lines = text.splitlines()
        # a decimal comma stands in files with semicolons or tabs alone
        separator = max(",;\t", key=lines[0].count) if lines else ","
        rows = [row for row in csv.reader(lines, delimiter=separator) if row]
    except csv.Error as error:
        raise WorkspaceError(f"{show(file_name)}: not a table in CSV: {error}.") from None
    header = [column.strip() for column in rows[0]] if rows else []
    if "length_m" in header:
        read_sections(file_name, lambda _: text)
        return "lines"
    numbers = sum(_is_number(cell if separator == "," else cell.replace(",", ".")) for row in rows[1:3] for cell in row)
    if len(header) < 2 or len(rows) < 3 or numbers < 4 or any(len(row) != len(header) for row in rows):
        raise WorkspaceError(
            f"{show(file_name)}: neither a line's sections, with a column length_m, nor a run: a row of names, and at "
            "least two rows of numbers below it, separated by commas, semicolons or tabs."
        )
    return "runs"


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def default_folder() -> Path:
    """Return where a user's own files are kept, as the platform has it."""
    if sys.platform == "win32":
        base = os.environ.get("LOCALAPPDATA")
        return Path(base or Path.home() / "AppData" / "Local") / "railjoule"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Application Support" / "railjoule"
    base = os.environ.get("XDG_DATA_HOME")
    return Path(base or Path.home() / ".local" / "share") / "railjoule"


def _content(name: str, text: str) -> bytes:
    try:
        content = text.encode("utf-8")
    except UnicodeEncodeError:
        raise WorkspaceError(f"{name}: its text is not UTF-8.") from None
    if len(content) > LARGEST_FILE_BYTES:
        raise WorkspaceError(
            f"{name}: {len(content) / 1e6:.1f} MB are more than the {LARGEST_FILE_BYTES / 1e6:g} MB allowed."
        )
    return content


def _put_where_nothing_is(path: Path, target: Path) -> None:
    """Move a file to a place that nothing has, not even what this program does not list."""
    try:
        os.link(path, target)
    except FileExistsError:
        raise NameTakenError(f"There is a file {target.name} in {target.parent.name} already.") from None
    except OSError as error:  # a file system without hard links; or there is nothing to move
        if os.path.lexists(target):
            raise NameTakenError(f"There is a file {target.name} in {target.parent.name} already.") from error
        path.rename(target)
    else:
        path.unlink()


def _stamp(found: os.stat_result) -> Stamp:
    return found.st_mtime_ns, found.st_size, found.st_ino


def _settle(folder: Path) -> None:
    """Have the disk know the names in a folder; without that a file could be lost with the power."""
    with suppress(OSError):  # Windows opens no folders
        number = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(number)
        finally:
            os.close(number)


@contextmanager
def _told(what: str) -> Iterator[None]:
    """Turn what the disk refuses into a sentence."""
    try:
        yield
    except OSError as error:
        raise WorkspaceError(f"{what}: {error.strerror or error}.") from None
