"""Runs with one effort in each cell: what they reach, and that no limit is passed where phases meet within a cell."""

import numpy as np
import pytest
from builders import plain_scenario
from set_speeds import drive_under_limits

from railjoule.core.limit_search.regulation import make_regulation
from railjoule.core.limit_search.trip import trip_over_cells
from railjoule.core.task import prepare_task


@pytest.mark.parametrize("border", [1000.0000001, 1000.0004, 999.9995])
def test_borders_beside_a_node_are_merged_with_it(border):
    """The mesh has a node at 1000 m: cells of less than a millimetre would hold rounding."""
    run = drive_under_limits(plain_scenario({"search.boundaries_m": [border]}), [60, 40], "coast")
    assert np.diff(run.nodes_m).min() > 1e-3
    there = drive_under_limits(plain_scenario({"search.boundaries_m": [1000.0]}), [60, 40], "coast")
    assert run.energy_kwh == pytest.approx(there.energy_kwh, rel=1e-5)


def test_a_train_too_fast_to_brake_fails_where_it_passes_the_limit():
    """From 20 m/s a stop at 0.5 m/s2 takes 400 m; the line has 300."""
    scenario = plain_scenario({"line.sections": [{"length_m": 300.0}], "vehicle.braking.max_deceleration_ms2": 0.5})
    mesh = prepare_task(scenario).mesh
    data = mesh.data._replace(fixed_speed2=np.where(np.arange(mesh.cell_count + 1) == 0, 400.0, mesh.data.fixed_speed2))
    regulation = make_regulation(mesh, 0.8, False)
    position, speed2, seconds, _ = trip_over_cells(data, regulation, np.empty(0), np.array([25.0]))
    assert seconds == np.inf
    assert position[-1] == 300
    assert speed2[-1] == pytest.approx(400 - 2 * 0.5 * 300)
