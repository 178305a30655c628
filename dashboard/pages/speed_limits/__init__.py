"""The page Speed limits."""

from railjoule.dashboard.page_entry import PageEntry

PAGE = PageEntry(
    "How close to the optimum does a simple rule come: one set speed for each section?",
    group="Equipment",
    strategies="",
)
