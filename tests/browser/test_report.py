"""A report opened from disk without a network."""

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, expect

from browser.findings import grave_findings
from browser.reader import Reader, written
from railjoule.core import load_scenario
from railjoule.dashboard.look.tokens import DARK, LIGHT
from railjoule.dashboard.report.contents import Contents

CANARY = "<img src=x onerror='window.pwned=true'></script><script>window.pwned=true</script>"
MOST_PAGES = 8
PAPER_PX = 695
"""Of A4, what the margins leave: 184 mm of 96 px an inch."""
BEYOND = """width => [...document.querySelectorAll("main *, header *")]
  .filter(element => element.checkVisibility() && element.getBoundingClientRect().right > width + 1)
  .map(element => element.outerHTML.slice(0, 80))"""
COLOURS_OF = """canvas => {
  const {data} = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  const found = new Set();
  for (let k = 0; k < data.length; k += 4) {
    if (data[k + 3] === 255) {
      found.add("#" + [0, 1, 2].map(i => data[k + i].toString(16).padStart(2, "0")).join("").toUpperCase());
    }
  }
  return [...found];
}"""


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A report of a line with a stop, under a disturbance, with hostile texts."""
    changes = {
        "title": CANARY,
        "vehicle.name": CANARY,
        "line.name": CANARY,
        "line.stations": [{"name": CANARY, "position_m": 1200.0, "dwell_s": 20.0}],
        "timetable.travel_time_s": 230.0,
        "disturbance.coordinate_error_m": 8.0,
    }
    contents = Contents(author=CANARY, note=f"{CANARY}\n\n{'x' * 300}")
    return written(tmp_path_factory.mktemp("report"), load_scenario("metro-with-limit", changes), contents)


@pytest.fixture(scope="module")
def turned(chromium: Browser, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Reader]:
    """A report with the surface of ENOC."""
    path = written(tmp_path_factory.mktemp("turned"), load_scenario("ftorek-300s"), Contents(("trade-off",)))
    context = chromium.new_context(offline=True)
    someone = Reader(context.new_page(), path)
    yield someone
    assert someone.troubles == []
    context.close()


@pytest.fixture(scope="module", params=["light", pytest.param("dark", marks=pytest.mark.nightly)])
def reader(request: pytest.FixtureRequest, chromium: Browser, file: Path) -> Iterator[Reader]:
    context = chromium.new_context(
        viewport={"width": 1280, "height": 900}, color_scheme=request.param, offline=True, reduced_motion="reduce"
    )
    someone = Reader(context.new_page(), file)
    yield someone
    assert someone.troubles == []
    assert someone.page.evaluate("window.pwned") is None
    context.close()


def test_texts_of_users_stay_texts(reader: Reader) -> None:
    expect(reader.page.get_by_role("heading", level=1, name=CANARY)).to_be_visible()
    expect(reader.page.get_by_role("cell", name=CANARY)).to_be_visible()
    expect(reader.page.get_by_role("banner")).to_contain_text(f"by {CANARY}")
    expect(reader.page.get_by_role("region", name="Note by the author")).to_contain_text(CANARY)


def test_scripts_that_others_have_put_into_the_file_do_not_run(chromium: Browser, file: Path, tmp_path: Path) -> None:
    changed = tmp_path / "changed.html"
    bad = "<script>window.pwned = 1</script><img src=x onerror='window.pwned = 2'>"
    changed.write_text(file.read_text(encoding="utf-8").replace("<main>", f"<main>{bad}"), encoding="utf-8")
    context = chromium.new_context(offline=True)
    someone = Reader(context.new_page(), changed)
    assert someone.page.evaluate("window.pwned") is None
    refused = [trouble for trouble in someone.troubles if "Content Security Policy" in trouble]
    assert len(refused) >= 2
    context.close()


def test_a_report_without_figures_opens_and_prints(chromium: Browser, tmp_path: Path) -> None:
    path = written(tmp_path, load_scenario("liashenko-0"), Contents(("proof", "robustness", "scenario")))
    context = chromium.new_context(offline=True)
    someone = Reader(context.new_page(), path)
    expect(someone.page.get_by_role("region", name="Lower bound")).to_be_visible()
    assert someone.page.pdf().startswith(b"%PDF")
    assert someone.troubles == []
    context.close()


def test_the_slider_moves_numbers_words_and_figures(reader: Reader) -> None:
    page = reader.page
    before, pictures = reader.energy(), {name: reader.picture(name) for name in ("speed", "phases", "power")}
    page.get_by_role("slider", name="Travel time of the optimum, s").focus()
    for _ in range(6):
        page.keyboard.press("ArrowLeft")
    expect(page.locator("#shown")).not_to_have_text("Optimal, 230.0 s")
    expect(page.locator("#numbers .figure.main .value")).not_to_have_text(before)
    assert float(reader.energy().split()[0].removesuffix("kWh")) > float(before.split()[0].removesuffix("kWh"))
    page.wait_for_function("Bokeh.documents[0].is_idle")
    assert all(reader.picture(name) != picture for name, picture in pictures.items())
    page.get_by_role("button", name="Back to the timetable").click()
    expect(page.locator("#shown")).to_have_text("Optimal, 230.0 s")
    assert reader.energy() == before


def test_the_mouse_writes_values_into_the_captions(reader: Reader) -> None:
    box = reader.page.locator("[data-plot=speed]").bounding_box()
    assert box is not None
    reader.page.mouse.move(box["x"] + 0.4 * box["width"], box["y"] + 0.5 * box["height"])
    expect(reader.page.locator("[data-plot=speed]")).to_contain_text(re.compile(r"m: [\d.]+ km/h"))


def test_a_surface_is_turned_by_mouse_and_keyboard(turned: Reader) -> None:
    reader, surface = turned, turned.page.locator("canvas[data-surface]")
    surface.scroll_into_view_if_needed()
    reader.drawn()
    first = surface.screenshot()
    box = surface.bounding_box()
    assert box is not None
    reader.page.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
    reader.page.mouse.down()
    reader.page.mouse.move(box["x"] + 0.7 * box["width"], box["y"] + 0.6 * box["height"], steps=4)
    reader.page.mouse.up()
    reader.drawn()
    turned = surface.screenshot()
    assert turned != first
    surface.press("ArrowLeft")
    reader.drawn()
    assert surface.screenshot() != turned


def test_nothing_grave_is_found(reader: Reader) -> None:
    assert grave_findings(reader.page) == {}


def test_a_figure_fills_the_screen_and_is_saved(reader: Reader) -> None:
    place = reader.page.locator("[data-plot=speed]")
    place.hover()
    with reader.page.expect_download() as download:
        place.get_by_title("Save", exact=True).click()
    assert download.value.suggested_filename == "speed-km-h.png"
    place.get_by_title("Fullscreen", exact=True).click()
    reader.page.wait_for_function("document.fullscreenElement")
    # as in test_saving.py
    reader.page.wait_for_timeout(1000)
    place.get_by_title("Fullscreen", exact=True).click()
    reader.page.wait_for_function("!document.fullscreenElement")
    reader.page.mouse.move(5, 5)


def test_every_figure_has_its_words(reader: Reader) -> None:
    figures = reader.page.locator("[role=figure][aria-label], [role=img][aria-label]")
    expect(figures.first).to_be_visible()
    plots = reader.page.locator(".plot, .surface").count()
    assert plots >= 9
    assert figures.count() == plots
    assert all(len(figure.get_attribute("aria-label") or "") > 30 for figure in figures.all())


@pytest.mark.parametrize("width", [360, 2560])
def test_it_fits_every_screen(reader: Reader, width: int) -> None:
    reader.page.set_viewport_size({"width": width, "height": 900})
    # Bokeh is idle before it has heard of the new width, too: on a loaded machine figures follow a little later
    reader.page.wait_for_function("width => document.documentElement.scrollWidth <= width", arg=width)
    reader.page.set_viewport_size({"width": 1280, "height": 900})


def test_paper_is_light_and_short(reader: Reader) -> None:
    pages = reader.page.pdf(prefer_css_page_size=True, print_background=True)
    assert 1 < len(re.findall(rb"/Type\s*/Page\b", pages)) <= MOST_PAGES
    copies = reader.page.locator("[data-plot=speed] .paper canvas")
    colours = set(copies.evaluate(COLOURS_OF))
    assert LIGHT["optimal"] in colours
    assert DARK["optimal"] not in colours


def test_nothing_lies_beyond_the_paper(reader: Reader) -> None:
    page = reader.page
    page.set_viewport_size({"width": PAPER_PX, "height": 900})
    page.emulate_media(media="print")
    page.evaluate("window.dispatchEvent(new Event('beforeprint'))")
    assert page.locator(".paper canvas").first.is_visible()
    assert page.evaluate(BEYOND, PAPER_PX) == []
    assert page.evaluate("document.documentElement.scrollWidth") <= PAPER_PX
    page.evaluate("window.dispatchEvent(new Event('afterprint'))")
    page.emulate_media(media="screen")
    page.set_viewport_size({"width": 1280, "height": 900})


def test_a_surface_is_printed_in_its_own_proportions(turned: Reader) -> None:
    page, surface = turned.page, turned.page.locator("canvas[data-surface]")
    page.emulate_media(media="print")
    page.evaluate("window.dispatchEvent(new Event('beforeprint'))")
    drawn, shown = surface.evaluate("one => [one.width / one.height, one.clientWidth / one.clientHeight]")
    assert drawn == pytest.approx(shown, rel=1e-3)
    page.evaluate("window.dispatchEvent(new Event('afterprint'))")
    page.emulate_media(media="screen")
