"""The shipped scenarios as cards, each with the run that Drive shows first."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache

from railjoule.core import RailjouleError, Trajectory, load_scenario
from railjoule.core.scenario import preset_names
from railjoule.core.strategies import Task, prepare_task, run_strategy

FIRST = ("metro-with-limit", "metro-10-stations", "tram-950m", "ftorek-300s", "kharkiv-like-40kmh", "liashenko-ii")
"""Scenarios shown first; the others follow."""


@dataclass(frozen=True, eq=False)
class Card:
    """A shipped scenario.

    Parameters
    ----------
    name : str
        Its file's name.
    title, vehicle : str
    length_m : float
        Length of its line [m].
    stations : int
        Planned stops between the ends.
    run : Trajectory or None
        The run of the scenario's own strategy; if that refuses, the optimum; if none is found, the fastest run;
        None until it is computed.
    """

    name: str
    title: str
    vehicle: str
    length_m: float
    stations: int
    run: Trajectory | None = None


def card_names() -> tuple[str, ...]:
    """Return the names of all shipped scenarios in the order of their cards."""
    return tuple(dict.fromkeys((*FIRST, *preset_names("scenarios"))))


@cache
def outline(name: str) -> Card:
    """Return the card of a shipped scenario without its run; it never changes, so each is made once a process."""
    scenario = load_scenario(name)
    line = scenario.line
    return Card(name, scenario.title, scenario.vehicle.name, line.length_m, len(line.inner_stations))


@cache
def make_card(name: str) -> Card:
    """Return the card of a shipped scenario with its run."""
    scenario = load_scenario(name)
    run = _first_run(prepare_task(scenario), (scenario.strategy, "optimal", "fastest"))
    return replace(outline(name), run=run)


def outlines() -> tuple[Card, ...]:
    """Return all cards without their runs."""
    return tuple(outline(name) for name in card_names())


def _first_run(task: Task, strategies: tuple[str, ...]) -> Trajectory:
    """Return the run of the first strategy that takes a task; the last one takes every one."""
    for strategy in strategies[:-1]:
        try:
            return run_strategy(task, strategy)
        except RailjouleError:
            continue
    return run_strategy(task, strategies[-1])


def compute_cards(names: tuple[str, ...]) -> Iterator[tuple[Card, ...]]:
    """Yield the cards of the named scenarios, each time with one run more."""
    cards = {name: outline(name) for name in names}
    for name in names:
        cards[name] = make_card(name)
        yield tuple(cards.values())
