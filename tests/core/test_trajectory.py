"""A run as arrays: its account, its gap, its table."""

from dataclasses import FrozenInstanceError, fields, replace

import numpy as np
import pytest
from builders import COPPER_LOSS, plain_scenario

from railjoule.core import Bound, solve
from railjoule.core.lower_bound import Reference
from railjoule.core.motion import build_meshed_line
from railjoule.core.trajectory import make_trajectory

DWELL = {
    "line.stations": [{"position_m": 900.0, "dwell_s": 30.0}],
    "vehicle.auxiliary_power_kw": 40.0,
    "timetable.travel_time_s": 250.0,
}


@pytest.fixture(scope="module")
def stopping():
    return solve(plain_scenario(DWELL))


def test_a_dwell_is_a_cell_without_length(stopping):
    (cell,) = np.flatnonzero(np.diff(stopping.position_m) == 0)
    assert stopping.position_m[cell] == 900
    assert stopping.speed_ms[cell : cell + 2].tolist() == [0, 0]
    assert stopping.effort_n[cell] == stopping.max_effort_n[cell] == 0
    assert stopping.supply_power_w[cell] == 40e3
    assert np.diff(stopping.time_s)[cell] == pytest.approx(30)
    assert np.diff(stopping.supply_energy_j)[cell] == pytest.approx(30 * 40e3)
    nodes = len(stopping.position_m)
    assert {len(getattr(stopping, name)) for name in ("speed_ms", "time_s", "supply_energy_j")} == {nodes}
    cells = ("tractive_effort_n", "electric_braking_n", "friction_braking_n", "supply_power_w", "gradient_permille")
    assert {len(getattr(stopping, name)) for name in cells} == {nodes - 1}


def test_arrays_and_fields_are_frozen(stopping):
    arrays = [getattr(stopping, field.name) for field in fields(stopping)]
    for array in (array for array in arrays if isinstance(array, np.ndarray)):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0
    with pytest.raises(FrozenInstanceError):
        stopping.strategy = "other"


def bound_runs(run, energy_j, late_s=0.0):
    """Return a bound of every driving that takes as long as a run, or longer by `late_s`."""
    return Bound(energy_j, "any", run.travel_time_s + late_s, energy_j)


def bound_mesh_runs(run, **details):
    """Return a bound of runs over just the nodes of a run, no later than it."""
    return replace(bound_runs(run, 1.0), position_m=run.nodes_m, **details)


def test_a_bound_covers_no_run_that_is_slower_than_its_proof_allows(stopping):
    slowest = np.where(stopping.node_speed_ms > 0, 0.9 * stopping.node_speed_ms, 0.0)
    bound = bound_mesh_runs(stopping, slowest_ms=slowest)
    assert bound.covers(stopping)
    slowest[5] = 1.1 * stopping.node_speed_ms[5]
    assert not replace(bound, slowest_ms=slowest).covers(stopping)


def test_gap_is_relative_to_the_bound(stopping):
    net = stopping.energy.net_j
    assert stopping.with_bound(bound_runs(stopping, 0.8 * net)).gap == pytest.approx(0.25)
    assert stopping.with_bound(bound_runs(stopping, net)).gap == 0


@pytest.mark.parametrize("bound_j", [0.0, 1.0, -2e5])
def test_gap_of_a_small_bound_is_relative_to_a_tenth_of_the_kinetic_energy(stopping, bound_j):
    """Of 110 t at the mean speed, 2000 m in the time of the run."""
    tenth = 0.1 * 0.5 * 110e3 * (2000 / stopping.travel_time_s) ** 2
    run = stopping.with_bound(bound_runs(stopping, bound_j))
    assert run.gap == pytest.approx((stopping.energy.net_j - bound_j) / tenth)


def test_a_bound_can_be_given_and_taken_away(stopping):
    bound = bound_runs(stopping, 1.0)
    given, taken = stopping.with_bound(bound), stopping.with_bound(None)
    assert given.bound is bound
    assert (taken.gap, taken.lower_bound_kwh) == (None, None)
    assert given.speed_ms is taken.speed_ms is stopping.speed_ms


def test_a_run_without_bound_has_no_gap_and_is_not_proven(stopping):
    run = replace(stopping, bound=None)
    assert (run.gap, run.lower_bound_kwh, run.is_proven) == (None, None, False)


@pytest.mark.parametrize("tolerance", [5e-4, 1e-5])
@pytest.mark.parametrize(
    ("part", "below", "proven"), [(0.9, 0.0, True), (0, 0.9, True), (1.1, 0, False), (0, 1.1, False)]
)
def test_a_run_is_proven_within_the_tolerance_of_its_scenario(stopping, tolerance, part, below, proven):
    """Below its bound, only rounding of a hundred-thousandth is tolerated: such a run is one of too coarse a mesh."""
    bound = bound_runs(stopping, stopping.energy.net_j / (1 + part * tolerance - below * 1e-5))
    scenario = stopping.scenario.replace(**{"solver.tolerance": tolerance})
    run = replace(stopping, scenario=scenario, bound=bound)
    assert (run.is_proven, run.is_below_bound) == (proven, below > 1)


