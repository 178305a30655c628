import json
from dataclasses import replace

import pytest

from railjoule.core import Bound, load_scenario, solve
from railjoule.core.advice import Instruction
from railjoule.dashboard.command.summary import summarise

CONTRACT = [
    "title", "strategy", "energy_kwh", "traction_energy_kwh", "recuperated_kwh", "auxiliary_kwh", "losses_kwh",
    "travel_time_s", "distance_m", "max_speed_kmh", "lower_bound_kwh", "gap", "proven", "cells", "bound_covers",
    "solve_time_s", "phases", "notes",
]  # fmt: skip
"""Keys that the design promises to other programs."""
PHASE_KEYS = ["phase", "start_m", "end_m", "start_s", "end_s", "start_kmh", "end_kmh", "energy_kwh"]


@pytest.fixture(scope="module")
def run():
    return solve(load_scenario("liashenko-ii"))


@pytest.fixture(scope="module")
def summary(run):
    return summarise(run, 76.9)


def test_it_has_the_keys_of_the_contract(summary):
    assert set(CONTRACT) <= set(summary)
    assert all(list(phase) == PHASE_KEYS for phase in summary["phases"])


def test_numbers_are_those_of_the_trajectory(run, summary):
    assert (summary["title"], summary["strategy"]) == ("Metro, profile II", "optimal")
    assert summary["energy_kwh"] == run.energy_kwh
    assert (summary["gap"], summary["proven"]) == (run.gap, True)
    assert summary["price_of_time_wh_per_s"] == pytest.approx(run.price_of_time_w / 3600)
    assert summary["shortest_time_s"] == 76.9
    assert summary["phases"][0]["end_kmh"] == pytest.approx(run.phases[0].end_ms * 3.6)


def test_the_account_closes():
    changes = {"drive.recuperation_factor": 0.5, "vehicle.auxiliary_power_kw": 20.0}
    result = summarise(solve(load_scenario("metro-with-limit", changes)))
    taken = result["traction_energy_kwh"] - result["recuperated_kwh"]
    stored = sum(result[f"{kind}_kwh"] for kind in ("kinetic", "potential", "magnetic_field"))
    assert sum(result["losses_kwh"].values()) + stored == pytest.approx(taken, rel=1e-6)
    assert result["energy_kwh"] == pytest.approx(taken + result["auxiliary_kwh"], rel=1e-12)


def test_phases_cover_the_run(summary):
    phases = summary["phases"]
    assert phases[0]["start_m"] == 0
    assert phases[-1]["end_m"] == summary["distance_m"]
    own = summary["energy_kwh"] - summary["auxiliary_kwh"]
    assert sum(phase["energy_kwh"] for phase in phases) == pytest.approx(own)


def test_the_advice_is_told_with_the_numbers_that_are_printed(run, summary):
    assert [Instruction(**told) for told in summary["advice"]] == list(run.advice)
    assert len(summary["advice"]) == len(summary["phases"])
    assert all(told["from_m"] == round(told["from_m"]) for told in summary["advice"])


def test_what_is_not_known_is_null(run):
    plain = summarise(replace(run, bound=None, price_of_time_w=None))
    unknown = "lower_bound_kwh", "gap", "bound_statement", "bound_covers", "price_of_time_wh_per_s", "shortest_time_s"
    assert [plain[key] for key in unknown] == [None] * len(unknown)


def test_it_names_the_runs_that_a_bound_covers(run, summary):
    assert (summary["bound_covers"], summary["cells"]) == ("every run", len(run.nodes_m) - 1)
    assert "every_run_lower_bound_kwh" not in summary
    by_chains = Bound(3.6e6 * 2.2, "Chains.", run.travel_time_s, 3.6e6 * 2.1, run.nodes_m)
    tighter = summarise(run.with_bound(by_chains))
    assert (tighter["bound_covers"], tighter["lower_bound_kwh"]) == ("runs over this mesh", 2.2)
    assert tighter["every_run_lower_bound_kwh"] == pytest.approx(2.1)


def test_an_infinite_bound_is_null(run):
    endless = summarise(run.with_bound(Bound(float("-inf"), "None.", run.travel_time_s, float("-inf"))))
    assert endless["lower_bound_kwh"] is None
    assert endless["gap"] is None
    json.dumps(endless, allow_nan=False)
