"""The pages: for each its name, its question and its place in the bar, known before anything of it is loaded."""

from dataclasses import dataclass
from functools import cache
from importlib import import_module
from typing import Any, Literal


@dataclass(frozen=True)
class PageEntry:
    """One page.

    Parameters
    ----------
    question : str
        Its question, in one sentence: its heading.
    place : str
        Its place: behind the brand, in the bar, or at the bar's right end.
    group : str
        The entry of the bar whose list names it; empty where it is an entry itself.
    has_sidebar : bool
        Whether the scenario stands beside it.
    has_plan : bool
        Whether the sidebar has the sliders of the plan.
    strategies : str
        The use of the list of strategies beside it: "draw" them, only "choose" the one of all numbers, or nothing.
    shows_runs : bool
        Whether it draws the runs of these strategies, and so turns grey while they are computed.
    """

    question: str
    place: Literal["brand", "bar", "right"] = "bar"
    group: str = ""
    has_sidebar: bool = True
    has_plan: bool = True
    strategies: Literal["draw", "choose", ""] = "choose"
    shows_runs: bool = False


PAGES = {
    "Start": PageEntry(
        "How little energy does a train need to arrive on time?",
        "brand",
        has_sidebar=False,
        strategies="",
        shows_runs=True,
    ),
    "Drive": PageEntry(
        "How should this train be driven, and what if the day goes differently?", strategies="draw", shows_runs=True
    ),
    "Compare": PageEntry("Strategies, pinned runs or two scenarios side by side", strategies="draw", shows_runs=True),
    "Trade-off": PageEntry("Energy against travel time", strategies="draw", shows_runs=True),
    "What if": PageEntry("Cost of another load, unplanned events and chance"),
    "Set speeds": PageEntry("Set speeds by section, compared with the optimum", group="Equipment", strategies=""),
    "Motor": PageEntry("The motors in closed-loop control", group="Equipment"),
    "Line": PageEntry("Running time supplement of a whole line, by leg", strategies=""),
    "Explore": PageEntry("Which quantities decide the energy, and by how much?", strategies="", has_plan=False),
    "Learn": PageEntry("Why does coasting save energy, and when should a train coast?", has_sidebar=False),
    "Files": PageEntry("How do I use my own line, train or recorded runs?", "right", strategies=""),
    "Papers": PageEntry("Comparison with published results", "right", has_sidebar=False),
    "Help": PageEntry("Meaning of the words and numbers, and list of the keys", "right", has_sidebar=False),
}
"""In the order of the bar. A page is its entry here and its package in `railjoule.dashboard.pages`."""
KEYED = tuple(name for name, entry in PAGES.items() if entry.place == "bar")[:9]
"""The pages that the keys 1 to 9 open."""


def grouped_pages() -> dict[str, list[str]]:
    """Return the names of the pages by the entry of the bar that they are, or whose list names them."""
    found: dict[str, list[str]] = {}
    for name, entry in PAGES.items():
        found.setdefault(entry.group or name, []).append(name)
    return found


def bar_entries() -> tuple[str, ...]:
    """Return the entries of the bar: pages, and the names of groups."""
    return tuple(entry for entry, names in grouped_pages().items() if PAGES[names[0]].place == "bar")


def package_name(name: str) -> str:
    """Return the name of a page's package, which is also that of its model in addresses."""
    return name.lower().replace(" ", "_").replace("-", "_")


@cache
def page_classes() -> dict[str, Any]:
    """Return the classes of all pages by name: each stands in the module `page` of its package."""
    found = {}
    for name in PAGES:
        module = import_module(f"railjoule.dashboard.pages.{package_name(name)}.page")
        own = (kind for kind in vars(module).values() if getattr(kind, "__module__", "") == module.__name__)
        found[name] = next(kind for kind in own if getattr(kind, "page", None) == name)
    return found
