"""`python -m tests.judge_bounds --count 300` searches random scenarios for a run that lies below its lower bound.

Each scenario is solved with `optimal`. Its rivals are the runs of every strategy over meshes from the given one to half
a metre, a train driven in steps of a millisecond along the optimum (`tests.continuous_run`), and with `--ipopt` the
optimum of IPOPT over a mesh of 1 m. A rival counts if it arrives in time and `check_run` finds no broken rule. Runs
over cells keep the limits of effort at the mean speed of each cell only, so one below the bound decides nothing: its
plan is driven in steps of a millisecond, for a shorter time until the train is in time, and that energy refutes it.

Every scenario is a line of JSON in a file, so that an interrupted run continues. `--shipped` judges the scenarios that
come with railjoule, and `--no-rivals` solves only. The status is 1 where a rival that decides lies below its bound.
"""

import argparse
import json
import math
import sys
import tempfile
import time
import traceback
from collections.abc import Collection, Iterator, Sequence
from pathlib import Path

from railjoule.core import RailjouleError, Scenario, Trajectory, check_run, solve
from railjoule.core.check.efforts import SWITCHING
from railjoule.core.compilation import require_compiled
from railjoule.core.physics.energy_balance import SMALL_ENERGY_SHARE
from railjoule.core.strategies import STRATEGIES, Task, prepare_task, run_strategy
from railjoule.core.units import J_PER_KWH
from railjoule.core.validation import ipopt
from tests.check_many import drive_all
from tests.continuous_run import drive_plan
from tests.judged_scenarios import judged_scenario, shipped_names
from tests.judged_tables import BELOW_SHARE, SMOOTH, Row, refuting, table

MESHES_M = (5.0, 2.0, 1.0, 0.5)
MAX_CELLS: dict[str, int] = {"bellman": 150, "speed_limits": 300}
"""Greatest meshes of strategies that take long."""
MOST_CELLS_SMOOTH, MOST_CELLS_IDLE, MOST_CELLS_IPOPT = 4000, 1500, 3000
"""Greatest meshes of the others, for drives without and with idle losses, and of IPOPT."""
LATE_S, EXCESS_SHARE = 1e-5, 1e-5
"""A run over cells may be late by what solvers leave [s]. A driven train is never late, and exceeds a limit by less
than this share."""
ON_TIME_S, PLANS = 0.002, 4
"""A train that arrives late, or early by more, is sent off again with another plan, up to so many times."""


# ---- one scenario, in a worker


def judge(
    name: str,
    meshes_m: Sequence[float] = MESHES_M,
    strategies: Collection[str] = tuple(STRATEGIES),
    repeats: int = 1,
    with_ipopt: bool = False,
) -> Row:
    """Return the energy, bound and rivals of a scenario.

    Parameters
    ----------
    name : str
        A shipped scenario, or a seed in digits.
    meshes_m : sequence of float
        Lengths of cells beside the given one [m]; without any there are no rivals.
    strategies : collection of str
        The rivals over these meshes.
    repeats : int
        How often the scenario is solved, for the least time.
    with_ipopt : bool
        Whether IPOPT is a rival.
    """
    scenario = judged_scenario(name)
    runs = [_timed(scenario) for _ in range(repeats)]
    run = runs[0][0]
    assert run.bound is not None
    row = {
        "model": scenario.vehicle.drive.model,
        "energy_kwh": run.energy_kwh,
        "bound_kwh": run.lower_bound_kwh,
        "gap": run.gap,
        "proven": run.is_proven,
        "every_run": run.bound.covers_every_run,
        "cells": len(run.nodes_m) - 1,
        "seconds": min(seconds for _, seconds in runs),
    }
    if not meshes_m or run.lower_bound_kwh is None:
        return row
    found = list(_mesh_rivals(run, meshes_m, strategies))
    row["driven"] = driven_rival(run, "optimal", min(meshes_m))
    if with_ipopt:
        row["ipopt"] = _ipopt_rival(run)
    return row | {"rivals": found}


def _timed(scenario: Scenario) -> tuple[Trajectory, float]:
    started = time.perf_counter()
    run = solve(scenario, "optimal")
    return run, time.perf_counter() - started


def below_share(best: Trajectory, energy_j: float) -> float:
    """Return by how much an energy [J] lies below the bound of a run, as a share of the bound, negative above it."""
    assert best.bound is not None
    mean_ms = best.distance_m / best.travel_time_s
    kinetic_j = 0.5 * best.scenario.vehicle.total_inertia_kg * mean_ms**2
    return (best.bound.energy_j - energy_j) / max(abs(best.bound.energy_j), SMALL_ENERGY_SHARE * kinetic_j)


def _mesh_rivals(best: Trajectory, meshes_m: Sequence[float], strategies: Collection[str]) -> Iterator[Row]:
    """Yield the runs of strategies over the meshes that have few enough cells for them."""
    given_m = best.scenario.solver.mesh_m
    for mesh_m in (given_m, *(mesh for mesh in meshes_m if mesh < given_m)):
        task = _task(best.scenario, mesh_m)
        for name in strategies:
            if task is not None and task.mesh.cell_count <= _most_cells(best.scenario, name):
                yield from _strategy_rival(best, task, name)


def _task(scenario: Scenario, mesh_m: float) -> Task | None:
    try:
        return prepare_task(scenario.replace(**{"solver.mesh_m": mesh_m}))
    except RailjouleError:
        return None


def _most_cells(scenario: Scenario, strategy: str) -> int:
    most = MOST_CELLS_SMOOTH if scenario.vehicle.drive.model in SMOOTH else MOST_CELLS_IDLE
    return MAX_CELLS.get(strategy, most)


