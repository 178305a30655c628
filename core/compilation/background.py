"""Compile all kernels once per machine and version, in helper processes."""

import logging
import os
import queue
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any, Literal, get_args

from tqdm import tqdm

from railjoule.core import kernel_cache
from railjoule.core.compiled import MODE

LOG = logging.getLogger(__name__)
Part = Literal[
    "solver",
    "fastest",
    "proof",
    "limits",
    "bellman",
    "optimum",
    "switching",
    "metro",
    "regulators",
    "closed_loop",
    "simple_advice",
    "following",
    "maps",
    "phases",
    "enoc",
]
"""A part of the kernels. The first ones take longest, and two that share kernels do not follow each other."""
PARTS_IN_ORDER: tuple[Part, ...] = get_args(Part)
KERNEL_LINE, PART_LINE = "kernel", "part"
"""Lines that a helper prints for each kernel and each part that it has compiled."""
HELPER = "railjoule.core.compilation.parts"
"""The module that a helper process runs."""
COMPILING = "railjoule compiles its solver, only this once"
KERNELS = 900
"""About how many kernels there are: the end of the progress bar."""
HELPERS = 2
TRIES = 2
"""A part whose process was killed is compiled again once, and then at its first use."""
LOOKS_EVERY_S = 0.3


class Compilation:
    """The compilation of all kernels, begun at most once a process.

    Attributes
    ----------
    ready : threading.Event
        Set once compiled code is called.
    kernel_count : int
        Kernels compiled so far.
    """

    def __init__(self) -> None:
        self.ready = threading.Event()
        self.kernel_count = 0
        self._begun, self._lock = False, threading.Lock()
        self._then: list[Callable[[], None]] = []

    @property
    def share(self) -> float:
        """About how much of the work is done, from 0 to 1."""
        return min(self.kernel_count / KERNELS, 1.0)

    def begin(self) -> bool:
        """Begin, unless that was done before; return whether this call began it."""
        with self._lock:
            if self._begun:
                return False
            self._begun = True
        # what is computed in the meantime does not wait, however long it takes
        MODE.before_interpreting = lambda: None
        if MODE.is_compiled:
            self._finish()
        else:
            # a daemon: a process that ends while kernels compile does not wait for them
            threading.Thread(target=self._run, name="railjoule-compilation", daemon=True).start()
        return True

    def then(self, act: Callable[[], None]) -> None:
        """Call a function once compiled code is available: immediately, or later in a thread of its own."""
        with self._lock:
            if not self.ready.is_set():
                self._then.append(act)
                return
        act()

    def _finish(self) -> None:
        MODE.is_compiled = True
        with self._lock:
            self.ready.set()
        for act in self._then:
            act()

    def _run(self) -> None:
        try:
            with _exclusive_access() as folder:
                # another process may have compiled them while this one waited
                if not kernel_cache.has_all_kernels() and self._compile_parts():
                    kernel_cache.mark_complete()
                    kernel_cache.remove_old_formats()
            LOG.debug("the kernels are in %s", folder)
        except Exception:
            LOG.exception("the kernels could not be compiled ahead; each is compiled at its first use")
        finally:
            self._finish()

    def _compile_parts(self) -> bool:
        """Return whether all parts have been compiled."""
        due: queue.Queue[tuple[Part, int]] = queue.Queue()
        for part in PARTS_IN_ORDER:
            due.put((part, 1))
        failed: list[str] = []
        count = min(HELPERS, os.cpu_count() or 1)
        threads = [threading.Thread(target=self._feed, args=(due, failed), daemon=True) for _ in range(count)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        if failed:
            # such as on a full disk: what this process compiles itself, it does not save
            MODE.is_saving = False
            LOG.warning("parts of the solver are compiled at their first use, and not saved: %s", ", ".join(failed))
        return not failed

    def _feed(self, due: "queue.Queue[tuple[Part, int]]", failed: list[str]) -> None:
        """Let helper processes, one after the other where one is killed, compile parts until none is left."""
        process = None
        with suppress(queue.Empty):
            while True:
                part, number = due.get_nowait()
                try:
                    process = process or _start_helper()
                    done = self._compile_part(process, part)
                except OSError as error:
                    LOG.warning("no process could be started to compile: %s", error)
                    done = False
                if not done:
                    if process is not None:
                        _close(process)
                    process = None
                    # the other helper may have ended: this thread tries again itself
                    due.put((part, number + 1)) if number < TRIES else failed.append(part)
        if process is not None:
            process.kill()
            _close(process)

    def _compile_part(self, process: "subprocess.Popen[str]", part: str) -> bool:
        """Return whether a helper has compiled a part; False when the helper has ended before."""
        assert process.stdin is not None
        assert process.stdout is not None
        with suppress(BrokenPipeError):
            process.stdin.write(f"{part}\n")
            process.stdin.flush()
        for line in process.stdout:
            if line.strip() == PART_LINE:
                return True
            self.kernel_count += 1
        LOG.warning("the process that compiled %s has ended (exit status %s)", part, process.wait())
        return False


def _start_helper() -> "subprocess.Popen[str]":
    pipes: Any = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.DEVNULL, "text": True}
    # a session of its own: Ctrl+C at the terminal of this process would reach it too
    return subprocess.Popen([sys.executable, "-m", HELPER], start_new_session=True, **pipes)


def _close(process: "subprocess.Popen[str]") -> None:
    """Wait for the end of a helper and close its pipes."""
    for pipe in (process.stdin, process.stdout):
        # the line for a part that the helper did not take is lost with it
        with suppress(OSError):
            if pipe is not None:
                pipe.close()
    process.wait()


@contextmanager
def _exclusive_access() -> Iterator[Path]:
    """Wait while another process of this machine compiles the same kernels."""
    folder = kernel_cache.cache_folder()
    try:
        # Windows has none
        fcntl: Any = import_module("fcntl")
        file = (folder / "compilation.lock").open("w")
    except (ImportError, OSError):
        yield folder
        return
    # the lock ends with the file, and so with a process that is killed
    with file:
        with suppress(OSError):
            fcntl.flock(file, fcntl.LOCK_EX)
        yield folder


@cache
def compilation() -> Compilation:
    """Return the compilation of this process."""
    return Compilation()


def require_compiled() -> None:
    """Wait until compiled code is available; where that takes a minute, print a progress bar to standard error."""
    if MODE.is_compiled:
        return
    one = compilation()
    # a server that has begun it shows the progress on its pages
    if not one.begin():
        one.ready.wait()
        return
    if not sys.stderr.isatty():
        print(f"{COMPILING}; this takes about a minute.", file=sys.stderr)
    # disable=None: no bar where standard error is a file
    with tqdm(total=KERNELS, desc=COMPILING, unit=" kernels", disable=None, leave=False) as bar:
        while not one.ready.wait(LOOKS_EVERY_S):
            bar.update(min(one.kernel_count, KERNELS) - bar.n)
