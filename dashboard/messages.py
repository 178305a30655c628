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


@contextlib.contextmanager
def one_message() -> Iterator[None]:
    """Send all changes made within as one message; the document is searched once, before it is sent.

    Were it searched after that, the browser would be sent the new models again with the next message.
    """
    document = pn.state.curdoc
    with pn.io.hold():
        if document is None:
            yield
            return
        with unfrozen():
            document.models._push_freeze()
            yield
            document.models._pop_freeze()


@contextlib.contextmanager
def added_to(place: Viewable) -> Iterator[None]:
    """Send all changes made within as one message, where all that is new is put into one place."""
    document = pn.state.curdoc
    with pn.io.hold():
        if document is None:
            yield
            return
        with unfrozen():
            document.models._push_freeze()
            yield
            for model, _ in place._models.values():
                attach(document, model)
            # what has left the page stays known until the document is searched the next time
            document.models._freeze_count -= 1


def attach(document: Any, model: Any) -> None:
    """Make a model and all that it holds models of a document, as a search of the whole document would."""
    models = document.models
    for new in model.references():
        if new.id not in models:
            new._attach_document(document)
            models[new.id] = new
            models._new_models.add(new)
            if new.name is not None:
                models._models_by_name.add_value(new.name, new)


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


def frozen(document: Any) -> int:
    """Return how many times a document is frozen."""
    return 0 if document is None else int(document.models._freeze_count)


def thaw(document: Any, count: int) -> None:
    """Thaw a document until it is frozen only so many times."""
    while frozen(document) > count:
        document.models._pop_freeze()
