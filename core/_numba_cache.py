"""Keep numba's compiled kernels in a folder that belongs to exactly these sources.

numba looks at a kernel's own file alone: when a helper or a constant in another file is edited,
its cache goes on serving the old number. A folder named by a hash of all sources cannot.
"""

import hashlib
import logging
import os
import sys
import tempfile
from pathlib import Path

LOG = logging.getLogger(__name__)
VARIABLE = "NUMBA_CACHE_DIR"


def source_hash(folder: Path) -> str:
    """Return 16 hexadecimal digits that change with any Python file below `folder`."""
    digest = hashlib.sha256()
    for path in sorted(folder.rglob("*.py")):
        # the name too: a file that moves changes which module a cached kernel belongs to
        digest.update(path.relative_to(folder).as_posix().encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def cache_root() -> Path:
    """Return a folder for railjoule's cached files that can be written to, by this user alone."""
    variable = "LOCALAPPDATA" if sys.platform == "win32" else "XDG_CACHE_HOME"
    base = os.environ.get(variable)
    try:
        root = (Path(base) if base else Path.home() / ".cache") / "railjoule"
        _require_writable(root)
    except (OSError, RuntimeError) as error:
        return _passing_folder(error)
    return root


def _require_writable(folder: Path) -> None:
    """Make a folder, and raise OSError if nothing can be written there: one may exist and yet be read-only."""
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryFile(dir=folder):
        pass


def _passing_folder(error: Exception) -> Path:
    """Return a folder for this process alone, and say why."""
    # compiled code is loaded from there, so it must not be a place where others may have put theirs
    folder = Path(tempfile.mkdtemp(prefix="railjoule-"))
    LOG.warning("railjoule cannot keep its compiled kernels (%s): it compiles for a minute at each start.", error)
    return folder


def select_cache_folder() -> str:
    """Point numba to this version's folder, unless the user has chosen one; return the folder.

    It works before and after numba's first import, as numba reads the variable only once.
    """
    folder = os.environ.get(VARIABLE)
    try:
        # numba would quietly keep its files beside the sources, where an edited helper gives an old number
        if folder:
            _require_writable(Path(folder))
    except OSError as error:
        folder = os.environ[VARIABLE] = str(_passing_folder(error))
    if not folder:
        folder = str(cache_root() / f"numba-{source_hash(Path(__file__).parent)}")
        os.environ[VARIABLE] = folder
    # numba reads the variable at its import alone, so where that came first its own setting is changed
    if "numba" in sys.modules:
        sys.modules["numba"].config.CACHE_DIR = folder
    return folder
