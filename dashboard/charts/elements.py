"""HoloViews' elements as railjoule's figures: shared by notebooks and the pages that use HoloViews.

Loading HoloViews takes a third of a second, and making a figure of an element some hundredths: pages do both in a
thread, and import this module there.
"""

import threading
from collections.abc import Callable

import holoviews as hv
import holoviews.plotting.bokeh  # options are known only once their backend is
from bokeh.document import Document
from bokeh.plotting import figure

from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.tokens import FONT

# options of elements stand in tables of the process, which all threads write to
_ONE_AT_A_TIME = threading.Lock()


def render_figure(make: Callable[[], hv.core.ViewableElement | hv.Overlay]) -> figure:
    """Return the figure that an element becomes; the element is made here too, as its options are the process's."""
    with _ONE_AT_A_TIME:
        # Without a document of its own the renderer takes Bokeh's current one. That is no matter of the thread: it is
        # the one of whichever session is being served just now, and its theme would be set while its page is built.
        # Only the mode of servers heeds the document it is given.
        return hv.renderer("bokeh").instance(mode="server").get_plot(make(), doc=Document()).state


def dress_legends(f: figure, palette: Palette, ground: str | None = "surface") -> None:
    """Give the legends of a figure our font and colours, and a ground where one is named."""
    for legend in f.legend:
        legend.update(label_text_font=FONT, label_text_font_size="12px", border_line_color=None)
        palette.paint(legend, label_text_color="ink2")
        if ground is None:
            legend.background_fill_color = None
        else:
            palette.paint(legend, background_fill_color=ground)
