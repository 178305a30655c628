"""The shipped scenarios: their groups and uses, and cards with the run that Drive shows first."""

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cache

from railjoule.core import RailjouleError, Trajectory, load_scenario
from railjoule.core.scenario import preset_names
from railjoule.core.strategies import prepare_task, run_strategy

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
    task = prepare_task(scenario)
    for strategy in (scenario.strategy, "optimal"):
        with suppress(RailjouleError):
            return replace(outline(name), run=run_strategy(task, strategy))
    # this one takes every task
    return replace(outline(name), run=run_strategy(task, "fastest"))


def compute_cards(names: tuple[str, ...]) -> Iterator[tuple[Card, ...]]:
    """Yield the cards of the named scenarios, each time with one run more."""
    cards = {name: outline(name) for name in names}
    for name in names:
        cards[name] = make_card(name)
        yield tuple(cards.values())


# ---- the groups

GROUPS: tuple[tuple[str, str, tuple[str, ...]], ...] = (
    (
        "First steps",
        "one run between two stops: move the travel time and see what changes",
        ("metro-with-limit", "tram-950m", "ftorek-300s", "liashenko-ii", "tram-950m-stop", "tram-950m-recuperating"),
    ),
    (
        "Whole lines",
        "several stations: how the optimum shares the time among them",
        ("metro-10-stations",),
    ),
    (
        "Other kinds of trains",
        "a regional and a high-speed train, light rail and freight, with the sources of their numbers",
        ("regional-flirt", "light-rail-sd160", "high-speed-velaro", "freight-vectron"),
    ),
    (
        "From the papers",
        "the cases of published studies, to compare with what they print",
        (
            "liashenko-0",
            "liashenko-i",
            "liashenko-iii",
            "liashenko-fig-3",
            "liashenko-fig-4",
            "liashenko-fig-5",
            "liashenko-fig-6",
            "kharkiv-like-40kmh",
            "kharkiv-like-20kmh",
        ),
    ),
)
"""Title, what they show and names of the scenarios that belong together."""
OTHERS = ("More", "further scenarios")
GOOD_FOR = {
    "metro-with-limit": "Start here: gradients, a speed limit and part of the braking energy recuperated.",
    "tram-950m": "Level track without recuperation: why coasting saves.",
    "ftorek-300s": "All strategies run on it: good for Compare and Trade-off.",
    "liashenko-ii": "Down into a valley and out of it: where to coast and where to drive.",
    "tram-950m-stop": "A red signal on the way: what an unplanned stop costs.",
    "tram-950m-recuperating": "The same tram with recuperation: later coasting, later braking.",
    "metro-10-stations": "Ten stations in one timetable: which leg gets how much running-time supplement.",
    "regional-flirt": "Six stations and a curve: a light train that brakes back most of its energy.",
    "light-rail-sd160": "Out of the street and over a hill: 35 per mille and short runs.",
    "high-speed-velaro": "Air resistance decides: 300\u00a0km/h allowed, and less is enough.",
    "freight-vectron": "1103 tonnes over a ridge: momentum, not braking.",
    "liashenko-0": "A steady rise of 3 per mille: the plain case beside the three profiles.",
    "liashenko-i": "Light gradients, up to 10 per mille.",
    "liashenko-iii": "Heavy gradients, up to 40 per mille.",
    "liashenko-fig-3": "Planned at half load, driven full and with the position 10\u00a0m wrong.",
    "liashenko-fig-4": "Planned at half load, driven nearly empty and 5\u00a0m wrong, on profile I.",
    "liashenko-fig-5": "Planned at half load, driven full at the right position, on profile II.",
    "liashenko-fig-6": "Planned at half load, driven fuller and 15\u00a0m wrong, on profile III.",
    "kharkiv-like-40kmh": "Limits of sections as set speeds, at 40\u00a0km/h on average.",
    "kharkiv-like-20kmh": "The same line at half the speed: where limits as set speeds cost most.",
}
"""The use of each shipped scenario, in one line."""


def scenario_groups(names: tuple[str, ...]) -> list[tuple[str, str, tuple[str, ...]]]:
    """Return title, description and scenarios of each group; scenarios without a group come last."""
    named = [name for _, _, members in GROUPS for name in members]
    rest = tuple(name for name in names if name not in named)
    listed = [(title, shows, tuple(name for name in members if name in names)) for title, shows, members in GROUPS]
    return [*listed, *([(*OTHERS, rest)] if rest else [])]
