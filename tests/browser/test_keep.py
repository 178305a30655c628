"""What a user keeps and shares: steps back, the address, and files."""

import re
from pathlib import Path

from playwright.sync_api import Page, expect

from browser.findings import grave_findings
from browser.server import Server
from browser.user import PATIENCE_MS, User
from railjoule.dashboard.keep.dropped import embedded

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
FIGURES = ("Energy from the supply", "Travel time", "Highest speed", "Recuperated")


def numbers(user: User) -> list[str]:
    return [user.number(figure) for figure in FIGURES]


def drop(page: Page, name: str, text: str) -> None:
    """Drop a file onto the page."""
    script = """([name, text]) => {
      const data = new DataTransfer();
      data.items.add(new File([text], name));
      return data;
    }"""
    page.dispatch_event("body", "drop", {"dataTransfer": page.evaluate_handle(script, [name, text])})


def press(user: User, name: str) -> None:
    user.page.get_by_role("button", name=name, exact=True).click()


def test_change_undo_redo_and_reload(user: User, server: Server) -> None:
    page, load = user.page, user.page.get_by_label("Load, % of capacity, as a number", exact=True)
    first = numbers(user)
    user.type("Load, % of capacity", "30")
    expect(page).to_have_url(server.drive_url + "&load_percent=30")
    expect(user.figure_value(FIGURES[0])).not_to_have_text(first[0])
    changed = numbers(user)
    expect(page.get_by_title("changed: was 50 %")).to_be_visible()
    press(user, "Undo")
    expect(load).to_have_value("50")
    expect(page).to_have_url(server.drive_url)
    expect(user.figure_value(FIGURES[0])).to_have_text(first[0])
    user.slider("Load, % of capacity").focus()
    page.keyboard.press("Control+y")
    expect(load).to_have_value("30")
    expect(page).to_have_url(server.drive_url + "&load_percent=30")
    page.get_by_label("Draw EOC").check()
    expect(page).to_have_url(re.compile("ticked=optimal,eoc,fastest"))
    expect(user.figure_value(FIGURES[0])).to_have_text(changed[0])
    page.reload()
    page.locator("html.rj-started").wait_for(timeout=PATIENCE_MS)
    expect(user.figure_value(FIGURES[0])).to_have_text(changed[0])
    expect(page.get_by_label("Draw EOC")).to_be_checked()
    assert numbers(user) == changed
    user.see_no_alert()


def test_save_and_drop(user: User, tmp_path: Path) -> None:
    user.go()
    user.type("Travel time, s", "190")
    expect(user.figure_value(FIGURES[1])).to_have_text("190.0s")
    kept = numbers(user)
    press(user, "Share")
    expect(user.page.get_by_label("Command line")).to_contain_text("--set timetable.travel_time_s=190.0")
    press(user, "Copy as Python")
    expect(user.page.get_by_text("Copied.", exact=True)).to_be_visible()
    with user.page.expect_download() as download:
        press(user, "Save as TOML")
    path = tmp_path / download.value.suggested_filename
    download.value.save_as(path)
    press(user, "Undo all")
    expect(user.figure_value(FIGURES[1])).not_to_have_text(kept[1])
    drop(user.page, path.name, path.read_text(encoding="utf-8"))
    expect(user.figure_value(FIGURES[1])).to_have_text(kept[1])
    assert numbers(user) == kept
    drop(user.page, "<b>bad</b>.toml", "railjoule = 99")
    alert = user.page.get_by_role("alert").filter(has_text="<b>bad</b>.toml: ")
    expect(alert).to_be_visible()
    assert grave_findings(user.page) == {}
    press(user, "Close the message")
    expect(alert).to_be_hidden()


def test_a_file_is_opened_and_its_markup_stays_text(user: User, server: Server, tmp_path: Path) -> None:
    text = GOOD.replace('"Own line"', f'"{CANARY}"').replace('"Half way"', f'"{CANARY}"')
    path = tmp_path / f"{CANARY.replace('/', '')}.toml"
    path.write_text(text.replace("[line]", f'name = "{CANARY}"\n[line]\nname = "{CANARY}"'), encoding="utf-8")
    user.open_file(path)
    expect(user.scenario(CANARY)).to_be_visible()
    expect(user.page.locator("option:checked").first).to_have_text(f"{CANARY} (file)")
    expect(user.page.locator(".advice")).to_contain_text("stand 20 s")
    user.see_no_alert()
    drop(user.page, f"{CANARY}.html", f"<html>{embedded(text)}</html>")
    expect(user.scenario(CANARY)).to_be_visible()
    expect(user.page.get_by_label("Command line")).to_contain_text(CANARY)
    user.turn_to("Line")
    expect(user.page.get_by_text("onerror").first).to_be_attached()
    assert user.page.evaluate("window.pwned") is None
    user.page.goto(f"{server.url}?v=1&load_percent={CANARY}&{CANARY}=1&page={CANARY}&edits={CANARY}")
    alert = user.page.get_by_role("alert").filter(has_text="Parts of the link were ignored")
    expect(alert).to_contain_text("</style>")
    user.page.locator("html.rj-started").wait_for(timeout=PATIENCE_MS)
    assert user.page.evaluate("window.pwned") is None
    expect(user.page).to_have_url(server.url)


def test_a_file_too_large_says_so_and_changes_nothing(user: User, tmp_path: Path) -> None:
    user.go()
    energy, alert = user.number(FIGURES[0]), user.page.get_by_role("alert")
    path = tmp_path / "large.toml"
    path.write_text("#" * 2_500_000)
    user.open_file(path)
    expect(alert).to_contain_text("larger than the 2 MB of a scenario or the 10 MB of a report")
    expect(user.figure_value(FIGURES[0])).to_have_text(energy)
    press(user, "Close the message")
    expect(alert).to_be_hidden()
    user.push("Travel time, s", 4)
    expect(user.figure_value(FIGURES[0])).not_to_have_text(energy)
