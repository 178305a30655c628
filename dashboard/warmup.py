"""Compile the kernels once a process, in a thread, and tell how far that is.

With numba's cache filled it takes a fraction of a second; the very first start takes about a minute.
"""

import logging
import sys
import threading
from collections.abc import Iterator
from functools import cache
from typing import Any

from numba.core.dispatcher import Dispatcher

from railjoule.core import compare, load_scenario, solve
from railjoule.core.advice import advise
from railjoule.core.scenario import Scenario
from railjoule.core.simulate.disturbances import simulate_disturbances
from railjoule.core.simulate.field_oriented import current_ripple, simulate_field_oriented
from railjoule.core.simulate.following import simulate_following
from railjoule.core.simulate.regulator import drive_under_limits
from railjoule.core.studies.induction_map import induction_map
from railjoule.core.studies.motor_map import motor_map
from railjoule.core.studies.storage import saving_over_size

LOG = logging.getLogger(__name__)
SCENARIOS = ("liashenko-i", "ftorek-300s", "tram-950m")
"""Three small runs that use every kernel but those of maps and regulators."""
METRO = "kharkiv-like-40kmh"
"""A run for the kernels of maps, regulators and storages."""
CLOSED_LOOP = "tram-950m"
"""A short run for those of the closed loop."""


class Warmup:
    """The compilation of all kernels, started once."""

    def __init__(self) -> None:
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
        try:
            for scenario in scenarios():
                for run in compare(scenario)[0]:
                    advise(run)
            simulate_following(load_scenario(SCENARIOS[0]))
            simulate_disturbances(load_scenario("tram-950m-stop"))
            drive_the_metro()
            drive_in_closed_loop()
        except Exception:
            LOG.exception("the kernels could not be compiled")
        finally:
            self.ready.set()

    @property
    def progress(self) -> tuple[int, int]:
        """How many kernels are ready, and how many there are."""
        kernels = list(all_kernels())
        return sum(bool(kernel.signatures) for kernel in kernels), len(kernels)


def scenarios() -> Iterator[Scenario]:
    """Yield the scenarios whose runs use every kernel."""
    for name in SCENARIOS:
        yield load_scenario(name)


def all_kernels() -> Iterator[Any]:
    """Yield the compiled functions of the core, each once."""
    seen: set[int] = set()
    for name, module in list(sys.modules.items()):
        if name.startswith("railjoule.core"):
            for member in list(vars(module).values()):
                if isinstance(member, Dispatcher) and id(member) not in seen:
                    seen.add(id(member))
                    yield member


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
    warmup().start()
    warmup().wait()
