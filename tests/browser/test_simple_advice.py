"""Simple advice is shown on Drive, and another scenario comes: all of the page is of that one."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import expect

from browser.test_keep import GOOD
from browser.user import User
from railjoule.core import Scenario, load_scenario, solve
from railjoule.core.scenario import parse_scenario
from railjoule.dashboard.look import words


@pytest.fixture
def advised(user: User) -> User:
    """A user with simple advice before her."""
    user.page.get_by_role("button", name="Simple", exact=True).click()
    see_sentence(user)
    return user


def see_sentence(user: User) -> None:
    """See the sentence on simple advice once it is computed."""
    expect(user.page.locator(".note.advised:visible")).to_have_text(re.compile("instructions"))
    user.settled()


def see_scenario(user: User, scenario: Scenario, listed: str, address: str) -> None:
    """See heading, menu, address and numbers of a scenario; its energy is computed here without the page."""
    expect(user.scenario(scenario.title)).to_be_visible()
    expect(user.page.locator("option:checked").first).to_have_text(listed)
    expect(user.page).to_have_url(re.compile(address))
    energy = words.energy(solve(scenario).energy_kwh)
    expect(user.figure_value("Energy from the supply")).to_have_text(f"{energy}kWh")
    expect(user.figure_value("Travel time")).to_have_text(f"{words.time(scenario.travel_time_s)}s")
    user.see_no_alert()


@pytest.mark.nightly
def test_each_way_to_another_scenario(advised: User, tmp_path: Path) -> None:
    user, path = advised, tmp_path / "own.toml"
    path.write_text(GOOD)

    def press_card() -> None:
        user.turn_to("Start")
        user.page.get_by_role("button", name="Tram, flat 950 m", exact=True).click()

    tram = load_scenario("tram-950m"), "Tram, flat 950 m", "preset=tram-950m(&|$)"
    ways: list[tuple[Callable[[], object], tuple[Scenario, str, str]]] = [
        (
            lambda: user.choose("Metro, profile 0"),
            (load_scenario("liashenko-0"), "Metro, profile 0", "preset=liashenko-0(&|$)"),
        ),
        (press_card, tram),
        (lambda: user.open_file(path), (parse_scenario(GOOD), "Own line (file)", "[?&]toml=")),
        (user.page.get_by_role("button", name="Undo", exact=True).click, tram),
        (
            lambda: user.page.evaluate("location.hash = '#v=1&page=Drive&preset=liashenko-i'"),
            (load_scenario("liashenko-i"), "Metro, profile I", "preset=liashenko-i(&|$)"),
        ),
    ]
    for go, (scenario, listed, address) in ways:
        go()
        see_scenario(user, scenario, listed, address)
        if user.page.get_by_role("button", name="Exact", exact=True).get_attribute("aria-pressed") == "true":
            user.page.get_by_role("button", name="Simple", exact=True).click()
        see_sentence(user)
