"""The page Papers."""

from railjoule.dashboard.page_entry import PageEntry

PAGE = PageEntry("Comparison with published results", "right", has_sidebar=False)
