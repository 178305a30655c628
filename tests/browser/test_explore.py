"""What HoloViews draws, reached from Start by mouse: the draws of What if and the differences of Papers."""

import re
from collections.abc import Iterator

import pytest
from playwright.sync_api import BrowserContext, Locator, expect

from browser.findings import assert_nothing_grave
from browser.server import Server
from browser.user import User

WORKED_MS = 60_000
DRAWS = re.compile(r"^([\d\u202f]+) of 500 draws \(")
DOT = """
k => {
  const [view] = Bokeh.index.query(({model}) =>
    model.type === "Figure" && model.html_attributes["aria-label"]?.startsWith("Differences"));
  const {x, y} = view.el.getBoundingClientRect();
  const {row, height} = view.model.renderers[1].data_source.data;
  return [x + view.frame.x_scale.compute(row[k]), y + view.frame.y_scale.compute(height[k])];
}
"""
"""Where a row of the first paper is drawn."""


@pytest.fixture(scope="module")
def user(server: Server, window: BrowserContext) -> Iterator[User]:
    """One user, who begins at Start and stays for all tests of this file."""
    with User.on(window, server.url, on_drive=False) as someone:
        yield someone


def chart(user: User, name: str) -> Locator:
    return user.page.locator(f".rj-chart-{name}:visible canvas").first


def told(user: User) -> Locator:
    return user.page.get_by_text(DRAWS)


def held(user: User) -> int:
    found = DRAWS.match(told(user).inner_text())
    assert found is not None
    return int(found[1])


def drag(user: User, name: str, start: tuple[float, float], end: tuple[float, float]) -> None:
    """Drag over a chart, between places told in shares of it."""
    canvas = chart(user, name)
    canvas.scroll_into_view_if_needed()
    box = canvas.bounding_box()
    assert box is not None
    mouse = user.page.mouse
    (x, y), (to_x, to_y) = ((box["x"] + a * box["width"], box["y"] + b * box["height"]) for a, b in (start, end))
    mouse.move(x, y)
    mouse.down()
    mouse.move(to_x, to_y, steps=8)
    mouse.up()


def test_the_draws_are_explored_only_once_asked_for(user: User) -> None:
    user.turn_to("What if")
    user.page.get_by_role("tab", name="Chance").click()
    expect(user.page.get_by_text("runs, seed 1.")).to_contain_text("500 of 500 runs", timeout=WORKED_MS)
    assert user.page.locator(".rj-chart-draws").count() == 0
    user.page.get_by_role("button", name="Explore the draws").click()
    expect(chart(user, "draws")).to_be_visible()
    expect(user.page.get_by_text("500 draws that reached the end.")).to_be_visible()
    expect(chart(user, "draws_late")).to_be_visible()


def test_what_lies_within_all_brushes_is_counted_and_stands_out(user: User) -> None:
    user.settled()
    late = user.picture("draws_late")
    drag(user, "draws", (0.3, 0.1), (0.6, 0.7))
    expect(told(user)).to_be_visible()
    expect(told(user)).to_contain_text("load ")
    user.see_change("draws_late", late)
    one = held(user)
    assert 0 < one < 500
    drag(user, "draws_resistance", (0.3, 0.5), (0.6, 0.5))
    expect(told(user)).to_contain_text("running resistance ")
    assert 0 < held(user) < one
    user.page.get_by_role("button", name="Let go of all brushes").click()
    expect(user.page.get_by_text("500 draws that reached the end.")).to_be_visible()


def test_a_brush_outlasts_another_axis_and_goes_with_a_click(user: User) -> None:
    drag(user, "draws_resistance", (0.3, 0.5), (0.6, 0.5))
    expect(told(user)).to_be_visible()
    count = held(user)
    user.page.get_by_role("combobox", name="To the right").click()
    user.page.get_by_role("menuitem", name="Delay at the stop, s").click()
    expect(chart(user, "draws_load")).to_be_visible()
    expect(chart(user, "draws")).to_be_visible()
    user.settled()
    assert held(user) == count
    chart(user, "draws_resistance").scroll_into_view_if_needed()
    box = chart(user, "draws_resistance").bounding_box()
    assert box is not None
    user.page.mouse.click(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
    expect(user.page.get_by_text("500 draws that reached the end.")).to_be_visible()
    assert_nothing_grave(user)


def test_a_dot_of_papers_tells_its_row(user: User) -> None:
    user.turn_to("Papers")
    expect(chart(user, "differences")).to_be_visible()
    user.settled()
    x, y = user.page.evaluate(DOT, 0)
    user.page.mouse.move(x - 4, y)
    user.page.mouse.move(x, y)
    tip = user.page.locator(".told")
    # the first row of Ftorek's table: 86.094 km/h are printed
    expect(tip.get_by_text("v_max").first).to_be_visible()
    expect(tip.get_by_text("86.094 km/h").first).to_be_visible()
    user.page.mouse.move(5, 5)
