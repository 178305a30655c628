"""One process of a machine compiles what the others then load."""

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from importlib import import_module
from pathlib import Path
from typing import Any


@contextmanager
def compiling_alone(name: str) -> Iterator[bool]:
    """Hold all other processes of this machine that want the same kernels, and tell whether they are still to be made.

    Parameters
    ----------
    name : str
        Of the set of kernels; those of each version have a folder of their own.

    Yields
    ------
    bool
        Whether nobody on this machine has gone through this block before without an error.
    """
    folder = Path(os.environ["NUMBA_CACHE_DIR"])
    done = folder / f"{name}.compiled"
    if done.exists():
        yield False
        return
    # where nothing can be written each process compiles for itself
    with suppress(OSError):
        folder.mkdir(parents=True, exist_ok=True)
    with _locked(folder / f"{name}.lock"):
        made = done.exists()
        yield not made
        with suppress(OSError):
            done.touch()


@contextmanager
def _locked(path: Path) -> Iterator[None]:
    try:
        # Windows has none
        fcntl: Any = import_module("fcntl")
        file = path.open("w")
    except (ImportError, OSError):
        yield
        return
    # the lock ends with the file, and so with a process that is killed
    with file:
        with suppress(OSError):
            fcntl.flock(file, fcntl.LOCK_EX)
        yield
