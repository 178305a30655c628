"""Compile the kernels once a process, and tell how far that is.

With numba's cache filled that takes a fraction of a second. The very first start takes a minute or more, so what the
first page shows is compiled first, and the rest behind it, by other processes: numba compiles with the interpreter's
lock held, and a page whose server compiles would stutter. They leave it in the cache, from which it is taken then.
"""

import contextlib
import logging
import os
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

from numba.core.dispatcher import Dispatcher

from railjoule.core import StrategyRefusedError, compare, load_scenario, solve
from railjoule.core.advice import advise
from railjoule.core.scenario import Scenario, StrategyName
from railjoule.core.simulate.disturbances import simulate_disturbances
from railjoule.core.simulate.field_oriented import current_ripple, simulate_field_oriented
from railjoule.core.simulate.following import simulate_following
from railjoule.core.simulate.regulator import drive_under_limits
from railjoule.core.strategies import prepare_task, run_strategy
from railjoule.core.studies.induction_map import induction_map
from railjoule.core.studies.motor_map import motor_map
from railjoule.core.studies.storage import saving_over_size

LOG = logging.getLogger(__name__)
# as `FIRST_SCENARIO` of state/scenario.py, which brings param: the processes that compile need none of the page
FIRST = "metro-with-limit"
"""The scenario with which a page opens."""
FIRST_KERNELS = 200
"""About how many kernels its runs take: what the progress is measured by."""
FIRST_STRATEGIES: tuple[StrategyName, ...] = ("fastest", "optimal")
"""The fastest run comes first: a page asks for the shortest time while it opens, and waits for what compiles then."""
APART_STRATEGIES: tuple[StrategyName, ...] = ("bellman", "phases", "enoc")
SCENARIOS = ("liashenko-i", "ftorek-300s", "tram-950m")
"""Three small runs that use every kernel but those of maps and regulators."""
METRO = "kharkiv-like-40kmh"
"""A run for the kernels of maps, regulators and storages."""
CLOSED_LOOP = "tram-950m"
"""A short run for those of the closed loop."""
APART = "apart"
"""The part that has least to do with the first page, so that two processes seldom compile the same at once."""
LOOKS_EVERY_S = 1.0
HELPERS_NICENESS = 10
TOLD_DONE = "complete"
"""The file that says, beside the kernels, that all of them are there."""


class Warmup:
    """The compilation of all kernels, started once."""

    def __init__(self) -> None:
        self.first = threading.Event()
        """Set when the first page can compute what it shows, at the latest with `ready`."""
        self.compiles = False
        """Whether the cache is not filled yet, so that it takes a minute and not seconds."""
        self.ready = threading.Event()
        self._thread = threading.Thread(target=self._run, name="railjoule-warmup", daemon=True)

    def start(self) -> None:
        """Begin, unless it has begun already."""
        if self._thread.ident is None:
            self._thread.start()

    def wait(self) -> None:
        """Wait until it is done."""
        self._thread.join()

    def _run(self) -> None:
        self.compiles = not is_filled()
        helpers = begun(APART) if self.compiles else []
        try:
            drive_first()
            self.first.set()
            # behind an open page everything is compiled elsewhere, and taken from the cache here
            helpers += begun() if helpers else []
            for helper in helpers:
                helper.wait()
            drive_all()
        except Exception:
            LOG.exception("the kernels could not be compiled")
        finally:
            for helper in helpers:
                helper.kill()
                helper.wait()
            # after an error too, as pages wait for both: a kernel that is missing is compiled when it is called
            self.first.set()
            self.ready.set()

    @property
    def progress(self) -> tuple[int, int]:
        """How many kernels of the first page are ready, and about how many there are."""
        return min(sum(bool(kernel.signatures) for kernel in all_kernels()), FIRST_KERNELS), FIRST_KERNELS


def marker() -> Path:
    """Return the file that says that all kernels are in the cache."""
    # the folder's name has a hash of the core's sources, so that no mark of former sources is found
    return Path(os.environ["NUMBA_CACHE_DIR"]) / TOLD_DONE


def is_filled() -> bool:
    """Return whether all kernels have been compiled before."""
    return marker().is_file()


