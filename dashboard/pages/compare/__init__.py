"""The page Compare."""

from railjoule.dashboard.page_entry import PageEntry

PAGE = PageEntry("Strategies and pinned runs side by side", strategies="draw")
