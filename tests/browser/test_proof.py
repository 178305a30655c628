"""The bound of a drive that idles as it tightens on Drive, by mouse from Start."""

import re

from playwright.sync_api import Browser, expect

from browser.findings import assert_nothing_grave
from browser.server import Server
from browser.user import User

QUICK, HARD = "Tram, flat 950 m, recuperating", "Metro, set speeds, 20 km/h"
"""Whose proof is done after the first stage, and one whose first stage leaves much to prove."""


def share_above(user: User) -> float:
    """Return by how much the run lies above its bound [%]."""
    return float(re.match(r"\+([\d.]+)", user.number("Above the bound")).group(1))  # type: ignore[union-attr]


def test_the_bound_tightens_further_when_asked_and_stops(server: Server, chromium: Browser) -> None:
    page = chromium.new_page(viewport={"width": 1280, "height": 900}, color_scheme="light")
    user = User(page, server.url)
    page.goto(server.url)
    proof, further, stop = (
        page.locator(".proof-row:visible"),
        page.get_by_role("button", name="Prove further", exact=True),
        page.get_by_role("button", name="Stop", exact=True),
    )
    page.get_by_role("button", name=QUICK, exact=True).click()
    expect(user.scenario(QUICK)).to_be_visible()
    page.get_by_role("radio", name="Optimal", exact=True).check()
    # the first stage comes by itself
    expect(proof).to_contain_text("No run with one effort in each cell")
    expect(proof).to_contain_text("As close as the proof aims.")
    expect(further).to_be_hidden()
    assert share_above(user) == 0.05

    user.choose(HARD)
    page.get_by_role("radio", name="Optimal", exact=True).check()
    expect(proof).to_contain_text("No run")
    expect(further).to_be_enabled()
    before = share_above(user)
    further.click()
    expect(stop).to_be_visible()
    expect(page.get_by_role("progressbar", name="Share of the boxes looked at")).to_be_visible()
    expect(stop).to_be_focused()
    # as soon as a level has proven more, it is told
    expect(proof).to_contain_text("No run with one effort in each cell")
    now = share_above(user)
    assert now < before
    if stop.is_visible():
        stop.click()
    expect(stop).to_be_hidden()
    expect(page.get_by_role("progressbar", name="Share of the boxes looked at")).to_be_hidden()
    assert share_above(user) <= now
    assert_nothing_grave(user)
    assert user.errors == [], user.errors
    page.close()
