"""The check of a table of nodes: as far as it tells, as of the run itself; what it does not tell is said."""

import numpy as np
import pandas as pd
import pytest

from railjoule.core import ScenarioError, check_table, solve
from tests.builders import COPPER_LOSS, INDUCTION, plain_scenario
from tests.core.check.test_check import scenario_of

FRICTION = {"vehicle.braking.friction_effort_kn": 50.0, "vehicle.braking.max_effort_kn": 40.0}


@pytest.fixture(scope="module")
def run():
    return solve(plain_scenario({"vehicle.drive": COPPER_LOSS}))


@pytest.fixture
def table(run):
    return run.to_dataframe()


def names(result):
    return {check.name for check in result.checks}, {rule.name for rule in result.not_checked}


def test_a_table_of_a_good_run_keeps_every_rule(run, table):
    result = check_table(run.scenario, table)
    checked, unchecked = names(result)
    assert result.ok
    assert {"balance of forces", "line power", "motor current", "sharing of the brakes", "energy so far"} <= checked
    assert unchecked == {"account", "bound below the energy", "early arrival"}


@pytest.mark.parametrize(
    "drive", [COPPER_LOSS, INDUCTION | {"motors": 20}, plain_scenario().vehicle.drive.model_dump()]
)
def test_of_two_brakes_only_their_sum_and_what_is_possible_is_checked(drive):
    run = solve(
        plain_scenario({"vehicle.drive": drive | {"recuperation_factor": 1.0}} | FRICTION), "fastest", prove_seconds=0
    )
    table = run.to_dataframe()
    result = check_table(run.scenario, table, "fastest")
    checked, unchecked = names(result)
    assert result.ok
    assert {"effort of all brakes", "line power"} <= checked
    assert {"sharing of the brakes", "electric braking effort", "friction braking effort"} <= unchecked
    # no sharing gives back more than all of it in the electric brake
    braking = int(np.argmin(run.supply_power_w))
    table.loc[braking, "line_power_kw"] *= 1.01
    assert "line power" in {check.name for check in check_table(run.scenario, table, "fastest").broken}


@pytest.mark.parametrize(
    ("column", "rule"),
    [
        ("effort_kn", "balance of forces"),
        ("line_power_kw", "line power"),
        ("line_energy_kwh", "energy so far"),
        ("gradient_permille", "gradient"),
        ("current_a", "motor current"),
        ("time_s", "time of each cell"),
        ("position_m", "whole line driven"),
        ("speed_kmh", "time of each cell"),
    ],
)
def test_every_column_is_checked(run, table, column, rule):
    table[column] = 1.001 * table[column] + (0.01 if column == "gradient_permille" else 0.0)
    assert rule in {check.name for check in check_table(run.scenario, table).broken}


@pytest.mark.parametrize("column", ["effort_kn", "line_power_kw", "line_energy_kwh", "gradient_permille", "current_a"])
def test_a_column_that_is_missing_is_told(run, table, column):
    whole, less = check_table(run.scenario, table), check_table(run.scenario, table.drop(columns=column))
    assert less.ok
    assert len(less.checks) < len(whole.checks)
    reasons = " ".join(rule.reason for rule in less.not_checked)
    assert column in reasons


@pytest.mark.parametrize("column", ["position_m", "time_s", "speed_kmh"])
def test_a_column_that_must_be_there_is_asked_for(run, table, column):
    with pytest.raises(
        ScenarioError, match=f"^has no column {column}; a run needs at least position_m, time_s, speed_kmh"
    ):
        check_table(run.scenario, table.drop(columns=column))


def test_words_and_short_tables_are_refused(run, table):
    with pytest.raises(ScenarioError, match="no number in its column time_s"):
        check_table(run.scenario, table.astype({"time_s": str}).assign(time_s="later"))
    with pytest.raises(ScenarioError, match="has 1 of at least 2 rows"):
        check_table(run.scenario, table.head(1))


def test_an_empty_cell_is_no_finite_number(run, table):
    table.loc[7, "speed_kmh"] = None
    result = check_table(run.scenario, table)
    assert [check.name for check in result.broken] == ["finite numbers"]
    assert result.broken[0].at_m == run.position_m[7]


def test_a_table_goes_through_csv_unharmed(run, table, tmp_path):
    table.to_csv(tmp_path / "run.csv", index=False)
    assert check_table(run.scenario, pd.read_csv(tmp_path / "run.csv")).ok


def test_the_strategy_says_whether_a_run_may_be_late(run, table):
    hurried = run.scenario.replace(**{"timetable.travel_time_s": 149.0})
    assert "late arrival" in {check.name for check in check_table(hurried, table).broken}
    assert "late arrival" not in {check.name for check in check_table(hurried, table, "speed_limits").broken}


@pytest.mark.parametrize("drive", ["copper_loss", "induction", "synchronous", "efficiency_map"])
def test_no_table_is_too_strange(drive):
    """Whatever stands in it, a table gets its verdict, without an error or a warning."""
    good = solve(scenario_of(drive), "fastest", prove_seconds=0)
    rng = np.random.default_rng(1)
    strange = [0.0, -1.0, 1e-300, 1e300, np.inf, np.nan, 1e6]
    for _ in range(20):
        table = good.to_dataframe().iloc[: int(rng.integers(2, 80))].reset_index(drop=True)
        for column in rng.choice(table.columns, int(rng.integers(1, 4))):
            rows = rng.integers(0, len(table), int(rng.integers(1, 4))) if rng.random() < 0.7 else slice(None)
            table.loc[rows, column] = rng.choice(strange)
        result = check_table(good.scenario, table, "fastest")
        assert not result.ok
        assert result.verdict
