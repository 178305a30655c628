"""Motor, as a user works with it."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import BrowserContext, expect

from browser.findings import assert_nothing_grave
from browser.server import Server
from browser.user import User

CHARTS = ("loop_speed", "tracking", "loop_currents", "loop_place", "rival_speed", "machine_map", "ripple")


@pytest.fixture(scope="module")
def user(server: Server, window: BrowserContext) -> Iterator[User]:
    """One user, who stays on the page for all tests of this file."""
    with User.on(window, server.drive_url) as someone:
        someone.turn_to("Motor")
        expect(someone.page.get_by_text("simulates induction motors")).to_be_visible()
        someone.page.get_by_role("button", name="Open Suburban, flat 5 km").click()
        expect(someone.figure_value("Tracking error")).not_to_be_empty()
        yield someone


def test_figures_are_drawn(user: User) -> None:
    for chart in CHARTS:
        place = user.page.locator(f".rj-chart-{chart}:visible")
        place.scroll_into_view_if_needed()
        expect(place.locator("canvas").first).to_be_visible()
    user.page.locator(".rj-chart-loop_speed:visible").scroll_into_view_if_needed()


def test_nothing_grave_once_all_is_drawn(user: User) -> None:
    assert_nothing_grave(user)


def test_without_the_precompensator_the_train_lags_by_metres(user: User) -> None:
    error, switch = user.figure_value("Tracking error"), user.page.get_by_label("Pre-compensator", exact=True)
    expect(error).to_contain_text("mm")
    switch.uncheck()
    expect(error).not_to_contain_text("mm")
    metres = float(error.inner_text().replace("m", ""))
    assert metres > 5.0
    switch.check()
    expect(error).to_contain_text("mm")


def test_blocks_and_figures_light_each_other(user: User) -> None:
    block = user.page.locator("svg.wide [data-block=motion_control]")
    lit = user.page.locator("svg.wide [data-block].lit")
    chart = user.page.locator(".rj-chart-loop_speed:visible")
    chart.scroll_into_view_if_needed()
    block.hover()
    expect(lit).to_have_count(1)
    expect(user.page.locator(".rj-lit")).to_have_count(1)
    user.page.mouse.move(5, 5)
    expect(lit).to_have_count(0)
    expect(user.page.locator(".rj-lit")).to_have_count(0)
    chart.hover()
    expect(lit).to_have_attribute("data-block", "motion_control")
    user.page.mouse.move(5, 5)
    # by key: the block after the one that is focused, and its figure into sight
    block.focus()
    user.page.keyboard.press("Tab")
    expect(lit).to_have_attribute("data-block", "current_control")
    user.page.keyboard.press("Enter")
    expect(user.page.locator(".rj-chart-loop_currents:visible canvas").first).to_be_in_viewport()


def test_a_limit_that_is_too_low_is_told(user: User) -> None:
    held = user.page.get_by_text("limited the motors from")
    user.type("Current, A", "300")
    expect(held.first).to_be_visible()
    user.type("Current, A", "100")
    alert = user.alert()
    assert "max current = 100 A must be above" in alert
    user.type("Current, A", "810")
    expect(held).to_have_count(0)
    user.see_no_alert()


def test_the_study_of_detuning_runs_and_shows_its_table(user: User) -> None:
    user.page.get_by_role("button", name="Run the study").click()
    expect(user.page.get_by_text("2.00 \u00d7")).to_be_visible()
    expect(user.page.get_by_role("button", name="Stop", exact=True)).to_be_hidden()
    user.page.locator(".rj-chart-detuning:visible").scroll_into_view_if_needed()
    expect(user.page.locator(".rj-chart-detuning:visible canvas").first).to_be_visible()