def _strategy_rival(best: Trajectory, task: Task, name: str) -> Iterator[Row]:
    """Yield the run of a strategy, if it takes the task and arrives in time."""
    try:
        run = run_strategy(task, name)
    except RailjouleError:
        return
    if run.travel_time_s - best.scenario.travel_time_s > LATE_S:
        return
    # a bound for free switching is one for all
    broken = [check.name for check in check_run(task.scenario, run).broken if check.name != SWITCHING]
    mesh_m, below = task.scenario.solver.mesh_m, below_share(best, run.energy.net_j)
    row = {"strategy": name, "mesh_m": mesh_m, "cells": len(run.nodes_m) - 1, "below": below, "broken": broken}
    yield row | {"driven": driven_rival(best, name, mesh_m) if below > BELOW_SHARE and not broken else None}


def driven_rival(best: Trajectory, strategy: str, mesh_m: float) -> Row | None:
    """Return the train that is driven in time along plans of a strategy over a mesh [m]; None if it cannot be."""
    due_s = planned_s = best.scenario.travel_time_s
    found: list[tuple[float, float]] = []
    for _ in range(PLANS):
        plan = _plan(best.scenario, strategy, mesh_m, planned_s)
        run = None if plan is None else drive_plan(plan)
        if run is None:
            break
        early_s = due_s - run.travel_time_s
        if early_s >= 0 and run.excess_share <= EXCESS_SHARE:
            found.append((run.energy_j, early_s))
        # a plan that does not use its time gets no slower with more of it
        if 0 <= early_s <= ON_TIME_S or (plan is not None and plan.travel_time_s < planned_s - 1):
            break
        planned_s += early_s - 0.5 * ON_TIME_S
    if not found:
        return None
    energy_j, early_s = min(found)
    return {"below": below_share(best, energy_j), "early_s": early_s}


def _plan(scenario: Scenario, strategy: str, mesh_m: float, planned_s: float) -> Trajectory | None:
    min_m = 1.2 * scenario.line.length_m / _most_cells(scenario, strategy)
    changes = {"solver.mesh_m": max(mesh_m, min_m), "timetable.travel_time_s": planned_s}
    try:
        return run_strategy(prepare_task(scenario.replace(**changes)), strategy)
    except RailjouleError:
        return None


def _ipopt_rival(best: Trajectory) -> Row | None:
    """Return the optimum of IPOPT over a mesh of 1 m, beside the product's over the same mesh."""
    task = _task(best.scenario, 1.0)
    if task is None or not ipopt.is_known(task) or task.mesh.cell_count > MOST_CELLS_IPOPT:
        return None
    theirs, run = ipopt.IpoptProblem(task).solve(), run_strategy(task, "optimal")
    return {
        "converged": theirs.converged,
        "energy_kwh": theirs.energy_j / J_PER_KWH,
        "below": below_share(best, theirs.energy_j),
        "railjoule_above": run.energy.net_j / theirs.energy_j - 1,
        "seconds": theirs.solve_time_s,
        "cells": task.mesh.cell_count,
    }


def work(asked: argparse.Namespace) -> None:
    """Judge the scenarios whose names standard input has; write the rows to standard output."""
    require_compiled()
    meshes = () if asked.no_rivals else MESHES_M
    # a first solution loads the compiled code
    judge("liashenko-ii", meshes)
    print("ready", flush=True)
    for line in sys.stdin:
        name = line.strip()
        try:
            row = judge(name, meshes, repeats=asked.repeats, with_ipopt=asked.ipopt) | {"status": "solved"}
        except RailjouleError as error:
            row = {"status": "refused", "words": f"{type(error).__name__}: {error}"}
        except Exception:
            row = {"status": "traceback", "words": traceback.format_exc()}
        print(json.dumps({"seed": name, **row}, default=float), flush=True)
        print("ready", flush=True)


def main() -> int:
    """Judge many scenarios, and print the tables; return 1 if a bound is refuted or a call fails."""
    parser = argparse.ArgumentParser(prog="python -m tests.judge_bounds", description=__doc__)
    parser.add_argument("--first", type=int, default=0, help="the first seed")
    parser.add_argument("--count", type=int, default=300, help="how many seeds")
    parser.add_argument("--shipped", action="store_true", help="judge the shipped scenarios instead")
    parser.add_argument("--seeds", nargs="*", help="judge these seeds or names instead")
    parser.add_argument("--no-rivals", action="store_true", help="only solve")
    parser.add_argument("--ipopt", action="store_true", help="let IPOPT solve smooth drives over a mesh of 1 m")
    parser.add_argument("--repeats", type=int, default=1, help="solve so often, for the least time")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--minutes", type=float, default=math.inf, metavar="M", help="begin no scenario after these")
    parser.add_argument("--limit", type=float, default=300.0, metavar="S", help="time that a scenario may take")
    parser.add_argument("--results", type=Path, default=Path(tempfile.gettempdir()) / "judge_bounds.jsonl")
    parser.add_argument("--worker", action="store_true", help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if asked.worker:
        work(asked)
        return 0
    names = asked.seeds or (
        shipped_names() if asked.shipped else map(str, range(asked.first, asked.first + asked.count))
    )
    options = [option for option in ("--no-rivals", "--ipopt") if getattr(asked, option[2:].replace("-", "_"))]
    arguments = ["tests.judge_bounds", "--worker", *options, "--repeats", str(asked.repeats)]
    until_s = time.monotonic() + 60 * asked.minutes
    rows = drive_all(asked.results, tuple(names), asked.processes, asked.limit, until_s, arguments)
    print(table(rows))
    wrong = (row["status"] in ("traceback", "stopped") or (row.get("every_run") and any(refuting(row))) for row in rows)
    return 1 if any(wrong) else 0


if __name__ == "__main__":
    sys.exit(main())
