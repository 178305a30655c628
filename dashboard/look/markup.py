"""HTML in which whatever is not HTML itself is escaped: what is HTML has the type `Markup`, all else is text.

A piece of HTML is a template with braces, never an f-string, which would take a scenario's title as it stands; a test
looks through all files for such.
"""

import html
from collections.abc import Iterable

from markupsafe import Markup

__all__ = ["Markup", "escaped", "joined", "markup"]


def markup(template: str, *values: object, **named: object) -> Markup:
    """Return HTML in which values take the places of braces; each is escaped, unless it is HTML already."""
    return Markup(template.format(*map(safe, values), **{name: safe(value) for name, value in named.items()}))


def joined(pieces: Iterable[str], between: str = "") -> Markup:
    """Return pieces one after the other; those that are no HTML are escaped."""
    return Markup(between.join(map(safe, pieces)))


def escaped(text: str) -> Markup:
    """Return a text that may come from a user, fit for HTML."""
    return markup("{}", text)


def safe(value: object) -> str:
    """Return a value as HTML, several times faster than Markup does: each move of a slider writes hundreds."""
    return value if isinstance(value, Markup) else html.escape(str(value))
