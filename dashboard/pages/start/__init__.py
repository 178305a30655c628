"""The page Start."""

from railjoule.dashboard.page_entry import PageEntry

PAGE = PageEntry("How little energy does a train need to arrive on time?", "brand", has_sidebar=False, strategies="")
