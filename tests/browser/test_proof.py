"""A bound that is loose as it tightens on Drive, by mouse from Start."""

import re
from pathlib import Path

import pytest
from playwright.sync_api import BrowserContext, expect

from browser.findings import assert_nothing_grave
from browser.server import Server
from browser.user import User
from railjoule.core import load_scenario
from railjoule.core.scenario import format_scenario

CHANGES = {"title": "Slow metro", "strategy": "optimal", "solver.mesh_m": 40.0}
"""With these the first stage of the proof leaves 1.8 % of the slow metro, and the next one less."""


def share_above(user: User) -> float:
    """Return by how much the run lies above its bound [%]."""
    return float(re.match(r"\+([\d.]+)", user.number("Above the bound")).group(1))  # type: ignore[union-attr]


@pytest.mark.nightly
def test_the_bound_tightens_when_asked_and_stops(server: Server, window: BrowserContext, tmp_path: Path) -> None:
    file = tmp_path / "slow.toml"
    file.write_text(format_scenario(load_scenario("kharkiv-like-20kmh", CHANGES)))
    page = window.new_page()
    user = User(page, server.url)
    proof, bar = (
        page.locator(".proof-row:visible"),
        page.get_by_role("progressbar", name="Share of the boxes looked at"),
    )
    further, stop = (page.get_by_role("button", name=name, exact=True) for name in ("Prove further", "Stop"))
    user.load()
    user.open_file(file)
    user.turn_to("Drive")
    # the run comes at once, what is proven of it tightens by itself
    expect(user.figure_value("Above the bound")).to_be_visible()
    expect(proof).to_contain_text("cells of at most 40 m, with one effort in each, uses less than")
    expect(further).to_be_enabled()
    first = share_above(user)
    # free switching alone leaves a fifth
    assert first < 5

    further.click()
    expect(stop).to_be_focused()
    expect(bar).to_be_visible()
    user.wait_until(lambda: share_above(user) < first)
    if stop.is_visible():
        stop.click()
    expect(stop).to_be_hidden()
    expect(bar).to_be_hidden()
    now = share_above(user)
    assert now < first
    # nothing comes late, and turning away and back loses nothing
    user.turn_to("Help")
    user.turn_to("Drive")
    assert share_above(user) == now
    assert_nothing_grave(user)
    assert user.errors == [], user.errors
    page.close()
