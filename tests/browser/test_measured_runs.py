"""Recorded runs on Files, as a user works with them: by mouse, with the example and with files of her own."""

import re
from pathlib import Path

import pytest
from measured_example import DRIVERS, FOLDER
from playwright.sync_api import expect

from browser.user import User, open_page

EXAMPLE = FOLDER / DRIVERS[0].file
CHARTS = ("measured_speed", "line", "measured_energy")
CANARY = "<img src=x onerror=window.pwned=1>"


LINK = "?v=1&page=Start"


@pytest.fixture(scope="module")
def user(user: User) -> User:
    """One user, who begins on Start and stays on the page for all tests of this file."""
    open_page(user, "Files")
    user.page.get_by_role("tab", name="Recorded runs").click()
    return user


def press(user: User, name: str) -> None:
    user.page.get_by_role("button", name=name, exact=True).click()


def bring(user: User, *paths: Path) -> None:
    """Choose files on the page; the sidebar has another button for scenarios."""
    user.page.locator("input[type=file][accept*=xlsx]").set_input_files(paths)


def test_the_example_tells_what_could_be_saved(user: User) -> None:
    expect(user.page.get_by_text("The page finds where the run lies")).to_be_visible()
    press(user, "Try the example")
    saved = user.figure_value("Potential saving")
    # 9.26 kWh modelled, 7.61 the optimum: see test_work.py
    expect(saved).to_have_text(re.compile(r"17\.\d%"))
    expect(user.page.get_by_text("proven for the modelled train").first).to_be_visible()
    for chart in CHARTS:
        expect(user.page.locator(f".rj-chart-{chart}:visible canvas").first).to_be_visible()
    expect(user.page.get_by_text("B and C cannot be separated by these runs")).to_be_visible()
    expect(user.page.get_by_text("The page finds where the run lies")).to_be_hidden()


def test_a_question_about_a_unit_is_answered_by_a_press(user: User, tmp_path: Path) -> None:
    path = tmp_path / "own.csv"
    path.write_text(EXAMPLE.read_text().replace("line_power_kw", "power_w").replace("outside_degc", CANARY))
    bring(user, path)
    question = user.page.get_by_text("was kW meant?")
    expect(question).to_be_visible()
    expect(user.page.get_by_text("no power was measured")).to_be_visible()
    press(user, "Use kW")
    expect(question).to_be_hidden()
    expect(user.figure_value("Measured")).to_have_text(re.compile(r"9\.6\d"))
    press(user, "Change")
    expect(user.page.get_by_role("combobox", name="speed_kmh", exact=True)).to_have_value("Speed")
    user.page.get_by_label("effort_kn", exact=True).select_option("Not used")
    expect(user.page.get_by_text("4 of 6 columns used.")).to_be_visible()
    press(user, "Fold")
    expect(user.page.get_by_role("combobox", name="speed_kmh", exact=True)).to_be_hidden()
    assert user.page.evaluate("window.pwned") is None


def test_a_run_is_dropped_on_any_page_and_the_example_survives_a_reload(user: User) -> None:
    open_page(user, "Drive")
    user.page.evaluate(
        """text => {
          const data = new DataTransfer();
          data.items.add(new File([text], "dropped.csv"));
          window.dispatchEvent(new DragEvent("drop", {dataTransfer: data, bubbles: true, cancelable: true}));
        }""",
        EXAMPLE.read_text(),
    )
    expect(user.question("Files")).to_be_visible()
    expect(user.page.get_by_text("dropped.csv, run").first).to_be_visible()
    expect(user.figure_value("Potential saving")).to_have_text(re.compile(r"17\.\d%"))
    user.settled()
    user.page.reload()
    expect(user.question("Files")).to_be_visible()
    expect(user.page.get_by_text(f"{DRIVERS[-1].file}, run 2 of 2")).to_be_visible()
