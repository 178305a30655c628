"""`python -m tests.check_many` drives many random scenarios with every strategy, and tables what their check finds.

The scenarios are those of `tests.any_scenarios`, over the whole format, windows of arrival included; with --review
those of the review's generator (shared/check/gen.py, beside the repository), whose lines are longer, and its checker
judges their runs as well. After the strategies their runs are compared, as `compare` does. Two processes work at once,
each call within a limit of time; a longer one is stopped and counted. Every call is written down as a line of JSON, so
that a run that was broken off or ended by --minutes goes on where it was, as long as the sources are the same.
`--count 5000` takes a quarter of an hour, a night is `--count 20000 --minutes 480`. The status is 1 where any call
broke a rule, left the numbers, raised a traceback or a warning of NumPy, or took longer than the limit; where a run
that is called optimal misses a window of arrival, or none is found; and where a bound is shown beside a run that needs
less.
"""

import argparse
import importlib.util
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
from collections.abc import Iterable, Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from railjoule.core import InfeasibleLineError, RailjouleError, Trajectory, check_run
from railjoule.core.bounds import bounded
from railjoule.core.check import switching
from railjoule.core.kernel_cache import source_hash
from railjoule.core.scenario import scenario_from_document
from railjoule.core.strategies import STRATEGIES, Task, prepare_task, run_strategy, with_bounds
from tests.any_scenarios import MODELS, add_windows, any_time, any_wide_document

REVIEW = Path(__file__).parents[2] / "shared" / "check"
LONGEST_TIME_S = 86_400
WARMING_SEEDS = range(2 * len(MODELS))
"""Their calls compile what later ones find compiled; no limit holds for them."""
STARTING_S = 1800.0
SAID = "no run was found"
"""What a run says of itself that is switched more often than the scenario allows, as no other was found in time."""
MOST_NAMED = 12
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


def review_module(name: str) -> ModuleType | None:
    """Return a module of the review, or None where it is not beside the repository."""
    path = REVIEW / f"{name}.py"
    if not path.is_file():
        return None
    spec = importlib.util.spec_from_file_location(f"review_{name}", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def document_of(seed: int, generator: ModuleType | None) -> tuple[Row, float]:
    """Return the scenario of a seed, without a timetable, and the share of its shortest time that it shall have."""
    if generator is None:
        return any_wide_document(seed), any_time(seed)
    document, share = generator.scenario(seed)
    return document, share


def timed_task(document: Row, share: float, seed: int | None = None) -> Task:
    """Return the task of a scenario with a share of its shortest time; the document gets the timetable.

    With a seed it also gets windows of arrival.
    """
    first = prepare_task(scenario_from_document(document))
    total = first.shortest_time_s * share + first.dwell_s
    if total > LONGEST_TIME_S:
        raise InfeasibleLineError("the generator's timetable is longer than a day.")
    document["timetable"] = {**document.get("timetable", {}), "travel_time_s": total}
    if seed is not None:
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


def calls(seed: int, done: Iterable[str], generator: ModuleType | None, reference: ModuleType | None) -> Iterator[Row]:
    """Yield what became of each strategy over the scenario of a seed, before each its name alone."""
    document, share = document_of(seed, generator)
    about = {"seed": seed, "model": document["vehicle"]["drive"]["model"]}
    yield about | {"strategy": "", "begins": True}
    try:
        task = timed_task(document, share, seed if generator is None else None)
    except Exception as error:
        yield about | {"strategy": "", **failure(error)}
        return
    bound, runs = None, []
    for name in STRATEGIES:
        if name in done:
            continue
        yield about | {"strategy": name, "begins": True}
        started = time.perf_counter()
        try:
            run = run_strategy(task, name)
            seconds = time.perf_counter() - started
            runs.append(run)
            bound = run.bound if name == "optimal" else bound
            run = bounded(task, run, bound)
            found = checked(run) | promises(run)
            if reference is not None:
                found["reference"] = [[kind, amount] for kind, amount, _ in reference.check(document, run, name)]
        except Exception as error:
            seconds, found = time.perf_counter() - started, failure(error)
        yield about | {"strategy": name, "seconds": seconds, **found}
    if COMPARE in done or not runs:
        return
    yield about | {"strategy": COMPARE, "begins": True}
    started = time.perf_counter()
    try:
        found = compared(task, runs)
    except Exception as error:
        found = failure(error)
    yield about | {"strategy": COMPARE, "seconds": time.perf_counter() - started, **found}


def compared(task: Task, runs: list[Trajectory]) -> Row:
    """Return what the runs of all strategies promise where they are compared: the worst of them."""
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
        "cells": len(run.line_power_w),
        "broken": [[check.name, check.largest, check.allowed, check.at_m] for check in broken],
        "told": [check.name for check in broken] == [switching.NAME] and says_so,
    }


def failure(error: Exception) -> Row:
    """Return what became of a call that raised: a refusal in a sentence, or a traceback."""
    if isinstance(error, RailjouleError):
        return {"status": "refused", "words": f"{type(error).__name__}: {error}"}
    return {"status": "traceback", "words": "".join(traceback.format_exception(error))}


def work(is_review: bool) -> None:
    """Do what standard input asks for, line by line; write what becomes of it to standard output."""
    warnings.simplefilter("ignore")
    # a division by nothing is a fault, even where the run is right
    warnings.simplefilter("error", RuntimeWarning)
    generator, reference = (review_module("gen"), review_module("check")) if is_review else (None, None)
    for seed in WARMING_SEEDS:
        list(calls(seed, (), None, None))
    print(json.dumps({"ready": True}), flush=True)
    for line in sys.stdin:
        asked = json.loads(line)
        for row in calls(asked["seed"], asked["done"], generator, reference):
            print(json.dumps(row, default=float), flush=True)
        print(json.dumps({"ready": True}), flush=True)


