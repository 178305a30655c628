"""Set speeds, as a user works with it."""

import pytest
from playwright.sync_api import expect

from browser.user import User
from railjoule.dashboard.charts.dress import RIGHT_BORDER_PX

LENGTH_M, TOP_KMH = 2400.0, 80.0 * 1.09
"""Of the line, and at the upper end of the speed chart."""
LEFT_PX, ABOVE_PX, BELOW_PX = 50.0, 2.0, 7.0
"""Borders of the chart around its frame."""
LIMIT = "Section 1: set speed, km/h"


LINK = "?v=1&page=Drive&preset=kharkiv-like-40kmh"


@pytest.fixture(scope="module")
def user(user: User) -> User:
    """One user, who stays on the page for all tests of this file."""
    user.page.get_by_role("button", name="Adjust set speeds").click()
    expect(user.page.get_by_label(f"{LIMIT}, as a number")).to_have_value("50.8")
    return user


def drag(user: User, start: tuple[float, float], end: tuple[float, float]) -> None:
    """Drag from one place and speed to another, and let go."""
    box = user.page.locator(".rj-chart-limit_speed:visible canvas").first.bounding_box()
    assert box is not None
    width, height = box["width"] - LEFT_PX - RIGHT_BORDER_PX, box["height"] - ABOVE_PX - BELOW_PX

    def at(place: tuple[float, float]) -> tuple[float, float]:
        x = box["x"] + LEFT_PX + width * place[0] / LENGTH_M
        return x, box["y"] + ABOVE_PX + height * (1 - place[1] / TOP_KMH)

    user.page.mouse.move(*at(start))
    user.page.mouse.down()
    user.page.mouse.move(*at(end), steps=6)
    expect(user.page.get_by_text("release the step to compare")).to_be_visible()
    # the chart stays where it is under the mouse, though the numbers above it are fewer now
    assert user.page.locator(".rj-chart-limit_speed:visible canvas").first.bounding_box() == box
    user.page.mouse.up()
    expect(user.page.get_by_text("release the step to compare")).to_be_hidden()


def test_a_step_and_a_border_are_dragged(user: User) -> None:
    before, limit = user.number("Extra energy of set speeds"), user.page.get_by_label(f"{LIMIT}, as a number")
    end = user.page.get_by_label("Section 1: ends at, m, as a number")
    drag(user, (600.0, 50.8), (600.0, 60.0))
    user.see_number(limit, 60.0, within=0.6)
    expect(user.figure_value("Extra energy of set speeds")).not_to_have_text(before)
    drag(user, (1200.0, 31.0), (900.0, 31.0))
    user.see_number(end, 900.0, within=4.0)
    user.page.get_by_role("button", name="Search set speeds").click()
    expect(limit).not_to_have_value("60.0")
