"""`python -m tests.check_many` drives many random scenarios with every strategy, and tables what their check finds.

The scenarios are those of `tests.any_scenarios`, over the whole format, windows of arrival included. After the
strategies their runs are compared, as `compare` does. Two processes work in parallel, each call within a time limit; a
longer one is stopped and counted, with the rest of its scenario left out. Every call is a line of JSON in a file, so
that an interrupted run, or one ended by --minutes, continues with the next scenario if the sources are the same.
`--count 5000` takes a quarter of an hour, a night is `--count 20000 --minutes 480`. The status is 1 where any call
broke a rule, left the numbers, raised a traceback or a warning of NumPy, or took longer than the limit; where a run
that is called optimal misses a window of arrival, or none is found; and where a bound is shown beside a run that needs
less.
"""

import argparse
import json
import math
import queue
import subprocess
import sys
import tempfile
import threading
import time
import traceback
import warnings
from collections import Counter, defaultdict
from collections.abc import Collection, Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from railjoule.core import InfeasibleLineError, RailjouleError, Trajectory, check_run
from railjoule.core.bounds import bounded
from railjoule.core.check.efforts import SWITCHING
from railjoule.core.kernel_cache import source_hash
from railjoule.core.scenario import scenario_from_document
from railjoule.core.strategies import STRATEGIES, Task, prepare_task, run_strategy, with_bounds
from tests.any_scenarios import MODELS, add_windows, any_placed_document, any_time

LONGEST_TIME_S = 86_400
WARMING_SEEDS = range(2 * len(MODELS))
"""Their calls compile what later ones find compiled; no limit holds for them."""
STARTING_S = 1800.0
SAID = "no run was found"
"""What a run says of itself that is switched more often than the scenario allows, as no other was found in time."""
MAX_NAMED = 12
"""So many calls are named where more are counted."""
DEARER = 1e-3
"""From this share on another strategy's run counts as cheaper than the optimum."""

COMPARE = "compare"
"""Stands for a strategy where the runs of all strategies are compared."""
CALLS = (*STRATEGIES, COMPARE)
PROOF_S = 0.1
"""For how long a proof by chains goes on in a comparison [s]."""
MISSED_S = 1e-3
"""A window of arrival missed by more counts as broken [s]."""
BELOW_SHARE = 1e-6
"""A run that lies below its bound by more than this share breaks it."""

Row = dict[str, Any]


# ---- one scenario, in a worker


def timed_task(document: Row, share: float, seed: int) -> Task:
    """Return the task of a scenario with a share of its shortest time; the document gets timetable and windows."""
    first = prepare_task(scenario_from_document(document))
    total = first.shortest_time_s * share + first.dwell_s
    if total > LONGEST_TIME_S:
        raise InfeasibleLineError("the generator's timetable is longer than a day.")
    document["timetable"] = {**document.get("timetable", {}), "travel_time_s": total}
    fastest = run_strategy(first, "fastest")
    arrivals = {place: arrival_s(fastest, place) for place in _stations(document)}
    add_windows(document, seed, arrivals, total - fastest.travel_time_s)
    return prepare_task(scenario_from_document(document))


def _stations(document: Row) -> list[float]:
    """Return the places at which a line's stations, and its end, stand in a file [m]."""
    line, length = document["line"], sum(section["length_m"] for section in document["line"]["sections"])
    places = [station["position_m"] for station in line.get("stations", ())]
    return [*places, 0.0 if line.get("reverse") else length]


def arrival_s(run: Trajectory, place_m: float) -> float:
    """Return when a run arrives at a place of its scenario's file [s]."""
    line = run.scenario.line
    driven_m = line.length_m - place_m if line.reverse else place_m
    # where the train stands, two nodes share a place: it arrives at the first
    node = int(np.argmax(run.position_m >= driven_m - 1e-6))
    return float(run.time_s[node] - run.time_s[0])


def missed_s(run: Trajectory) -> float:
    """Return by how much a run misses the window of arrival that it misses most [s]."""
    missed = [0.0]
    for station in run.scenario.line.stations:
        arrival, (earliest, latest) = arrival_s(run, station.position_m), station.window_s
        missed += [earliest - arrival, arrival - latest]
    return max(missed)


def promises(run: Trajectory) -> Row:
    """Return what a run that is called optimal misses [s], and by which share a run lies below the bound beside it."""
    optimal, missed = run.strategy == "optimal" or run.is_proven, missed_s(run)
    return {
        "keeps_windows": missed <= MISSED_S,
        "missed_s": missed if optimal else 0.0,
        "below": 0.0 if run.gap is None else max(-run.gap, 0.0),
    }


