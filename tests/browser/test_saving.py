"""The toolbar of a figure, the numbers of a page, the advice and the report, as a user takes them away."""

import csv
import re
from pathlib import Path

import pytest
from playwright.sync_api import ViewportSize, expect

from browser.findings import grave_findings
from browser.user import User

PNG = b"\x89PNG\r\n\x1a\n"
# the colours of the corners and of the middle of a picture
COLOURS = """(bytes) => createImageBitmap(new Blob([new Uint8Array(bytes)])).then((image) => {
  const canvas = Object.assign(document.createElement("canvas"), {width: image.width, height: image.height});
  const context = canvas.getContext("2d");
  context.drawImage(image, 0, 0);
  const places = [[2, 2], [image.width - 3, image.height - 3], [image.width - 60, image.height / 2]];
  return places.map(([x, y]) => [...context.getImageData(x, y, 1, 1).data]);
})"""
# the size, title and background of the figure that fills the screen
FULL = """() => {
  let element = document.fullscreenElement;
  while (element?.shadowRoot?.fullscreenElement) { element = element.shadowRoot.fullscreenElement; }
  if (!element) { return null; }
  const {width, height} = element.getBoundingClientRect(), title = getComputedStyle(element, "::before").content;
  return {size: [width, height], title, ground: getComputedStyle(element).backgroundColor};
}"""
WINDOW, SCREEN = ViewportSize(width=1280, height=900), ViewportSize(width=1280, height=1000)
SURFACES = {"light": (255, 255, 255, 255), "dark": (20, 24, 30, 255)}


@pytest.mark.parametrize("colours", ["light", pytest.param("dark", marks=pytest.mark.nightly)])
def test_a_figure_fills_the_screen_and_comes_back(user: User, colours: str) -> None:
    page = user.page
    user.prefer(colours)
    canvas = page.locator(".rj-chart-speed:visible canvas").first
    box = canvas.bounding_box()
    user.press("speed", "Fullscreen")
    # the bars of a browser make room, and so the page is laid out again
    page.set_viewport_size(SCREEN)
    filled = {"x": 0, "y": 0, **SCREEN}
    user.wait_until(lambda: canvas.bounding_box() == filled)
    surface = ", ".join(map(str, SURFACES[colours][:3]))
    size = list(SCREEN.values())
    assert page.evaluate(FULL) == {"size": size, "title": '"Speed, km/h"', "ground": f"rgb({surface})"}
    # Chromium ignores a request to leave the full screen while it is still entering it
    page.wait_for_timeout(1000)
    page.locator(".rj-chart-speed:visible").get_by_title("Fullscreen", exact=True).click()
    user.wait_until(lambda: page.evaluate("!document.fullscreenElement"))
    page.set_viewport_size(WINDOW)
    page.mouse.move(5, 5)
    user.wait_until(lambda: canvas.bounding_box() == box)


def test_a_figure_is_saved_on_the_ground_of_the_page(user: User) -> None:
    for colours in ("dark", "light"):
        user.prefer(colours)
        with user.page.expect_download() as download:
            user.press("speed", "Save")
        content = Path(download.value.path()).read_bytes()
        assert download.value.suggested_filename == "metro-profile-ii-i-speed-km-h.png"
        assert content.startswith(PNG)
        assert [tuple(colour) for colour in user.page.evaluate(COLOURS, list(content))] == [SURFACES[colours]] * 3


def test_the_toolbar_is_reached_by_the_tab_key(user: User) -> None:
    tool = user.page.locator(".rj-chart-speed:visible").get_by_title("Save", exact=True)
    user.page.mouse.move(5, 5)
    user.page.get_by_role("button", name="Time", exact=True).focus()
    for _ in range(8):
        user.page.keyboard.press("Tab")
        if tool.evaluate("button => button.matches(':focus')"):
            break
    assert tool.evaluate("button => getComputedStyle(button).opacity") == "1"
    with user.page.expect_download():
        user.page.keyboard.press("Enter")


