"""The page Motor."""

from railjoule.dashboard.page_entry import PageEntry

PAGE = PageEntry("What happens inside the motors during this run?", group="Equipment")
