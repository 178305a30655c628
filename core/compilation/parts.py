"""Small runs that use all kernels, in parts, and the helper process that compiles these parts.

The process reads the names of parts, one per line, and prints a line for each kernel and each part.
"""

import contextlib
import os
import queue
import sys
import threading
from collections.abc import Callable, Mapping
from functools import cache, partial
from typing import Any

import numpy as np
from numba.core import event

from railjoule.core import StrategyRefusedError, load_scenario, solve
from railjoule.core.advice import advise
from railjoule.core.bounds.minimum import FREE_CENTRING, TOLERANCE
from railjoule.core.compilation.background import KERNEL_LINE, PART_LINE, Part
from railjoule.core.compiled import MODE
from railjoule.core.continuous_bound.bound import continuous_bound
from railjoule.core.interior_point.solver import Optimum, minimise_energy
from railjoule.core.motion import build_meshed_line
from railjoule.core.physics.between_nodes import follow_between_nodes, slow_to_possible
from railjoule.core.scenario import Scenario
from railjoule.core.simulation.disturbances import simulate_disturbances
from railjoule.core.simulation.field_oriented import current_ripple, simulate_field_oriented
from railjoule.core.simulation.following import simulate_following
from railjoule.core.strategies import Task, prepare_task, run_strategy
from railjoule.core.studies.motor_map import induction_map, motor_map
from railjoule.core.studies.storage import saving_over_size

NICENESS = 10
"""On few cores, the process that computes has priority."""
FIRST = "metro-with-limit"
"""The scenario with which a page opens."""
SCENARIOS = ("liashenko-i", "ftorek-300s", "tram-950m")
"""Three small runs that use every kernel but those of maps and regulators."""
METRO = "kharkiv-like-40kmh"
"""A run for the kernels of maps, regulators and storages."""
COARSE_MESH_M = 30.0
"""Mesh of runs that only compile their kernels, in half the time; coarser ones do not use all kernels of switching."""
CLOSED_LOOP = "tram-950m"
"""A short run for the kernels of the closed loop."""


def coarse(name: str) -> Scenario:
    """Return a shipped scenario with a coarse mesh."""
    return load_scenario(name, {"solver.mesh_m": COARSE_MESH_M})


@cache
def first_task() -> Task:
    """Return the task with which a page opens."""
    return prepare_task(load_scenario(FIRST))


def drive_fastest() -> None:
    """Use the kernels of a run, its energy and its advice."""
    advise(run_strategy(first_task(), "fastest"))


def drive_solver() -> None:
    """Use the kernels of the interior point without those that are called before it: it has no steps to do."""
    mesh = build_meshed_line(load_scenario(FIRST)).data
    minimise_energy(mesh, mesh.limit_speed2, 1.0, 2.0, TOLERANCE, 0, FREE_CENTRING, False)


def drive_proof() -> None:
    """Use the kernels of the bound without those of the interior point, of whose result they take the form."""
    task = first_task()
    prices, speed2 = np.ones(task.mesh.cell_count), task.fastest_speed2
    guess = Optimum(speed2, prices, prices, np.ones((12, len(prices))), prices, 1.0, 1.0, 1.0, 0, 0)
    continuous_bound(task.mesh, guess, task.running_time_s)
    follow_between_nodes(task.mesh.data, speed2)
    slow_to_possible(task.mesh.data, speed2)


def drive_optimum() -> None:
    """Use all kernels of an optimum."""
    solve(load_scenario(FIRST), "optimal")


def drive_strategy(name: str) -> None:
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
        limits = {"search.limits_kmh": [45.0, 30.0], "search.regulator": regulator}
        run_strategy(prepare_task(coarse(METRO).replace(**limits)), "speed_limits")


def drive_maps() -> None:
    """Use the kernels of the maps of machines."""
    motor_map(load_scenario(METRO))
    induction_map(load_scenario(CLOSED_LOOP))


def drive_closed_loop() -> None:
    """Use the kernels of machines under field-oriented control."""
    run = simulate_field_oriented(load_scenario(CLOSED_LOOP, {"simulation.flux": "min_loss"}))
    current_ripple(run, 0.5 * run.planned.travel_time_s)


def drive_simple_advice() -> None:
    """Use the kernels of runs with few changes of regime."""
    # no page needs it until it is asked for
    from railjoule.core.studies.simple_advice import FEWEST_CHANGES, simple_advice  # noqa: PLC0415

    simple_advice(first_task(), FEWEST_CHANGES)


PARTS: Mapping[Part, Callable[[], object]] = {
    "solver": drive_solver,
    "fastest": drive_fastest,
    "proof": drive_proof,
    "limits": partial(drive_strategy, "speed_limits"),
    "bellman": partial(drive_strategy, "bellman"),
    "optimum": drive_optimum,
    "switching": partial(drive_strategy, "optimal"),
    "metro": drive_metro,
    "regulators": drive_regulators,
    "closed_loop": drive_closed_loop,
    "simple_advice": drive_simple_advice,
    "following": drive_following,
    "maps": drive_maps,
    "phases": partial(drive_strategy, "phases"),
    "enoc": partial(drive_strategy, "enoc"),
}


class _PrintKernels(event.Listener):
    """Prints a line for each kernel that has been compiled."""

    def on_start(self, _event: object) -> None:
        """Do nothing."""

    def on_end(self, _event: object) -> None:
        """Print the line."""
        print(KERNEL_LINE, flush=True)


def main() -> None:
    """Compile parts until the other end of the pipe is closed, then end immediately."""
    if hasattr(os, "nice"):
        os.nice(NICENESS)
    MODE.is_compiled = True
    due: queue.Queue[Any] = queue.Queue()

    def read() -> None:
        for line in sys.stdin:
            due.put(line.strip())
        # in the middle of a part too: the process that asked has ended
        os._exit(0)

    threading.Thread(target=read, daemon=True).start()
    with event.install_listener("numba:compile", _PrintKernels()):
        while True:
            PARTS[due.get()]()
            print(PART_LINE, flush=True)


if __name__ == "__main__":
    main()
