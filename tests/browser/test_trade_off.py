"""Trade-off, as a user works with it."""

from playwright.sync_api import expect

from browser.user import User

LINK = "?v=1&page=Trade-off&preset=ftorek-300s"


def test_frontier_surface_and_contours(user: User) -> None:
    # the true optimum at 300 s, and ENOC with its own best acceleration time (findings on Ftorek 2025)
    expect(user.figure_value("Optimum at 300.0 s")).to_have_text("4.181kWh")
    for chart in ("frontier", "share", "surface"):
        expect(user.page.locator(f".rj-chart-{chart}:visible canvas").first).to_be_visible()
    table = user.page.get_by_role("table").filter(has_text="ramp, s")
    expect(table.get_by_role("row", name="ENOC, best ramp 4.250")).to_contain_text("31.0")
    expect(table.get_by_role("row", name="ENOC as printed 4.407")).to_be_visible()
    user.page.get_by_role("button", name="Contours", exact=True).click()
    user.page.locator(".rj-chart-contour:visible").scroll_into_view_if_needed()
    expect(user.page.locator(".rj-chart-contour:visible canvas").first).to_be_visible()
    expect(user.page.locator(".rj-chart-surface:visible")).to_have_count(0)
    user.page.get_by_role("button", name="Surface", exact=True).click()
    expect(user.page.locator(".rj-chart-surface:visible canvas").first).to_be_visible()


def test_the_surface_is_saved(user: User) -> None:
    place = user.page.locator(".rj-chart-surface:visible")
    place.scroll_into_view_if_needed()
    place.hover()
    with user.page.expect_download() as download:
        place.locator("[data-title='Download plot as a PNG']").click()
    assert download.value.suggested_filename == "enoc-energy-kwh-as-a-surface-drag-to-turn.png"
    header, *rows = user.save_numbers()[1]["enoc-energy-kwh-as-a-surface-drag-to-turn.csv"].splitlines()
    assert header.startswith('series,"Travel time, s","Acceleration time, s"')
    assert sum(row.startswith("surface,") for row in rows) > 500


def test_a_click_on_the_frontier_sets_the_travel_time(user: User) -> None:
    user.choose("Metro, profile II + I")
    before = user.page.locator(".figure.main:visible .label").inner_text()
    box = user.page.locator(".rj-chart-frontier:visible canvas").first.bounding_box()
    assert box is not None
    user.page.mouse.click(box["x"] + 0.8 * box["width"], box["y"] + 0.5 * box["height"])
    expect(user.page.locator(".figure.main:visible .label")).not_to_have_text(before)
