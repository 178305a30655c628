"""All pages by name. Each stands in a room of its own, and is known here before anything of it is loaded."""

from functools import cache
from importlib import import_module
from importlib.util import find_spec
from keyword import iskeyword
from typing import Any

from railjoule.dashboard.page_entry import PageEntry

NAMES = (
    "Start",
    "Drive",
    "Compare",
    "Trade-off",
    "What if",
    "Set speeds",
    "Motor",
    "Line",
    "Explore",
    "Learn",
    "Files",
    "Papers",
    "Help",
)
"""In the order of the bar. A page is its name here and the room in `railjoule.dashboard.pages` that bears it."""


def room_of(name: str) -> str:
    """Return the package that a page stands in."""
    room = name.lower().replace(" ", "_").replace("-", "_")
    # no package can be called `import`
    return f"railjoule.dashboard.pages.{f'{room}s' if iskeyword(room) else room}"


def entry_of(name: str) -> PageEntry:
    """Return what is known of a page before it is opened."""
    entry: PageEntry = import_module(room_of(name)).PAGE
    return entry


@cache
def page_classes() -> dict[str, Any]:
    """Return the pages that are one class, by name: those whose room has a module `page`."""
    found = {}
    for name in NAMES:
        if find_spec(f"{room_of(name)}.page") is not None:
            module = import_module(f"{room_of(name)}.page")
            own = (kind for kind in vars(module).values() if getattr(kind, "__module__", "") == module.__name__)
            found[name] = next(kind for kind in own if getattr(kind, "page", None) == name)
    return found


PAGES = {name: entry_of(name) for name in NAMES}
KEYED = tuple(name for name, entry in PAGES.items() if entry.place == "bar")[:9]
"""The pages that the keys 1 to 9 open."""


def bar_entries() -> tuple[str, ...]:
    """Return what stands in the bar: pages, and the names of groups."""
    return tuple(dict.fromkeys(entry.group or name for name, entry in PAGES.items() if entry.place == "bar"))
