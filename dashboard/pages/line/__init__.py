"""The page Line."""

from railjoule.dashboard.page_entry import PageEntry

PAGE = PageEntry("Running time supplement of a whole line, by leg", strategies="")
