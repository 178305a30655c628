"""The lessons of a report from disk, without a network: by mouse and keyboard, by touch, and on paper."""

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Locator, Page, expect

from browser.findings import grave_findings
from browser.reader import Reader, written
from railjoule.core import load_scenario
from railjoule.core.units import J_PER_KWH
from railjoule.dashboard.look.words import number
from railjoule.dashboard.pages.learn import alone, by_hand, drawing, slack
from railjoule.dashboard.pages.learn.answers import answer_of
from railjoule.dashboard.pages.learn.compute import FIRST_VALUES, LessonRequest, compute_lesson
from railjoule.dashboard.pages.learn.guesses import GUESSES
from railjoule.dashboard.report.contents import Contents

ARRIVES_MS = 60_000
FOCUSED = "one => one.getRootNode().activeElement === one"
OPTIMUM_DRAWN = """highest => [...Bokeh.documents[0].all_models].some((model) => model.type === "ColumnDataSource" &&
  Object.values(model.data).some((column) => column.length && Math.abs(Math.max(...column) - highest) < 0.1))"""


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return written(tmp_path_factory.mktemp("report"), load_scenario("liashenko-0"), Contents(("proof", "lessons")))


@pytest.fixture
def reader(request: pytest.FixtureRequest, chromium: Browser, file: Path) -> Iterator[Reader]:
    scheme, width, touch = request.param
    context = chromium.new_context(
        viewport={"width": width, "height": 900}, color_scheme=scheme, has_touch=touch, offline=True
    )
    someone = Reader(context.new_page(), file)
    yield someone
    assert someone.page.evaluate("document.documentElement.scrollWidth") == width
    assert someone.troubles == []
    context.close()


def reach(page: Page, target: Locator) -> None:
    for _ in range(60):
        if target.evaluate(FOCUSED):
            return
        page.keyboard.press("Tab")
    raise AssertionError("the keyboard does not reach it")


def told(name: str, guess: float) -> str:
    """Return what the library says of a guess."""
    result = compute_lesson(LessonRequest(name, FIRST_VALUES[name]))
    return str(GUESSES[name].told(guess, *answer_of(result))["sentence"])


@pytest.mark.parametrize("reader", [("light", 1280, False)], indirect=True, ids=["wide"])
def test_all_are_played_by_mouse_and_keyboard_and_judged_as_by_the_library(reader: Reader) -> None:
    page, keys = reader.page, reader.page.keyboard
    # the train drives on while the others are played
    drive = page.locator("section.drive-it")
    reach(page, drive.get_by_role("button", name="10\u00d7"))
    keys.press("Enter")
    keys.press("ArrowUp")
    expect(drive.get_by_text("Try 1 of 3: on the way")).to_be_visible()
    share_out(page)
    draw_speed(page)
    guess(page)
    expect(drive.locator(".outcome")).to_be_focused(timeout=ARRIVES_MS)
    verdict = by_hand.verdict_on("p0")
    kwh, bound = f"{verdict['kwh']:.2f}", f"{verdict['bound_kwh']:.2f}"
    expect(drive.locator(".outcome")).to_have_text(f"You used {kwh} kWh; nobody on time can use less than {bound}.")
    expect(drive.get_by_text(verdict["parting"]["there"])).to_be_visible()
    # no server: nothing that needs one
    expect(page.get_by_role("button", name=re.compile("workbench|link"))).to_have_count(0)
    assert grave_findings(page) == {}


def share_out(page: Page) -> None:
    share, mouse = page.locator("section.share-out"), page.mouse
    border = share.get_by_role("slider").first
    border.scroll_into_view_if_needed()
    box, whole = border.bounding_box(), share.locator(".split").bounding_box()
    assert box is not None
    assert whole is not None
    mouse.move(box["x"] + box["width"] / 2, box["y"] + 10)
    mouse.down()
    mouse.move(whole["x"] + whole["width"] * 12 / 60, box["y"] + 10, steps=4)
    mouse.up()
    keys = page.keyboard
    keys.press("ArrowRight")
    reach(page, share.get_by_role("button", name="Show the best sharing"))
    keys.press("Enter")
    verdict = slack.verdict_on("uneven", (13, 27, 20))
    kwh, bound = f"{verdict['kwh']:.2f}", f"{verdict['bound_kwh']:.2f}"
    expect(share.locator(".outcome")).to_have_text(f"You need {kwh} kWh; no sharing needs less than {bound}.")
    expect(share.get_by_role("listitem")).to_have_text(verdict["sentences"])


