"""Study, as a user works with it: 1,500 runs, reached from the front page, to one on Drive and a file on the disk."""

import base64
import csv
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, BrowserContext, Locator, expect

from browser.findings import assert_nothing_grave
from browser.layout import layout_faults
from browser.server import Server
from browser.user import User, open_page

RUN_MS, RUNS = 240_000, 1500
DONE = re.compile(r"^([\d\u202f]+) of ([\d\u202f]+) runs")
DROP = """
([content, name]) => {
  const data = new DataTransfer();
  data.items.add(new File([Uint8Array.from(atob(content), (sign) => sign.charCodeAt(0))], name));
  document.body.dispatchEvent(new DragEvent("drop", {dataTransfer: data, bubbles: true, cancelable: true}));
}
"""
# the name of a heading has plain spaces
CHOSEN = re.compile(r"^Chosen: ([\d\s]+) runs")


@pytest.fixture(scope="module")
def user(server: Server, window: BrowserContext) -> Iterator[User]:
    """One user, who begins at Start and stays for all tests of this file."""
    with User.on(window, server.url, on_drive=False) as someone:
        open_page(someone, "Study")
        yield someone


def number(text: str) -> int:
    return int("".join(text.split()))


def done(user: User) -> int:
    """Return how many runs the page says are done."""
    found = DONE.match(status(user).inner_text().replace("\n", " "))
    assert found is not None
    return number(found[1])


def status(user: User) -> Locator:
    return user.page.locator(".study-status:visible p")


def button(user: User, name: str) -> Locator:
    return user.page.get_by_role("button", name=name, exact=True)


def chart(user: User, name: str) -> Locator:
    return user.page.locator(f".rj-chart-study_{name}:visible canvas").first


def test_a_field_is_added_dragged_and_left_out(user: User) -> None:
    user.page.get_by_label("Add a field").select_option("vehicle.tare_kg")
    rail = user.page.get_by_role("slider", name="Tare, kg: from, slider", exact=True)
    before = user.page.get_by_role("textbox", name="Tare, kg: from", exact=True)
    value = before.input_value()
    rail.focus()
    rail.press("ArrowRight")
    expect(before).not_to_have_value(value)
    button(user, "Leave Tare, kg as it is").click()
    expect(rail).to_have_count(0)
    expect(user.page.get_by_text("About ").get_by_text("on this computer.")).to_be_visible()


def test_it_runs_is_stopped_and_goes_on(user: User) -> None:
    user.type("Runs", str(RUNS))
    user.page.locator("main").get_by_role("button", name="Run", exact=True).click()
    expect(button(user, "Stop")).to_be_visible()
    expect(chart(user, "runs")).to_be_visible(timeout=RUN_MS)
    button(user, "Stop").click()
    expect(button(user, "Resume")).to_be_visible(timeout=RUN_MS)
    expect(status(user)).to_contain_text("stopped")
    stopped = done(user)
    assert 0 < stopped <= RUNS
    button(user, "Resume").click()
    expect(status(user).get_by_text("done", exact=True)).to_be_visible(timeout=RUN_MS)
    assert done(user) == RUNS
    expect(user.figure_value("decides")).to_contain_text("%")
    expect(chart(user, "map")).to_be_visible()
    expect(chart(user, "along_x")).to_be_visible()
    user.settled()
    assert layout_faults(user, "Study") == {}
    assert_nothing_grave(user)


def test_a_rectangle_chooses_runs_and_is_cleared(user: User) -> None:
    box = chart(user, "runs").bounding_box()
    assert box is not None
    mouse = user.page.mouse
    mouse.move(box["x"] + 0.3 * box["width"], box["y"] + 0.3 * box["height"])
    mouse.down()
    mouse.move(box["x"] + 0.7 * box["width"], box["y"] + 0.7 * box["height"], steps=6)
    mouse.up()
    title = user.page.get_by_role("heading", name=CHOSEN)
    expect(title).to_be_visible()
    found = CHOSEN.match(title.inner_text())
    assert found is not None
    assert 0 < number(found[1]) < RUNS
    expect(title).to_contain_text("travel time ")
    button(user, "Clear the choice").click()
    expect(user.page.get_by_role("heading", name=re.compile(r"^All: 1\s500 runs"))).to_be_visible()


def test_other_axes_are_drawn_and_a_point_tells_its_run(user: User) -> None:
    user.page.get_by_role("combobox", name="To the right", exact=True).click()
    user.page.get_by_role("menuitem", name="Recuperation factor", exact=True).click()
    axis = user.page.locator(".legend:visible").get_by_text("Energy, kWh, over recuperation factor")
    expect(axis).to_be_visible()
    user.settled()
    x, y = user.page.evaluate(
        """() => {
          const [view] = Bokeh.index.query(({model}) => model.type === "Figure"
            && model.html_attributes["aria-label"] === "Energy, kWh, over recuperation factor, ");
          const {left, top} = view.el.getBoundingClientRect(), {x, y} = view.model.renderers[0].data_source.data;
          return [left + view.frame.x_scale.compute(x[1000]), top + view.frame.y_scale.compute(y[1000])];
        }"""
    )
    user.page.mouse.move(x - 3, y)
    user.page.mouse.move(x, y)
    expect(user.page.locator(".told").get_by_text("Run:").first).to_be_visible()
    user.page.mouse.move(5, 5)


def test_the_table_is_downloaded(user: User) -> None:
    with user.page.expect_download() as download:
        button(user, "CSV").click()
    assert download.value.suggested_filename == "study.csv"
    with Path(download.value.path()).open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == RUNS
    assert {"timetable.travel_time_s", "vehicle.load_factor", "energy_kwh"} <= set(rows[0])


def test_a_saved_study_opens_again_by_dialog_and_drop(user: User, server: Server, chromium: Browser) -> None:
    with user.page.expect_download() as download:
        button(user, "Save study").click()
    assert download.value.suggested_filename == "study.nc"
    saved = Path(download.value.path())
    with User.at(chromium, server.url, on_drive=False) as other:
        open_page(other, "Study")
        expect(other.page.get_by_text("Open a study").first).to_be_visible()
        file = {"name": "study.nc", "mimeType": "application/x-netcdf", "buffer": saved.read_bytes()}
        other.page.locator("input[type=file][accept='.nc']").set_input_files(file)
        expect(status(other).get_by_text("done", exact=True)).to_be_visible(timeout=RUN_MS)
        assert done(other) == RUNS
        expect(chart(other, "runs")).to_be_visible()
    with User.at(chromium, server.url, on_drive=False) as other:
        other.page.evaluate(DROP, [base64.b64encode(saved.read_bytes()).decode(), "study.nc"])
        expect(other.question("Study")).to_be_visible()
        expect(status(other).get_by_text("done", exact=True)).to_be_visible(timeout=RUN_MS)
        assert done(other) == RUNS


def test_a_run_opens_on_drive_and_one_step_takes_it_back(user: User) -> None:
    row = user.page.locator(".chosen-runs tbody tr").nth(2)
    cells = row.locator("td").all_inner_texts()
    row.get_by_role("button").click()
    expect(user.question("Drive")).to_be_visible()
    user.see_drive()
    # the energy is the last cell before the button
    expect(user.figure_value("Energy from the supply")).to_contain_text(cells[-2])
    user.page.get_by_role("button", name="Undo", exact=True).click()
    expect(user.page.get_by_text("Unchanged", exact=True)).to_be_visible()
    open_page(user, "Study")
    expect(status(user).get_by_text("done", exact=True)).to_be_visible()
