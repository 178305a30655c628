"""Scenario files that a user opens, good ones and bad ones."""

from pathlib import Path

from playwright.sync_api import expect

from browser.user import User

CANARY = "</style></script><script>window.pwned=true</script><img src=x onerror='window.pwned=true'>"
GOOD = """
title = "Own line"
[vehicle]
preset = "metro-81-7036"
[line]
sections = [{ length_m = 900, gradient_permille = 2 }]
stations = [{ name = "Half way", position_m = 400, dwell_s = 20 }]
[timetable]
travel_time_s = 150
"""


def bad(old: str, new: str) -> str:
    """Return the good file with one thing changed."""
    assert old in GOOD
    return GOOD.replace(old, new)


def test_a_good_file(user: User, tmp_path: Path) -> None:
    path = tmp_path / "own.toml"
    path.write_text(GOOD)
    user.open_file(path)
    expect(user.scenario("Own line")).to_be_visible()
    expect(user.page.locator("option:checked").first).to_have_text("Own line (file)")
    expect(user.page.locator(".advice")).to_contain_text("stand 20 s")
    user.see_no_alert()


BAD = {
    "title = 'x": "not a valid TOML file",
    "#" * 2_500_000: "it is larger than the 2 MB of a scenario or the 10 MB of a report. Only scenarios",
}
"""Files that cannot be opened, and what the page says."""


def test_a_bad_file_says_why_and_changes_nothing(user: User, tmp_path: Path) -> None:
    user.begin_anew()
    energy, alert = user.number("Energy from the supply"), user.page.get_by_role("alert")
    for number, (text, sentence) in enumerate(BAD.items()):
        path = tmp_path / f"bad-{number}.toml"
        path.write_text(text)
        user.open_file(path)
        expect(alert).to_contain_text(sentence)
        expect(user.figure_value("Energy from the supply")).to_have_text(energy)
    user.page.get_by_role("button", name="Close the message").click()
    expect(alert).to_be_hidden()
    user.push("Travel time, s", 4)
    expect(user.figure_value("Energy from the supply")).not_to_have_text(energy)


def test_markup_in_a_file_stays_text(user: User, tmp_path: Path) -> None:
    text = bad('"Own line"', f'"{CANARY}"').replace('"Half way"', f'"{CANARY}"')
    text = text.replace("[line]", f'name = "{CANARY}"\n[line]\nname = "{CANARY}"')
    path = tmp_path / f"{CANARY.replace('/', '')}.toml"
    path.write_text(text)
    user.open_file(path)
    expect(user.scenario(CANARY)).to_be_visible()
    user.page.get_by_role("button", name="Pin run").click()
    for page in ("Compare", "Line"):
        user.turn_to(page)
        expect(user.page.get_by_text("onerror").first).to_be_attached()
    assert user.page.evaluate("window.pwned") is None
