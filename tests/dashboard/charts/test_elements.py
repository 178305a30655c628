import gc
import weakref

import holoviews as hv
from bokeh.document import Document
from bokeh.io.doc import patch_curdoc
from bokeh.plotting import figure

from railjoule.dashboard.charts.elements import figure_of


def _of_points() -> figure:
    return figure_of(lambda: hv.Points([(1.0, 2.0), (3.0, 4.0)]))


def test_the_page_being_served_meanwhile_is_left_alone() -> None:
    page = Document()
    theme = page.theme
    # Bokeh's current document is the same for all threads: a figure made beside a session in hand sees its page
    with patch_curdoc(page):
        f = _of_points()
    assert page.theme is theme
    assert page.session_destroyed_callbacks == set()
    assert f.document is None


def test_nothing_keeps_a_figure_that_is_dropped() -> None:
    f = weakref.ref(_of_points())
    gc.collect()
    assert f() is None
