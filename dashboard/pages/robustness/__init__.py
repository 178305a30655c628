"""The page Robustness."""

from railjoule.dashboard.page_entry import PageEntry

PAGE = PageEntry("What does it cost when the load or the position is not as planned?", group="What if")
