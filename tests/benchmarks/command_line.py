"""How long the command takes from its call to its answer, kernels cached."""

import statistics
import subprocess
import sys
import time
from collections.abc import Iterator

from tests.benchmarks.measurement import Measurement

CALLS = 5


def command_line() -> Iterator[Measurement]:
    """Time `railjoule solve` in a process of its own."""
    command = [sys.executable, "-m", "railjoule.dashboard", "solve", "liashenko-ii", "--json"]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    times = []
    for _ in range(CALLS):
        started = time.perf_counter()
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        times.append(time.perf_counter() - started)
    yield Measurement("railjoule solve, from call to answer", statistics.median(times), "s", at_most=2)
