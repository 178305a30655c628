"""Every figure of every page, drawn for shipped scenarios in both themes: no error, data within named axes, tools."""

import logging
import re
from functools import partial

import numpy as np
import pytest
from bokeh.models import FullscreenTool, GlyphRenderer, SaveTool
from bokeh.plotting import figure

from railjoule.dashboard.app import Session
from railjoule.dashboard.charts.dress import DARK_INK, WHITE
from railjoule.dashboard.look.tokens import COST_SCALES, SAVING_SCALES, THEMES
from railjoule.dashboard.page_list import PAGES
from railjoule.dashboard.pages.learn.lessons import LESSONS

UNIT = re.compile(r", (km/h|kWh|Wh/s|kN|MW|kW|A|V s|V|N m|rad/s|Wb|s|mm|m|ms|min|%|J|Hz|\u2030|\u2013)(?![a-z])")
COUNTED = ("Trip", "Printed number, in the order of the tables", "Students", "Load factor", "Recuperation factor")
"""What is counted, and a factor, has no unit."""
CUT = {("contour", "x")} | {
    (name, "y")
    for name in (
        "scatter",
        "lesson_price",
        "plane_multiplier",
        "plane_recuperation",
        "price",
    )
}
"""Axes that cut off their data on purpose: the rise beyond them would hide the rest."""
COLOURS = ("line_color", "fill_color", "text_color", "background_fill_color")
SHORT = {"line": {"sections": [{"length_m": 1000.0}]}, "timetable.travel_time_s": 75.0}


def with_edits(edits, state):
    state.scenario.edit(edits)


def with_law(state):
    state.chosen = "bellman"


def with_guesses(state):
    learn = state.pages["Learn"]
    learn.open_class()
    for lesson in LESSONS:
        setattr(learn, lesson.guess, lesson.guess_ends[0])
    learn.played["drawn"].type_speed()
    learn.hear("drawn", "done", learn.played["drawn"].text)
    learn.hear("driven", "done", "p0c300p600")


def with_simple_advice(state):
    state.pages["Drive"].param.update(advice="simple", supply="power", has_prices_open=True)
    state.pin()
    state.scenario.travel_time_s += 5


def with_files(state):
    state.pages["Files"].try_example()
    state.pages["Files"].say(2, "rows NOM_VOIE", "V1")


def with_runs(state):
    state.pages["Files"].tab = "runs"
    state.pages["Files"].try_example()


def with_a_study(state):
    page = state.pages["Explore"]
    page.param.update(over={"vehicle.load_factor": [0.0, 1.0], "timetable.travel_time_s": [150, 190]}, runs=40)
    page.begin()


def with_contours(state):
    state.pages["Trade-off"].map_view = "contours"


SCENARIOS = ("metro-with-limit", "ftorek-300s", "tram-950m-stop")


def with_tab(page, tab, state):
    state.pages[page].tab = tab


def with_a_second_scenario(state):
    state.pages["Compare"].param.update(tab="scenarios", second="time")


def with_live_run(state):
    state.pages["What if"].tab = "events"
    state.pages["What if"].live.on = True


def with_a_stop(state):
    state.pages["What if"].tab = "events"
    state.pages["What if"].drop("stop", state.day.free_m())


CASES = {
    **{page: [(name, None) for name in SCENARIOS] for page in PAGES},
    "Start": [("metro-with-limit", None)],
    "Drive": [("metro-with-limit", with_law), ("ftorek-300s", None), ("tram-950m-stop", with_simple_advice)],
    "Trade-off": [("metro-with-limit", None), ("ftorek-300s", None), ("ftorek-300s", with_contours)],
    "What if": [
        ("metro-with-limit", None),
        ("metro-with-limit", with_a_stop),
        ("metro-with-limit", with_live_run),
        ("metro-with-limit", partial(with_tab, "What if", "chance")),
    ],
    "Compare": [("metro-with-limit", None), ("metro-with-limit", with_a_second_scenario)],
    "Set speeds": [
        ("kharkiv-like-40kmh", None),
        ("ftorek-300s", None),
        ("kharkiv-like-40kmh", partial(with_tab, "Set speeds", "losses")),
    ],
    "Motor": [("metro-with-limit", None), ("ftorek-300s", partial(with_edits, SHORT))],
    "Line": [("metro-with-limit", None), ("metro-10-stations", None)],
    "Explore": [("metro-with-limit", with_a_study)],
    "Learn": [("metro-with-limit", with_guesses)],
    "Files": [("metro-with-limit", None), ("metro-with-limit", with_files), ("metro-with-limit", with_runs)],
    "Papers": [("metro-with-limit", None)],
    "Help": [("metro-with-limit", None)],
}
"""Of each page the scenarios, and what is done there, until each of its figures is drawn."""
NO_FIGURE = {"sankey", "surface", "robust_speed", "candidates"}
"""What is no figure of Bokeh, and studies that are begun by hand: tests/dashboard/pages/what_if."""
WITHOUT_FIGURE = {"Start", "Files", "Help"}
"""Pages that have none in sight when they open, and so no button that saves numbers."""


