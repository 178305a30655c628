"""The page What if."""

from railjoule.dashboard.page_entry import PageEntry

PAGE = PageEntry("What do another load, unplanned events and chance cost?")
