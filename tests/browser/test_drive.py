"""Drive, as a user works with it."""

import re

import pytest
from playwright.sync_api import expect

from browser.findings import assert_nothing_grave
from browser.user import User
from railjoule.dashboard.charts.axis import END_LABEL_SHARE


@pytest.fixture
def user(user: User) -> User:
    """The user before what a new page shows."""
    user.go()
    return user


SLOWER = 5
"""A processor this many times slower."""


def test_a_timetable_that_no_train_can_keep(user: User) -> None:
    figures = ("Energy from the supply", "Travel time", "Highest speed", "Recuperated")
    before = [user.number(figure) for figure in figures]
    user.type("Travel time, s", "120")
    alert = user.alert()
    assert alert.startswith("120.0 s is too short. The shortest possible run takes 133.6 s.")
    assert "Shown: the last valid run, 170.0 s." in alert
    assert [user.number(figure) for figure in figures] == before
    user.page.get_by_role("button", name="Use 133.7 s").click()
    user.see_no_alert()
    expect(user.figure_value("Travel time")).to_have_text("133.7s")


def test_pinning_a_run(user: User) -> None:
    user.page.get_by_role("button", name="Pin run").click()
    user.push("Travel time, s", 20)
    main = user.page.locator(".figure.main:visible")
    expect(main).to_contain_text("▼")
    expect(main).to_contain_text("against pinned 7.8")
    expect(user.page.locator(".rj-chart-difference:visible")).to_be_visible()
    user.push("Travel time, s", -20)
    user.page.get_by_role("button", name="Unpin").click()
    expect(user.page.locator(".rj-chart-difference")).to_be_hidden()


def x_range(user: User) -> tuple[float, float]:
    """Return the ends of the axis that all charts share, as the browser has them."""
    script = """() => {
      const figures = [...Bokeh.documents[0].all_models].filter((model) => model.type === "Figure");
      return [figures[0].x_range.start, figures[0].x_range.end];
    }"""
    start, end = user.page.evaluate(script)
    return start, end


def test_a_zoom_survives_a_slider_and_not_the_axis_of_time(user: User) -> None:
    whole = x_range(user)
    box = user.page.locator(".rj-chart-speed:visible canvas").first.bounding_box()
    assert box is not None
    middle = box["y"] + box["height"] / 2
    user.page.mouse.move(box["x"] + 200, middle)
    user.page.mouse.down()
    user.page.mouse.move(box["x"] + 500, middle, steps=8)
    user.page.mouse.up()
    user.wait_until(lambda: x_range(user) != whole)
    zoomed = x_range(user)
    assert zoomed[1] - zoomed[0] < 0.6 * (whole[1] - whole[0])
    user.push("Travel time, s", 5)
    assert x_range(user) == zoomed
    user.page.mouse.dblclick(box["x"] + 300, middle)
    user.wait_until(lambda: x_range(user) == whole)
    speed = user.picture("speed")
    user.page.get_by_role("button", name="Time", exact=True).click()
    user.see_change("speed", speed)
    user.settled()
    assert x_range(user)[1] == pytest.approx(172.5 * (1 + END_LABEL_SHARE), rel=1e-6)


def test_one_cursor_through_all_charts(user: User) -> None:
    box = user.page.locator(".rj-chart-speed:visible canvas").first.bounding_box()
    assert box is not None
    user.page.mouse.move(box["x"] + 400, box["y"] + 100)
    user.page.mouse.move(box["x"] + 420, box["y"] + 100)
    captions = [user.page.locator(f".rj-chart-{chart}:visible .rj-caption div").first for chart in ("speed", "energy")]
    expect(captions[1]).to_contain_text("kWh")
    speed, energy = (caption.inner_text() for caption in captions)
    assert "m: " in speed
    assert speed.endswith("km/h")
    assert energy.endswith("kWh")
    user.push("Travel time, s", 20)
    expect(captions[0]).not_to_have_text(speed)
    expect(captions[1]).not_to_have_text(energy)


@pytest.mark.nightly
def test_on_a_slow_machine_slider_number_and_run_stay_together(user: User) -> None:
    """Changes come faster than the page draws them, and it must not send old ones back."""
    user.slow_down(SLOWER)
    for steps in (20, -12):
        user.push("Travel time, s", steps)
    user.slow_down(1)
    expect(user.figure_value("Travel time")).to_have_text("174.0s")
    expect(user.page.get_by_label("Travel time, s, as a number", exact=True)).to_have_value("174.0")
    expect(user.slider("Travel time, s")).to_have_value("174")


