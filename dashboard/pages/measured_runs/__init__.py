"""The page Measured runs."""

from railjoule.dashboard.page_entry import PageEntry

PAGE = PageEntry("What did this run cost, and what could it have cost?", group="Compare", strategies="")
