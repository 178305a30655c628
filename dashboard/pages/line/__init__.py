"""The page Line."""

from railjoule.dashboard.page_entry import PageEntry

PAGE = PageEntry("How should the time for a whole line be shared between its stations?", strategies="")
