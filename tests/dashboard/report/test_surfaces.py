import json

import numpy as np
import pytest

from railjoule.core import load_scenario, solve
from railjoule.core.studies.sensitivity_table import sensitivity
from railjoule.dashboard.pages.trade_off.compute import compute_enoc_map
from railjoule.dashboard.report.surfaces import MAX_NODES, cost_surface, enoc_surface


@pytest.fixture(scope="module")
def enoc():
    found = compute_enoc_map(load_scenario("ftorek-300s"))
    assert found is not None
    return found


def test_the_surface_of_enoc_has_the_map_s_own_numbers(enoc):
    data = enoc_surface(enoc).data
    assert len(data["x"]) == len(data["z"][0]) == MAX_NODES
    row = int(np.flatnonzero(enoc.acceleration_time_s == data["y"][3])[0])
    column = int(np.flatnonzero(enoc.travel_time_s == data["x"][5])[0])
    assert data["z"][3][5] == pytest.approx(enoc.energy_kwh[row, column], rel=1e-4)


def test_valley_and_run_lie_on_the_surface_of_enoc(enoc):
    run = solve(load_scenario("ftorek-300s"), "enoc")
    surface = enoc_surface(enoc, run)
    assert "dot: its run" in surface.element
    [place] = surface.data["points"]
    assert place == pytest.approx([run.travel_time_s, 31.0, run.energy_kwh], rel=2e-3)  # 31.0 s: the run's own note
    # the run has the best acceleration time, so it lies in the valley
    line = np.array(surface.data["line"])
    assert place[1] == pytest.approx(np.interp(place[0], line[:, 0], line[:, 1]), rel=2e-3)
    assert place[2] == pytest.approx(np.interp(place[0], line[:, 0], line[:, 2]), rel=2e-3)
    # beneath the cut alone, and no lower than the surface is anywhere at its travel time
    assert line[:, 2].max() <= np.nanmax(surface.z)
    assert np.all(np.diff(line[:, 0]) > 0)
    assert enoc_surface(enoc).data["points"] == []


def test_ticks_are_round_and_keep_clear_of_the_corners(enoc):
    for axis in ("x", "y", "z"):
        ticks = enoc_surface(enoc).data["ticks"][axis]
        assert 2 <= len(ticks) <= 6
        assert all(0.05 < share < 0.95 for share, _ in ticks)
        assert all(float(text) * 2 == round(float(text) * 2) for _, text in ticks)


def test_the_surface_of_costs_is_the_table():
    table = sensitivity(load_scenario("liashenko-ii"), (0.0, 1.0), (-10.0, 0.0, 10.0), both_directions=False)
    surface = cost_surface(table)
    assert np.array(surface.data["z"]) == pytest.approx(100 * table.overconsumption, rel=1e-4)
    assert 'aria-label="Overconsumption, %, over load and position error, from' in surface.element
    # no number that JSON does not know
    assert json.loads(json.dumps(surface.data, allow_nan=False))["x"] == [-10.0, 0.0, 10.0]


def test_a_scenario_that_enoc_does_not_take_has_no_such_surface():
    assert compute_enoc_map(load_scenario("metro-with-limit")) is None
