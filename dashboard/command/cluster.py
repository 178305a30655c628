"""Workers of a running Dask cluster as an executor for `railjoule study sweep --scheduler`.

Each worker compiles nothing that its node has compiled before: compiled kernels are saved in the cache folder of its
user (`railjoule.core.kernel_cache`), and one worker of a node compiles while the others wait (`require_compiled`).
"""

import gc
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from typing import Any

from railjoule.core.errors import RailjouleError
from railjoule.core.scenario._sentences import shorten

CONNECTING_S = 10
"""Wait for the scheduler [s]; a busy one answers within a second or two."""
WAITING_S = 30
"""Wait for workers [s], as a batch system starts them one after the other."""
RETRIES = 3
"""How often the chunk of a lost worker is computed again: a chunk that ends each worker is itself at fault."""


class ClusterError(RailjouleError):
    """A cluster that cannot be reached, or has no workers."""


@contextmanager
def cluster(address: str) -> Iterator[tuple[Executor, Callable[[], int]]]:
    """Yield an executor of a running Dask cluster, and a function that returns how many chunks it works on at a time.

    Parameters
    ----------
    address : str
        Address of its scheduler, such as "tcp://node1:8786".

    Raises
    ------
    ClusterError
        If Dask is not installed here, the scheduler does not answer, no worker has come in half a minute, or the same
        chunk has cost one worker after the other.
    """
    try:
        import distributed  # noqa: PLC0415  (an extra, and slow to import)
    except ModuleNotFoundError:
        raise ClusterError("a cluster needs distributed: pip install 'railjoule[cluster]'.") from None
    shown = shorten(address)
    no_worker = ClusterError(f"the cluster {shown} has had no worker for {WAITING_S} s.")
    # a client that did not connect, collected while another one starts, would wait for the lock that this one holds
    gc.collect()
    try:
        client: Any = distributed.Client(address, timeout=CONNECTING_S, set_as_default=False)
    except (OSError, TimeoutError, ValueError) as error:
        raise ClusterError(f"the cluster {shown} does not answer within {CONNECTING_S} s: {_words(error)}.") from None
    with client:
        try:
            client.wait_for_workers(1, timeout=WAITING_S)
        except TimeoutError:
            raise no_worker from None
        last_seen = time.monotonic()

        def threads() -> int:
            nonlocal last_seen
            count: int = sum(client.nthreads().values())
            if count:
                last_seen = time.monotonic()
            elif time.monotonic() - last_seen > WAITING_S:
                raise no_worker
            return count

        try:
            # not pure, as Dask would take two chunks of equal numbers for one
            yield client.get_executor(pure=False, retries=RETRIES), threads
        except (distributed.KilledWorker, OSError) as error:
            raise ClusterError(f"the cluster {shown} has lost its workers: {_words(error)}.") from error


def _words(error: BaseException) -> str:
    words = " ".join(str(error).split()).rstrip(".")
    return shorten(words) if words else type(error).__name__
