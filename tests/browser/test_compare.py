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


def row(user: User, name: str) -> list[str]:
    """Return the cells of a run in the table."""
    table = user.page.get_by_role("table").filter(has_text="vs reference, kWh")
    return table.get_by_role("row").filter(has_text=name).get_by_role("cell").all_inner_texts()


def number(cell: str) -> float:
    return float(cell.replace("\u2212", "-").replace("\u202f", ""))


def test_pinned_runs_stand_beside_all_strategies(user: User) -> None:
    table = user.page.get_by_role("table").filter(has_text="vs reference, kWh")
    # Bellman is not ticked: it comes with the work behind this page
    for name in ("Optimal", "Bellman", "Set speeds", "Fastest", "1 Optimal, 170.0 s", "2 Optimal, 170.0 s"):
        expect(table.get_by_role("row").filter(has_text=name).first).to_be_visible()
    # more time saves energy: the optimum of 180 s lies below the pinned runs, and is the reference until one is chosen
    assert row(user, "Fastest")[2].startswith("+")
    user.page.get_by_role("combobox", name="Reference run").locator("visible=true").click()
    user.page.get_by_role("menuitem", name="2 Optimal").click()
    expect(user.page.get_by_text("of another scenario").locator("visible=true")).to_be_visible()
    one, two = row(user, "1 Optimal"), row(user, "2 Optimal")
    assert two[2:4] == ["0.000", "0.00"]
    assert number(one[2]) == pytest.approx(number(one[1]) - number(two[1]), abs=0.011)
    for chart in ("compared_speed", "compared_energy"):
        expect(user.page.locator(f".rj-chart-{chart}:visible canvas").first).to_be_visible()
    told = user.page.locator(".differences li")
    expect(told).to_have_text(["1 Optimal, 170.0 s, load 50 %, recuperation 40 %: load 50 % instead of 70 %."])


def test_the_table_is_sorted_by_a_column(user: User) -> None:
    table = user.page.get_by_role("table").filter(has_text="vs reference, kWh")
    sort = table.get_by_role("button", name="kWh", exact=True)
    for upwards in (True, False):
        sort.click()
        energies = [number(text) for text in table.locator("tbody td:nth-child(2)").all_inner_texts()]
        assert energies == sorted(energies, reverse=not upwards)


def test_a_pin_takes_a_name_which_is_text_and_nothing_else(user: User) -> None:
    field = user.page.get_by_label("Name of pinned run 1")
    field.fill(CANARY)
    field.press("Enter")
    table = user.page.get_by_role("table").filter(has_text="vs reference, kWh")
    expect(table).to_contain_text(f"1 {CANARY}")
    expect(user.page.locator(".differences")).to_contain_text(CANARY)
    assert user.page.evaluate("window.canary") is None
    assert_nothing_grave(user)


def test_a_second_train_stands_beside_the_first_in_two_columns(user: User) -> None:
    page = user.page
    page.get_by_role("tab", name="Two scenarios").click()
    expect(page.get_by_text("Choose a second scenario").locator("visible=true")).to_be_visible()
    page.get_by_role("combobox", name="Second scenario").locator("visible=true").click()
    page.get_by_role("menuitem", name="Tram 105N").click()
    difference_line = page.get_by_text("The second scenario has vehicle Tram 105N instead of Metro 81-7036").locator(
        "visible=true"
    )
    expect(difference_line).to_be_visible()
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