def test_a_run_tells_by_how_much_it_lies_above_its_reference(stopping):
    net = stopping.energy.net_j
    run = replace(stopping, reference=Reference(0.8 * net, "other", 150.0, proven=True))
    assert (run.above_share, run.above_kwh) == (pytest.approx(0.25), pytest.approx(0.2 * net / 3.6e6))
    assert (replace(run, reference=None).above_share, replace(run, reference=None).above_kwh) == (None, None)


def test_a_negative_reference_is_no_measure_but_leaves_the_difference(stopping):
    run = replace(stopping, reference=Reference(-3.6e6, "other", 150.0, proven=True))
    assert run.above_share is None
    assert run.above_kwh == pytest.approx(stopping.energy_kwh + 1)


def test_a_bound_covers_the_runs_that_are_no_later_and_over_its_nodes_if_it_has_any(stopping):
    assert len(stopping.nodes_m) == len(stopping.position_m) - 1  # where it dwells a node stands twice
    assert stopping.with_bound(bound_runs(stopping, 1.0, late_s=5.0)).bound is not None
    assert stopping.with_bound(bound_runs(stopping, 1.0, late_s=-5.0)).bound is None
    of_mesh, of_all = bound_mesh_runs(stopping), bound_runs(stopping, 1.0)
    assert (of_mesh.covers_every_run, of_all.covers_every_run) == (False, True)
    assert of_mesh.covers(stopping)
    assert not replace(of_mesh, position_m=stopping.nodes_m[::2]).covers(stopping)


def test_table_has_a_row_a_node_and_its_unit_in_each_name(stopping):
    table = stopping.to_dataframe()
    assert table["position_m"].tolist() == stopping.position_m.tolist()
    assert table["time_s"].tolist() == stopping.time_s.tolist()
    for column, expected in {
        "speed_kmh": 3.6 * stopping.speed_ms,
        "effort_kn": np.append(stopping.effort_n, stopping.effort_n[-1]) / 1e3,
        "line_power_kw": np.append(stopping.supply_power_w, stopping.supply_power_w[-1]) / 1e3,
        "line_energy_kwh": stopping.supply_energy_j / 3.6e6,
        "gradient_permille": np.append(stopping.gradient_permille, stopping.gradient_permille[-1]),
    }.items():
        assert table[column].to_numpy() == pytest.approx(expected), column
    assert len(table.columns) == 7


def test_table_has_a_current_where_the_drive_has_one():
    """Of one of four motors: F r / (n k u), negative in braking."""
    run = solve(plain_scenario({"vehicle.drive": COPPER_LOSS}))
    current = run.to_dataframe()["current_a"].to_numpy()[:-1]
    assert current == pytest.approx(run.effort_n * 0.4 / (4 * 5.0 * 5.0))
    assert current.min() < 0 < current.max()
    assert solve(plain_scenario()).current_a is None


def test_an_electric_brake_that_would_draw_power_leaves_it_to_friction():
    """Below v = coefficient F, 1.5 m/s here and so in the last cell alone, motors would draw; they generate most, with
    v^2 / (4 coefficient), at half of the effort that just generates nothing."""
    drive = {**COPPER_LOSS, "resistance_ohm": 0.3}
    with_friction = plain_scenario({"vehicle.drive": drive, "vehicle.braking.friction_effort_kn": 100.0})
    mesh = build_meshed_line(with_friction)
    speed2 = 2 * 0.7 * np.minimum(mesh.position_m, 2000 - mesh.position_m).clip(max=80.0)
    without = plain_scenario({"vehicle.drive": drive})
    by_motors = make_trajectory(without, build_meshed_line(without), "any", speed2)
    by_both = make_trajectory(with_friction, mesh, "any", speed2)
    assert by_motors.supply_power_w[-1] > 0
    coefficient, speed = mesh.drive.parameters[0], 0.5 * by_both.speed_ms[-2]
    assert by_both.electric_braking_n[-1] == pytest.approx(speed / (2 * coefficient))
    assert by_both.supply_power_w[-1] == pytest.approx(-0.5 * speed**2 / (4 * coefficient))
    spared = (by_motors.supply_power_w - by_both.supply_power_w) @ np.diff(by_motors.time_s)
    assert by_both.energy.net_j == pytest.approx(by_motors.energy.net_j - spared)
    # where motors generate the more the more they brake, they do all
    mean_speed = 0.5 * (by_both.speed_ms[1:] + by_both.speed_ms[:-1])
    fast = mean_speed > 2 * coefficient * by_motors.electric_braking_n
    assert 0 < np.count_nonzero(~fast) < 8
    assert np.array_equal(by_both.electric_braking_n[fast], by_motors.electric_braking_n[fast])


def test_the_permitted_speed_ends_at_a_stop_and_begins_anew_behind_it():
    """At 0.5 m/s2: 10 m/s 100 m before the stop, and from there 1100 m to the end, the limit of 100 km/h."""
    run = solve(plain_scenario({**DWELL, "vehicle.braking.permitted_deceleration": [[0, 0.5]]}), "fastest")
    permitted = run.permitted_speed_ms
    assert permitted[np.argmin(np.abs(run.position_m - 800))] == pytest.approx(10)
    assert permitted[run.position_m == 900.0].tolist() == [0.0, pytest.approx(100 / 3.6)]
    assert permitted[[0, -1]].tolist() == [pytest.approx(100 / 3.6), 0.0]
    assert solve(plain_scenario(DWELL), "fastest").permitted_speed_ms is None
