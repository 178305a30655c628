"""A sweep is held against `solve`, run by run: nothing else says what a row has to be."""

from dataclasses import replace

import numpy as np
import pytest

from railjoule.core import RailjouleError, ScenarioError, load_scenario, solve, sweep
from railjoule.core.strategies import prepare_task, run_strategy
from railjoule.core.studies.sweep import COLUMNS
from tests.builders import HILLS, plain_scenario

OVER = {
    "vehicle.load_factor": (0.0, 1.0),
    "timetable.travel_time_s": (105.0, 130.0),
    "vehicle.resistance.constant_n_per_kn": (0.9, 1.4),
    "drive.recuperation_factor": (0.0, 1.0),
}
# every number that an optimum of a plain train can depend on, with a range around what it is
NUMBERS = {
    "vehicle.tare_kg": (90e3, 120e3),
    "vehicle.capacity_passengers": (300.0, 500.0),
    "vehicle.passenger_mass_kg": (60.0, 90.0),
    "vehicle.load_factor": (0.0, 1.0),
    "vehicle.crush_load_factor": (1.0, 1.3),
    "vehicle.rotating_mass_factor": (0.05, 0.15),
    "vehicle.inertial_mass_kg": (105e3, 120e3),
    "vehicle.auxiliary_power_kw": (0.0, 30.0),
    "vehicle.line_voltage_v": (600.0, 900.0),
    "vehicle.length_m": (10.0, 120.0),
    "vehicle.resistance.constant_n_per_kn": (1.0, 3.0),
    "vehicle.resistance.linear_n_per_kn_per_kmh": (0.0, 0.01),
    "vehicle.resistance.quadratic_n_per_kn_per_kmh2": (1e-4, 1e-3),
    "vehicle.resistance.constant_n": (0.0, 500.0),
    "vehicle.resistance.linear_n_per_kmh": (0.0, 10.0),
    "vehicle.resistance.quadratic_n_per_kmh2": (0.0, 0.5),
    "vehicle.resistance.curve_constant_m_n_per_kn": (0.0, 700.0),
    "vehicle.traction.max_effort_kn": (90.0, 120.0),
    "vehicle.traction.max_power_kw": (800.0, 1200.0),
    "vehicle.traction.max_speed_kmh": (80.0, 110.0),
    "vehicle.traction.max_acceleration_ms2": (0.8, 1.2),
    "vehicle.braking.max_effort_kn": (60.0, 100.0),
    "vehicle.braking.max_power_kw": (600.0, 1200.0),
    "vehicle.braking.friction_effort_kn": (0.0, 50.0),
    "vehicle.braking.max_deceleration_ms2": (0.8, 1.2),
    "vehicle.drive.traction_efficiency": (0.8, 0.9),
    "drive.braking_efficiency": (0.7, 0.9),
    "drive.recuperation_factor": (0.0, 1.0),
    "line.head_wind_kmh": (0.0, 40.0),
    "timetable.travel_time_s": (150.0, 190.0),
    "timetable.average_speed_kmh": (38.0, 48.0),
    "timetable.entry_speed_kmh": (0.0, 30.0),
    "timetable.exit_speed_kmh": (0.0, 30.0),
    "solver.mesh_m": (8.0, 25.0),
}


def hills():
    return plain_scenario({"line.sections": HILLS, "timetable.travel_time_s": 170.0, "solver.mesh_m": 25.0})


def solved(scenario, strategy):
    """Return the run of `solve`, or the optimum over the scenario's own mesh for a drive without idle losses."""
    task = prepare_task(scenario)
    if strategy != "optimal" or task.mesh.drive.has_idle_losses:
        return solve(scenario, strategy)
    return run_strategy(replace(task, can_be_remeshed=False), strategy)


def one_by_one(base, table):
    """Return the numbers of the rows of a table, by column, NaN where a row is refused; and the reasons."""
    values, reasons = {name: np.full(table.rows, np.nan) for name in table.columns}, {}
    for row in range(table.rows):
        changes = {name: float(of[row]) for name, of in table.samples.items()}
        try:
            run = solved(base.replace(**changes), table.study.strategy)
        except RailjouleError as error:
            reasons[row] = str(error)
            continue
        for name in table.columns:
            number = COLUMNS[name](run)
            values[name][row] = np.nan if number is None else number
    return values, reasons


def assert_same(base, table):
    values, reasons = one_by_one(base, table)
    assert table.reasons == reasons
    for name, of in table.columns.items():
        # bit for bit: no tolerance
        assert np.array_equal(of, values[name], equal_nan=True), name


