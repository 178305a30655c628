"""The parts in which the kernels are compiled, and the processes that compile them on the very first start.

Numba compiles with the interpreter's lock held: a page whose server compiles would stutter. So where the cache is empty
two other processes compile, each some of the parts, in the order in which the page needs them. They leave the kernels
in numba's cache, and beside them a file for each part that is done.
"""

import contextlib
import hashlib
import logging
import os
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np
from numba.core.dispatcher import Dispatcher

from railjoule.core import StrategyRefusedError, load_scenario, solve
from railjoule.core.advice import advise
from railjoule.core.bounds.minimum import FREE_CENTRING, TOLERANCE
from railjoule.core.compiled import specialisations
from railjoule.core.interior_point.proof import prove
from railjoule.core.interior_point.solver import Optimum, minimise_energy
from railjoule.core.motion import build_course
from railjoule.core.scenario import Scenario, StrategyName
from railjoule.core.simulate.disturbances import simulate_disturbances
from railjoule.core.simulate.field_oriented import current_ripple, simulate_field_oriented
from railjoule.core.simulate.following import simulate_following
from railjoule.core.simulate.regulator import drive_under_limits
from railjoule.core.strategies import STRATEGIES, Task, prepare_task, run_strategy
from railjoule.core.studies.induction_map import induction_map
from railjoule.core.studies.motor_map import motor_map
from railjoule.core.studies.storage import saving_over_size

LOG = logging.getLogger(__name__)
# as `FIRST_SCENARIO` of state/scenario.py, which brings param: the processes that compile need none of the page
FIRST = "metro-with-limit"
"""The scenario with which a page opens."""
FIRST_STRATEGIES: tuple[StrategyName, ...] = ("fastest", "optimal")
"""What it shows of it."""
SCENARIOS = ("liashenko-i", "ftorek-300s", "tram-950m")
"""Three small runs that use every kernel but those of maps and regulators."""
METRO = "kharkiv-like-40kmh"
"""A run for the kernels of maps, regulators and storages."""
COARSE_MESH_M = 30.0
"""Of runs that are there for their kernels alone, in half the time; coarser ones leave kernels of switching unused."""
CLOSED_LOOP = "tram-950m"
"""A short run for those of the closed loop."""
PARTS_FIRST = ("tasks", "fastest", "advice", "solver", "proof", "optimum")
"""What the first page needs."""
SHARES = (
    ("solver", "optimum", "switching", "metro"),
    (
        *("tasks", "fastest", "advice", "proof", "bellman", "phases", "enoc", "limits", "regulators", "maps"),
        *("following", "closed_loop", "simple_advice"),
    ),
)
"""What each of two processes compiles: about half, and what one of them has compiled the other seldom needs before."""
KERNELS = 400
"""About how many kernels there are: what the progress is measured by."""
LOOKS_EVERY_S = 1.0
HELPERS_NICENESS = 10
DONE = "{}-{}.done"
"""The file that says, beside the kernels, that those of a part are there, for the sources of one place."""
ALL = "all"


def coarse(name: str) -> Scenario:
    """Return a shipped scenario with a coarse mesh."""
    return load_scenario(name, {"solver.mesh_m": COARSE_MESH_M})


@cache
def first_task() -> Task:
    """Return the task with which a page opens."""
    return prepare_task(load_scenario(FIRST))


def drive_fastest() -> None:
    """Use the kernels of a run and its energy."""
    run_strategy(first_task(), "fastest")


def drive_advice() -> None:
    """Use the kernels of phases and advice."""
    advise(run_strategy(first_task(), "fastest"))


def drive_solver() -> None:
    """Use the kernels of the interior point without those that are called before it: it has no steps to do."""
    course = build_course(load_scenario(FIRST)).data
    minimise_energy(course, course.largest_speed2, 1.0, 2.0, TOLERANCE, 0, FREE_CENTRING, False, False)


def drive_proof() -> None:
    """Use the kernels of the first proof without those of the interior point, of whose result they take the form."""
    task = first_task()
    course, cells = task.course.data, task.course.cell_count
    prices, speed2 = np.ones(cells), task.greatest_speed2
    guess = Optimum(speed2, prices, prices, np.ones((12, cells)), prices, 1.0, 1.0, 1.0, 0, 0)
    prove(course, guess, speed2, task.running_time_s, TOLERANCE, 0)


def drive_optimum() -> None:
    """Use all that the first page shows."""
    for name in FIRST_STRATEGIES:
        advise(solve(load_scenario(FIRST), name))


def drive_strategy(name: StrategyName) -> None:
    """Use the kernels of a strategy."""
    # dynamic programming needs no mesh as fine as theirs to use its kernels
    read = coarse if name == "bellman" else load_scenario
    for scenario in SCENARIOS:
        # not every scenario suits each of them: it is enough that a kernel runs in one
        with contextlib.suppress(StrategyRefusedError):
            advise(run_strategy(prepare_task(read(scenario)), name))


def drive_following() -> None:
    """Use the kernels of runs that meet other conditions than the planned ones."""
    simulate_following(load_scenario(SCENARIOS[0]))
    simulate_disturbances(load_scenario("tram-950m-stop"))


