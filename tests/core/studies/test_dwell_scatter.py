"""Dwells that scatter: delays in closed form, and the run that makes up for them."""

import numpy as np
import pytest

from railjoule.core import ScenarioError
from railjoule.core.studies.montecarlo import CONDITIONS, SENSOR_ERRORS, draw_dwells, monte_carlo, punctuality
from tests.builders import plain_scenario

STATIONS = [{"name": "A", "position_m": 700.0, "dwell_s": 20.0}, {"position_m": 1400.0, "dwell_s": 20.0}]


def scenario_with(dwell, runs=20, **changes):
    nothing = {name: {"distribution": "fixed", "value": 0.0} for name in (*CONDITIONS, "speed_error", *SENSOR_ERRORS)}
    nothing |= {name: {"distribution": "fixed", "value": 1.0} for name in ("resistance_factor", "line_voltage_factor")}
    return plain_scenario(
        {
            "line.stations": STATIONS,
            "line.sections": [{"length_m": 2100.0}],
            "timetable": {"reserve_percent": 30.0},
            "simulation.target_braking": False,
            "solver.mesh_m": 25.0,
            "montecarlo": {"runs": runs, "seed": 1, **nothing, "dwell_delay_s": dwell},
            **changes,
        }
    )


def test_delays_add_up_where_the_plan_is_kept():
    table = monte_carlo(scenario_with({"distribution": "exponential", "mean": 6.0}))
    first, second = table["dwell_delay_1_s"], table["dwell_delay_2_s"]
    assert table["arrival_delay_1_s"] == pytest.approx(0.0, abs=1e-3)
    assert table["arrival_delay_2_s"] == pytest.approx(first, abs=2e-3)
    assert table.delay_s == pytest.approx(first + second, abs=4e-3)
    # the auxiliaries of this train take nothing: standing longer costs nothing, making up for it does
    assert table.energy_kwh == pytest.approx(table.attributes["planned_energy_kwh"], rel=1e-3)
    assert np.all(table["made_up_delay_s"] < table.delay_s - 0.5 * np.minimum(table.delay_s, 5.0))
    assert np.all(table["made_up_kwh"] > table.energy_kwh)
    rows = {row.place: row for row in punctuality(table)}
    assert list(rows) == ["A", "station 3", "end, keeps to plan", "end, makes up"]
    assert rows["station 3"].mean_delay_s == pytest.approx(first.mean(), abs=2e-3)
    assert rows["end, makes up"].share_on_time >= rows["end, keeps to plan"].share_on_time


def test_a_shorter_dwell_waits_for_the_departure():
    table = monte_carlo(scenario_with({"distribution": "uniform", "low": -15.0, "high": 0.0}, runs=5))
    assert table.delay_s == pytest.approx(0.0, abs=2e-3)


def test_the_draws_have_their_distribution():
    drawn = draw_dwells(scenario_with({"distribution": "exponential", "mean": 6.0}, runs=4000))
    assert drawn.shape == (4000, 2)
    assert drawn.mean(axis=0) == pytest.approx([6.0, 6.0], rel=0.05)
    assert np.quantile(drawn, 0.5) == pytest.approx(6.0 * np.log(2), rel=0.05)
    assert abs(np.corrcoef(drawn.T)[0, 1]) < 0.05


def test_a_line_without_stations_has_no_dwells():
    with pytest.raises(ScenarioError, match="dwell_delay_s has no effect on a line without a station"):
        plain_scenario({"montecarlo.dwell_delay_s": {"distribution": "exponential", "mean": 6.0}})