# ---- many of them


class Worker:
    """A process that drives one scenario after another, and is started anew when a call takes too long."""

    def __init__(self, limit_s: float, is_review: bool) -> None:
        self.limit_s, self.is_review = limit_s, is_review
        self.process: subprocess.Popen[str] | None = None

    def rows(self, seed: int, done: set[str]) -> Iterator[Row]:
        """Yield what became of each strategy that is not done yet."""
        finished = set(done)
        while True:
            current: Row | None = None
            for row in self._answers(seed, finished):
                if row.get("begins"):
                    current = row
                    continue
                if row.get("ready"):
                    return
                if "died" in row:
                    break
                current = None
                finished.add(row["strategy"])
                yield row
            # what was at work when the process ended is not asked again
            if current is None:
                return
            del current["begins"]
            yield current | {"status": "stopped", "seconds": self.limit_s}
            finished.add(current["strategy"])
            if not current["strategy"]:
                return

    def _answers(self, seed: int, done: set[str]) -> Iterator[Row]:
        if self.process is None:
            self._start()
        assert self.process is not None
        assert self.process.stdin is not None
        self.process.stdin.write(json.dumps({"seed": seed, "done": sorted(done)}) + "\n")
        self.process.stdin.flush()
        while True:
            row = self._next(self.limit_s)
            yield row
            if "ready" in row or "died" in row:
                return

    def _start(self) -> None:
        command = [sys.executable, "-m", "tests.check_many", "--worker", *(["--review"] if self.is_review else [])]
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.lines: queue.Queue[str] = queue.Queue()
        threading.Thread(target=self._listen, args=(self.process, self.lines), daemon=True).start()
        if "died" in self._next(STARTING_S):
            raise SystemExit("a worker did not start; its own words are above.")

    @staticmethod
    def _listen(process: "subprocess.Popen[str]", lines: "queue.Queue[str]") -> None:
        assert process.stdout is not None
        for line in process.stdout:
            lines.put(line)
        lines.put(json.dumps({"died": True}))

    def _next(self, limit_s: float) -> Row:
        try:
            row: Row = json.loads(self.lines.get(timeout=limit_s))
        except queue.Empty:
            row = {"died": True}
        if "died" in row:
            self.close()
        return row

    def close(self) -> None:
        """End the process."""
        if self.process is not None:
            self.process.kill()
            self.process.wait()
            self.process = None


def sources() -> str:
    """Return a hash of the core's sources."""
    return source_hash()


def kept_rows(file: Path, seeds: range, is_review: bool = False) -> list[Row]:
    """Return the rows of a file for seeds of one generator, from the same sources; a torn last line does not count."""
    rows = []
    for line in file.read_text(encoding="utf-8").splitlines() if file.exists() else ():
        try:
            row = json.loads(line)
        except ValueError:
            continue
        if row["sources"] == sources() and row["review"] == is_review and row["seed"] in seeds:
            rows.append(row)
    return rows


def drive_all(
    file: Path, seeds: range, processes: int, limit_s: float, until_s: float = math.inf, is_review: bool = False
) -> list[Row]:
    """Drive all scenarios that are not in the file yet, and return all rows; none is begun after `until_s` [s]."""
    rows = kept_rows(file, seeds, is_review)
    done: dict[int, set[str]] = defaultdict(set)
    for row in rows:
        done[row["seed"]].add(row["strategy"])
    waiting: queue.SimpleQueue[int] = queue.SimpleQueue()
    for seed in seeds:
        if "" not in done[seed] and done[seed] != set(CALLS):
            waiting.put(seed)
    written = threading.Lock()

    def keep_working() -> None:
        worker = Worker(limit_s, is_review)
        try:
            while time.monotonic() < until_s:
                seed = waiting.get_nowait()
                for row in worker.rows(seed, done[seed]):
                    with written, file.open("a", encoding="utf-8") as kept:
                        rows.append(row)
                        kept.write(json.dumps(row | {"sources": sources(), "review": is_review}) + "\n")
                print(f"\r{waiting.qsize()} seeds left   ", end="", file=sys.stderr, flush=True)
        except queue.Empty:
            return
        finally:
            worker.close()

    # an interrupt ends this process at once, and workers whose input ends go after their call
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
    compared = [row for row in solved if "reference" in row]
    if compared:
        ours = {id(row) for row in compared if row["broken"]}
        theirs = {id(row) for row in compared if any(kind != "early" for kind, _ in row["reference"])}
        yield (
            f"beside the review's checker, early arrivals apart: both find a fault in {len(ours & theirs)} runs, ours "
            f"alone in {len(ours - theirs)}, the review's alone in {len(theirs - ours)}"
        )


def _places(rows: Iterable[Row]) -> str:
    found = [f"{row['strategy'] or 'scenario'} {row['seed']}" for row in rows]
    more = [f"{len(found) - MOST_NAMED} more"] if len(found) > MOST_NAMED else []
    return f"{len(found)} ({', '.join([*found[:MOST_NAMED], *more])})" if found else "none"


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
    parser.add_argument("--review", action="store_true", help="scenarios of the review, judged by its checker, too")
    parser.add_argument("--worker", action="store_true", help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if asked.worker:
        work(asked.review)
        return 0
    if asked.review and review_module("gen") is None:
        parser.error(f"--review needs {REVIEW / 'gen.py'}.")
    seeds = range(asked.first, asked.first + asked.count)
    until_s = time.monotonic() + 60 * asked.minutes
    rows = drive_all(asked.results, seeds, asked.processes, asked.limit, until_s, asked.review)
    print(table(rows))
    print(verdict(rows, seeds))
    return 1 if any(faults(rows).values()) else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit(130)
