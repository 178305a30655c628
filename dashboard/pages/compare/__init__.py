"""The page Compare."""

from railjoule.dashboard.page_entry import PageEntry

PAGE = PageEntry(
    "Which way of driving needs the least energy, and where do they part?", strategies="draw", group="Compare"
)
