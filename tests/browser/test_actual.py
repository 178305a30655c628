"""The actual run on Drive, as a user works with it who comes from Start by mouse."""

import re

from playwright.sync_api import BrowserContext, expect

from browser.findings import assert_nothing_grave
from browser.server import Server
from browser.user import User

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


def extra(user: User) -> str:
    """Return what the actual run costs [kWh], as a text."""
    return number_of(user.number("Actual run costs"))


def number_of(text: str) -> str:
    """Return the first number of a text."""
    return re.match(r"[+\u2212]?[\d\u202f.]+", text).group()  # type: ignore[union-attr]


def changed(user: User, before: tuple[str, str]) -> tuple[str, str]:
    """Wait until the number and the dashed line have changed, and return them."""
    expect(user.figure_value("Actual run costs")).not_to_contain_text(before[0])
    user.page.wait_for_function(f"before => ({DASHED})() !== before", arg=before[1])
    return extra(user), user.page.evaluate(DASHED)


def test_every_widget_of_the_day_moves_number_and_curve(server: Server, window: BrowserContext) -> None:
    with User.on(window, server.url, size=(1280, 1000)) as user:
        page = user.page
        page.get_by_role("button", name=SCENARIO, exact=True).click()
        expect(user.scenario(SCENARIO)).to_be_visible()
        expect(user.figure_value("Energy from the supply")).to_be_visible()
        page.get_by_role("switch", name="Actual run").click()
        expect(user.figure_value("Actual run costs")).to_be_visible()
        user.settled()
        now = extra(user), page.evaluate(DASHED)
        for name, steps in (("Travel time, s", 30), ("Actual load, %", -15), ("Position error, m", -6)):
            user.push(name, steps)
            now = changed(user, now)
        page.get_by_role("button", name="+ stop").click()
        expect(page.get_by_label("Stop 1: at, m, as a number")).to_be_visible()
        now = changed(user, now)
        # a train that drives as fast as it may already arrives later, and needs no more
        time = user.number("Travel time")
        user.type("Stop 1: for, s", "40")
        expect(user.figure_value("Travel time")).not_to_have_text(time)

        user.type("Stop 1: at, m", "2310")
        alert = user.alert()
        assert "A stop at 2310 m lies beyond the line, 2300 m." in alert
        assert "Kept: " in alert
        user.type("Stop 1: at, m", "1800")
        user.see_no_alert()
        changed(user, now)
        assert_nothing_grave(user)