# Panel warns once of how panel-material-ui calls it
@pytest.mark.filterwarnings("ignore::PendingDeprecationWarning")
@pytest.mark.parametrize("page", PAGES)
def test_all_figures_of_a_page_are_drawn(page, caplog):
    drawn, known = set(), set()
    for preset, prepare in CASES[page]:
        session = Session()
        session.state.scenario.choose(preset)
        session.state.page = page
        if prepare is not None:
            prepare(session.state)
        session.state.page = page
        view = session.views[page]
        if prepare is None:
            assert view.numbers.button.visible == (page not in WITHOUT_FIGURE)
        # the many rows of Papers are computed for each theme
        for dark in (False,) if page == "Papers" else (False, True):
            session.state.dark = dark
            for chart in view.charts:
                known.add(chart.name)
                if chart.is_drawn and in_open_tab(view, chart):
                    drawn.add(chart.name)
                    check(chart, "dark" if dark else "light")
    assert known - drawn <= NO_FIGURE
    assert [record for record in caplog.records if record.levelno >= logging.ERROR] == []


def in_open_tab(view, chart):
    """Return whether a chart can be seen: behind another tab it is drawn in other colours once that is open."""
    bodies = getattr(getattr(getattr(view, "of", None), "tabs", None), "bodies", {})
    return not any(chart.host in body.select() for tab, body in bodies.items() if tab != view.of.tab)


def check(chart, theme):
    f = chart.figure
    if not isinstance(f, figure):
        return
    check_axes(chart, f)
    assert has_toolbar(f), f"toolbar of {chart.name}"
    colours = {*THEMES[theme].values(), *COST_SCALES[theme], *SAVING_SCALES[theme], DARK_INK, WHITE}
    for drawn in (one for one in f.renderers if isinstance(one, GlyphRenderer) and one.visible):
        glyph, data = drawn.glyph, drawn.data_source.data
        for attribute in set(COLOURS) & glyph.properties():
            one = getattr(glyph, attribute)
            worn = data[one] if isinstance(one, str) and one in data else [one]
            # runs of a study are coloured by a scale of their own
            if not chart.name.startswith("explore_"):
                assert {colour for colour in worn if isinstance(colour, str)} <= colours, (chart.name, attribute)
        for axis, ends in (("x", f.x_range), ("y", f.y_range)):
            name = getattr(glyph, axis, None)
            if type(glyph).__name__ not in {"Line", "Scatter"} or (chart.name, axis) in CUT or name not in data:
                continue
            values = np.asarray(data[name], dtype=float)
            values, room = values[np.isfinite(values)], 0.02 * abs(ends.end - ends.start)
            assert np.isfinite(room)
            assert room > 0
            low, high = sorted((ends.start, ends.end))
            assert np.all((low - room <= values) & (values <= high + room)), (chart.name, axis)


def check_axes(chart, f):
    if f.xaxis[0].visible:
        label = f.xaxis[0].axis_label or ""
        assert UNIT.search(label) or label in COUNTED, f"x axis of {chart.name}: {label!r}"
    # of the runs of a study the heading above names both axes
    if chart.name != "explore_runs" and f.yaxis[0].visible and f.yaxis[0].major_label_text_alpha:
        # a caption stands at the upper end of the y axis, and names it
        label = f.yaxis[0].axis_label or chart.caption
        assert UNIT.search(label) or label in COUNTED, f"y axis of {chart.name}: {label!r}"


def has_toolbar(f):
    """Return whether the toolbar shows only full screen and saving, while the mouse is over the figure."""
    buttons = [type(tool) for tool in f.tools if tool.visible]
    names = [tool.filename for tool in f.tools if isinstance(tool, SaveTool)]
    return buttons == [FullscreenTool, SaveTool] and all(names) and bool(f.toolbar_location) and f.toolbar.autohide