def calls(seed: int) -> Iterator[Row]:
    """Yield the result of each strategy over the scenario of a seed, and of their comparison."""
    document = any_placed_document(seed)
    about = {"seed": seed, "model": document["vehicle"]["drive"]["model"]}
    try:
        task = timed_task(document, any_time(seed), seed)
    except Exception as error:
        yield about | {"strategy": "", **failure(error)}
        return
    runs: list[Trajectory] = []
    for name in CALLS:
        started = time.perf_counter()
        try:
            found = compared(task, runs) if name == COMPARE else solved(task, name, runs)
        except Exception as error:
            found = failure(error)
        yield about | {"strategy": name, "seconds": time.perf_counter() - started, **found}


def solved(task: Task, name: str, runs: list[Trajectory]) -> Row:
    """Return what the check finds of a strategy's run, which is added to the runs."""
    run = run_strategy(task, name)
    runs.append(run)
    optimal = next((one for one in runs if one.strategy == "optimal"), None)
    run = bounded(task, run, optimal.bound if optimal is not None else None)
    return checked(run) | promises(run)


def compared(task: Task, runs: list[Trajectory]) -> Row:
    """Return what the runs of all strategies promise where they are compared: the worst of them."""
    if not runs:
        return {"status": "compared"}
    promised = [promises(run) for run in with_bounds(task, runs, PROOF_S)]
    return {"status": "compared", **{key: max(one[key] for one in promised) for key in ("missed_s", "below")}}


def checked(run: Trajectory) -> Row:
    """Return what the check finds of a run."""
    broken = check_run(run.scenario, run).broken
    says_so = any(SAID in note.lower() for note in run.notes)
    return {
        "status": "solved",
        "energy_kwh": run.energy_kwh,
        "time_s": run.travel_time_s,
        "cells": len(run.supply_power_w),
        "broken": [[check.name, check.largest, check.allowed, check.at_m] for check in broken],
        "told": [check.name for check in broken] == [SWITCHING] and says_so,
    }


def failure(error: Exception) -> Row:
    """Return what became of a call that raised: a refusal in a sentence, or a traceback."""
    if isinstance(error, RailjouleError):
        return {"status": "refused", "words": f"{type(error).__name__}: {error}"}
    return {"status": "traceback", "words": "".join(traceback.format_exception(error))}


def work() -> None:
    """Solve the scenarios whose seeds standard input names; write the rows to standard output."""
    warnings.simplefilter("ignore")
    # a division by zero is a fault, even where the run is right
    warnings.simplefilter("error", RuntimeWarning)
    for seed in WARMING_SEEDS:
        list(calls(seed))
    print("ready", flush=True)
    for line in sys.stdin:
        for row in calls(int(line)):
            print(json.dumps(row, default=float), flush=True)
        print("ready", flush=True)


# ---- many of them


class Worker:
    """A process that solves one scenario after another, and is started again when a call takes too long."""

    def __init__(self, limit_s: float, arguments: Sequence[str]) -> None:
        self.limit_s, self.arguments = limit_s, arguments
        self.process: subprocess.Popen[str] | None = None

    def rows(self, seed: int | str) -> list[Row]:
        """Return the rows of a scenario; the last one is `stopped` where a call took too long or the process died."""
        if self.process is None:
            self._start()
        assert self.process is not None
        assert self.process.stdin is not None
        self.process.stdin.write(f"{seed}\n")
        self.process.stdin.flush()
        rows: list[Row] = []
        while (line := self._next(self.limit_s)) != "ready":
            if line is None:
                stopped = {"seed": seed, "strategy": CALLS[len(rows)], "status": "stopped", "seconds": self.limit_s}
                return [*rows, stopped]
            rows.append(json.loads(line))
        return rows

    def _start(self) -> None:
        command = [sys.executable, "-m", *self.arguments]
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.lines: queue.Queue[str | None] = queue.Queue()
        threading.Thread(target=self._read, args=(self.process, self.lines), daemon=True).start()
        if self._next(STARTING_S) is None:
            raise SystemExit("a worker did not start; its error is above.")

    @staticmethod
    def _read(process: "subprocess.Popen[str]", lines: "queue.Queue[str | None]") -> None:
        assert process.stdout is not None
        for line in process.stdout:
            lines.put(line.strip())
        lines.put(None)

    def _next(self, limit_s: float) -> str | None:
        """Return the next line of the process, or None, and end the process, if there is none in time."""
        try:
            line = self.lines.get(timeout=limit_s)
        except queue.Empty:
            line = None
        if line is None:
            self.close()
        return line

    def close(self) -> None:
        """End the process."""
        if self.process is not None:
            self.process.kill()
            self.process.wait()
            self.process = None


