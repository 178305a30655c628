"""The choice among runs of simple advice."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

from railjoule.core.advice import Instruction
from railjoule.core.studies.simple_advice import SimpleAdvice
from railjoule.dashboard.work.simple_advice import (
    LITTLE_ENERGY_SHARE,
    by_changes,
    choose_simple,
    first_cheap_run,
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
    assert first_cheap_run(advice(12.0, dear, cheap, 10.001)).changes == 4
    assert first_cheap_run(advice(12.0, 11.0)).changes == 3
    # without an optimum nothing is known to be cheap
    assert first_cheap_run(advice(12.0, 11.0, 10.0, optimum=None)).changes == 4
    # less than nothing, where the line gives energy back: a hundredth of -10 kWh lies above it
    assert first_cheap_run(advice(-9.0, -9.95, optimum=-10.0)).changes == 3


def test_of_two_runs_with_as_many_changes_the_cheaper_one_is_told() -> None:
    found = advice(12.0, 11.0)
    again = SimpleNamespace(changes_allowed=4, changes=3, run=run(10.5))
    runs = by_changes(replace(found, runs=(*found.runs, again)))
    assert [*runs] == [2, 3]
    assert runs[3].run.energy_kwh == 10.5


def test_the_fewest_instructions_that_cost_little_are_chosen() -> None:
    exact = tuple(Instruction("coast", 10.0 * k) for k in range(5))

    def found(**energies: float) -> SimpleAdvice:
        """Return simple advice whose runs have so many instructions, by words for the number, and energies [kWh]."""
        counts = {"three": 3, "four": 4, "five": 5}
        made = advice(*energies.values())
        for simple, name in zip(made.runs, energies, strict=True):
            simple.run.advice = exact[: counts[name]]
        made.optimum.advice = exact
        return made

    simple, sentence = choose_simple(found(three=10.09, four=10.05, five=10.0))
    assert len(simple.run.advice) == 3
    assert sentence == "3 instructions instead of 5: +0.90 % energy."
    simple, sentence = choose_simple(found(three=12.0, four=10.5, five=10.0))
    assert len(simple.run.advice) == 4
    assert sentence == "No advice with fewer than 5 instructions is within 1 % of the optimum: with 4 it is +5.0 %."
    simple, sentence = choose_simple(found(three=16.0, five=10.0))
    assert simple is None
    assert sentence.endswith("with 3 it is +60.0 %.")
    assert choose_simple(found(five=10.0)) == (None, "The optimum is already as simple as it gets: 5 instructions.")
    assert choose_simple(advice(12.0, optimum=None))[1] == "No optimum is known to compare with."
