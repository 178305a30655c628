import numpy as np
import pytest

from railjoule.core import ScenarioError, load_scenario
from railjoule.core.simulation.field_oriented import simulate_field_oriented
from railjoule.core.studies.detuning import detuning_steps

SCENARIO = load_scenario(
    "ftorek-300s",
    {"line.preset": None, "line.sections": [{"length_m": 1000.0}], "timetable.travel_time_s": 90.0},
)


def test_it_grows_by_a_run_a_step():
    tables = list(detuning_steps(SCENARIO, (0.7, 1.0, 1.5)))
    assert [table.done for table in tables] == [0, 1, 2, 3]
    assert [np.count_nonzero(np.isfinite(table.energy_kwh)) for table in tables] == [0, 1, 2, 3]
    table = tables[-1]
    tuned = simulate_field_oriented(SCENARIO)
    assert table.energy_kwh[1] == tuned.energy_by_input_power_kwh
    assert table.max_current_a[1] == tuned.max_current_a
    # too large a resistance leaves less flux, and the same torque takes more current
    assert table.max_current_a[2] > table.max_current_a[1]
    assert table.energy_kwh[2] > table.energy_kwh[1]
    assert table.magnetising_loss_kwh[0] > table.magnetising_loss_kwh[1] > table.magnetising_loss_kwh[2]
    assert table.to_xarray().sizes == {"rotor_resistance_factor": 3}


def test_a_factor_out_of_bounds_is_refused():
    with pytest.raises(ScenarioError, match=r"simulation\.rotor_resistance_factor = 9 must be at most 5"):
        next(detuning_steps(SCENARIO, (1.0, 9.0)))
    with pytest.raises(ScenarioError, match="at least one factor"):
        next(detuning_steps(SCENARIO, ()))
