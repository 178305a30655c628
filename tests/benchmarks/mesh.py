"""`python -m tests.benchmarks.mesh` tables how much the mesh decides: energies and switching from 20 to 1 m.

Over a shipped scenario of each drive: the energy of `optimal`, that of its relaxation, which may switch within cells
where the drive takes power as soon as it is on, and for how long the drive stays on or off between two switchings.
"""

import argparse
import time
from dataclasses import dataclass

import numpy as np

from railjoule.core import RailjouleError, load_scenario
from railjoule.core.bounds import minimise
from railjoule.core.physics.stretches import IS_OFF, NOTHING, RunActions, actions_of_run
from railjoule.core.strategies import prepare_task, run_strategy
from railjoule.core.units import J_PER_KWH
from tests.benchmarks.referee import with_drive

MESHES_M = (20.0, 10.0, 5.0, 2.0, 1.0)
SCENARIOS = {
    "constant_efficiency": "liashenko-ii",
    "copper_loss": "ftorek-300s",
    "induction": "tram-950m",
    "loss_polynomial": "kharkiv-like-40kmh",
    "efficiency_map": "kharkiv-like-40kmh",
    "synchronous": "kharkiv-like-40kmh",
}
"""One shipped scenario a drive; the drives of the tests where it has another."""


@dataclass(frozen=True)
class Dwells:
    """How a run's drive is switched.

    Parameters
    ----------
    blocks : int
        Stretches of one mode: driving, electric braking or off.
    shortest_on_s, shortest_off_s : float
        Shortest of those in which the drive is on, and of those off between two of them [s]; infinite without any.
    """

    blocks: int
    shortest_on_s: float
    shortest_off_s: float


def dwells_of(done: RunActions) -> Dwells:
    """Return how the drive of a run is switched; what interrupts it begins and ends a stretch."""
    borders = np.flatnonzero(np.append(True, (np.diff(done.action) != 0) | (done.interrupted_by[1:] != NOTHING)))
    lasts, is_off = np.add.reduceat(done.duration_s, borders), done.action[borders] == IS_OFF
    # off between two stretches that are on, and at neither end of the way between two stops
    departs = np.append(done.interrupted_by[borders] != NOTHING, True)
    inner = is_off & ~departs[:-1] & ~departs[1:]
    shortest = (float(lasts[some].min(initial=np.inf)) for some in (~is_off, inner))
    return Dwells(len(borders), *shortest)


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.mesh", description=__doc__)
    parser.add_argument("--meshes", nargs="*", type=float, default=list(MESHES_M), help="lengths of cells [m]")
    heads = ("mesh, m", "cells", "run, kWh", "relaxed", "above it", "blocks", "on, s", "off, s", "call, s")
    print(f"{'scenario':24}{'drive':18}" + "".join(f"{head:>10}" for head in heads))
    meshes = parser.parse_args().meshes
    for drive, name in SCENARIOS.items():
        for mesh in meshes:
            task = prepare_task(with_drive(load_scenario(name), drive).with_(**{"solver.mesh_m": mesh}))
            started = time.perf_counter()
            try:
                run = run_strategy(task, "optimal")
                relaxed = minimise(task).energy_j
            except RailjouleError as error:
                print(f"{name:24}{drive:18}{mesh:10g} {error}", flush=True)
                continue
            seconds, dwells = (
                time.perf_counter() - started,
                dwells_of(actions_of_run(task.course.data, run.node_speed_ms**2)),
            )
            print(
                f"{name:24}{drive:18}{mesh:10g}{task.course.cell_count:10d}{run.energy_kwh:10.5f}"
                f"{relaxed / J_PER_KWH:10.5f}{100 * (run.energy.net_j / relaxed - 1):9.3f}%"
                f"{dwells.blocks:10d}{dwells.shortest_on_s:10.2f}{dwells.shortest_off_s:10.2f}{seconds:10.1f}",
                flush=True,
            )


if __name__ == "__main__":
    main()
