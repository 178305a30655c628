"""The shipped scenarios as cards, each with the speed of its optimum."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache

from railjoule.core import RailjouleError, Trajectory, load_scenario
from railjoule.core.scenario import preset_names
from railjoule.core.strategies import prepare_task, run_strategy

FIRST = ("metro-with-limit", "metro-10-stations", "tram-950m", "ftorek-300s", "kharkiv-like-40kmh", "liashenko-ii")
"""What one may begin with; the others follow."""


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
    run : Trajectory
        Its optimum; where that is not found, the fastest run.
    """

    name: str
    title: str
    vehicle: str
    length_m: float
    stations: int
    run: Trajectory


def card_names() -> tuple[str, ...]:
    """Return the names of all shipped scenarios in the order of their cards."""
    return tuple(dict.fromkeys((*FIRST, *preset_names("scenarios"))))


@cache
def make_card(name: str) -> Card:
    """Return the card of a shipped scenario; it never changes, so each is made once a process."""
    scenario = load_scenario(name)
    task = prepare_task(scenario)
    try:
        run = run_strategy(task, "optimal")
    except RailjouleError:
        run = run_strategy(task, "fastest")
    line = scenario.line
    return Card(name, scenario.title, scenario.vehicle.name, line.length_m, len(line.inner_stations), run)


def compute_cards(names: tuple[str, ...]) -> Iterator[tuple[Card, ...]]:
    """Yield the cards of the named scenarios as they come."""
    done: tuple[Card, ...] = ()
    for name in names:
        done = (*done, make_card(name))
        yield done
