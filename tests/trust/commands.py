"""Section 4: the command line on a full disk, without a folder, and stopped."""

import os
import resource
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

from tests.trust.rows import Found, Row

LARGEST_BYTES = 20_000
"""More than that no file may have: to a program that is a full disk, without a file system of its own."""
LONGEST_S = 120
OLD = "what was there before\n"


def full_disk() -> None:
    """Let this process, which is about to become the command, write no large file."""
    resource.setrlimit(resource.RLIMIT_FSIZE, (LARGEST_BYTES, LARGEST_BYTES))


def run(
    *words: str, folder: Path, prepare: Callable[[], None] | None = None, before: tuple[str, ...] = ()
) -> subprocess.CompletedProcess[str]:
    """Run a command of railjoule, behind the words of a program that runs it in turn."""
    return subprocess.run(
        [*before, sys.executable, "-m", "railjoule.dashboard", *words],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=LONGEST_S,
        check=False,
        preexec_fn=prepare,
        # a cache that is filled: nothing but the result is written
        env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1"},
    )


def told(done: subprocess.CompletedProcess[str]) -> bool:
    """Return whether a command was refused in one sentence."""
    lines = done.stderr.strip().splitlines()
    return done.returncode == 2 and len(lines) == 1 and "Traceback" not in done.stderr


def on_a_full_disk(words: tuple[str, ...], name: str, old: bool) -> Callable[[], Found]:
    """Return what finds what is left where a result does not fit."""

    def find() -> Found:
        with tempfile.TemporaryDirectory() as place:
            folder = Path(place)
            if old:
                (folder / name).write_text(OLD)
            done = run(*words, name, folder=folder, prepare=full_disk)
            left = {file.name: file.stat().st_size for file in folder.iterdir()}
            kept = left == ({name: len(OLD)} if old else {}) and (not old or (folder / name).read_text() == OLD)
            words_left = "old file as it was" if old else "nothing left"
            return Found(f"rc {done.returncode}, {words_left if kept else left}", told(done) and kept)

    return find


def missing_folder() -> Found:
    """Write into a folder that is not there."""
    with tempfile.TemporaryDirectory() as place:
        done = run("solve", "liashenko-0", "--trajectory", "none/run.csv", folder=Path(place))
        return Found(f"rc {done.returncode}: {done.stderr.strip()[:90]}", told(done))


READ_ONLY = 'mount --bind "$0" "$0" && mount -o remount,bind,ro "$0" && cd "$0" && exec "$@"'
"""Makes a folder read-only, even for root, and runs a command in it; seen by nobody outside its own space of mounts."""


def read_only_folder() -> Found:
    """Write over an old file in a folder that is mounted read-only."""
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        (folder / "t.csv").write_text(OLD)
        alone = ("unshare", "--map-root-user", "--mount", "sh", "-c", READ_ONLY, place)
        done = run(*TABLE, "t.csv", folder=folder, before=alone)
        left = {file.name: file.read_text() for file in folder.iterdir()}
        words = "old file as it was" if left == {"t.csv": OLD} else f"{sorted(left)}"
        is_kept = left == {"t.csv": OLD} and "read-only" in done.stderr.lower()
        return Found(f"rc {done.returncode}, {words}: {done.stderr.strip()[:90]}", told(done) and is_kept)


def no_memory() -> Found:
    """Ask for more cells than anything may have."""
    with tempfile.TemporaryDirectory() as place:
        done = run("solve", "metro-with-limit", "--set", "solver.mesh_m=0.001", folder=Path(place))
        return Found(f"rc {done.returncode}: {done.stderr.strip()[:110]}", told(done))


REPORT, TABLE = ("report", "liashenko-0", "-o"), ("solve", "liashenko-ii", "--trajectory")
ROWS = (
    Row("4", "full disk, report over an old file", "old file gone", on_a_full_disk(REPORT, "r.html", True), False),
    Row("4", "full disk, report to a new file", "61 kB left behind", on_a_full_disk(REPORT, "r.html", False), False),
    Row("4", "full disk, table over an old file", "not tried", on_a_full_disk(TABLE, "t.csv", True)),
    Row("4", "missing folder", "one sentence, rc 2", missing_folder, False),
    Row("4", "folder mounted read-only", "one sentence, rc 2", read_only_folder, False),
    Row("4", "46,000,000 cells", "MemoryError not caught", no_memory, False),
)
