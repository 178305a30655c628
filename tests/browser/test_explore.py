"""Explore, as a user works with it: runs, reached from the front page, to one on Drive and a file on the disk."""

import base64
import csv
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import BrowserContext, Locator, expect

from browser.findings import assert_nothing_grave
from browser.layout import layout_faults
from browser.server import Server
from browser.user import User, open_page

RUN_MS, RUNS = 240_000, 500
DONE = re.compile(r"^([\d\u202f]+) of ([\d\u202f]+) runs")
DROP = """
([content, name]) => {
  const data = new DataTransfer();
  data.items.add(new File([Uint8Array.from(atob(content), (sign) => sign.charCodeAt(0))], name));
  document.body.dispatchEvent(new DragEvent("drop", {dataTransfer: data, bubbles: true, cancelable: true}));
}
"""
# the name of a heading has plain spaces
CHOSEN = re.compile(r"^Selected: ([\d\s]+) runs")


@pytest.fixture(scope="module")
def user(server: Server, window: BrowserContext) -> Iterator[User]:
    """One user for all tests of this file, who begins at Start; the page is her own, as a study outlives a link."""
    with User.on(window, server.url) as someone:
        open_page(someone, "Explore")
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
    return user.page.locator(f".rj-chart-explore_{name}:visible canvas").first


def test_a_preview_is_there_and_its_ranges_are_typed(user: User) -> None:
    expect(user.page.get_by_text("The preview below shows the first ")).to_be_visible()
    expect(chart(user, "runs")).to_be_visible(timeout=RUN_MS)
    # the plan's sliders would say the same as the ranges
    expect(user.page.get_by_text("what the timetable expects")).to_be_hidden()
    low = user.page.get_by_role("textbox", name="Load factor: from, as a number", exact=True)
    low.fill("2")
    low.press("Enter")
    expect(
        user.page.get_by_text("The range 2 to 1 begins above its end.").or_(user.page.get_by_text("At most"))
    ).to_be_visible()
    low.fill("0.2")
    low.press("Enter")
    expect(user.page.get_by_text("At most")).to_have_count(0)
    expect(user.page.get_by_text("on this computer.")).to_be_visible()


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
    assert layout_faults(user, "Explore") == {}
    assert_nothing_grave(user)


def test_a_rectangle_selects_runs_until_it_is_cleared(user: User) -> None:
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
    button(user, "Clear selection").click()
    expect(user.page.get_by_role("heading", name=re.compile(f"^All: {RUNS} runs"))).to_be_visible()


def test_other_axes_are_drawn_a_point_has_its_run_and_all_are_downloaded(user: User) -> None:
    user.page.get_by_role("combobox", name="Horizontal axis", exact=True).click()
    user.page.get_by_role("menuitem", name="Recuperation factor", exact=True).click()
    axis = user.page.locator(".legend:visible").get_by_text("Energy, kWh, over recuperation factor")
    expect(axis).to_be_visible()
    user.settled()
    x, y = user.page.evaluate(
        """(run) => {
          const [view] = Bokeh.index.query(({model}) => model.type === "Figure"
            && model.html_attributes["aria-label"] === "Runs over two axes");
          const {left, top} = view.el.getBoundingClientRect();
          const points = view.model.renderers.map((one) => one.data_source).find(({data}) => data.row?.length);
          const {x, y} = points.data;
          return [left + view.frame.x_scale.compute(x[run]), top + view.frame.y_scale.compute(y[run])];
        }""",
        RUNS // 2,
    )
    user.page.mouse.move(x - 3, y)
    user.page.mouse.move(x, y)
    expect(user.page.locator(".point-tip").get_by_text("Run:").first).to_be_visible()
    user.page.mouse.move(5, 5)
    with user.page.expect_download() as download:
        button(user, "CSV").click()
    assert download.value.suggested_filename == "study.csv"
    with Path(download.value.path()).open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == RUNS
    assert {"timetable.travel_time_s", "vehicle.load_factor", "energy_kwh"} <= set(rows[0])


def test_a_saved_study_is_dropped_and_another_file_refused(user: User, server: Server, window: BrowserContext) -> None:
    with user.page.expect_download() as download:
        button(user, "Save study").click()
    assert download.value.suggested_filename == "study.nc"
    expect(status(user)).to_contain_text("Saved to your downloads: study.nc")
    saved = Path(download.value.path())
    with User.on(window, server.url) as other:
        other.page.evaluate(DROP, [base64.b64encode(saved.read_bytes()).decode(), "study.nc"])
        expect(other.question("Explore")).to_be_visible()
        expect(status(other).get_by_text("done", exact=True)).to_be_visible(timeout=RUN_MS)
        assert done(other) == RUNS
        expect(chart(other, "runs")).to_be_visible()
        file = {"name": "other.nc", "mimeType": "application/x-netcdf", "buffer": b"CDF"}
        other.page.locator("input[type=file][accept='.nc']").set_input_files(file)
        expect(other.page.get_by_text("other.nc does not contain a study")).to_be_visible()
        assert done(other) == RUNS


def test_a_run_opens_on_drive_and_one_step_takes_it_back(user: User) -> None:
    # a run that was chosen stays so while it is listed, wherever it stands
    chosen = user.page.get_by_role("combobox", name="Run", exact=True).inner_text().strip()
    rows = [row.locator("td").all_inner_texts() for row in user.page.locator("main tbody:visible tr").all()]
    (cells,) = (cells for cells in rows if cells and f"Run {cells[0]}" == chosen)
    button(user, "Open on Drive").click()
    expect(user.question("Drive")).to_be_visible()
    user.see_drive()
    # the energy is the last cell
    expect(user.figure_value("Energy from the supply")).to_contain_text(cells[-1])
    user.page.get_by_role("button", name="Undo", exact=True).click()
    expect(user.page.get_by_text("Unchanged", exact=True)).to_be_visible()
    open_page(user, "Explore")
    expect(status(user).get_by_text("done", exact=True)).to_be_visible()
