"""Settings of all tests of the dashboard."""

import sys

import pytest


@pytest.fixture(autouse=True)
def _two_cards(monkeypatch):
    """Let a session that begins on Start compute two cards, and not those of all shipped scenarios."""
    page = sys.modules.get("railjoule.dashboard.pages.start.page")
    if page is not None:
        compute = page.compute_cards
        monkeypatch.setattr(page, "compute_cards", lambda _: compute(("liashenko-0", "liashenko-ii")))
