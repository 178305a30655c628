"""The page Disturbances."""

from railjoule.dashboard.page_entry import PageEntry

PAGE = PageEntry("What do unplanned stops and limits cost, and who handles them best?", group="What if")