@pytest.mark.parametrize("method", ["grid", "random", "sobol", "halton"])
def test_a_row_is_the_run_over_its_mesh_bit_for_bit(method):
    base = load_scenario("liashenko-ii").replace(**{"solver.mesh_m": 10.0})
    table = sweep(base, OVER, 16, method, seed=3, columns=tuple(COLUMNS))
    assert not table.reasons
    assert_same(base, table)


@pytest.mark.parametrize("field", NUMBERS)
def test_each_number_reaches_what_depends_on_it(field):
    """A part of a meshed line that was kept by mistake would give the numbers of another row."""
    base = hills()
    # each alone, and beside two that touch little, so that as much as possible is kept
    assert_same(base, sweep(base, {field: NUMBERS[field]}, 3, "grid"))
    beside = {"vehicle.load_factor": (0.2, 0.8), "drive.recuperation_factor": (0.3, 0.9), field: NUMBERS[field]}
    assert_same(base, sweep(base, beside, 4, "random"))


def test_a_line_with_stations_has_its_dwells():
    base = load_scenario("metro-10-stations").replace(**{"solver.mesh_m": 100.0})
    over = {"vehicle.load_factor": (0.0, 1.0), "vehicle.auxiliary_power_kw": (0.0, 50.0)}
    table = sweep(base, over, 9, "grid", columns=tuple(COLUMNS))
    # its stations make it stand for some minutes: a time without dwells would be another
    assert table.columns["travel_time_s"] == pytest.approx(base.travel_time_s, abs=0.01)
    assert not table.reasons
    assert_same(base, table)


def test_what_cannot_be_driven_keeps_its_row_with_the_reason():
    base = hills()
    table = sweep(base, {"timetable.travel_time_s": (60.0, 200.0), "vehicle.load_factor": (0.0, 1.0)}, 25, "grid")
    assert 0 < len(table.reasons) < 25
    assert all("is shorter than the shortest possible" in reason for reason in table.reasons.values())
    assert [row for row in range(25) if np.isnan(table.columns["energy_kwh"][row])] == list(table.reasons)
    assert_same(base, table)
    frame = table.to_dataframe()
    assert (frame["reason"] != "").sum() == len(table.reasons)
    assert list(frame.columns) == [*table.samples, *table.columns, "reason"]


def test_ranges_that_do_not_fit_together_everywhere_are_checked_row_by_row():
    base = hills()
    over = {"vehicle.load_factor": (0.5, 1.2), "vehicle.crush_load_factor": (1.0, 1.3)}
    base = base.replace(**{"vehicle.crush_load_factor": 1.2})
    table = sweep(base, over, 16, "grid")
    assert any("must be at most" in reason for reason in table.reasons.values())
    assert 0 < len(table.reasons) < 16
    assert_same(base, table)


@pytest.mark.parametrize("strategy", ["fastest", "phases"])
def test_other_strategies_go_by_solve(strategy):
    base = load_scenario("tram-950m").replace(**{"solver.mesh_m": 25.0})
    table = sweep(base, {"vehicle.load_factor": (0.0, 1.0)}, 2, "grid", strategy=strategy)
    assert table.study.strategy == strategy
    assert_same(base, table)


def test_a_drive_that_takes_power_without_effort_goes_by_solve():
    base = load_scenario("tram-950m").replace(**{"solver.mesh_m": 50.0})
    assert_same(base, sweep(base, {"timetable.travel_time_s": (100.0, 120.0)}, 2, "grid"))


def test_a_table_cannot_be_written_to():
    table = sweep(hills(), {"vehicle.load_factor": (0.0, 1.0)}, 2)
    with pytest.raises(ValueError, match="read-only"):
        table.columns["energy_kwh"][0] = 0.0


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"strategy": "best"}, "strategy = 'best' must be one of optimal, bellman"),
        ({"columns": ("energy",)}, "there is no column energy: did you mean 'energy_kwh'"),
        ({"columns": ("energy_kwh", "energy_kwh")}, "the column energy_kwh is named twice"),
        ({"sample": 10**9}, "a table of 5 columns takes at most 6,710,886 rows"),
        ({"sample": 0}, "sample = 0 must be a whole number from 1"),
        ({"seed": -1}, "seed = -1 must be a whole number from 0"),
        ({"method": "latin"}, "method = 'latin' must be one of grid, random, sobol, halton"),
    ],
)
def test_a_bad_sweep_is_refused_in_a_sentence(changes, words):
    asked = {"over": {"vehicle.load_factor": (0.0, 1.0)}, "sample": 4, **changes}
    with pytest.raises(ScenarioError, match=words):
        sweep(hills(), **asked)
