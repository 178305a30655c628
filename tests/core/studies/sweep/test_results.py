import numpy as np
import pytest

from railjoule.core import ScenarioError
from railjoule.core.studies.sweep import MemoryResults, study_of, table_of
from railjoule.core.studies.sweep.results import Chunk, gaps_between
from railjoule.core.studies.sweep.rows import Rows
from tests.builders import plain_scenario


def study(rows=10):
    return study_of(plain_scenario(), {"vehicle.load_factor": (0.0, 1.0)}, rows, columns=("energy_kwh",))


def chunk(first, *numbers, reasons=None):
    values = np.array(numbers)[:, None]
    return Chunk(first, values / 10, Rows(values, reasons or {}, 1.0))


@pytest.mark.parametrize(
    ("stretches", "gaps"),
    [
        ([], [(0, 10)]),
        ([(0, 10)], []),
        ([(0, 3), (3, 5)], [(5, 10)]),
        ([(2, 4), (7, 10)], [(0, 2), (4, 7)]),
    ],
)
def test_gaps_are_what_stretches_leave(stretches, gaps):
    assert gaps_between(stretches, 10) == gaps


def test_chunks_in_any_order_become_a_table_in_that_of_the_rows():
    results = MemoryResults(study())
    results.append(chunk(6, 6.0, 7.0), 2.0)
    results.append(chunk(1, np.nan, 2.0, reasons={0: "too short"}), 3.0)
    table = table_of(results)
    assert (results.done, results.seconds) == (4, 5.0)
    assert results.gaps() == [(0, 1), (3, 6), (8, 10)]
    assert table.index.tolist() == [1, 2, 6, 7]
    assert table.columns["energy_kwh"].tolist()[1:] == [2.0, 6.0, 7.0]
    assert table.reasons == {1: "too short"}
    assert [(part.first, part.end, part.reasons) for part in table.chunks()] == [(1, 3, {1: "too short"}), (6, 8, {})]
    assert table.to_dataframe()["reason"].tolist() == ["too short", "", "", ""]


def test_a_table_too_large_for_the_memory_is_refused():
    # 2**28 bytes are 16,777,216 rows of two numbers
    with pytest.raises(ScenarioError, match="takes at most 16,777,216 rows in memory"):
        MemoryResults(study(16_777_217))
