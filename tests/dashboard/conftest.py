"""Settings of all tests of the dashboard."""

import pytest


@pytest.fixture(autouse=True)
def _two_cards(monkeypatch):
    """Let a session that begins on Start compute two cards, and not those of all shipped scenarios."""
    monkeypatch.setattr("railjoule.dashboard.pages.start.work.card_names", lambda: ("liashenko-0", "liashenko-ii"))
