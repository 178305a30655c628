"""The page Import."""

from railjoule.dashboard.page_entry import PageEntry

PAGE = PageEntry("How does your own line or train get in?", "right", has_sidebar=False, strategies="")
