"""Changes of the page that go to the browser together, and what new models cost the document.

Whenever the library changes what a model holds, it searches the whole document for models that are new. With all pages
in it that takes a tenth of a second; so it is done once a message, and not at all where the place of what is new is
known.
"""

import contextlib
from collections.abc import Iterator
from typing import Any

import panel as pn
from panel.viewable import Viewable

from railjoule.dashboard.insides import attach, freeze, frozen, models_of, thaw, thaw_unsearched


@contextlib.contextmanager
def one_message() -> Iterator[None]:
    """Send all changes made within as one message; the document is searched once, before it is sent.

    Were it searched after that, the browser would be sent the new models again with the next message.
    """
    with _one_freeze() as document:
        yield
        if document is not None:
            thaw(document, frozen(document) - 1)


@contextlib.contextmanager
def added_to(place: Viewable) -> Iterator[None]:
    """Send all changes made within as one message, where all that is new is put into one place."""
    with _one_freeze() as document:
        yield
        if document is not None:
            for model in models_of(place):
                attach(document, model)
            thaw_unsearched(document)


@contextlib.contextmanager
def _one_freeze() -> Iterator[Any]:
    """Freeze the document of this turn once more, and hold its messages; who asks for it thaws it."""
    # the hold around it: the search at the thaw comes before the message goes
    with pn.io.hold(), unfrozen():
        if (document := pn.state.curdoc) is not None:
            freeze(document)
        yield document


@contextlib.contextmanager
def unfrozen() -> Iterator[None]:
    """Leave the document of this turn open to changes even where what is done in between fails.

    The library freezes a document while it changes what it holds, and forgets to thaw it after an error: whatever is
    added later would then never reach the browser.
    """
    document = pn.state.curdoc
    before = frozen(document)
    try:
        yield
    except Exception:
        thaw(document, before)
        raise
