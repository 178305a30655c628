"""Workers of a Dask cluster as an executor for studies: `dask scheduler` and `dask worker`, as their users start them.

Each worker compiles nothing that its node has compiled already: numba's files lie in the cache folder of its user
(`railjoule.core.kernel_cache`), and one worker of a node compiles while the others wait (`require_compiled`).
"""

import time
from collections.abc import Callable, Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from typing import Any

from railjoule.core.errors import RailjouleError
from railjoule.core.scenario._sentences import shorten

# who types a wrong address waits for it; a busy scheduler answers within a second or two
CONNECTING_S = 10
# a batch system starts workers one after the other
WAITING_S = 30
RETRIES = 3
"""How often a chunk is done again whose worker has gone: one that kills each worker is at fault itself."""


class ClusterError(RailjouleError):
    """A cluster that cannot be reached, or has no workers."""


@contextmanager
def cluster(address: str) -> Iterator[tuple[Executor, Callable[[], int]]]:
    """Yield an executor of a running Dask cluster, and what tells how many chunks it works on at a time.

    Parameters
    ----------
    address : str
        Of its scheduler, such as "tcp://node1:8786".

    Raises
    ------
    ClusterError
        If Dask is not installed here, nobody answers there, no worker has come in half a minute, or the same chunk has
        cost one worker after the other.
    """
    try:
        import distributed  # noqa: PLC0415  (an extra, and slow to import)
    except ModuleNotFoundError:
        raise ClusterError("a cluster needs distributed: pip install 'railjoule[cluster]'.") from None
    shown = shorten(address)
    try:
        # without a heartbeat's warnings in between: the study tells what has become of it
        client: Any = distributed.Client(address, timeout=CONNECTING_S, set_as_default=False)
    except (OSError, TimeoutError, ValueError) as error:
        raise ClusterError(f"the cluster {shown} does not answer within {CONNECTING_S} s: {_words(error)}.") from None
    with client:
        try:
            client.wait_for_workers(1, timeout=WAITING_S)
        except TimeoutError:
            raise ClusterError(f"the cluster {shown} has had no worker for {WAITING_S} s.") from None
        # not pure: Dask would take two chunks of the same numbers for one
        try:
            yield client.get_executor(pure=False, retries=RETRIES), _WorkerCount(client, shown)
        except (distributed.KilledWorker, OSError) as error:
            raise ClusterError(f"the cluster {shown} has lost its workers: {_words(error)}.") from error


class _WorkerCount:
    """Tells how many threads a cluster's workers have; raises ClusterError once it has had none for a while."""

    def __init__(self, client: Any, shown: str) -> None:
        self._client, self._shown, self._seen = client, shown, time.monotonic()

    def __call__(self) -> int:
        threads: int = sum(self._client.nthreads().values())
        if threads:
            self._seen = time.monotonic()
        elif time.monotonic() - self._seen > WAITING_S:
            raise ClusterError(f"the cluster {self._shown} has had no worker for {WAITING_S} s.")
        return threads


def _words(error: BaseException) -> str:
    words = " ".join(str(error).split()).rstrip(".")
    return shorten(words) if words else type(error).__name__
