"""The page Motor."""

from railjoule.dashboard.page_entry import PageEntry

PAGE = PageEntry("The motors in closed-loop control", group="Equipment")
