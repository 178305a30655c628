"""The page Explore."""

from railjoule.dashboard.page_entry import PageEntry

PAGE = PageEntry("Which quantities decide the energy, and by how much?", strategies="", has_plan=False)
