"""`python -m tests.judge_bounds --count 300` searches random scenarios for a run that lies below its lower bound.

Each scenario is solved with `optimal`. Its rivals are the runs of every strategy over meshes from the given one to half
a metre, a train driven in steps of a millisecond along the optimum (`tests.continuous_run`), and with `--ipopt` the
optimum of IPOPT over a mesh of 1 m. A rival counts if it arrives in time and `check_run` finds no broken rule. Runs
over cells keep the limits of effort at the mean speed of each cell only, so one below the bound decides nothing: its
plan is driven in steps of a millisecond, for a shorter time until the train is in time, and that energy refutes it.

Every scenario is a line of JSON in a file, so that an interrupted run continues. `--shipped` judges the scenarios that
come with railjoule, `--no-rivals` solves only, and `--before FILE` compares with the rows of an earlier state. The
status is 1 where a rival that decides lies below its bound.
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
from typing import Any

import numpy as np

from railjoule.core import RailjouleError, Scenario, Trajectory, check_run, solve
from railjoule.core.check import switching
from railjoule.core.compilation import require_compiled
from railjoule.core.physics.reference import SMALL_ENERGY_SHARE
from railjoule.core.scenario import StrategyName
from railjoule.core.strategies import STRATEGIES, Task, prepare_task, run_strategy
from railjoule.core.units import J_PER_KWH
from railjoule.core.validation import ipopt
from tests.check_many import drive_all
from tests.continuous_run import drive_plan
from tests.judged_scenarios import judged_scenario, shipped_names

Row = dict[str, Any]

MESHES_M = (5.0, 2.0, 1.0, 0.5)
MOST_CELLS: dict[str, int] = {"bellman": 150, "speed_limits": 300}
"""Of strategies that take long; others over `MOST_CELLS_OF_MODEL`."""
SMOOTH = ("constant_efficiency", "copper_loss")
MOST_CELLS_SMOOTH, MOST_CELLS_IDLE, MOST_CELLS_IPOPT = 4000, 1500, 3000
LATE_S, EXCESS_SHARE, BELOW_SHARE = 1e-5, 1e-5, 1e-6
"""A run over cells may be late by what solvers leave [s]. A driven train is never late, and exceeds a limit by less
than this share; it refutes a bound that it undercuts by more than this share."""
MOST_LINES = 20
"""So many rivals are listed where more are counted."""
ON_TIME_S, PLANS = 0.002, 4
"""A train that arrives late, or early by more, is sent off again with another plan, up to so many times."""


# ---- one scenario, in a worker


def judge(
    name: str,
    meshes_m: Sequence[float] = MESHES_M,
    strategies: Collection[StrategyName] = tuple(STRATEGIES),
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
        "every_run": getattr(run.bound, "covers_every_run", False),
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


def _mesh_rivals(best: Trajectory, meshes_m: Sequence[float], strategies: Collection[StrategyName]) -> Iterator[Row]:
    """Yield the runs of strategies over the meshes that have few enough cells for them."""
    given_m = best.scenario.solver.mesh_m
    for mesh_m in (given_m, *(mesh for mesh in meshes_m if mesh < given_m)):
        task = _task(best.scenario, mesh_m)
        for name in strategies:
            if task is not None and task.course.cell_count <= _most_cells(best.scenario, name):
                yield from _strategy_rival(best, task, name)


def _task(scenario: Scenario, mesh_m: float) -> Task | None:
    try:
        return prepare_task(scenario.with_(**{"solver.mesh_m": mesh_m}))
    except RailjouleError:
        return None


def _most_cells(scenario: Scenario, strategy: str) -> int:
    most = MOST_CELLS_SMOOTH if scenario.vehicle.drive.model in SMOOTH else MOST_CELLS_IDLE
    return MOST_CELLS.get(strategy, most)


def _strategy_rival(best: Trajectory, task: Task, name: StrategyName) -> Iterator[Row]:
    """Yield the run of a strategy, if it takes the task and arrives in time."""
    try:
        run = run_strategy(task, name)
    except RailjouleError:
        return
    if run.travel_time_s - best.scenario.travel_time_s > LATE_S:
        return
    # a bound for free switching is one for all
    broken = [check.name for check in check_run(task.scenario, run).broken if check.name != switching.NAME]
    mesh_m, below = task.scenario.solver.mesh_m, below_share(best, run.energy.net_j)
    row = {"strategy": name, "mesh_m": mesh_m, "cells": len(run.nodes_m) - 1, "below": below, "broken": broken}
    yield row | {"driven": driven_rival(best, name, mesh_m) if below > BELOW_SHARE and not broken else None}


def driven_rival(best: Trajectory, strategy: StrategyName, mesh_m: float) -> Row | None:
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


def _plan(scenario: Scenario, strategy: StrategyName, mesh_m: float, planned_s: float) -> Trajectory | None:
    least_m = 1.2 * scenario.line.length_m / _most_cells(scenario, strategy)
    changes = {"solver.mesh_m": max(mesh_m, least_m), "timetable.travel_time_s": planned_s}
    try:
        return run_strategy(prepare_task(scenario.with_(**changes)), strategy)
    except RailjouleError:
        return None


def _ipopt_rival(best: Trajectory) -> Row | None:
    """Return the optimum of IPOPT over a mesh of 1 m, beside the product's over the same mesh."""
    task = _task(best.scenario, 1.0)
    if task is None or not ipopt.is_known(task) or task.course.cell_count > MOST_CELLS_IPOPT:
        return None
    theirs, ours = ipopt.IpoptProblem(task).solve(), run_strategy(task, "optimal")
    return {
        "converged": theirs.converged,
        "energy_kwh": theirs.energy_j / J_PER_KWH,
        "below": below_share(best, theirs.energy_j),
        "ours_above": ours.energy.net_j / theirs.energy_j - 1,
        "seconds": theirs.solve_time_s,
        "cells": task.course.cell_count,
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


# ---- the tables


def refuting(row: Row) -> Iterator[tuple[str, float]]:
    """Yield the driven trains that refute a bound, along which plan, and by which share."""
    plans = [(f"{rival['strategy']} at {rival['mesh_m']:.3g} m", rival["driven"]) for rival in row.get("rivals", ())]
    for name, train in [("optimal over the finest mesh", row.get("driven")), *plans]:
        if train is not None and train["below"] > BELOW_SHARE:
            yield name, train["below"]


def table(rows: list[Row], before: dict[str, Row]) -> str:
    """Return the summary by drive, and the rivals below their bounds."""
    solved = [row for row in rows if row["status"] == "solved" and row["gap"] is not None]
    kinds = sorted({row["model"] for row in solved})
    lines = [f"{len(rows)} scenarios: {', '.join(_statuses(rows))}", "", *_gap_lines(solved, kinds)]
    if before:
        lines += [
            "",
            "before:",
            "",
            *_gap_lines([before[row["seed"]] for row in solved if row["seed"] in before], kinds),
        ]
        lines += ["", *_change_lines(solved, before)]
    return "\n".join([*lines, "", *_rival_lines(solved)])


def _statuses(rows: list[Row]) -> list[str]:
    statuses = [row["status"] for row in rows]
    return [f"{statuses.count(status)} {status}" for status in sorted(set(statuses))]


def _gap_lines(rows: list[Row], kinds: list[str]) -> Iterator[str]:
    yield "| drive | count | median gap [%] | 90 % | 99 % | worst | <= 0.05 % | <= 0.5 % | cells | time [ms] | worst |"
    yield "| --- " * 11 + "|"
    groups = [(kind, [row for row in rows if row.get("model") == kind]) for kind in kinds]
    smooth = [row for row in rows if row.get("model") in SMOOTH]
    for kind, mine in [*groups, ("smooth drives", smooth), ("all", rows)]:
        gaps = np.array([row["gap"] for row in mine if row.get("gap") is not None])
        if not len(gaps):
            continue
        quantiles = " | ".join(f"{100 * np.quantile(gaps, share):.4f}" for share in (0.5, 0.9, 0.99, 1.0))
        shares = " | ".join(f"{100 * np.mean(gaps <= share):.1f} %" for share in (5e-4, 5e-3))
        cells, times = (np.array([row[key] for row in mine if key in row]) for key in ("cells", "seconds"))
        yield (
            f"| {kind} | {len(gaps)} | {quantiles} | {shares} | {np.median(cells):.0f} | "
            f"{1e3 * np.median(times):.1f} | {1e3 * times.max():.0f} |"
        )


def _change_lines(rows: list[Row], before: dict[str, Row]) -> Iterator[str]:
    """Yield a row for each shipped scenario, and the change of energy of all others by drive."""
    yield "| scenario | kWh before | after | gap before [%] | after | cells before | after | ms before | after |"
    yield "| --- " * 9 + "|"
    changes = []
    for row in rows:
        old = before.get(row["seed"])
        if old is None or old.get("gap") is None:
            continue
        changes.append(row["energy_kwh"] / old["energy_kwh"] - 1)
        if not row["seed"].isdigit():
            yield (
                f"| {row['seed']} | {old['energy_kwh']:.5f} | {row['energy_kwh']:.5f} | {100 * old['gap']:.4f} | "
                f"{100 * row['gap']:.4f} | {old['cells']} | {row['cells']} | {1e3 * old['seconds']:.1f} | "
                f"{1e3 * row['seconds']:.1f} |"
            )
    if changes:
        quantiles = ", ".join(f"{100 * np.quantile(changes, share):+.3f} %" for share in (0.0, 0.1, 0.5, 0.9, 1.0))
        yield f"energy after over before, least, 10 %, median, 90 %, most: {quantiles}"


def _rival_lines(rows: list[Row]) -> Iterator[str]:
    """Yield the counts of rivals, those below by strategy and mesh, and each that refutes a bound."""
    judged = [(row, rival) for row in rows for rival in row.get("rivals", ())]
    below = [(row, rival) for row, rival in judged if rival["below"] > BELOW_SHARE and not rival["broken"]]
    yield f"runs over cells: {len(judged)}, of them with a broken rule: {sum(bool(r['broken']) for _, r in judged)}"
    yield f"of the others below the bound: {len(below)}, in {len({row['seed'] for row, _ in below})} scenarios"
    finest = {row["seed"]: min(rival["mesh_m"] for rival in row["rivals"]) for row, _ in judged}
    left = [(row, rival) for row, rival in below if rival["mesh_m"] == finest[row["seed"]]]
    yield f"of them over the finest mesh of their scenario: {len(left)}"
    for row, rival in sorted(below, key=lambda pair: -pair[1]["below"])[:MOST_LINES]:
        driven = "not in time" if rival["driven"] is None else f"{100 * rival['driven']['below']:+.4f} %"
        yield (
            f"  {row['seed']} {row['model']}: {rival['strategy']} at {rival['mesh_m']:.3g} m by "
            f"{100 * rival['below']:.4f} %, driven {driven}, gap {100 * row['gap']:.4f} %"
        )
    ipopts = [row["ipopt"] for row in rows if row.get("ipopt") is not None and row["ipopt"]["converged"]]
    yield _spread_line("IPOPT over 1 m, above the bound", [-rival["below"] for rival in ipopts])
    yield _spread_line("railjoule over 1 m, above IPOPT", [rival["ours_above"] for rival in ipopts])
    trains = [row["driven"] for row in rows if row.get("driven") is not None]
    yield _spread_line("driven trains, above the bound", [-train["below"] for train in trains])
    refuted = [(row["seed"], *rival) for row in rows for rival in refuting(row)]
    covering = sum(row["every_run"] for row in rows)
    yield f"bounds refuted: {len({seed for seed, *_ in refuted})} of {len(rows)}; {covering} are to cover every run"
    for seed, name, share in sorted(refuted, key=lambda found: -found[2])[:MOST_LINES]:
        yield f"  {seed}: driven along {name}, by {100 * share:.4f} %"


def _spread_line(name: str, shares: list[float]) -> str:
    if not shares:
        return f"{name}: none"
    spread = ", ".join(f"{100 * np.quantile(shares, share):.5f} %" for share in (0.0, 0.1, 0.5, 0.9, 1.0))
    return f"{name}: {len(shares)}; least, 10 %, median, 90 %, most {spread}"


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
    parser.add_argument("--before", type=Path, metavar="FILE", help="rows of an earlier state, to compare with")
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
    print(table(rows, _rows_by_name(asked.before)))
    wrong = (row["status"] in ("traceback", "stopped") or (row.get("every_run") and any(refuting(row))) for row in rows)
    return 1 if any(wrong) else 0


def _rows_by_name(file: Path | None) -> dict[str, Row]:
    lines = file.read_text(encoding="utf-8").splitlines() if file is not None else ()
    return {row["seed"]: row for row in map(json.loads, lines)}


if __name__ == "__main__":
    sys.exit(main())
