import pytest

from railjoule.core import ScenarioError
from railjoule.core.studies.sweep import MemoryResults, make_study
from tests.builders import plain_scenario


def study(rows=10):
    return make_study(plain_scenario(), {"vehicle.load_factor": (0.0, 1.0)}, rows, columns=("energy_kwh",))


def test_a_table_too_large_for_the_memory_is_refused():
    # 2**28 bytes are 16,777,216 rows of two numbers
    with pytest.raises(ScenarioError, match="takes at most 16,777,216 rows in memory"):
        MemoryResults(study(16_777_217))