def draw_speed(page: Page) -> None:
    draw, keys = page.locator("section.draw-speed"), page.keyboard
    reach(page, draw.get_by_role("slider"))
    for _ in range(4):
        keys.press("PageDown")
    for _ in range(drawing.POINTS - 1):
        keys.press("Shift+ArrowRight")
    reach(page, draw.get_by_role("button", name="Show the best run"))
    keys.press("Enter")
    run = drawing.run_of((60,) * drawing.POINTS)
    bound = alone.drawing_optima().lines.energy_j_at(run.travel_time_s) / J_PER_KWH
    expect(draw.locator(".outcome")).to_contain_text(f"You use {run.energy_kwh:.2f} kWh; in ")
    expect(draw.locator(".outcome")).to_contain_text(f"nobody can use less than {bound:.2f}.")
    # which run is drawn is told
    best = next(one for one in alone.drawing_optima().runs[::-1] if one.travel_time_s <= run.travel_time_s)
    less = number(run.travel_time_s - best.travel_time_s)
    expect(draw.get_by_text(f"{less} s less than yours, the thinner line is yours.")).to_be_visible()
    expect(draw.get_by_role("listitem")).to_have_text(drawing.stretches(run, best))


def guess(page: Page) -> None:
    """Guess: before it, nothing of the optimum is on the page, and nothing after taking it back."""
    lesson, keys = page.get_by_role("article", name="4. Why coasting saves"), page.keyboard
    # km/h, of the optimum of this lesson, as tests/browser/test_lessons.py has it from the library
    highest = 57.5
    expect(lesson.get_by_text("The best run is hidden until you have guessed.")).to_be_visible()
    assert not page.evaluate(OPTIMUM_DRAWN, highest)
    lesson.get_by_role("slider").first.focus()
    keys.press("ArrowRight")
    keys.press("Enter")
    expect(lesson.get_by_role("group", name="Your guess and the answer")).to_be_focused()
    expect(lesson.get_by_text(told("coasting", 21.0))).to_be_visible()
    expect(lesson.get_by_text("Full power to 57.5 km/h, 10.09 kWh drawn", exact=False)).to_be_visible()
    assert page.evaluate(OPTIMUM_DRAWN, highest)
    keys.press("Tab")
    keys.press("Enter")
    expect(lesson.get_by_text("Full power to", exact=False)).to_have_count(0)
    assert not page.evaluate(OPTIMUM_DRAWN, highest)


@pytest.mark.parametrize("reader", [("dark", 390, True)], indirect=True, ids=["narrow"])
def test_they_are_played_by_touch_and_left_out_on_paper(reader: Reader) -> None:
    page = reader.page
    drive, draw = page.locator("section.drive-it"), page.locator("section.draw-speed")
    drive.get_by_role("button", name="Power").tap()
    expect(drive.get_by_text("Try 1 of 3: on the way")).to_be_visible()
    share = page.locator("section.share-out")
    share.get_by_role("button", name="1 s earlier").first.tap()
    expect(share.get_by_text("19 s", exact=True)).to_be_visible()
    canvas = draw.locator("canvas")
    canvas.scroll_into_view_if_needed()
    canvas.tap(position={"x": 200, "y": 100})
    draw.get_by_role("button", name="Show the best run").tap()
    expect(draw.locator(".outcome")).to_be_visible()
    for name, question in GUESSES.items():
        asked = page.locator(f"[data-lesson={name}]")
        if question.choices:
            asked.get_by_role("button").first.tap()
            expect(asked.get_by_text(told(name, question.choices[0]))).to_be_visible()
        else:
            asked.get_by_role("button", name="This is my guess").tap()
        expect(asked.get_by_role("figure").first).to_be_visible()
    assert grave_findings(page) == {}
    page.emulate_media(media="print")
    expect(page.get_by_text("they are played on the screen")).to_be_visible()
    expect(drive).to_be_hidden()
    page.emulate_media(media="screen")
