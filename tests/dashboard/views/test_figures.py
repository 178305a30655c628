"""Every figure of every page: its axes have names and units, and its toolbar has two buttons."""

import re

import pytest
from bokeh.models import FullscreenTool, HoverTool, SaveTool
from bokeh.plotting import figure

from railjoule.dashboard.app import VIEWS, Session
from railjoule.dashboard.charts.figures import dress_alone
from railjoule.dashboard.look.paint import Palette

UNIT = re.compile(r", (km/h|kWh|Wh/s|kN|MW|kW|A|V s|V|N m|rad/s|Wb|s|mm|m|ms|min|%|J|Hz|\u2030|\u2013)(?![a-z])")
COUNTED = ("Trip", "Row, in the order of the tables", "Changes of regime between two stops")
"""What is counted has no unit."""


def has_toolbar(f: figure) -> bool:
    """Return whether the toolbar shows full screen and saving alone, while the mouse is over the figure."""
    buttons = [type(tool) for tool in f.tools if tool.visible]
    names = [tool.filename for tool in f.tools if isinstance(tool, SaveTool)]
    return buttons == [FullscreenTool, SaveTool] and all(names) and bool(f.toolbar_location) and f.toolbar.autohide


# Panel warns once of how panel-material-ui calls it
@pytest.mark.filterwarnings("ignore::PendingDeprecationWarning")
@pytest.mark.parametrize("page", list(VIEWS))
def test_all_figures(page: str) -> None:
    session = Session()
    session.state.scenario.choose("ftorek-300s")
    session.state.page = page
    view = session.views[VIEWS[page].__name__]
    session.state.param.trigger("page")
    named = 0
    for chart in view.charts:
        if chart.figure is None:
            chart.build()
        f = chart.figure
        if not isinstance(f, figure):
            continue
        assert has_toolbar(f), f"toolbar of {chart.name}"
        if f.xaxis[0].visible:
            label = f.xaxis[0].axis_label or ""
            assert UNIT.search(label) or label in COUNTED, f"x axis of {chart.name}: {label!r}"
            named += 1
        if f.yaxis[0].visible and f.yaxis[0].major_label_text_alpha:
            # a caption stands at the upper end of the y axis, and names it
            label = f.yaxis[0].axis_label or chart.caption
            assert UNIT.search(label), f"y axis of {chart.name}: {label!r}"
            named += 1
    assert named or not view.charts


@pytest.mark.parametrize("keeps_hover", [True, False])
def test_figures_that_are_made_in_threads_have_the_toolbar(keeps_hover: bool) -> None:
    f = figure(tools="pan,hover,save,reset")
    dress_alone(f, "Energy, kWh", Palette(dark=True), keeps_hover=keeps_hover)
    assert has_toolbar(f)
    assert any(isinstance(tool, HoverTool) for tool in f.tools) == keeps_hover
