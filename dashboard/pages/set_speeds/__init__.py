"""The page Set speeds."""

from railjoule.dashboard.page_entry import PageEntry

PAGE = PageEntry(
    "Set speeds by section, compared with the optimum",
    group="Equipment",
    strategies="",
)
