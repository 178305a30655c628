"""Runs a second of a sweep, beside the same runs by `solve` in a loop and by IPOPT, all in one go.

`python -m tests.benchmarks.sweep` prints them; with `--rows` more of them, with `--cluster` those of a Dask cluster of
two worker processes on the loopback and of chunks of other sizes, too.
"""

import argparse
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from functools import partial
from itertools import chain
from multiprocessing import get_context

from railjoule.core import Scenario, load_scenario, solve
from railjoule.core.strategies import prepare_task
from railjoule.core.studies.sweep import MemoryResults, SweepTable, run_study, study_of, sweep
from railjoule.core.studies.sweep.cluster import cluster
from railjoule.core.studies.sweep.engine import solve_rows
from railjoule.core.studies.sweep.running import rows_in_order
from railjoule.core.validation.ipopt import IpoptProblem, is_installed
from tests.benchmarks.measurement import Measurement
from tests.local_cluster import started_cluster

ROWS, ROUNDS = 4096, 3
LOOP_ROWS, IPOPT_ROWS = 256, 16
OVER = {
    "vehicle.load_factor": (0.0, 1.0),
    "timetable.travel_time_s": (105.0, 135.0),
    "vehicle.resistance.constant_n_per_kn": (0.9, 1.5),
    "drive.recuperation_factor": (0.0, 1.0),
}
LEAST_RUNS_PER_S = 3000


def profile_two() -> Scenario:
    """Liashenko's profile II at a 10 m mesh."""
    return load_scenario("liashenko-ii").with_(**{"solver.mesh_m": 10.0})


def fastest_of(call: Callable[[], object]) -> tuple[float, float]:
    """Return the least time of a call and the least time of processors that it takes [s], of a few rounds."""
    wall, cpu = [], []
    for _ in range(ROUNDS):
        # a shared machine only ever makes both longer
        started, used = time.perf_counter(), time.process_time()
        call()
        wall.append(time.perf_counter() - started)
        cpu.append(time.process_time() - used)
    return min(wall), min(cpu)


def sweeps(rows: int = ROWS) -> Iterator[Measurement]:
    """Four numbers of profile II vary, each run proven."""
    base = profile_two()

    def swept(threads: int, count: int) -> SweepTable:
        with ThreadPoolExecutor(threads) as executor:
            return sweep(base, OVER, count, executor=executor)

    table = swept(1, 64)
    changes = [{name: float(of[row]) for name, of in table.samples.items()} for row in range(table.rows)]
    for threads in (1, 2):
        wall, cpu = fastest_of(lambda threads=threads: swept(threads, rows))
        name, bar = f"sweep, {threads} thread{'s' * (threads > 1)}", LEAST_RUNS_PER_S if threads > 1 else None
        yield Measurement(name, rows / wall, "runs/s", at_least=bar)
        yield Measurement(f"{name}: processor", 1e3 * cpu / rows, "ms a run")
    few = (changes * LOOP_ROWS)[:LOOP_ROWS]
    wall, cpu = fastest_of(lambda: [solve(base.with_(**change)) for change in few])
    yield Measurement("solve(scenario.with_()) in a loop", LOOP_ROWS / wall, "runs/s")
    yield Measurement("solve(scenario.with_()): processor", 1e3 * cpu / LOOP_ROWS, "ms a run")
    if is_installed():
        yield from _by_ipopt([base.with_(**change) for change in changes[:IPOPT_ROWS]])


def _by_ipopt(scenarios: list[Scenario]) -> Iterator[Measurement]:
    """The problem is built anew for each run, as its numbers are constants of CasADi's graph; no proof is made."""
    wall, cpu = fastest_of(lambda: [solve_by_ipopt(scenario) for scenario in scenarios])
    yield Measurement("CasADi and IPOPT in a loop, not proven", len(scenarios) / wall, "runs/s")
    yield Measurement("CasADi and IPOPT: processor", 1e3 * cpu / len(scenarios), "ms a run")
    with ProcessPoolExecutor(2, get_context("spawn")) as executor:
        wall, _ = fastest_of(lambda: list(executor.map(solve_by_ipopt, scenarios)))
    yield Measurement("CasADi and IPOPT in 2 processes", len(scenarios) / wall, "runs/s")


def solve_by_ipopt(scenario: Scenario) -> None:
    """Solve a scenario by IPOPT."""
    IpoptProblem(prepare_task(scenario)).solve()


def by_cluster(rows: int) -> Iterator[Measurement]:
    """The same sweep on two workers of a cluster, and in chunks of other sizes by two threads."""
    study = study_of(profile_two(), OVER, rows)
    with started_cluster(2) as (address, _scheduler, _workers), cluster(address) as (executor, workers):

        def swept() -> None:
            run_study(MemoryResults(study), executor=executor, workers=workers)

        wall, _ = fastest_of(swept)
    yield Measurement("sweep, Dask cluster of 2 processes", rows / wall, "runs/s")
    work = partial(solve_rows, study.plan)
    for size in (16, 64, 256, 1024, 2048):
        with ThreadPoolExecutor(2) as threads:
            wall, _ = fastest_of(
                lambda size=size, threads=threads: [*rows_in_order(work, study.sampler().take(rows), threads, size)]
            )
        yield Measurement(f"sweep, 2 threads, chunks of {size}", rows / wall, "runs/s")


def main() -> None:
    """Print all measurements."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.sweep", description=__doc__)
    parser.add_argument("--rows", type=int, default=ROWS, help="rows of the sweeps")
    parser.add_argument("--cluster", action="store_true", help="with a Dask cluster, and chunks of other sizes")
    options = parser.parse_args()
    for measured in chain(sweeps(options.rows), by_cluster(options.rows) if options.cluster else ()):
        print(f"{measured.name:45}{measured.value:12,.4g} {measured.unit}", flush=True)


if __name__ == "__main__":
    main()
