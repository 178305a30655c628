"""Every axis of every figure of every page says what it shows, and in which unit."""

import re

import pytest
from bokeh.plotting import figure

from railjoule.dashboard.app import VIEWS, Session

UNIT = re.compile(r", (km/h|kWh|Wh/s|kN|MW|kW|A|V s|V|N m|rad/s|Wb|s|mm|m|ms|min|%|J|Hz|\u2030|\u2013)(?![a-z])")
COUNTED = ("Trip", "Row, in the order of the tables", "Changes of regime between two stops")
"""What is counted has no unit."""


# Panel warns once of how panel-material-ui calls it
@pytest.mark.filterwarnings("ignore::PendingDeprecationWarning")
@pytest.mark.parametrize("page", list(VIEWS))
def test_all_axes_are_named(page: str) -> None:
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