def drive_metro() -> None:
    """Use the kernels of storages, and of proofs that free switching leaves something to."""
    scenario = coarse(METRO)
    solve(scenario, "optimal")
    saving_over_size(solve(scenario), [1.0], 1e3)


def drive_regulators() -> None:
    """Use the kernels of the regulators of speed limits."""
    for regulator in ("coast", "literal"):
        drive_under_limits(coarse(METRO), [45.0, 30.0], regulator)


def drive_maps() -> None:
    """Use the kernels of the maps of machines."""
    motor_map(load_scenario(METRO))
    induction_map(load_scenario(CLOSED_LOOP))


def drive_closed_loop() -> None:
    """Use the kernels of machines under field-oriented control."""
    run = simulate_field_oriented(load_scenario(CLOSED_LOOP, {"simulation.flux": "least_loss"}))
    current_ripple(run, 0.5 * run.planned.travel_time_s)


def drive_simple_advice() -> None:
    """Use the kernels of runs with few changes of regime."""
    # no page needs it until it is asked for
    from railjoule.core.studies.simple_advice import FEWEST_CHANGES, simple_advice  # noqa: PLC0415

    simple_advice(first_task(), FEWEST_CHANGES)


PARTS: Mapping[str, Callable[[], object]] = {
    "tasks": first_task,
    "fastest": drive_fastest,
    "advice": drive_advice,
    "solver": drive_solver,
    "proof": drive_proof,
    "optimum": drive_optimum,
    "switching": partial(drive_strategy, "optimal"),
    "bellman": partial(drive_strategy, "bellman"),
    "phases": partial(drive_strategy, "phases"),
    "enoc": partial(drive_strategy, "enoc"),
    "limits": partial(drive_strategy, "speed_limits"),
    "following": drive_following,
    "metro": drive_metro,
    "regulators": drive_regulators,
    "maps": drive_maps,
    "closed_loop": drive_closed_loop,
    "simple_advice": drive_simple_advice,
}


def drive_all() -> None:
    """Use every kernel, and leave word that all are there."""
    for name in STRATEGIES:
        drive_strategy(name)
    for part in ("following", "metro", "regulators", "maps", "closed_loop", "simple_advice"):
        PARTS[part]()
    tell_done(ALL)


def cache_folder() -> Path:
    """Return the folder of the compiled kernels."""
    return Path(os.environ["NUMBA_CACHE_DIR"])


def mark_of(part: str) -> Path:
    """Return the file that says that the kernels of a part are there."""
    # The folder's name has a hash of the core's sources, so that no mark of former sources is found. Numba keeps the
    # kernels by the path of their source too: a second copy of the same sources has to compile its own.
    place = hashlib.sha256(os.fsencode(Path(__file__).parent)).hexdigest()[:12]
    return cache_folder() / DONE.format(part, place)


def is_done(part: str) -> bool:
    """Return whether the kernels of a part have been compiled before."""
    return mark_of(part).is_file()


def tell_done(part: str) -> None:
    """Leave word that the kernels of a part are in the cache, for whoever waits and for the next start."""
    try:
        mark_of(part).touch()
    except OSError:  # numba has said so already, where its cache cannot be written to
        LOG.info("the compiled kernels could not be kept")


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


def progress() -> tuple[int, int]:
    """Return how many kernels are there, and about how many there are in all."""
    # numba has an index for each: those that another process has compiled are seen too
    cached = sum(1 for _ in cache_folder().glob("*/*.nbi"))
    return min(max(cached, sum(map(specialisations, all_kernels()))), KERNELS), KERNELS


def begun() -> "list[subprocess.Popen[bytes]]":
    """Begin to compile in other processes; in none where there is one core alone, or no process to be had."""
    if (os.cpu_count() or 1) < 2:
        return []
    quiet: Any = {"stdin": subprocess.DEVNULL, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    helpers = []
    for share in SHARES:
        command = [sys.executable, "-m", __name__, str(os.getpid()), *share]
        try:
            # of a session of its own: Ctrl+C at the server's terminal would make it print where it was
            helpers.append(subprocess.Popen(command, start_new_session=True, **quiet))
        except OSError:
            LOG.warning("no process could be begun that compiles")
    return helpers


def help_out(parent: int) -> None:
    """Stand back in this process for that of its parent, and end it when that has ended, whichever way."""
    if hasattr(os, "nice"):  # where cores are short, the page goes first
        os.nice(HELPERS_NICENESS)

    def look() -> None:
        while os.getppid() == parent:
            time.sleep(LOOKS_EVERY_S)
        # `sys.exit` would end this thread alone
        os._exit(0)

    threading.Thread(target=look, daemon=True).start()


def compile_parts(parts: Iterable[str]) -> None:
    """Compile parts one after the other, those that an earlier start has left."""
    for part in parts:
        if not is_done(part):
            PARTS[part]()
            tell_done(part)


if __name__ == "__main__":
    help_out(int(sys.argv[1]))
    compile_parts(sys.argv[2:])
