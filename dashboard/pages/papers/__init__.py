"""The page Papers."""

from railjoule.dashboard.page_entry import PageEntry

PAGE = PageEntry("Does railjoule compute what the papers print?", "right", has_sidebar=False)
