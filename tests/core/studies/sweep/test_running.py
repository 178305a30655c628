import os
import pickle
import signal
import threading
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import replace
from multiprocessing import get_context

import numpy as np
import pytest

from railjoule.core import load_scenario, sweep
from railjoule.core.errors import SolverError
from railjoule.core.strategies import prepare_task
from railjoule.core.studies import energy_time_frontier, monte_carlo, sensitivity
from railjoule.core.studies.rows import RowByRow, all_rows, rows_in_order
from railjoule.core.studies.sweep import InterruptedStudyError, MemoryResults, make_study, run_study, running
from railjoule.core.studies.sweep.engine import VersionError, solve_rows
from tests.builders import HILLS, plain_scenario

LOADS = {"vehicle.load_factor": (0.0, 1.0)}


def samples_of(table):
    return np.column_stack(list(table.samples.values()))


def hills():
    return plain_scenario({"line.sections": HILLS, "timetable.travel_time_s": 170.0, "solver.mesh_m": 25.0})


def test_neither_order_nor_number_of_workers_changes_a_table():
    class Backwards(Executor):
        """Runs what it is given when the result is asked for, the last first."""

        def __init__(self):
            self.given = []

        def submit(self, function, /, *arguments):
            future = Future()
            self.given.append((future, function, arguments))
            if len(self.given) == limit:
                self.run()
            return future

        def run(self):
            for future, function, arguments in reversed(self.given):
                future.set_result(function(*arguments))
            self.given.clear()

    limit = 2
    rows = 2 * running.FIRST_CHUNK
    base = hills()
    over = {"vehicle.load_factor": (0.0, 1.0), "timetable.travel_time_s": (150.0, 200.0)}
    with ThreadPoolExecutor(1) as one, ThreadPoolExecutor(3) as three:
        tables = [sweep(base, over, rows, executor=executor) for executor in (one, three, Backwards(), None)]
    for table in tables[1:]:
        for name, of in tables[0].columns.items():
            assert np.array_equal(of, table.columns[name], equal_nan=True)
        for name, of in tables[0].samples.items():
            assert np.array_equal(of, table.samples[name])


def test_another_process_can_take_a_chunk():
    """What an executor of processes or of a cluster does with it: it is sent there and back."""
    base, over = hills(), {"vehicle.load_factor": (0.0, 1.0), "timetable.travel_time_s": (100.0, 200.0)}
    table = sweep(base, over, 16)
    rows = pickle.loads(pickle.dumps(solve_rows))(*pickle.loads(pickle.dumps((table.study, samples_of(table)))))
    sent = pickle.loads(pickle.dumps(rows))
    assert np.array_equal(sent.values, np.column_stack(list(table.columns.values())), equal_nan=True)
    assert sent.reasons == table.reasons != {}


def test_who_stops_leaves_nothing_waiting():
    def stop(_done):
        raise KeyboardInterrupt

    with ThreadPoolExecutor(1) as executor:
        given = []
        submit = executor.submit
        executor.submit = lambda *arguments: given.append(submit(*arguments)) or given[-1]
        with pytest.raises(KeyboardInterrupt):
            sweep(hills(), {"vehicle.load_factor": (0.0, 1.0)}, 10_000, executor=executor, progress=stop)
    # one thread: what it had begun when the first chunk was told, and that chunk itself
    assert len(given) > 2
    assert sum(not future.cancelled() for future in given) <= 3


def test_progress_ends_with_all_rows():
    told = []
    sweep(hills(), {"vehicle.load_factor": (0.0, 1.0)}, 150, progress=told.append)
    assert told == sorted(told)
    assert told[-1] == 150


class TwoChunks(threading.Event):
    """Stops a study after the first progress that is told."""

    def __init__(self):
        super().__init__()
        self.told = []

    def is_set(self):
        return bool(self.told)


