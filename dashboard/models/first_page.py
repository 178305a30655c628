"""Which page an address asks for."""

from collections.abc import Mapping, Sequence

from railjoule.dashboard.models.workbench import PAGES


def first_page(query: Mapping[str, Sequence[bytes]]) -> str:
    """Return the page that the query of an address names, or Start if it names none that there is.

    Parameters
    ----------
    query : mapping of str to sequence of bytes
        As servers give it, such as {'v': [b'1'], 'page': [b'Drive']}.
    """
    named = query.get("page") or [b""]
    name = named[-1].decode("utf-8", "replace")
    return name if name in PAGES else PAGES[0]
