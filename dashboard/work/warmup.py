"""Wait until the kernels are compiled, and tell how far that is.

With numba's cache filled that takes a fraction of a second. The very first start takes a minute or more; then the page
shows at each stage what it can, and asks for nothing that would be compiled in its own process.
"""

import logging
import threading
import time
from collections.abc import Callable
from functools import cache
from typing import NamedTuple

from railjoule.dashboard.work.kernel_parts import (
    ALL,
    PARTS,
    PARTS_FIRST,
    begun,
    drive_all,
    drive_fastest,
    drive_optimum,
    first_task,
    is_done,
    progress,
)

LOG = logging.getLogger(__name__)
LOOKS_EVERY_S = 0.2


class Reached(NamedTuple):
    """What can be had without compiling."""

    tasks: bool
    """Shortest times."""
    fastest: bool
    """Fastest runs."""
    first: bool
    """What the first page shows."""
    ready: bool
    """Everything."""


class Warmup:
    """The compilation of all kernels, started once."""

    def __init__(self) -> None:
        self.tasks, self.fastest = threading.Event(), threading.Event()
        self.first, self.ready = threading.Event(), threading.Event()
        self.compiles = False
        """Whether the cache was not filled at the start, so that it takes a minute and not seconds."""
        self._after: list[Callable[[], None]] = []
        # a daemon: a server that is stopped while kernels compile need not wait for them
        self._thread = threading.Thread(target=self._run, name="railjoule-warmup", daemon=True)

    def start(self) -> None:
        """Begin, unless it has begun already."""
        # not `is_alive`: a thread that has ended cannot be started again
        if self._thread.ident is None:
            # before anything is asked of the page
            self.compiles = not is_done(ALL)
            self._thread.start()

    def then(self, act: Callable[[], None]) -> None:
        """Call once when it is done, in its own thread; at once where that has been."""
        self._after.append(act)
        if self.ready.is_set():
            self._call()

    def _call(self) -> None:
        while self._after:
            self._after.pop()()

    def wait(self) -> None:
        """Wait until it is done."""
        self._thread.join()

    def wait_for_tasks(self) -> None:
        """Wait while a task would have to be compiled first."""
        if self.compiles:
            self.tasks.wait()

    @property
    def holds_up_tasks(self) -> bool:
        """Whether a task, and so an edit of a scenario, would have to be compiled first."""
        return self.compiles and not self.tasks.is_set()

    @property
    def holds_up_runs(self) -> bool:
        """Whether the runs of the first page would have to be compiled first."""
        return self.compiles and not self.first.is_set()

    @property
    def reached(self) -> Reached:
        """What can be had by now."""
        return Reached(self.tasks.is_set(), self.fastest.is_set(), self.first.is_set(), self.ready.is_set())

    @property
    def progress(self) -> tuple[int, int]:
        """How many kernels are ready, and about how many there are."""
        return progress()

    def _run(self) -> None:
        helpers = begun() if self.compiles else []

        def wait_for(*parts: str) -> None:
            while not all(map(is_done, parts)) and any(helper.poll() is None for helper in helpers):
                time.sleep(LOOKS_EVERY_S)

        try:
            # each is loaded here, or compiled where the others could not
            wait_for("tasks")
            first_task()
            self.tasks.set()
            wait_for("fastest")
            drive_fastest()
            self.fastest.set()
            wait_for(*PARTS_FIRST)
            drive_optimum()
            self.first.set()
            wait_for(*PARTS)
            drive_all()
        except Exception:
            LOG.exception("the kernels could not be compiled")
        finally:
            for helper in helpers:
                helper.kill()
                helper.wait()
            # after an error too, as pages wait for them: a kernel that is missing is compiled when it is called
            for stage in (self.tasks, self.fastest, self.first, self.ready):
                stage.set()
            self._call()


@cache
def warmup() -> Warmup:
    """Return the warm-up of this process."""
    return Warmup()


if __name__ == "__main__":
    # the gate compiles before its tests: processes that compile the same kernels at once spoil each other's index
    warmup().start()
    warmup().wait()