def test_a_stopped_study_goes_on_to_the_same_table():
    over = {"vehicle.load_factor": (0.0, 1.0), "timetable.travel_time_s": (120.0, 200.0)}
    study, stop = make_study(hills(), over, 300, "halton", seed=3), TwoChunks()
    results = MemoryResults(study)
    run_study(results, progress=stop.told.append, stop=stop)
    assert 0 < results.done < study.sample
    part = results.to_table()
    run_study(results)
    whole, other = results.to_table(), sweep(hills(), over, 300, "halton", seed=3)
    for name, values in whole.columns.items():
        assert np.array_equal(values, other.columns[name], equal_nan=True)
        assert np.array_equal(part.columns[name], values[part.index], equal_nan=True)
    assert whole.reasons == other.reasons != {}


def test_a_lost_worker_ends_a_study_in_a_sentence_and_what_is_done_stays():
    study = make_study(hills(), LOADS, 20_000)
    results, killed = MemoryResults(study), threading.Event()

    def kill(_done):
        if not killed.is_set():
            killed.set()
            os.kill(next(iter(pool._processes)), signal.SIGKILL)

    # one process: with a second one `_processes` may hold one that has not begun
    words = r"the workers of the study are gone; [0-9,]+ of 20,000 rows"
    with ProcessPoolExecutor(1, get_context("spawn")) as pool, pytest.raises(InterruptedStudyError, match=words):
        run_study(results, executor=pool, workers=lambda: 1, progress=kill)
    done = results.to_table()
    assert 0 < done.rows < study.sample
    assert np.array_equal(done.columns["energy_kwh"], sweep(hills(), LOADS, done.rows).columns["energy_kwh"])


def test_a_worker_of_another_version_is_refused():
    asked = replace(make_study(hills(), LOADS, 4), solver="of last week")
    with pytest.raises(VersionError, match="install the same railjoule"):
        solve_rows(asked, np.zeros((1, 1)))


def test_rows_come_in_order_whoever_makes_them():
    def slow_first(samples):
        if 0 in samples:
            late.wait(5)
        elif len(samples):
            late.set()
        return RowByRow(lambda sample: [2 * sample[0]], 1)(samples)

    samples, late = np.arange(7.0)[:, None], threading.Event()
    with ThreadPoolExecutor(2) as executor:
        steps = [rows.values[:, 0].tolist() for rows in rows_in_order(slow_first, samples, executor, 2)]
    assert [len(step) for step in steps] == [0, 2, 4, 6, 7]
    assert steps[-1] == [0, 2, 4, 6, 8, 10, 12]
    late.set()
    assert all_rows(slow_first, samples).values[:, 0].tolist() == steps[-1]


def test_an_error_that_is_no_result_ends_a_study():
    def fail(_sample):
        raise SolverError("no run")

    kept = RowByRow(fail, 2)(np.zeros((1, 1)))
    assert np.isnan(kept.values).all()
    assert kept.reasons == {0: "no run"}
    with pytest.raises(SolverError):
        all_rows(RowByRow(fail, 2, ()), np.zeros((3, 1)))
    with ThreadPoolExecutor(1) as executor, pytest.raises(SolverError):
        all_rows(RowByRow(fail, 2, ()), np.zeros((3, 1)), executor)


@pytest.mark.parametrize("study", [monte_carlo, sensitivity, energy_time_frontier])
def test_studies_do_not_depend_on_who_does_their_runs(study):
    base = load_scenario("liashenko-0").replace(**{"montecarlo.runs": 90})
    asked = {
        sensitivity: {"load_factors": (0.0, 1.0), "coordinate_errors_m": (-5.0, 5.0)},
        energy_time_frontier: {"travel_times_s": np.array([70.0, 150.0, 180.0])},
        monte_carlo: {},
    }[study]
    of = prepare_task(base) if study is energy_time_frontier else base
    with ThreadPoolExecutor(2) as executor:
        tables = [study(of, **asked, executor=who) for who in (None, executor)]
    assert tables[0].columns
    for name, values in tables[0].columns.items():
        assert np.array_equal(values, tables[1][name], equal_nan=True)
