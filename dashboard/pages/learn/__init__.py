"""The page Learn."""

from railjoule.dashboard.page_entry import PageEntry

PAGE = PageEntry("Why does coasting save energy, and when should a train coast?", has_sidebar=False)
