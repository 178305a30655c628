"""Each page by mouse: it opens, its number and figure answer one change, and axe-core finds nothing grave."""

from collections.abc import Callable
from dataclasses import dataclass

import pytest
from playwright.sync_api import Locator, expect

from browser.findings import assert_nothing_grave
from browser.user import User
from railjoule.dashboard.page_list import PAGES

MAIN = ".figure.main:visible .value"
SCENARIO, PRESET = "Suburban, flat 5 km", "ftorek-300s"
"""Its motor is known, so that all pages but Line have results."""


def press(name: str) -> Callable[[User], None]:
    return lambda user: user.page.get_by_role("button", name=name, exact=True).locator("visible=true").first.click()


def open_tab(name: str) -> Callable[[User], None]:
    return lambda user: user.page.get_by_role("tab", name=name).click()


def type_text(label: str, text: str) -> Callable[[User], None]:
    return lambda user: user.type(label, text)


@dataclass(frozen=True)
class Change:
    """What is changed on a page, and what answers.

    Parameters
    ----------
    make : callable
        Changes something by mouse or keyboard.
    text : str
        Where the number is that changes.
    chart : str
        The figure that changes; empty where the page has none.
    first : callable, optional
        What the page needs before.
    leaves : bool
        Whether the change opens another page.
    """

    make: Callable[[User], None]
    text: str = MAIN
    chart: str = ""
    first: Callable[[User], None] | None = None
    leaves: bool = False


CHANGES = {
    "Start": Change(press(SCENARIO), ".head:visible .scenario, .hero:visible .key b", leaves=True),
    "Drive": Change(type_text("Travel time, s", "320"), chart="speed"),
    "Compare": Change(type_text("Load, % of capacity", "20"), "table:visible tbody td:nth-child(2)", "compared_speed"),
    "Trade-off": Change(type_text("Load, % of capacity", "80"), chart="frontier"),
    "What if": Change(type_text("Actual load, % of capacity", "20"), chart="driven_speed"),
    "Set speeds": Change(type_text("Section 1: set speed, km/h", "50"), chart="limit_speed"),
    "Motor": Change(type_text("Current, A", "300"), chart="loop_speed"),
    "Line": Change(type_text("Travel time, s", "1100"), chart="line_speed", first=press("Open Metro, ten stations")),
    "Explore": Change(type_text("Runs", "77"), ':text("The preview below shows"):visible'),
    "Learn": Change(press("This is my guess"), "main:visible", "lesson_coasting"),
    "Files": Change(press("Try the example"), "main:visible", "import_limits"),
    "Papers": Change(press("Draw the figures of Rawicki"), "main:visible", first=open_tab("Rawicki")),
    "Help": Change(lambda user: user.page.locator("[data-open=Compare]").click(), "h1:visible", leaves=True),
}


def number(user: User, change: Change) -> Locator:
    return user.page.locator(change.text).first


@pytest.mark.parametrize("name", PAGES)
def test_a_page_opens_and_answers_a_change(user: User, name: str) -> None:
    change = CHANGES[name]
    user.go(f"?v=1&page={name}" + f"&preset={PRESET}" * (name != "Start"))
    expect(user.question(name)).to_be_visible()
    if change.first:
        change.first(user)
        user.settled()
    before = number(user, change).inner_text()
    chart = user.page.locator(f".rj-chart-{change.chart}:visible")
    picture = user.picture(change.chart) if change.chart and chart.is_visible() else b""
    if change.leaves:
        assert_nothing_grave(user)
    change.make(user)
    expect(number(user, change)).not_to_have_text(before)
    if change.chart:
        user.see_change(change.chart, picture)
    if not change.leaves:
        assert_nothing_grave(user)
