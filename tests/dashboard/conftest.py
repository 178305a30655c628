"""Settings of all tests of the dashboard."""

import sys

import pytest


@pytest.fixture(autouse=True)
def _two_cards(monkeypatch):
    """Let a session that begins on Start compute two cards, and not those of all shipped scenarios."""
    work = sys.modules.get("railjoule.dashboard.pages.start.work")
    if work is not None:
        monkeypatch.setattr(work, "card_names", lambda: ("liashenko-0", "liashenko-ii"))
