"""Which simple run is told first, and what is told of more and of fewer orders."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from railjoule.core.studies.simple_advice import FREE_SHARE, MAX_CHANGES, SimpleAdvice
from railjoule.dashboard.work.simple_advice import (
    LITTLE_ENERGY_SHARE,
    by_changes,
    first_told,
    more_changes,
    not_in_time,
)


def run(energy: float) -> Any:
    """Return what stands for a run of an energy [kWh]."""
    return SimpleNamespace(energy_kwh=energy, energy=SimpleNamespace(net_j=3.6e6 * energy))


def advice(*energies: float, optimum: float | None = 10.0, refused: tuple[int, ...] = ()) -> SimpleAdvice:
    """Return simple advice whose runs have these energies [kWh], with ever one change more."""
    runs = [
        SimpleNamespace(changes_allowed=changes, changes=changes, run=run(energy))
        for changes, energy in enumerate(energies, 2 + len(refused))
    ]
    told = tuple((changes, "late") for changes in refused)
    return SimpleAdvice(None if optimum is None else run(optimum), tuple(runs), told)


def test_the_fewest_changes_that_cost_at_most_a_hundredth_are_told_first() -> None:
    dear, cheap = 10 * (1 + 1.01 * LITTLE_ENERGY_SHARE), 10 * (1 + 0.99 * LITTLE_ENERGY_SHARE)
    assert first_told(advice(12.0, dear, cheap, 10.001)).changes == 4
    assert first_told(advice(12.0, 11.0)).changes == 3
    # without an optimum nothing is known to be cheap
    assert first_told(advice(12.0, 11.0, 10.0, optimum=None)).changes == 4
    # less than nothing, where the line gives energy back: a hundredth of -10 kWh lies above it
    assert first_told(advice(-9.0, -9.95, optimum=-10.0)).changes == 3


def test_of_two_runs_with_as_many_changes_the_cheaper_one_is_told() -> None:
    found = advice(12.0, 11.0)
    again = SimpleNamespace(changes_allowed=4, changes=3, run=run(10.5))
    runs = by_changes(replace(found, runs=(*found.runs, again)))
    assert [*runs] == [2, 3]
    assert runs[3].run.energy_kwh == 10.5


@pytest.mark.parametrize(
    ("found", "sentence"),
    [
        (advice(12.0, 10 * (1 + 0.5 * FREE_SHARE)), "More than 3 changes would gain less than 0.1 %."),
        (advice(12.0, 11.0), "More than 3 changes gain nothing."),
        (advice(*range(30, 30 - (MAX_CHANGES - 1), -1)), f"More than {MAX_CHANGES} changes are not tried."),
    ],
)
def test_what_more_orders_gain(found: SimpleAdvice, sentence: str) -> None:
    assert more_changes(found) == sentence


def test_where_no_run_is_in_time() -> None:
    assert not_in_time(advice(12.0)) == ""
    assert not_in_time(advice(12.0, refused=(2,))) == "With at most 2 changes no run is in time."
    assert not_in_time(advice(12.0, refused=(2, 3, 4))) == "With at most 2, 3 or 4 changes no run is in time."