def kept_rows(file: Path, seeds: Collection[int | str]) -> list[Row]:
    """Return the rows of a file for some seeds, from the same sources; an incomplete last line does not count."""
    rows = []
    for line in file.read_text(encoding="utf-8").splitlines() if file.exists() else ():
        try:
            row = json.loads(line)
        except ValueError:
            continue
        if row["sources"] == source_hash() and row["seed"] in seeds:
            rows.append(row)
    return rows


def drive_all(
    file: Path,
    seeds: Collection[int | str],
    processes: int,
    limit_s: float,
    until_s: float = math.inf,
    arguments: Sequence[str] = ("tests.check_many", "--worker"),
) -> list[Row]:
    """Solve all scenarios that are not in the file yet, and return all rows.

    Parameters
    ----------
    file : Path
        Lines of JSON, one for each row.
    seeds : collection of int or str
        Names of the scenarios.
    processes : int
    limit_s, until_s : float
        Time that a call may take, and the time after which no scenario is begun [s].
    arguments : sequence of str
        Module, and its arguments, that solves the scenarios named on its standard input.
    """
    rows = kept_rows(file, seeds)
    waiting: queue.SimpleQueue[int | str] = queue.SimpleQueue()
    for seed in sorted(set(seeds) - {row["seed"] for row in rows}):
        waiting.put(seed)
    lock = threading.Lock()

    def keep_working() -> None:
        worker = Worker(limit_s, arguments)
        try:
            while time.monotonic() < until_s:
                found = worker.rows(waiting.get_nowait())
                # one write a scenario: a file never has a part of one
                with lock, file.open("a", encoding="utf-8") as kept:
                    rows.extend(found)
                    kept.write("".join(json.dumps(row | {"sources": source_hash()}) + "\n" for row in found))
                print(f"\r{waiting.qsize()} seeds left   ", end="", file=sys.stderr, flush=True)
        except queue.Empty:
            return
        finally:
            worker.close()

    # an interrupt ends this process immediately, and workers whose input ends stop after their call
    threads = [threading.Thread(target=keep_working, daemon=True) for _ in range(processes)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    print(file=sys.stderr)
    return rows


# ---- the table


def is_faulty(row: Row) -> bool:
    """Return whether a solved call breaks a rule that its run does not say it breaks."""
    return bool(row["broken"]) and not row["told"]


def is_missed(row: Row) -> bool:
    """Return whether a run that is called optimal misses a window of arrival."""
    return bool(row.get("missed_s", 0.0) > MISSED_S)


def is_below(row: Row) -> bool:
    """Return whether a run lies below the bound that is shown beside it."""
    return bool(row.get("below", 0.0) > BELOW_SHARE)


def is_unsolved(row: Row) -> bool:
    """Return whether `optimal` ended without a run and without a reason in the scenario."""
    return row["strategy"] == "optimal" and row["status"] == "refused" and row["words"].startswith("SolverError")


def table(rows: list[Row]) -> str:
    """Return the table of strategies, and the lines that belong to it."""
    scenarios = {row["seed"] for row in rows}
    refused = [row for row in rows if not row["strategy"]]
    lines = [
        f"scenarios: {len(scenarios)}, of them refused before any strategy: {len(refused)}; "
        f"calls: {sum(bool(row['strategy']) for row in rows)}",
        "",
        "| strategy | tried | solved | without a fault | refused | faults by rule |",
        "| --- | --- | --- | --- | --- | --- |",
    ]
    for name in STRATEGIES:
        mine = [row for row in rows if row["strategy"] == name]
        solved = [row for row in mine if row["status"] == "solved"]
        kinds = Counter(broken[0] for row in solved if is_faulty(row) for broken in row["broken"])
        words = ", ".join(f"{kind} {count}" for kind, count in kinds.most_common()) or "none"
        lines.append(
            f"| {name} | {len(mine)} | {len(solved)} | {sum(not is_faulty(row) for row in solved)} | "
            f"{sum(row['status'] == 'refused' for row in mine)} | {words} |"
        )
    return "\n".join([*lines, "", *_other_lines(rows)])


def _other_lines(rows: list[Row]) -> Iterator[str]:
    solved = [row for row in rows if row.get("status") == "solved"]
    yield f"windows of arrival missed by a run that is called optimal: {_places(filter(is_missed, rows))}"
    yield f"bounds above a run they are shown beside: {_places(filter(is_below, rows))}"
    yield f"optima that were not found: {_places(filter(is_unsolved, rows))}"
    broken = [row for row in solved if is_faulty(row)]
    yield f"broken rules: {_places(broken)}"
    yield f"not finite: {_places(row for row in solved if row['broken'] and row['broken'][0][0] == 'finite numbers')}"
    yield f"switched more often than allowed, and said so: {_places(row for row in solved if row['told'])}"
    yield f"tracebacks: {_places(row for row in rows if row['status'] == 'traceback')}"
    yield f"stopped after the limit of time: {_places(row for row in rows if row['status'] == 'stopped')}"
    longest = sorted((row for row in rows if "seconds" in row), key=lambda row: -row["seconds"])[:3]
    yield "longest: " + ", ".join(f"{row['seconds']:.1f} s ({row['strategy']} {row['seed']})" for row in longest)
    yield f"optimal dearer by over {DEARER:.1%} than another run without a fault: {_places(_dearer(solved))}"


def _places(rows: Iterable[Row]) -> str:
    found = [f"{row['strategy'] or 'scenario'} {row['seed']}" for row in rows]
    more = [f"{len(found) - MAX_NAMED} more"] if len(found) > MAX_NAMED else []
    return f"{len(found)} ({', '.join([*found[:MAX_NAMED], *more])})" if found else "none"


def _dearer(solved: list[Row]) -> Iterator[Row]:
    """Yield the optima that a run without a fault undercuts, in no more time."""
    faultless: dict[int, list[Row]] = defaultdict(list)
    for row in solved:
        if not row["broken"] and row.get("keeps_windows", True):
            faultless[row["seed"]].append(row)
    for best in (row for row in solved if row["strategy"] == "optimal"):
        in_time = (row for row in faultless[best["seed"]] if row["time_s"] <= best["time_s"] * 1.000001)
        energy = min((row["energy_kwh"] for row in in_time), default=math.inf)
        if best["energy_kwh"] - energy > DEARER * abs(energy):
            yield best


def faults(rows: list[Row]) -> dict[str, int]:
    """Return how many calls were not as they must be, by what was wrong."""
    solved = [row for row in rows if row.get("status") == "solved"]
    not_finite = [row for row in solved if any(broken[0] == "finite numbers" for broken in row["broken"])]
    return {
        "not finite": len(not_finite),
        "a broken rule": sum(map(is_faulty, solved)) - len(not_finite),
        "an optimum not found": sum(map(is_unsolved, rows)),
        "a window missed by an optimum": sum(map(is_missed, rows)),
        "a bound above a run beside it": sum(map(is_below, rows)),
        "a traceback": sum(row["status"] == "traceback" for row in rows),
        "over the limit of time": sum(row["status"] == "stopped" for row in rows),
    }


def verdict(rows: list[Row], seeds: range) -> str:
    """Return one line: how many scenarios of those asked for were driven, and what was wrong."""
    found = ", ".join(f"{count} {kind}" for kind, count in faults(rows).items())
    return f"verdict: {len({row['seed'] for row in rows}):,} of {len(seeds):,} scenarios, {len(rows):,} calls: {found}"


def main() -> int:
    """Drive many scenarios, and print the table; return 1 if any call is not as it must be."""
    parser = argparse.ArgumentParser(prog="python -m tests.check_many", description=__doc__)
    parser.add_argument("--first", type=int, default=0, help="the first seed")
    parser.add_argument("--count", type=int, default=200, help="how many seeds")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--minutes", type=float, default=math.inf, metavar="M", help="begin no scenario after these")
    parser.add_argument("--limit", type=float, default=60.0, metavar="S", help="time that a call may take")
    parser.add_argument(
        "--results", type=Path, default=Path(tempfile.gettempdir()) / "check_many.jsonl", metavar="FILE"
    )
    parser.add_argument("--worker", action="store_true", help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if asked.worker:
        work()
        return 0
    seeds = range(asked.first, asked.first + asked.count)
    until_s = time.monotonic() + 60 * asked.minutes
    rows = drive_all(asked.results, seeds, asked.processes, asked.limit, until_s)
    print(table(rows))
    print(verdict(rows, seeds))
    return 1 if any(faults(rows).values()) else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit(130)
