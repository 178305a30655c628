"""When the charts of a page are drawn, told by a document that writes down what it is asked for."""

from collections.abc import Iterator

import pytest
from bokeh.document import Document
from panel.io.state import set_curdoc

from railjoule.dashboard.browser import Browser
from railjoule.dashboard.charts.drawing import LATER_MS, DrawingQueue
from railjoule.dashboard.charts.plot import CurveChart, Plot
from railjoule.dashboard.faults import Faults
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.work import events


@pytest.fixture
def someone() -> Iterator[object]:
    """One of whom is told when it waits."""
    who = type("Who", (), {})()
    yield who
    events.WAITS.settle(who)


@pytest.mark.parametrize("waits", [False, True])
def test_a_chart_that_is_new_comes_after_the_answers_to_moves(waits: bool, someone: object) -> None:
    asked: list[int] = []

    class Asked(Document):
        def add_next_tick_callback(self, callback):
            asked.append(0)

        def add_timeout_callback(self, callback, timeout_milliseconds):
            asked.append(timeout_milliseconds)

    browser, chart = Browser(), CurveChart(Plot("curve"), 300, Palette(dark=False))
    queue = DrawingQueue(browser, Faults(lambda _: None), lambda: True, lambda: None)
    queue.take((chart,))
    browser.started = True
    if waits:
        events.WAITS.wait(someone)
    with set_curdoc(Asked()):
        chart.show(lambda: chart.draw({}))
    assert asked == [LATER_MS if waits else 0]
