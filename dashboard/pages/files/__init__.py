"""The page Files."""

from railjoule.dashboard.page_entry import PageEntry

PAGE = PageEntry("How do I use my own line, train or recorded runs?", "right", strategies="")
