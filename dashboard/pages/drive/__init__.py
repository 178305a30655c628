"""The page Drive."""

from railjoule.dashboard.page_entry import PageEntry

PAGE = PageEntry("How should this train be driven, and what if the day goes differently?", strategies="draw")
