"""The page Trade-off."""

from railjoule.dashboard.page_entry import PageEntry

PAGE = PageEntry("How much energy does a later arrival save?")
