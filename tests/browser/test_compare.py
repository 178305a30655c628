"""Compare, as a user works with it."""

import pytest
from playwright.sync_api import expect

from browser.findings import assert_nothing_grave
from browser.user import User

CANARY = '<img src=x onerror="window.canary=1">'


@pytest.fixture(scope="module")
def user(user: User) -> User:
    """One user, who has pinned two runs and stays on the page for all tests of this file."""
    user.page.get_by_role("button", name="Pin run", exact=True).click()
    user.type("Load, % of capacity", "70")
    expect(user.page.get_by_role("button", name="Pin run", exact=True)).to_be_visible()
    user.page.get_by_role("button", name="Pin run", exact=True).click()
    user.type("Travel time, s", "180")
    user.turn_to("Compare")
    return user


def test_pinned_runs_are_compared_sorted_and_named(user: User) -> None:
    table = user.page.get_by_role("table").filter(has_text="vs reference, kWh")
    # Bellman is not ticked: it comes with the work behind this page
    for name in ("Bellman", "Fastest", "1 Optimal, 170.0 s", "2 Optimal, 170.0 s"):
        expect(table.get_by_role("row").filter(has_text=name).first).to_be_visible()
    user.page.get_by_role("combobox", name="Reference run").locator("visible=true").click()
    user.page.get_by_role("menuitem", name="2 Optimal").click()
    expect(user.page.get_by_text("of another scenario").locator("visible=true")).to_be_visible()
    cells = table.get_by_role("row").filter(has_text="2 Optimal").get_by_role("cell")
    assert cells.all_inner_texts()[2:4] == ["0.000", "0.00"]
    for chart in ("compared_speed", "compared_energy"):
        expect(user.page.locator(f".rj-chart-{chart}:visible canvas").first).to_be_visible()
    sort = table.get_by_role("button", name="kWh", exact=True)
    for upwards in (True, False):
        sort.click()
        energies = [float(text) for text in table.locator("tbody td:nth-child(2)").all_inner_texts()]
        assert energies == sorted(energies, reverse=not upwards)
    field = user.page.get_by_label("Name of pinned run 1")
    field.fill(CANARY)
    field.press("Enter")
    expect(table).to_contain_text(f"1 {CANARY}")
    told = user.page.locator(".differences li")
    expect(told).to_have_text([f"1 {CANARY}: load 50 % instead of 70 %."])
    assert user.page.evaluate("window.canary") is None
    assert_nothing_grave(user)


def test_a_second_train_stands_beside_the_first_in_two_columns(user: User) -> None:
    page = user.page
    page.get_by_role("tab", name="Two scenarios").click()
    expect(page.get_by_text("Choose a second scenario").locator("visible=true")).to_be_visible()
    page.get_by_role("combobox", name="Second scenario").locator("visible=true").click()
    page.get_by_role("menuitem", name="Tram 105N").click()
    figures = [page.locator(f".rj-chart-{side}_speed:visible") for side in ("first", "second")]
    boxes = []
    for figure in figures:
        expect(figure.locator("canvas").first).to_be_visible()
        boxes.append(figure.bounding_box())
    first, second = boxes
    assert first is not None
    assert second is not None
    # in two columns, side by side
    assert second["x"] > first["x"] + 0.9 * first["width"]
    assert abs(second["y"] - first["y"]) < 2
    assert_nothing_grave(user)