def test_a_figure_out_of_sight_rests_until_it_comes_into_sight(user: User) -> None:
    find = """(label) => {
      const name_of = ({html_attributes: a}) => a instanceof Map ? a.get("aria-label") : a["aria-label"];
      const found = Bokeh.index.query(({model}) => model.type === "Figure" && name_of(model) === label);
      const [{model, _render_count}] = [...found];
      return {rests: model.hold_render, painted: _render_count};
    }"""

    def speed() -> dict[str, int]:
        return dict(user.page.evaluate(find, "Speed, km/h"))

    def power() -> dict[str, int]:
        return dict(user.page.evaluate(find, "Current or power from the supply"))

    with user.resized(1280, 500):
        user.wait_until(lambda: bool(power()["rests"]))
        before = speed()["painted"], power()["painted"]
        user.push("Travel time, s", 2)
        user.wait_until(lambda: speed()["painted"] > before[0])
        assert power()["painted"] == before[1]
        user.page.locator(".rj-chart-current:visible").scroll_into_view_if_needed()
        user.wait_until(lambda: not power()["rests"] and power()["painted"] > before[1])
        # it is in sight again, and follows
        after = power()["painted"]
        user.push("Travel time, s", 2)
        user.wait_until(lambda: power()["painted"] > after)
    user.page.locator(".rj-chart-speed:visible").scroll_into_view_if_needed()


def test_simpler_advice_is_shown_and_pinned(user: User) -> None:
    user.choose("Metro, set speeds, 40 km/h")
    advice = user.page.get_by_role("list", name="Driver\u2019s advice", exact=True)
    user.page.get_by_role("button", name="Simple", exact=True).click()
    expect(user.page.get_by_text("5 instructions instead of 8: +0.10 % energy.")).to_be_visible()
    expect(advice.locator("li:has(> b)")).to_have_count(5)
    user.page.get_by_role("button", name="Pin this advice", exact=True).click()
    expect(user.page.get_by_text("Pinned: Simple advice").first).to_be_visible()
    assert_nothing_grave(user)
    user.page.get_by_role("button", name="Exact", exact=True).click()
    # of the strategy that this scenario names
    expect(advice.locator("li:has(> b)")).to_have_count(4)


def test_the_train_plays_pauses_and_is_dragged(user: User) -> None:
    page = user.page
    play, pause = (page.get_by_role("button", name=name, exact=True) for name in ("Play", "Pause"))
    slider, now = page.get_by_label("Time of the run, s"), page.locator("li.now")
    time, energy = (page.locator(f".player b[data-quantity={name}]") for name in ("time", "energy"))
    page.get_by_label("Pace", exact=True).select_option("10")
    play.click()
    user.wait_until(lambda: time.inner_text() not in {"\u2013", ""} and float(time.inner_text()) > 15)
    expect(now).to_contain_text("coast from 43 m")
    pause.click()
    stood = float(time.inner_text())
    assert 3 < float(energy.inner_text()) < 5
    train = page.evaluate(
        """() => [...Bokeh.documents[0].all_models]
          .filter((one) => one.type === "ColumnDataSource" && one.name === "train" && one.data.x.length)
          .map((one) => one.data.x[0])"""
    )
    # at one place in the figures of speed and track
    assert len(train) == 2
    assert train[0] == train[1] > 43
    slider.focus()
    page.keyboard.press("ArrowRight")
    assert float(time.inner_text()) == pytest.approx(stood + 1, abs=1.0)
    slider.fill("60")
    expect(now).to_contain_text("hold 50 km/h")
    assert_nothing_grave(user)


SWITCH = """() => {
  const models = [...Bokeh.documents[0].all_models];
  const line = models.find((one) => one.type === "Span" && one.name === "switch");
  const figure = models.find((one) => one.type === "Figure" && one.center.includes(line));
  const view = Bokeh.index.find_one(figure), box = view.el.getBoundingClientRect();
  return [box.left + view.frame.x_scale.compute(line.location), box.top + box.height / 2];
}"""
"""Returns the place of the dashed line on the screen."""


def test_the_start_of_coasting_is_dragged_and_typed(user: User) -> None:
    page, whole = user.page, x_range(user)
    page.get_by_role("combobox", name="Move an instruction").click()
    page.get_by_role("menuitem", name="6 coast", exact=True).click()
    place = page.get_by_label("Begins at, m, as a number")
    expect(place).to_have_value("970")
    place.fill("1000")
    place.press("Enter")
    expect(
        page.get_by_text(re.compile(r"Coasting from 1.000 m instead of 970 m: \+0\.\d\d %, same arrival\."))
    ).to_be_visible()
    user.settled()
    x, y = page.evaluate(SWITCH)
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x - 8, y, steps=4)
    page.mouse.up()
    expect(place).not_to_have_value("1000")
    expect(page.get_by_text(re.compile(r"Coasting from 9\d\d m instead of 970 m"))).to_be_visible()
    # the box that zooms did not take the drag
    assert x_range(user) == whole
    page.get_by_role("combobox", name="Move an instruction").click()
    page.get_by_role("menuitem", name="None", exact=True).click()
    expect(place).to_be_hidden()
    assert_nothing_grave(user)
