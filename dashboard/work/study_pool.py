"""The processes that studies are computed in: a study never takes the interpreter that serves the pages.

There is one pool for all pages, made when the first study begins. Its processes have a low priority, so that a move on
any page comes first, and they end with the server even where that is killed: each of them watches it.
"""

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable
from concurrent.futures import Executor, ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing.connection import wait

from railjoule.core.studies.rows import worker_count

NICE = 10
"""How far the priority of the processes lies below that of the server."""
STUDY_THREADS = ThreadPoolExecutor(max_workers=1, thread_name_prefix="railjoule-study")
"""Hands over the runs of one study at a time: those of other pages wait for their turn."""


def begin_worker(nice: int) -> None:
    """Begin a worker process: with a lower priority, and with an end when its server has gone."""
    if hasattr(os, "nice"):
        os.nice(nice)
    # pressed keys reach all processes of a terminal: only the server answers them
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_end_with, args=(parent.sentinel,), daemon=True).start()


def _end_with(sentinel: int) -> None:
    wait([sentinel])
    # a process that waits for work, or is in a kernel, would not notice: it is left immediately
    os._exit(0)


class StudyPool:
    """Worker processes that are made at first use, and again where one has died.

    Parameters
    ----------
    workers : callable
        Returns their number.
    nice : int
        By how much their priority is lower.
    """

    def __init__(self, workers: Callable[[], int], nice: int) -> None:
        self._workers, self._nice = workers, nice
        self._lock = threading.Lock()
        self._executor: ProcessPoolExecutor | None = None

    def executor(self) -> Executor:
        """Return the function that runs in the processes."""
        with self._lock:
            if self._executor is None:
                # a fork would take the threads' locks with it
                context = multiprocessing.get_context("spawn")
                self._executor = ProcessPoolExecutor(
                    self._workers(), context, initializer=begin_worker, initargs=(self._nice,)
                )
            return self._executor

    def renew(self) -> None:
        """Let go of processes one of which has died: the next use makes others."""
        with self._lock:
            broken, self._executor = self._executor, None
        if broken is not None:
            broken.shutdown(wait=False, cancel_futures=True)


RUNS = StudyPool(worker_count, NICE)
