"""A cluster as its users start it, by `dask scheduler` and `dask worker`, on the loopback."""

import os
import signal
import sys
from contextlib import suppress

import pytest
from distributed.utils import LoopRunner

from railjoule.core.studies.sweep import InterruptedStudyError, MemoryResults, make_study, run_study
from railjoule.dashboard.command import cluster as module
from railjoule.dashboard.command.cluster import ClusterError, cluster
from tests.builders import HILLS, plain_scenario
from tests.core.studies.sweep.test_file import same
from tests.local_cluster import started_cluster

ROWS = 4_000
OVER = {"vehicle.load_factor": (0.0, 1.0), "timetable.travel_time_s": (150.0, 200.0)}


@pytest.fixture(scope="module", autouse=True)
def _event_loop_of_distributed():
    """Begin one loop before the tests: distributed raises AssertionError if that takes 10 s, as in a busy process."""
    for _ in range(3):
        runner = LoopRunner()
        with suppress(AssertionError):
            runner.start()
            runner.stop()
            break


def study(rows=ROWS):
    return make_study(plain_scenario({"line.sections": HILLS, "timetable.travel_time_s": 170.0}), OVER, rows)


@pytest.mark.nightly
def test_a_cluster_makes_the_same_table_even_if_a_worker_is_killed():
    asked = study()
    results, here = MemoryResults(asked), MemoryResults(asked)
    run_study(here)
    with started_cluster(2) as (address, _scheduler, workers), cluster(address) as (executor, count):
        assert count() == 2

        def kill(_done):
            if len(workers) > 1:
                os.kill(workers.pop().pid, signal.SIGKILL)

        run_study(results, executor=executor, workers=count, progress=kill)
        assert len(workers) == 1
    same(results.to_table(), here.to_table())


@pytest.mark.nightly
def test_a_lost_scheduler_ends_a_study_in_a_sentence_and_what_is_done_goes_on_elsewhere(monkeypatch):
    monkeypatch.setattr(module, "CONNECTING_S", 2)
    results = MemoryResults(study())
    with (
        started_cluster(1) as (address, scheduler, _workers),
        pytest.raises((ClusterError, InterruptedStudyError), match="workers"),
        cluster(address) as (executor, count),
    ):
        run_study(results, executor=executor, workers=count, progress=lambda _done: scheduler.kill())
    assert 0 < results.done < ROWS
    run_study(results)
    assert results.gaps() == []


@pytest.mark.parametrize(
    ("address", "words"),
    [("tcp://127.0.0.1:9", "does not answer within 0.5 s"), ("nowhere at all", "does not answer")],
)
def test_a_cluster_that_cannot_be_reached_is_reported(monkeypatch, address, words):
    monkeypatch.setattr(module, "CONNECTING_S", 0.5)
    with pytest.raises(ClusterError, match=words), cluster(address):
        pass


@pytest.mark.parametrize("count", [0, 1])
def test_a_cluster_without_workers_is_reported_before_the_study_and_in_it(monkeypatch, count):
    monkeypatch.setattr(module, "WAITING_S", 0.5)
    with (
        started_cluster(count) as (address, _scheduler, workers),
        pytest.raises(ClusterError, match=r"has had no worker for 0\.5 s"),
        cluster(address) as (executor, threads),
    ):
        run_study(MemoryResults(study()), executor=executor, workers=threads, progress=lambda _: workers[0].kill())


def test_what_is_missing_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(ClusterError, match=r"pip install 'railjoule\[cluster\]'"), cluster("tcp://127.0.0.1:9"):
        pass
