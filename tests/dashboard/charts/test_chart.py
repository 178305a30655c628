import panel as pn
import pytest
from bokeh.core.property.descriptors import UnsetValueError
from bokeh.models import LinearColorMapper
from bokeh.plotting import figure

from railjoule.dashboard.charts.axis import Axis
from railjoule.dashboard.charts.chart import Chart
from railjoule.dashboard.charts.dress import check_complete
from railjoule.dashboard.look.paint import Palette


def test_an_axis_keeps_its_zoom_until_its_end_changes() -> None:
    axis = Axis(Palette(dark=False))
    axis.fit(1000.0, roomy=False)
    axis.range.update(start=200.0, end=400.0)
    axis.fit(1000.0, roomy=False)
    assert (axis.range.start, axis.range.end) == (200.0, 400.0)
    axis.fit(1200.0, roomy=False)
    assert (axis.range.start, axis.range.end) == (0.0, 1200.0)


class CountingChart(Chart):
    def __init__(self) -> None:
        super().__init__("counting", "", 100)
        self.built = 0

    def build(self) -> None:
        self.built += 1
        self.content = pn.Spacer()


def test_a_chart_takes_the_place_of_its_sketch_once_it_is_drawn() -> None:
    chart, drawn = CountingChart(), []
    assert "Being computed: counting" in chart.host.stylesheets[0]
    assert not chart.is_drawn
    chart.settle()
    assert chart.built == 0
    chart.show(lambda: drawn.append("first"))
    chart.show(lambda: drawn.append("second"))
    assert (chart.built, drawn) == (1, ["first", "second"])
    assert chart.is_drawn
    assert list(chart.host) == [chart.content]


def test_a_chart_that_fails_leaves_its_sketch_and_is_built_anew() -> None:
    chart = CountingChart()
    chart.waiting = lambda: 1 / 0
    with pytest.raises(ZeroDivisionError):
        chart.settle()
    assert not chart.is_drawn
    chart.fail()
    assert "could not be drawn" in chart.host[0].object
    chart.show(lambda: None)
    assert (chart.built, chart.is_drawn) == (2, True)


def test_a_figure_that_lacks_what_its_models_need_is_not_sent() -> None:
    f = figure()
    f.image("image", 0, 0, 1, 1, color_mapper=LinearColorMapper())
    with pytest.raises(UnsetValueError, match="palette"):
        check_complete(f)
