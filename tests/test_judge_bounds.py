"""The judge of bounds finds no rival below the bound on some seeds, and refutes a bound that is too high."""

from dataclasses import replace

import pytest

from railjoule.core import load_scenario, solve
from tests import judge_bounds
from tests.continuous_run import drive_plan
from tests.judge_bounds import judge
from tests.judged_tables import refuting, table

SEEDS = (pytest.param("7", marks=pytest.mark.nightly), "33", "42", "liashenko-ii", "tram-950m")
"""Short lines: copper loss, efficiency map, constant efficiency, induction; the first takes as long as the others."""


@pytest.mark.parametrize("name", SEEDS)
def test_no_rival_lies_below_the_bound(name):
    row = judge(name, (2.0,), ("optimal",))
    assert row["driven"] is not None
    assert not row["every_run"] or list(refuting(row)) == []


def test_a_bound_that_is_too_high_is_refuted(monkeypatch):
    def too_high(scenario, strategy):
        run = solve(scenario, strategy)
        return replace(run, bound=replace(run.bound, energy_j=1.002 * run.energy.net_j))

    monkeypatch.setattr(judge_bounds, "solve", too_high)
    row = judge("liashenko-ii", (2.0,), ("optimal",)) | {"seed": "liashenko-ii", "status": "solved"}
    # the optimum over cells of 2 m costs 0.04 % less than the one over the scenario's
    assert dict(refuting(row))["optimal over the finest mesh"] == pytest.approx(2e-3, abs=5e-4)
    assert "bounds refuted: 1 of 1" in table([row])


def test_the_driven_train_arrives_as_its_plan():
    """Over cells of 2 m, limits of effort at a cell's mean speed are nearly those at each instant."""
    plan = solve(load_scenario("ftorek-300s", {"solver.mesh_m": 2.0}))
    run = drive_plan(plan)
    assert run.travel_time_s == pytest.approx(plan.travel_time_s, rel=1e-4)
    assert run.energy_j == pytest.approx(plan.energy.net_j, rel=1e-4)
    assert run.excess_share == 0
