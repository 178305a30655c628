"""The page Help."""

from railjoule.dashboard.page_entry import PageEntry

PAGE = PageEntry("What do the words and numbers mean, and which keys are there?", "right", has_sidebar=False)
