"""The page Trade-off."""

from railjoule.dashboard.page_entry import PageEntry

PAGE = PageEntry("Energy against travel time", strategies="draw")
