import numpy as np
import pytest
from builders import plain_scenario

from railjoule.core import load_scenario
from railjoule.core.simulate.following import plan_for, simulate_following
from railjoule.core.studies import sensitivity


@pytest.fixture(scope="module")
def table():
    return sensitivity(load_scenario("liashenko-i"))


def test_cells_are_single_simulations(table):
    energy = 0.0
    for reverse in (False, True):
        changes = {"disturbance.actual_load_factor": 0.75, "disturbance.coordinate_error_m": -20.0}
        energy += simulate_following(
            load_scenario("liashenko-i").with_(**{**changes, "line.reverse": reverse})
        ).actual.energy_kwh
    cell = table.sel(load_factor=0.75, coordinate_error_m=-20.0)
    assert cell.energy_kwh.item() == pytest.approx(energy, rel=1e-12)
    assert cell.overconsumption.item() == pytest.approx(energy / table.attrs["planned_energy_kwh"] - 1)


def test_the_cell_of_the_plan_costs_nothing_more(table):
    cell = table.sel(load_factor=0.5, coordinate_error_m=0.0)
    assert cell.overconsumption.item() == pytest.approx(0, abs=1e-9)
    assert cell.over_replanned.item() == pytest.approx(0, abs=1e-9)
    assert cell.delay_s.item() == pytest.approx(0, abs=1e-6)


def test_overconsumption_grows_with_the_error(table):
    """Trend of Tables 4 to 7 of Liashenko 2025; size of Table 5 at half load as in findings.md."""
    planned = 100 * table.over_replanned.sel(load_factor=0.5)
    assert planned.sel(coordinate_error_m=[25.0, 20.0, 10.0]).values == pytest.approx([4.7, 3.8, 1.9], abs=0.1)
    assert np.all(np.diff(planned.sel(coordinate_error_m=[0.0, -10.0, -20.0, -25.0]).values) > 0)


def test_a_train_that_knows_its_load_loses_nothing_by_it():
    scenario = load_scenario("liashenko-ii")
    table = sensitivity(scenario, [0.0, 1.0], [0.0], both_directions=False, replan=True)
    assert table.over_replanned.values == pytest.approx(0, abs=1e-9)
    own = plan_for(scenario.with_(**{"vehicle.load_factor": 1.0})).energy_kwh
    assert table.energy_kwh.sel(load_factor=1.0).item() == pytest.approx(own, rel=1e-9)


def test_a_cell_that_cannot_be_driven_is_nan():
    changes = {
        "vehicle.capacity_passengers": 2000,
        "line.sections": [{"length_m": 600.0}, {"length_m": 1400.0, "gradient_permille": 45.0}],
        "timetable.travel_time_s": 300.0,
    }
    table = sensitivity(plain_scenario(changes), [0.0, 1.0], [0.0], both_directions=False)
    assert np.isnan(table.energy_kwh.values).tolist() == [[False], [True]]
