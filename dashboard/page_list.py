"""The table of pages: their names, the question that each of them answers, and their places in the app bar."""

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class PageEntry:
    """One page.

    Parameters
    ----------
    question : str
        What it answers, in one sentence: its heading.
    place : str
        Where it is found: behind the brand, in the bar, or at the bar's right end.
    group : str
        The entry of the bar whose list names it; empty where it is an entry itself.
    has_sidebar : bool
        Whether the scenario stands beside it.
    strategies : str
        What the list of strategies is for beside it: "draw" them, only "choose" the one of all numbers, or nothing.
    """

    question: str
    place: Literal["brand", "bar", "right"] = "bar"
    group: str = ""
    has_sidebar: bool = True
    strategies: Literal["draw", "choose", ""] = "choose"


PAGES: dict[str, PageEntry] = {
    "Start": PageEntry("How little energy does a train need to arrive on time?", "brand", strategies=""),
    "Drive": PageEntry("How should this train be driven, and what if the day goes differently?", strategies="draw"),
    "Compare": PageEntry("Which way of driving needs the least energy, and where do they part?", strategies="draw"),
    "Trade-off": PageEntry("How much energy does a later arrival save?"),
    "Robustness": PageEntry("What does it cost when the load or the position is not as planned?", group="What if"),
    "Disturbances": PageEntry("What do unplanned stops and limits cost, and who handles them best?", group="What if"),
    "Speed limits": PageEntry(
        "How close to the optimum does a simple rule come: one limit for each section?",
        group="Equipment",
        strategies="",
    ),
    "Motor": PageEntry("What happens inside the motors during this run?", group="Equipment"),
    "Line": PageEntry("How should the time for a whole line be shared between its stations?", strategies=""),
    "Learn": PageEntry("Why does coasting save energy, and when should a train coast?", has_sidebar=False),
    "Papers": PageEntry("Does railjoule compute what the papers print?", "right", has_sidebar=False),
    "Help": PageEntry("What do the words and numbers mean, and which keys are there?", "right", has_sidebar=False),
}
"""All pages by name, in the order of the bar."""
KEYED = tuple(name for name, entry in PAGES.items() if entry.place == "bar")[:9]
"""The pages that the keys 1 to 9 open."""


def bar_entries() -> tuple[str, ...]:
    """Return what stands in the bar: pages, and the names of groups."""
    return tuple(dict.fromkeys(entry.group or name for name, entry in PAGES.items() if entry.place == "bar"))
