"""Robustness, as a user works with it."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import BrowserContext, expect

from browser.server import Server
from browser.user import User

WORKED_MS = 60_000


@pytest.fixture(scope="module")
def user(server: Server, window: BrowserContext) -> Iterator[User]:
    """One user, who stays on the page for all tests of this file."""
    with User.on(window, server.drive_url) as someone:
        someone.turn_to("Robustness")
        yield someone


def test_a_press_on_a_cell_shows_its_run(user: User) -> None:
    user.choose("Metro, profile II")
    # 14.2 % more energy at full load and +10 m, as `railjoule simulate` has it
    expect(user.figure_value("Load 100 %, +10 m")).to_have_text("+14.2%")
    expect(user.figure_value("Largest in table")).to_have_text("+34.9%")
    for chart in ("heatmap", "driven_speed", "driven_effort"):
        expect(user.page.locator(f".rj-chart-{chart}:visible canvas").first).to_be_visible()
    box = user.page.locator(".rj-chart-heatmap:visible canvas").first.bounding_box()
    assert box is not None
    speed = user.picture("driven_speed")
    # the lowest cell at the left: load 0, -25 m
    user.page.mouse.click(box["x"] + 0.18 * box["width"], box["y"] + 0.76 * box["height"])
    expect(user.figure_value("Load 0 %, \u221225 m")).to_be_visible()
    user.see_change("driven_speed", speed)
    field = user.page.get_by_label("Position error, m, as a number").locator("visible=true")
    expect(field).to_have_value("\u221225")


def test_chance_draws_and_can_be_stopped(user: User) -> None:
    user.choose("Metro, profile I")
    note = user.page.get_by_text("runs, seed 1.")
    expect(note).to_contain_text("500 of 500 runs", timeout=WORKED_MS)
    user.page.get_by_role("button", name="Run 10").click()
    stop = user.page.get_by_role("button", name="Stop", exact=True)
    expect(stop).to_be_visible()
    expect(note).to_contain_text("of 10\u202f000 runs")
    # the page stays live in the meantime
    before = user.number("Load 100 %")
    slider = user.slider("Actual load, % of capacity")
    for _ in range(30):
        slider.press("ArrowLeft")
    expect(user.figure_value("Load 70 %")).not_to_have_text(before)
    stop.click()
    expect(stop).to_be_hidden()
    stopped = note.inner_text()
    user.settled()
    assert note.inner_text() == stopped
