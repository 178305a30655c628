"""Cache compiled kernels on disk, keyed by the code that they depend on.

Numba itself looks only at the file of a kernel: after a change in another file it would return the old number. Here the
key of a kernel is a hash of the syntax trees of its module and of all modules of the core that this one imports.
Comments and docstrings are not part of the trees, so that a changed comment compiles nothing.
"""

import ast
import hashlib
import json
import logging
import os
import shutil
import sys
import tempfile
from collections.abc import Iterator
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numba
from numba.core.caching import _CacheLocator

LOG = logging.getLogger(__name__)
VARIABLE = "NUMBA_CACHE_DIR"
PACKAGE = "railjoule.core"
CORE = Path(__file__).parent
STORE = "source_trees.json"
"""The file with the hashes of all syntax trees, so that a start parses only the files that have changed."""
COMPLETE = "complete-{}"
"""The file that marks the kernels of one state of the sources as compiled."""
KEPT_VERSIONS = 2
"""The kernels of this many states of a module are kept: a checkout is often switched between two."""
OTHER_LOCATORS = "UserProvidedCacheLocator,InTreeCacheLocator,UserWideCacheLocator,IPythonCacheLocator,ZipCacheLocator"


class Source(NamedTuple):
    """The part of a source file in the key of a kernel."""

    tree: str
    """Hash of its syntax tree without docstrings."""
    imports: tuple[str, ...]
    """Names of the core that it imports, modules among them."""


def cache_root() -> Path:
    """Return a folder for cached files that only this user can write to."""
    variable = "LOCALAPPDATA" if sys.platform == "win32" else "XDG_CACHE_HOME"
    base = os.environ.get(variable)
    return (Path(base) if base else Path.home() / ".cache") / "railjoule"


@cache
def cache_folder() -> Path:
    """Return the folder of the kernels: the user's own choice for numba, or railjoule's cache folder.

    If it cannot be written to, this returns a temporary folder and logs the reason once.
    """
    own = os.environ.get(VARIABLE)
    try:
        folder = Path(own) if own else cache_root() / "kernels"
        folder.mkdir(parents=True, exist_ok=True)
        # a folder may exist and be read-only, or have no room left
        with tempfile.TemporaryFile(dir=folder) as file:
            file.write(b"0" * 4096)
    except (OSError, RuntimeError) as error:
        return _temporary_folder(error)
    return folder


def _temporary_folder(error: Exception) -> Path:
    # compiled code is loaded from the folder, so it must not be one that others may have written to
    folder = Path(tempfile.mkdtemp(prefix="railjoule-"))
    # processes that this one starts share it
    os.environ[VARIABLE] = str(folder)
    LOG.warning("railjoule cannot save its compiled kernels (%s): it compiles for a minute at each start.", error)
    return folder


def source_hash(folder: Path = CORE) -> str:
    """Return 16 hexadecimal digits that change with the code of any Python file below a folder."""
    paths = sorted(folder.rglob("*.py"))
    return _digest("".join(f"{path.relative_to(folder).as_posix()} {_source(path).tree}\n" for path in paths))


@cache
def _own_hash() -> str:
    return source_hash()


def has_all_kernels() -> bool:
    """Return whether all kernels of these sources have been compiled."""
    # without the store nothing has been compiled here, and parsing all files would take a second
    return (cache_folder() / STORE).is_file() and _complete_mark().is_file()


def mark_complete() -> None:
    """Record that all kernels of these sources have been compiled."""
    with suppress(OSError):
        _complete_mark().touch()


def _complete_mark() -> Path:
    return cache_folder() / COMPLETE.format(_digest(f"{_own_hash()} {numba.__version__} {sys.version}"))


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def _parse(data: bytes) -> Source:
    tree = ast.parse(data)
    imports: set[str] = set()
    for node in executed_nodes(tree):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith(PACKAGE):
            imports |= {f"{node.module}", *(f"{node.module}.{name.name}" for name in node.names)}
        elif isinstance(node, ast.Import):
            imports |= {name.name for name in node.names if name.name.startswith(PACKAGE)}
        body = getattr(node, "body", None)
        if isinstance(body, list):
            node.body = [line for line in body if not _is_text(line)]  # type: ignore[attr-defined]
    return Source(_digest(ast.dump(tree)), tuple(sorted(imports)))


