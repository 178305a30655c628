"""`python -m tests.benchmarks.side_by_side CHECKOUT` times this checkout beside another one, call by call in turn.

Two processes, one a checkout, answer in turns, so that a busy machine slows both alike; each call that counts comes
after one that does not. What counts is the median over the rounds of the ratio of the two times in a round.
"""

import argparse
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

HERE = Path(__file__).parents[2]
PACKAGES = ("core", "dashboard", "assets")
ROUNDS = 60
MESH_5 = {"solver.mesh_m": 5.0}
SLOW_CALL_S = 0.05
"""Calls that take longer need no other call before them to be warm."""


@dataclass(frozen=True)
class Case:
    """What is timed: `call` is 'solve', or a strategy on a task that is prepared, or 'minimise' without its proof."""

    call: str
    scenario: str
    changes: tuple[tuple[str, Any], ...] = ()

    @property
    def name(self) -> str:
        """What the case is called."""
        return " ".join([self.call, self.scenario, *(f"{key.split('.')[-1]} {value:g}" for key, value in self.changes)])


CASES = {
    case.name: case
    for case in (
        Case("solve", "liashenko-ii", tuple(MESH_5.items())),
        Case("minimise", "liashenko-ii", tuple(MESH_5.items())),
        Case("solve", "metro-10-stations"),
        Case("minimise", "metro-10-stations"),
        Case("optimal", "liashenko-iii"),
        Case("optimal", "ftorek-300s"),
        Case("optimal", "tram-950m"),
        Case("optimal", "tram-950m-stop"),
        Case("optimal", "kharkiv-like-40kmh"),
        Case("bellman", "liashenko-ii"),
        Case("bellman", "ftorek-300s"),
        Case("bellman", "tram-950m"),
        Case("bellman", "kharkiv-like-40kmh"),
        Case("speed_limits", "metro-with-limit"),
    )
}


def callable_of(case: Case) -> Callable[[], Any]:
    """Return the call of a case, of whichever railjoule is on the path: names that both checkouts have."""
    from railjoule.core import load_scenario, solve  # noqa: PLC0415  (a worker's path decides which)
    from railjoule.core.strategies import prepare_task, run_strategy  # noqa: PLC0415

    try:
        from railjoule.core.bounds import minimise  # noqa: PLC0415
    except ImportError:
        from railjoule.core.strategies import minimise  # type: ignore[no-redef]  # noqa: PLC0415

    scenario = load_scenario(case.scenario).replace(**dict(case.changes))
    if case.call == "solve":
        return lambda: solve(scenario)
    task = prepare_task(scenario)
    if case.call == "minimise":
        return lambda: minimise(task)
    return lambda: run_strategy(task, case.call)


def answer_requests() -> None:
    """Answer each name of a case on standard input with the time of a warm call [s]."""
    calls: dict[str, Callable[[], Any]] = {}
    for line in sys.stdin:
        name = line.strip()
        if name not in calls:
            calls[name] = callable_of(CASES[name])
            calls[name]()
        started = time.perf_counter()
        calls[name]()
        if time.perf_counter() - started < SLOW_CALL_S:
            started = time.perf_counter()
            calls[name]()
        print(time.perf_counter() - started, flush=True)


@contextmanager
def worker(checkout: Path) -> Iterator[Callable[[str], float]]:
    """Start a process with the packages of a checkout; yield what asks it for the time of a case [s]."""
    with tempfile.TemporaryDirectory() as folder:
        package = Path(folder) / "railjoule"
        package.mkdir()
        (package / "__init__.py").touch()
        for name in PACKAGES:
            (package / name).symlink_to(checkout.resolve() / name)
        environment = {**os.environ, "PYTHONPATH": folder}
        environment.pop("NUMBA_CACHE_DIR", None)  # each checkout chooses the folder of its own sources
        process = subprocess.Popen(
            [sys.executable, str(Path(__file__)), "--worker"],
            env=environment,
            cwd=folder,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        assert process.stdin is not None
        assert process.stdout is not None
        requests, answers = process.stdin, process.stdout

        def ask(name: str) -> float:
            requests.write(f"{name}\n")
            requests.flush()
            return float(answers.readline())

        try:
            yield ask
        finally:
            requests.close()
            process.wait()


def main() -> int:
    """Print a row a case: both medians and their ratio; return 1 if a ratio exceeds the bar."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.side_by_side", description=__doc__)
    parser.add_argument("checkout", type=Path, help="folder of the other checkout")
    parser.add_argument("--rounds", type=int, default=ROUNDS)
    parser.add_argument("--only", default="", help="cases whose name contains this")
    parser.add_argument("--bar", type=float, default=1.05, help="largest ratio that is still as fast")
    asked, slower = parser.parse_args(), 0
    with worker(asked.checkout) as other, worker(HERE) as own:
        for name in (name for name in CASES if asked.only in name):
            other(name), own(name)
            pairs = []
            for number in range(asked.rounds):
                # whoever goes first finds other caches
                first, second = (other, own) if number % 2 else (own, other)
                times = first(name), second(name)
                pairs.append(times if number % 2 else times[::-1])
            before, after = (1e3 * statistics.median(times) for times in zip(*pairs, strict=True))
            ratio = statistics.median(new / old for old, new in pairs)
            slower += ratio > asked.bar
            print(f"{name:42} {before:10.3f} ms -> {after:10.3f} ms   x {ratio:.3f}", flush=True)
    return 1 if slower else 0


if __name__ == "__main__":
    if sys.argv[1:] == ["--worker"]:
        answer_requests()
    else:
        sys.exit(main())
