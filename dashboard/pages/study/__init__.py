"""The page Study."""

from railjoule.dashboard.page_entry import PageEntry

PAGE = PageEntry("Which quantities decide the energy, and by how much?", strategies="")