def tell_done() -> None:
    """Leave word that all kernels are in the cache, for the next start."""
    try:
        marker().touch()
    except OSError:  # numba has said so already, where its cache cannot be written to
        LOG.info("the compiled kernels could not be kept")


def begun(*parts: str) -> list["subprocess.Popen[bytes]"]:
    """Begin to compile in another process; none where there is one core alone, or no process to be had."""
    if (os.cpu_count() or 1) < 2:
        return []
    command = [sys.executable, "-m", "railjoule.dashboard.work.warmup", *parts, str(os.getpid())]
    quiet: Any = {"stdin": subprocess.DEVNULL, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    try:
        # of a session of its own: Ctrl+C at the server's terminal would make it print where it was
        return [subprocess.Popen(command, start_new_session=True, **quiet)]
    except OSError:
        LOG.warning("no process could be begun that compiles")
        return []


def help_out(parent: int) -> None:
    """Stand back in this process for that of its parent, and end it when that has ended, whichever way."""
    if hasattr(os, "nice"):  # where cores are short, the first page goes first
        os.nice(HELPERS_NICENESS)

    def look() -> None:
        while os.getppid() == parent:
            time.sleep(LOOKS_EVERY_S)
        # `sys.exit` would end this thread alone
        os._exit(0)

    threading.Thread(target=look, daemon=True).start()


def scenarios() -> Iterator[Scenario]:
    """Yield the scenarios whose runs use every kernel."""
    for name in SCENARIOS:
        yield load_scenario(name)


def all_kernels() -> Iterator[Any]:
    """Yield the compiled functions of the core, each once."""
    # a kernel stands in each module that imports it
    seen: set[int] = set()
    # copies of both: while the event loop asks for the progress, another thread imports
    for name, module in list(sys.modules.items()):
        if name.startswith("railjoule.core"):
            for member in list(vars(module).values()):
                if isinstance(member, Dispatcher) and id(member) not in seen:
                    seen.add(id(member))
                    yield member


def drive_first() -> None:
    """Use the kernels of what the first page shows."""
    for name in FIRST_STRATEGIES:
        advise(solve(load_scenario(FIRST), name))


def drive_all() -> None:
    """Use every kernel, and leave word that all are there."""
    for scenario in scenarios():
        for run in compare(scenario)[0]:
            advise(run)
    simulate_following(load_scenario(SCENARIOS[0]))
    simulate_disturbances(load_scenario("tram-950m-stop"))
    drive_the_metro()
    drive_in_closed_loop()
    tell_done()


def drive_apart() -> None:
    """Use the kernels of strategies, regulators and maps, which compile without those of the optimum."""
    for scenario in scenarios():
        task = prepare_task(scenario)
        for name in APART_STRATEGIES:
            # not every scenario suits each of them: it is enough that a kernel runs in one
            with contextlib.suppress(StrategyRefusedError):
                run_strategy(task, name)
    for regulator in ("coast", "literal"):
        drive_under_limits(load_scenario(METRO), [45.0, 30.0], regulator)
    motor_map(load_scenario(METRO))
    induction_map(load_scenario(CLOSED_LOOP))


def drive_the_metro() -> None:
    """Use the kernels of maps, regulators, storages, and of proofs that free switching leaves something to."""
    scenario = load_scenario(METRO)
    solve(scenario, "optimal")
    saving_over_size(solve(scenario), [1.0], 1e3)
    for regulator in ("coast", "literal"):
        drive_under_limits(scenario, [45.0, 30.0], regulator)
    motor_map(scenario)


def drive_in_closed_loop() -> None:
    """Use the kernels of machines under field-oriented control."""
    scenario = load_scenario(CLOSED_LOOP, {"simulation.flux": "least_loss"})
    run = simulate_field_oriented(scenario)
    current_ripple(run, 0.5 * run.planned.travel_time_s)
    induction_map(scenario)


@cache
def warmup() -> Warmup:
    """Return the warm-up of this process."""
    return Warmup()


if __name__ == "__main__":
    words = sys.argv[1:]
    if words and words[-1].isdigit():
        help_out(int(words[-1]))
    (drive_apart if APART in words else drive_all)()
