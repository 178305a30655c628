import numpy as np
import pytest
from builders import plain_scenario

from railjoule.core import ScenarioError, load_scenario
from railjoule.core.simulation.following import plan_for, simulate_following
from railjoule.core.studies import sensitivity, sensitivity_steps


@pytest.fixture(scope="module")
def table():
    return sensitivity(load_scenario("liashenko-i")).to_xarray()


def test_cells_are_single_simulations(table):
    energy = 0.0
    for reverse in (False, True):
        changes = {"disturbance.actual_load_factor": 0.75, "disturbance.coordinate_error_m": -20.0}
        energy += simulate_following(
            load_scenario("liashenko-i").replace(**{**changes, "line.reverse": reverse})
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


def test_the_table_fills_cell_by_cell():
    steps = list(sensitivity_steps(load_scenario("liashenko-0"), [0.0, 1.0], [-5.0, 5.0], both_directions=False))
    assert [int(np.isfinite(step.energy_kwh).sum()) for step in steps] == [0, 1, 2, 3, 4]
    assert [step.done for step in steps] == [0, 1, 2, 3, 4]


def test_a_train_that_knows_its_load_loses_nothing_by_it():
    scenario = load_scenario("liashenko-ii")
    table = sensitivity(scenario, [0.0, 1.0], [0.0], both_directions=False, known="load")
    assert table.over_replanned == pytest.approx(np.zeros((2, 1)), abs=1e-9)
    own = plan_for(scenario.replace(**{"vehicle.load_factor": 1.0})).energy_kwh
    assert table.energy_kwh[1, 0] == pytest.approx(own, rel=1e-9)


def test_a_train_that_knows_its_place_loses_nothing_by_its_error():
    wrong = sensitivity(load_scenario("liashenko-i"), [0.5], [-20.0, 20.0], both_directions=False)
    known = sensitivity(load_scenario("liashenko-i"), [0.5], [-20.0, 20.0], both_directions=False, known="place")
    both = sensitivity(load_scenario("liashenko-i"), [0.9], [20.0], both_directions=False, known="both")
    assert np.all(wrong.overconsumption > 0.005)
    assert known.overconsumption == pytest.approx(np.zeros((1, 2)), abs=1e-9)
    assert both.over_replanned == pytest.approx(np.zeros((1, 1)), abs=1e-9)


def test_a_cell_that_cannot_be_driven_is_nan():
    changes = {
        "vehicle.capacity_passengers": 2000,
        "line.sections": [{"length_m": 600.0}, {"length_m": 1400.0, "gradient_permille": 45.0}],
        "timetable.travel_time_s": 300.0,
    }
    table = sensitivity(plain_scenario(changes), [0.0, 1.0], [0.0], both_directions=False)
    assert np.isnan(table.energy_kwh).tolist() == [[False], [True]]


def test_a_load_above_the_crush_load_is_refused():
    with pytest.raises(ScenarioError, match=r"a load factor of the table = 1.3 must lie between 0 and 1.2.$"):
        sensitivity(load_scenario("liashenko-0"), [1.3])
