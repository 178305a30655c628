"""The actual run on Drive, as a user works with it who comes from Start by mouse."""

import re

from playwright.sync_api import expect

from browser.findings import assert_nothing_grave
from browser.user import User

LINK = "?v=1&page=Start"
SCENARIO = "Metro, profile II + I"
DASHED = """() => {
  for (const model of Bokeh.documents[0]._all_models.values()) {
    // charts out of sight leave their columns of the run as they are
    if (model.type !== "GlyphRenderer" || model.name !== "actual" || model.glyph.y?.field !== "speed") continue;
    const y = model.data_source.data.speed;
    if (y && y.length > 2) return `${y.length} ${Array.from(y).reduce((sum, one) => sum + one, 0)}`;
  }
  return "";
}"""
"""What the dashed line of the first chart is made of."""


def changed(user: User, before: tuple[str, str]) -> tuple[str, str]:
    """Wait until what the actual run costs [kWh] and the dashed line have changed, and return them."""
    expect(user.figure_value("Actual run costs")).not_to_contain_text(before[0])
    user.page.wait_for_function(f"before => ({DASHED})() !== before", arg=before[1])
    return now(user)


def now(user: User) -> tuple[str, str]:
    cost = re.match(r"[+\u2212]?[\d\u202f.]+", user.number("Actual run costs"))
    assert cost is not None
    return cost.group(), user.page.evaluate(DASHED)


def test_every_widget_of_the_day_moves_number_and_curve(user: User) -> None:
    page = user.page
    page.get_by_role("button", name=SCENARIO, exact=True).click()
    expect(user.scenario(SCENARIO)).to_be_visible()
    page.get_by_role("switch", name="Actual run").click()
    expect(user.figure_value("Actual run costs")).to_be_visible()
    user.settled()
    seen = now(user)
    for name, number in (("Travel time, s", "185"), ("Actual load, %", "85"), ("Position error, m", "4")):
        user.type(name, number)
        seen = changed(user, seen)
    page.get_by_role("button", name="+ stop").click()
    expect(page.get_by_label("Stop 1: at, m, as a number")).to_be_visible()
    seen = changed(user, seen)
    # a train that drives as fast as it may already arrives later, and needs no more
    time = user.number("Travel time")
    user.type("Stop 1: for, s", "40")
    expect(user.figure_value("Travel time")).not_to_have_text(time)
    user.type("Stop 1: at, m", "2310")
    assert "A stop at 2310 m lies beyond the line, 2300 m." in user.alert()
    user.type("Stop 1: at, m", "1800")
    user.see_no_alert()
    changed(user, seen)
    assert_nothing_grave(user)