def test_the_numbers_of_figures_and_tables(user: User) -> None:
    name, texts = user.save_numbers()
    assert name == "metro-profile-ii-i-drive.zip"
    assert "railjoule solve" in texts["about.txt"]
    assert "@software{railjoule" in texts["about.txt"]
    rows = list(csv.DictReader(texts["speed-km-h.csv"].splitlines()))
    optimal = [(float(row["Distance, m"]), float(row["Speed, km/h"])) for row in rows if row["series"] == "optimal"]
    # the line of the scenario is 2300 m long; the highest speed stands above the charts
    assert (optimal[0], optimal[-1]) == ((0.0, 0.0), (2300.0, pytest.approx(0.0, abs=1e-6)))
    highest = float(user.number("Highest speed").removesuffix("km/h"))
    assert max(speed for _, speed in optimal) == pytest.approx(highest, abs=0.06)
    header, *phases = csv.reader(texts["phases.csv"].splitlines())
    assert header == ["Phase", "from, m", "s", "to, km/h", "kWh"]
    assert phases[0][0].startswith("1 ")
    assert sum(float(row[2]) for row in phases) == pytest.approx(170.0, abs=0.5)
    flow = "energy-from-the-supply-to-losses-and-back-kwh"
    assert "Recuperated" in texts[f"{flow}.svg"]
    flows = {(row["From"], row["To"]): float(row["kWh"]) for row in csv.DictReader(texts[f"{flow}.csv"].splitlines())}
    net = flows["Supply", "Powertrain"] - flows["Brake", "Recuperated"]
    assert net == pytest.approx(float(user.number("Energy from the supply").removesuffix("kWh")), abs=0.011)


def test_the_advice_is_copied_and_printed(user: User) -> None:
    user.page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    user.page.get_by_role("button", name="Copy the advice").click()
    expect(user.page.get_by_role("button", name="Copy the advice")).to_have_text("Copied")
    lines = user.page.evaluate("navigator.clipboard.readText()").splitlines()
    assert lines[0] == "Metro, profile II + I: 170.0 s"
    assert lines[1].startswith("1. Full power to ")
    assert lines[-1].startswith(f"{len(lines) - 1}. brake fully from ")
    user.page.get_by_role("button", name="Print the advice").click()
    sheet = user.page.frame_locator("#rj-print")
    expect(sheet.locator("p")).to_have_count(len(lines) - 1)


def test_the_form_of_a_report_is_used_by_keyboard(user: User, tmp_path: Path) -> None:
    page = user.page
    page.get_by_role("button", name="Report", exact=True).focus()
    page.keyboard.press("Enter")
    form = page.get_by_role("dialog", name="Report")
    expect(form.get_by_role("button", name="Make the report")).to_be_visible()
    assert grave_findings(page) == {}
    page.keyboard.press("Escape")
    expect(form).not_to_be_visible()
    expect(page.get_by_role("button", name="Report", exact=True)).to_be_focused()
    page.keyboard.press("Enter")
    expect(form).to_be_visible()
    for box in form.get_by_role("checkbox", checked=True).all()[::-1]:
        box.press("Space")
    form.get_by_role("button", name="Make the report").press("Enter")
    expect(form.get_by_role("alert")).to_contain_text("a report has at least one of result, energy")
    form.get_by_role("checkbox", name="Lower bound").press("Space")
    form.get_by_role("textbox", name="Author").fill("A. Author")
    form.get_by_role("textbox", name="Note").fill("x" * 2001)
    form.get_by_role("button", name="Make the report").press("Enter")
    expect(form.get_by_role("alert")).to_have_text("note: has 2,001 characters, at most 2,000 are permitted.")
    form.get_by_role("textbox", name="Note").fill("One\n\nTwo")
    with page.expect_download() as saved:
        form.get_by_role("button", name="Make the report").press("Enter")
    expect(form).not_to_be_visible()
    saved.value.save_as(tmp_path / "report.html")
    text = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert re.findall(r'<section id="([\w-]+)"', text) == ["note", "proof"]
    assert "<p>One</p><p>Two</p>" in text
