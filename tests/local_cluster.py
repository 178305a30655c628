"""A Dask cluster on the loopback, started as its users start one, by `dask scheduler` and `dask worker`."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager


@contextmanager
def started(*words: str, until: str) -> Iterator[tuple[str, subprocess.Popen[str]]]:
    """Run `dask` with these words, from the moment that it has said something; yield that line and the process."""
    # colours and what Dask asks at its first start would come between
    command = [sys.executable, "-m", "dask", *words]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True, start_new_session=True) as process:
        try:
            assert process.stderr is not None
            yield next(line for line in process.stderr if until in line), process
        finally:
            os.killpg(process.pid, signal.SIGKILL)


@contextmanager
def started_cluster(worker_count: int) -> Iterator[tuple[str, subprocess.Popen[str], list[subprocess.Popen[str]]]]:
    """Yield the address of a scheduler with workers of one thread each, and their processes."""
    local = ("--no-dashboard", "--host", "127.0.0.1")
    with ExitStack() as stack:
        line, scheduler = stack.enter_context(started("scheduler", "--port", "0", *local, until="Scheduler at:"))
        address = line.split()[-1]
        workers = [
            # no nanny: a worker that is killed stays away
            stack.enter_context(
                started("worker", address, "--nthreads", "1", "--no-nanny", *local, until="Registered to")
            )[1]
            for _ in range(worker_count)
        ]
        yield address, scheduler, workers
