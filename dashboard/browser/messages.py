"""Changes of the page that go to the browser together."""

import contextlib
from collections.abc import Iterator

import panel as pn

from railjoule.dashboard.library_workarounds import frozen, thaw


@contextlib.contextmanager
def one_message() -> Iterator[None]:
    """Send all changes made within as one message, for which the document is searched once for new models.

    Bokeh searches the whole document whenever what a model contains changes.
    """
    document = pn.state.curdoc
    freeze = contextlib.nullcontext() if document is None else document.models.freeze()
    # the hold around the freeze: a search after the message would send the new models again with the next one
    with pn.io.hold(), unfrozen(), freeze:
        yield


@contextlib.contextmanager
def unfrozen() -> Iterator[None]:
    """Leave the document of this turn open to changes after an error within: Bokeh's own `freeze` does not."""
    document = pn.state.curdoc
    before = frozen(document)
    try:
        yield
    except Exception:
        thaw(document, before)
        raise