def executed_nodes(tree: ast.AST) -> Iterator[ast.AST]:
    """Yield all nodes of a tree but those below `if TYPE_CHECKING`, which never run."""
    yield tree
    for node in ast.iter_child_nodes(tree):
        if not (isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING"):
            yield from executed_nodes(node)


def _is_text(line: ast.stmt) -> bool:
    return isinstance(line, ast.Expr) and isinstance(line.value, ast.Constant) and isinstance(line.value.value, str)


class _Store:
    """Sources by the hash of their bytes, in memory and in a file."""

    def __init__(self, path: Path) -> None:
        self._path, self._known, self._is_changed = path, dict[str, Source](), False
        with suppress(OSError, ValueError, TypeError):
            saved = json.loads(path.read_text())
            self._known = {key: Source(tree, tuple(imports)) for key, (tree, imports) in saved.items()}

    def source(self, data: bytes) -> Source:
        """Return the source of a file with these bytes."""
        key = hashlib.sha256(data).hexdigest()[:32]
        if key not in self._known:
            self._known[key] = _parse(data)
            self._is_changed = True
        return self._known[key]

    def save(self) -> None:
        """Write new sources to the file; a file that cannot be written costs a second at each start."""
        if not self._is_changed:
            return
        self._is_changed = False
        with suppress(OSError), tempfile.NamedTemporaryFile("w", dir=self._path.parent, delete=False) as file:
            json.dump(self._known, file)
            file.close()
            os.replace(file.name, self._path)


@cache
def _store() -> _Store:
    return _Store(cache_folder() / STORE)


@cache
def _source(path: Path) -> Source:
    return _store().source(path.read_bytes())


@cache
def _path(module: str) -> Path | None:
    """Return the file of a module of the core; None for a name within one."""
    parts = module.split(".")[PACKAGE.count(".") + 1 :]
    place = CORE.joinpath(*parts)
    candidates = (place.with_suffix(".py"), place / "__init__.py") if parts else (place / "__init__.py",)
    return next((path for path in candidates if path.is_file()), None)


def module_files(module: str) -> list[Path]:
    """Return the files of a module and of all modules of the core that it imports, directly or not."""
    seen: set[Path] = set()
    due = [_path(module)]
    while due:
        path = due.pop()
        if path is not None and path not in seen:
            seen.add(path)
            due += map(_path, _source(path).imports)
    return sorted(seen)


@cache
def module_hash(module: str) -> str:
    """Return a hash of the code of `module_files`."""
    trees = [f"{path.relative_to(CORE).as_posix()} {_source(path).tree}\n" for path in module_files(module)]
    _store().save()
    return _digest("".join(trees))


class KernelLocator(_CacheLocator):
    """Places the kernels of the core in `cache_folder`; numba takes its own locators for all other functions."""

    def __init__(self, function: Any, file: str) -> None:
        # numba's base class uses the attribute of this name
        self._py_file = file
        self._hash = module_hash(function.__module__)
        self._folder = cache_folder() / function.__module__.removeprefix(f"{PACKAGE}.") / self._hash

    def get_cache_path(self) -> str:
        """Return the folder of a kernel's files."""
        return str(self._folder)

    def get_source_stamp(self) -> str:
        """Return the key without which a kernel's files are out of date."""
        return self._hash

    def get_disambiguator(self) -> str:
        """Return a text that distinguishes kernels of one name in one module: there are none."""
        return ""

    @classmethod
    def from_function(cls, py_func: Any, py_file: str) -> "KernelLocator | None":
        """Return the locator of a kernel of the core, and None for any other function."""
        if not py_func.__module__.startswith(f"{PACKAGE}."):
            return None
        locator = cls(py_func, py_file)
        _make_folder(locator._folder)
        return locator


@cache
def _make_folder(folder: Path) -> None:
    """Make the folder of a module's kernels, and remove those of former versions."""
    with suppress(OSError):
        folder.mkdir(parents=True, exist_ok=True)
        os.utime(folder)
        versions = sorted(folder.parent.iterdir(), key=lambda path: path.stat().st_mtime, reverse=True)
        for old in versions[KEPT_VERSIONS:]:
            shutil.rmtree(old, ignore_errors=True)


def remove_old_formats() -> None:
    """Remove the folders of release 1.0.0, each of which kept the kernels of one state of the sources."""
    for folder in cache_root().glob("numba-*"):
        shutil.rmtree(folder, ignore_errors=True)


def use_kernel_cache() -> None:
    """Let numba place the kernels of the core by `KernelLocator`."""
    config: Any = numba.config
    others = config.CACHE_LOCATOR_CLASSES or OTHER_LOCATORS
    config.CACHE_LOCATOR_CLASSES = f"{__name__}.KernelLocator,{others}"
