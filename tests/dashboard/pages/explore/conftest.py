from collections.abc import Mapping

import numpy as np
import pytest
from builders import plain_scenario

from railjoule.core.studies.sweep import MemoryResults, SweepTable, make_study, run_study

OVER: Mapping[str, tuple[float, float]] = {
    "timetable.travel_time_s": (140.0, 190.0),
    "vehicle.load_factor": (0.0, 1.0),
    "drive.recuperation_factor": (0.0, 0.8),
}


@pytest.fixture(scope="package")
def table() -> SweepTable:
    """200 runs of a plain scenario, three numbers of which vary."""
    results = MemoryResults(make_study(plain_scenario(), OVER, 200, seed=3))
    run_study(results)
    found = results.to_table()
    assert np.all(np.isfinite(found.columns["energy_kwh"]))
    return found
