"""Saving figures and tables, and handing on the advice, as a user does it; nothing is asked of the server."""

import csv
import io
from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree

import pytest
from playwright.sync_api import BrowserContext, expect

from browser.server import Server
from browser.user import User

PNG = b"\x89PNG\r\n\x1a\n"
SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture(scope="module")
def user(server: Server, window: BrowserContext) -> Iterator[User]:
    """One user, who stays on Drive for all tests of this file."""
    with User.on(window, server.drive_url) as someone:
        yield someone


def rows_of(content: bytes) -> list[list[str]]:
    return list(csv.reader(io.StringIO(content.decode())))


def test_a_figure_as_png(user: User) -> None:
    name, content = user.save("Speed, km/h", "PNG")
    assert name == "metro-profile-ii-i-speed-km-h.png"
    assert content.startswith(PNG)
    # two pixels for each of the page's: width and height stand in the first chunk
    box = user.page.locator(".rj-chart-speed:visible canvas").first.bounding_box()
    assert box is not None
    assert int.from_bytes(content[16:20], "big") == pytest.approx(2 * box["width"], abs=4)
    assert int.from_bytes(content[20:24], "big") > 2 * box["height"]


def test_a_figure_as_svg_with_an_axis_of_its_own(user: User) -> None:
    _, content = user.save("Speed, km/h", "SVG")
    svg = ElementTree.fromstring(content)
    assert svg.tag == f"{SVG}svg"
    assert len(list(svg.iter(f"{SVG}path"))) > 10
    texts = {"".join(text.itertext()) for text in svg.iter(f"{SVG}text")}
    assert {"Speed, km/h", "Distance, m", "limit 50"} <= texts
    # the page's own chart has no axis again
    visible = "[...Bokeh.index.query((v) => v.model.type === 'Figure')].map((v) => v.model.below[0].visible)"
    assert user.page.evaluate(visible)[0] is False


def test_a_figure_as_csv(user: User) -> None:
    _, content = user.save("Speed, km/h", "CSV")
    header, *rows = rows_of(content)
    assert header[0] == "series"
    series, x, y = header.index("series"), header.index("Distance, m"), header.index("Speed, km/h")
    optimal = [(float(row[x]), float(row[y])) for row in rows if row[series] == "optimal"]
    # the line of the scenario is 2300 m long; the highest speed stands above the charts
    assert (optimal[0], optimal[-1]) == ((0.0, 0.0), (2300.0, pytest.approx(0.0, abs=1e-6)))
    highest = user.number("Highest speed").removesuffix("km/h")
    assert max(speed for _, speed in optimal) == pytest.approx(float(highest), abs=0.06)


def test_the_flow_of_energy(user: User) -> None:
    user.page.locator(".rj-chart-sankey:visible").scroll_into_view_if_needed()
    figure = "Energy from the supply to losses and back, kWh"
    expect(user.page.get_by_role("img", name=figure)).to_be_visible()
    svg = ElementTree.fromstring(user.save(figure, "SVG")[1])
    assert any("Recuperated" in "".join(text.itertext()) for text in svg.iter(f"{SVG}text"))
    assert user.save(figure, "PNG")[1].startswith(PNG)
    header, *rows = rows_of(user.save(figure, "CSV")[1])
    assert header == ["From", "To", "kWh"]
    flows = {(row[0], row[1]): float(row[2]) for row in rows}
    net = flows["Supply", "Powertrain"] - flows["Brake", "Recuperated"]
    assert net == pytest.approx(float(user.number("Energy from the supply").removesuffix("kWh")), abs=0.011)


def test_a_table_as_csv(user: User) -> None:
    with user.page.expect_download() as download:
        user.page.get_by_role("button", name="Save Phases as CSV").click()
    header, *rows = rows_of(Path(download.value.path()).read_bytes())
    assert header == ["Phase", "from, m", "s", "to, km/h", "kWh"]
    assert rows[0][0].startswith("1 ")
    assert sum(float(row[2]) for row in rows) == pytest.approx(170.0, abs=0.5)


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
